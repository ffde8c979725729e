// Many receivers in one process: worker threads, each with its share of the receivers that are
// alive at a time, over one transport.
//
//   LoadRun run(options, transport);
//   run.start();
//   while (!run.finished()) { sleep; print(run.progress()); }
//   LoadResult result = run.end();
//
// A receiver's mesh is large, so only `concurrency` receivers are alive at once; the next one
// starts when one is done, or later, as the arrival rate says.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "load/duration_percentiles.h"
#include "load/simulated_receiver.h"
#include "load/view_choice.h"

namespace meshfront {

struct LoadRunOptions {
  MeshUrl url;
  SimulatedReceiverOptions receiver;
  uint64_t receivers = 100;    // in all
  uint64_t concurrency = 256;  // alive at a time, >= 1
  double arrivalRate = 0;      // receivers a second; 0: as fast as concurrency lets
  std::chrono::duration<double> duration{
      0};                // seconds after which what is alive is given up; 0: none
  unsigned workers = 1;  // threads, >= 1
};

struct LoadResult {
  uint64_t started = 0;
  uint64_t settled = 0;   // all that is seen is there; complete ones among them
  uint64_t complete = 0;  // the whole mesh is there
  uint64_t failed = 0;
  uint64_t unfinished = 0;  // given up at the end of time
  uint64_t resumed = 0;     // times that a receiver went on after losing the server
  uint64_t malformed = 0;   // answers
  uint64_t records = 0;     // applied
  uint64_t mostAlive = 0;
  double seconds = 0;                        // of the run
  DurationPercentiles settling;              // of the settled ones
  std::map<std::string, uint64_t> failures;  // by reason, the first kinds
};

class LoadRun {
 public:
  // `transport` outlives the run. `views` is used from now on.
  LoadRun(LoadRunOptions options, ViewChoice views, Transport& transport);
  // Gives up what is alive.
  ~LoadRun();
  LoadRun(const LoadRun&) = delete;
  LoadRun& operator=(const LoadRun&) = delete;

  void start();
  [[nodiscard]] bool finished() const;  // every receiver is done
  [[nodiscard]] LoadResult progress() const;
  // Gives up what is alive and joins the threads.
  [[nodiscard]] LoadResult end();

 private:
  class Worker;
  struct Ticket {  // one receiver to be started
    CameraSpec view;
  };
  using Clock = SimulatedReceiver::Clock;

  // For workers. The next receiver if its time has come; else when to ask again, in `later` (never,
  // if it stays unset).
  [[nodiscard]] std::optional<Ticket> nextTicket(std::optional<Clock::time_point>& later);
  void recordEnd(const SimulatedReceiver& receiver, SimulatedReceiver::State state);

  const LoadRunOptions options_;
  Transport& transport_;
  Clock::time_point begin_;
  mutable std::mutex mutex_;  // guards what follows
  ViewChoice views_;
  LoadResult result_;
  uint64_t alive_ = 0;
  std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace meshfront
