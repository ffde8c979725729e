#include "shared/receiver/automatic_resume.h"

#include <random>

namespace meshfront {

AutomaticResume::AutomaticResume(RetryPolicy policy)
    : AutomaticResume(policy, std::random_device{}()) {}

bool AutomaticResume::tend(Receiver& receiver, Clock::time_point now) {
  const uint64_t bytes = receiver.statistics().answerBytesDown;
  if (bytes != bytesThen_) attempts_ = 0;  // it got further
  bytesThen_ = bytes;
  if (!receiver.canResume()) {
    due_.reset();
    return false;
  }
  if (!due_) due_ = now + schedule_.delay(++attempts_, {});
  if (now < *due_) return false;
  due_.reset();
  return receiver.resume();
}

std::optional<std::chrono::milliseconds> AutomaticResume::nextResumeAfter(
    Clock::time_point now) const {
  if (!due_) return std::nullopt;
  if (*due_ <= now) return std::chrono::milliseconds(0);
  return std::chrono::ceil<std::chrono::milliseconds>(*due_ - now);
}

}  // namespace meshfront
