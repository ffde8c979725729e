// Threads for answers that wait for another machine, with a bounded queue.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace meshfront {

class WorkerPool {
 public:
  WorkerPool(unsigned threads, size_t maxQueued);
  ~WorkerPool() { finish(); }
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // False, without keeping the job, when the queue is full or after finish().
  [[nodiscard]] bool submit(std::function<void()> job);
  // Runs what is queued to its end, then stops the threads.
  void finish();

 private:
  void work();

  const size_t maxQueued_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> queue_;
  bool finishing_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace meshfront
