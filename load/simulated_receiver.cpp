#include "load/simulated_receiver.h"

#include <utility>

namespace meshfront {
namespace {

ReceiverOptions receiverOptionsOf(const SimulatedReceiverOptions& options,
                                  std::function<void()> onArrival) {
  ReceiverOptions result;
  result.mode = options.mode;
  result.batch = options.batch;
  result.window = options.window;
  result.onArrival = std::move(onArrival);
  return result;
}

}  // namespace

SimulatedReceiver::SimulatedReceiver(const MeshUrl& url, const CameraSpec& view,
                                     const SimulatedReceiverOptions& options, Transport& transport,
                                     std::function<void()> onArrival)
    : view_(view),
      options_(options),
      receiver_(url, receiverOptionsOf(options, std::move(onArrival)), transport) {}

SimulatedReceiver::State SimulatedReceiver::step(ProjectedPixels& pixels) {
  if (receiver_.state() == ReceiverState::degraded) {
    if (SimulatedReceiver::Clock::now() < wakeAt_) return State::resting;
    if (!receiver_.resume()) return State::failed;
    ++resumed_;
  }
  do {
    const uint64_t before = receiver_.statistics().answers;
    (void)receiver_.advance();
    if (receiver_.statistics().answers != before) lostAt_.reset();
    if (receiver_.mesh() != nullptr && receiver_.wantsRanking()) rank(pixels);
  } while (receiver_.isAtWork() && receiver_.waitForArrival(std::chrono::milliseconds(0)));
  switch (receiver_.state()) {
    case ReceiverState::connecting:
    case ReceiverState::refining:
      return State::waiting;
    case ReceiverState::settled:
    case ReceiverState::complete:
      return State::settled;
    default:
      return rest();
  }
}

void SimulatedReceiver::rank(ProjectedPixels& pixels) {
  const MeshMetadata& metadata = *receiver_.metadata();
  if (!camera_) {
    bounds_ = Bounds::of(metadata.boundsMin, metadata.boundsMax);
    camera_ = placeCamera(view_, bounds_, options_.picture.aspect());
  }
  receiver_.rank(
      pixels.count(*receiver_.mesh(), metadata.quantization, bounds_, *camera_, options_.picture));
}

// Lost: for a while, or for good.
SimulatedReceiver::State SimulatedReceiver::rest() {
  const Clock::time_point now = Clock::now();
  if (!lostAt_) lostAt_ = now;
  if (now - *lostAt_ >= options_.patience) return State::failed;
  wakeAt_ = now + options_.resumeInterval;
  return State::resting;
}

}  // namespace meshfront
