#include "shared/http/server/termination_signals.h"

#include <pthread.h>

#include <algorithm>
#include <cerrno>

namespace meshfront {
namespace {

using Clock = std::chrono::steady_clock;

// The signal, or -1 when `deadline` is over. An interrupted wait is taken up again.
int signalBefore(const sigset_t& signals, Clock::time_point deadline) {
  while (true) {
    const auto left = std::max(deadline - Clock::now(), Clock::duration::zero());
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
    timespec timeout{};
    timeout.tv_sec = seconds.count();
    timeout.tv_nsec = std::chrono::nanoseconds(left - seconds).count();
    const int signal = sigtimedwait(&signals, nullptr, &timeout);
    if (signal > 0 || errno != EINTR) return signal;
  }
}

int nextSignal(const sigset_t& signals) {
  int signal = 0;
  while (sigwait(&signals, &signal) == EINTR) {
  }
  return signal;
}

}  // namespace

TerminationSignals::TerminationSignals() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGTERM);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

void TerminationSignals::wait(const Meanwhile& meanwhile) const {
  const bool ticks = meanwhile.every.count() > 0;
  auto next = Clock::now() + meanwhile.every;
  while (true) {
    const int signal = ticks ? signalBefore(signals_, next) : nextSignal(signals_);
    if (signal == SIGTERM || signal == SIGINT) return;
    if (signal == SIGHUP) {
      if (meanwhile.onHangUp) meanwhile.onHangUp();
      continue;
    }
    if (meanwhile.onTick) meanwhile.onTick();
    next = Clock::now() + meanwhile.every;
  }
}

}  // namespace meshfront
