// A clean end on SIGTERM and SIGINT.
#pragma once

#include <csignal>

namespace meshfront {

// Make one before any thread is started: threads inherit the blocked signals. SIGPIPE is ignored.
class TerminationSignals {
 public:
  TerminationSignals();
  // Returns after SIGTERM or SIGINT.
  void wait() const;

 private:
  sigset_t signals_{};
};

}  // namespace meshfront
