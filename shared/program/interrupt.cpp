#include "shared/program/interrupt.h"

#include <csignal>

namespace meshfront {
namespace {

volatile std::sig_atomic_t asked = 0;

void ask(int /*signal*/) {
  asked = 1;
}

}  // namespace

void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = &ask;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second signal ends the program at once
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return asked != 0;
}

}  // namespace meshfront
