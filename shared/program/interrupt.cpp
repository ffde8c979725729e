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
  sigaction(SIGTERM, &action, nullptr);  // which timeout(1) and others send more than once
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends the program at once
  sigaction(SIGINT, &action, nullptr);
}

bool interrupted() {
  return asked != 0;
}

}  // namespace meshfront
