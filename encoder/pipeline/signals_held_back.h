// Interrupts that wait while a program writes.
#pragma once

#include <csignal>

namespace meshfront {

// While output is written an interrupt waits: writing looks for it and gives up, with nothing left
// behind; then it is delivered. One object at a time, from one thread.
class SignalsHeldBack {
 public:
  SignalsHeldBack() {
    sigemptyset(&set_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      struct sigaction action {};
      sigaction(signal, nullptr, &action);
      if (action.sa_handler != SIG_IGN) sigaddset(&set_, signal);
    }
    pthread_sigmask(SIG_BLOCK, &set_, &before_);
  }
  ~SignalsHeldBack() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeldBack(const SignalsHeldBack&) = delete;
  SignalsHeldBack& operator=(const SignalsHeldBack&) = delete;

  [[nodiscard]] bool interrupted() const {
    sigset_t waiting;
    sigpending(&waiting);
    sigandset(&waiting, &waiting, &set_);
    return sigisemptyset(&waiting) == 0;
  }
  // The output is there: from now on an interrupt comes too late to change how this ends.
  void ignore() const {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
      if (sigismember(&set_, signal) == 1) std::signal(signal, SIG_IGN);
  }

 private:
  sigset_t set_{};
  sigset_t before_{};
};

}  // namespace meshfront
