// Plays a camera path over something that refines, frame by frame in the path's own time, and
// writes what it sees. Knows nothing of GL or of receivers: FlownScene stands for both.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "shared/camera/camera.h"
#include "shared/result.h"
#include "viewer/picture/picture.h"
#include "viewer/run/camera_path.h"
#include "viewer/run/flight_log.h"

namespace meshfront {

enum class FlightPace : uint8_t {
  real,     // a frame gets the answers that arrive in its share of a second
  settled,  // a frame waits until its view is settled: exact pictures
};

class FlownScene {
 public:
  virtual ~FlownScene() = default;
  enum class Outlook : uint8_t {
    more,     // something is under way or to be asked for
    settled,  // all that this view shows is there
    stuck,    // nothing comes unless it is tried again; row().state says why
  };
  // Takes in what has arrived, looks from here and asks for what that view needs.
  [[nodiscard]] virtual Result<Outlook> look(const Camera& camera) = 0;
  // Until something arrives, at most so long.
  virtual void wait(std::chrono::milliseconds longest) = 0;
  [[nodiscard]] virtual Result<Picture> picture(const Camera& camera) = 0;
  // dB against a reference; none without one.
  [[nodiscard]] virtual Result<std::optional<double>> psnr(const Camera& camera,
                                                           const Picture& picture) = 0;
  // Costs and state now; frame, time and psnr are left as they are.
  [[nodiscard]] virtual FlightRow row() const = 0;
};

struct FlightOptions {
  FlightPace pace = FlightPace::real;
  std::optional<std::filesystem::path> frames;  // folder for frame-00000.png ..., made if missing
  std::optional<std::filesystem::path> log;     // CSV
  std::function<bool()> ended;                  // asked often: end the flight now
  std::function<void(uint64_t frame, uint64_t frames)> progress;  // may be empty
};

struct FlightSummary {
  uint64_t frames = 0;  // played
  uint64_t framesOfPath = 0;
  uint64_t settledFrames = 0;        // of views that were settled
  std::optional<double> lowestPsnr;  // dB
  std::optional<double> meanPsnr;    // dB
  bool stuck = false;                // by pace settled: a frame could not settle, and ended it
};

// Errors are of drawing or writing.
[[nodiscard]] Result<FlightSummary> fly(const CameraPath& path, FlownScene& scene,
                                        const FlightOptions& options);

}  // namespace meshfront
