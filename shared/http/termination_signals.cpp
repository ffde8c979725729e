#include "shared/http/termination_signals.h"

#include <pthread.h>

namespace meshfront {

TerminationSignals::TerminationSignals() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGTERM);
  sigaddset(&signals_, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

void TerminationSignals::wait() const {
  int signal = 0;
  sigwait(&signals_, &signal);
}

}  // namespace meshfront
