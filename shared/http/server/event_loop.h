// A thread that serves connections: waits until some of them, or a worker's answer, or a deadline
// needs something done, and does it.
//
// Nothing in it waits or sleeps but for epoll. A connection belongs to the loop that accepted it;
// loops share the listening socket, and what they share else is in Serving.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "shared/http/server/connection.h"
#include "shared/http/server/deadlines.h"
#include "shared/http/server/exchange.h"
#include "shared/http/server/response_head.h"
#include "shared/result.h"

namespace meshfront {

class EventLoop {
 public:
  struct Deadlines {
    DeadlineList header;
    DeadlineList content;
    DeadlineList answer;
    DeadlineList silence;
    DeadlineList turns;  // pass at once: there is more to read than one turn takes
  };

  // Accepts from `listener`, which is non-blocking and outlives the loop, until `serving.ending`.
  [[nodiscard]] static Result<std::unique_ptr<EventLoop>> start(Serving& serving, int listener);
  // Closes all connections.
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  // From any thread: an answer is there; look at what has changed in Serving.
  void post(std::shared_ptr<Exchange> exchange);
  void wake() const;

  // For connections, on the loop's thread.
  [[nodiscard]] Serving& serving() { return serving_; }
  [[nodiscard]] std::span<char> buffer() { return buffer_; }
  [[nodiscard]] int64_t now() const { return now_; }  // ms, steady, some ms coarse
  [[nodiscard]] const std::string& dateField();
  [[nodiscard]] Deadlines& deadlines() { return deadlines_; }

 private:
  EventLoop(Serving& serving, int listener, int epoll, int wakeup);
  void run();
  void turn();
  void accept();
  void open(int socket, const sockaddr_storage& peer);
  void setAccepting(bool accepting);
  void takePosts();
  void takeDeadlines();
  void takeTurns();
  void keepOrEnd(Connection& connection, bool goesOn);
  [[nodiscard]] int timeout() const;

  Serving& serving_;
  const int listener_;
  const int epoll_;
  const int wakeup_;
  std::vector<char> buffer_;
  int64_t now_;
  DateField date_;
  Deadlines deadlines_;
  bool accepting_ = false;
  int64_t acceptAgain_ = 0;                               // not before then
  std::vector<std::unique_ptr<Connection>> connections_;  // by socket

  std::atomic<bool> stopping_{false};
  std::mutex postMutex_;
  std::vector<std::shared_ptr<Exchange>> posts_;
  std::thread thread_;
};

}  // namespace meshfront
