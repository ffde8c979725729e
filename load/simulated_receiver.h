// One receiver of a load run: the viewer's receiver, looking from one camera until it has settled.
// Belongs to one worker's thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "load/projected_pixels.h"
#include "shared/camera/camera_spec.h"
#include "shared/receiver/receiver.h"

namespace meshfront {

struct SimulatedReceiverOptions {
  FetchMode mode = FetchMode::exact;
  uint32_t batch = 0;   // as ReceiverOptions has them
  uint32_t window = 0;  // likewise
  PixelSize picture{500, 500};
  std::chrono::milliseconds patience{60'000};  // how long it tries again after losing the server
  std::chrono::milliseconds resumeInterval{1'000};
};

class SimulatedReceiver {
 public:
  using Clock = std::chrono::steady_clock;

  enum class State {
    waiting,  // for answers
    resting,  // the server was lost; to be stepped again at wakeAt()
    settled,  // or complete: done
    failed    // reason() says why
  };

  // `onArrival` is called on a thread of the transport when step() has something to do.
  SimulatedReceiver(const MeshUrl& url, const CameraSpec& view,
                    const SimulatedReceiverOptions& options, Transport& transport,
                    std::function<void()> onArrival);

  // Applies what has arrived, ranks and asks, until it must wait. `pixels`: the worker's own.
  State step(ProjectedPixels& pixels);

  [[nodiscard]] Clock::time_point startedAt() const { return startedAt_; }
  [[nodiscard]] Clock::time_point wakeAt() const { return wakeAt_; }  // while resting
  [[nodiscard]] uint64_t resumed() const { return resumed_; }         // times
  [[nodiscard]] const std::string& reason() const { return receiver_.reason(); }
  [[nodiscard]] const Receiver& receiver() const { return receiver_; }

 private:
  void rank(ProjectedPixels& pixels);
  State rest();

  const CameraSpec view_;
  const SimulatedReceiverOptions options_;
  Receiver receiver_;
  Bounds bounds_;
  std::optional<Camera> camera_;
  const Clock::time_point startedAt_ = Clock::now();
  std::optional<Clock::time_point> lostAt_;
  Clock::time_point wakeAt_;
  uint64_t resumed_ = 0;
};

}  // namespace meshfront
