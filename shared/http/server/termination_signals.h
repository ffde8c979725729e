// A clean end on SIGTERM and SIGINT; SIGHUP for taking up what an operator has changed.
#pragma once

#include <chrono>
#include <csignal>
#include <functional>

namespace meshfront {

// Make one before any thread is started: threads inherit the blocked signals. SIGPIPE is ignored.
class TerminationSignals {
 public:
  TerminationSignals();

  // What the waiting thread does meanwhile; either may be empty.
  struct Meanwhile {
    std::function<void()> onHangUp;      // after a SIGHUP; several at once may count as one
    std::chrono::milliseconds every{0};  // 0: never
    std::function<void()> onTick;        // every that often, however many SIGHUP come
  };
  // Returns after SIGTERM or SIGINT, once what it was doing is done.
  void wait(const Meanwhile& meanwhile) const;
  void wait() const { wait(Meanwhile{}); }

 private:
  sigset_t signals_{};
};

}  // namespace meshfront
