// The way of a run: connect -> [take answers, draw, count, rank, request, wait]* for each frame
// -> write it -> the summary.
#include "viewer/path_run.h"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "shared/program/interrupt.h"
#include "shared/receiver/http_fetcher.h"
#include "shared/scene/scene_receiver.h"
#include "viewer/gl/gl_context.h"
#include "viewer/progress_line.h"
#include "viewer/reference_picture.h"
#include "viewer/run/flight.h"
#include "viewer/run_summary.h"
#include "viewer/scene_options.h"
#include "viewer/scene_picture.h"

namespace meshfront {
namespace {

using PathClock = std::chrono::steady_clock;

double secondsSince(PathClock::time_point start) {
  return std::chrono::duration<double>(PathClock::now() - start).count();
}

// The scene as a flight sees it.
class FlownMeshes final : public FlownScene {
 public:
  FlownMeshes(const ViewOptions& options, PathClock::time_point start)
      : options_(options),
        start_(start),
        scene_(options.scene, pictureSceneOptions(options), http_) {
    style_.colours = options.colours;
  }

  // Until there is a mesh.
  Result<void> connect() {
    while (!scene_.allHere() && scene_.status().state == ReceiverState::connecting && !ended()) {
      wait(std::chrono::milliseconds(50));
      (void)scene_.advance();
    }
    if (!scene_.allHere()) {
      const std::string reason = scene_.status().reason;
      return fail(ErrorCode::unavailable,
                  reason.empty() ? "ended before there was a mesh" : reason);
    }
    auto picture = ScenePicture::create(
        options_.size, options_.scene,
        options_.countOnCpu ? PixelCounter::Method::readBack : PixelCounter::Method::compute);
    if (!picture) return tl::unexpected(picture.error());
    picture_.emplace(std::move(*picture));
    return {};
  }
  [[nodiscard]] Bounds bounds() const { return *scene_.bounds(); }
  [[nodiscard]] SceneStatus status() const { return scene_.status(); }
  [[nodiscard]] bool ended() const {
    return interrupted() || (options_.timeout > 0 && secondsSince(start_) >= options_.timeout);
  }

  Result<Outlook> look(const Camera& camera) override {
    (void)scene_.advance();
    const ReceiverState state = scene_.status().state;
    if (state == ReceiverState::degraded) {
      scene_.tendLost(PathClock::now());
      // By pace settled a frame waits for the server as long as the run may take.
      if (scene_.status().state == ReceiverState::degraded)
        return options_.pace == FlightPace::real ? Outlook::stuck : Outlook::more;
    }
    // A new view is ranked even where the last one had settled.
    const bool changed = rankedAt_ != scene_.changeCount();
    if (rankedFor_ != camera || (changed && (scene_.wantsRanking() || scene_.hasBudgets()))) {
      const auto counts = picture_->count(scene_, camera, style_);
      if (!counts) return tl::unexpected(counts.error());
      rankedFor_ = camera;
      rankedAt_ = scene_.changeCount();
      scene_.rank(*counts);
    }
    return scene_.isAtWork() ? Outlook::more : Outlook::settled;
  }
  void wait(std::chrono::milliseconds longest) override { (void)scene_.waitForArrival(longest); }
  Result<Picture> picture(const Camera& camera) override {
    if (Result<void> drawn = picture_->draw(scene_, camera, style_); !drawn)
      return tl::unexpected(drawn.error());
    return picture_->read();
  }
  Result<std::optional<double>> psnr(const Camera& camera, const Picture& picture) override {
    if (!options_.reference) return std::nullopt;
    const auto reference = drawReference(*options_.reference, *picture_, camera, options_.colours,
                                         scene_.receiver(0).mesh()->attributeLayout().normalBits);
    if (!reference) return tl::unexpected(reference.error());
    const Result<double> measured = peakSignalToNoise(picture, *reference);
    if (!measured) return tl::unexpected(measured.error());
    return std::min(*measured, kIdenticalPsnr);
  }
  FlightRow row() const override {
    const SceneStatus status = scene_.status();
    FlightRow row;
    row.bytesDown = status.statistics.traffic.bytesDown();
    row.bytesUp = status.statistics.traffic.bytesUp;
    row.splits = status.statistics.records;
    row.triangles = status.triangles;
    row.state = stateName(status.state);
    row.collapses = status.collapses;
    row.resplits = status.resplits;
    row.memory = status.cpuBytes + status.gpuBytes;
    row.finalShare = status.finalShare;
    return row;
  }

 private:
  const ViewOptions& options_;
  const PathClock::time_point start_;
  HttpFetcher http_;
  SceneReceiver scene_;
  DrawStyle style_;
  std::optional<ScenePicture> picture_;
  std::optional<Camera> rankedFor_;
  uint64_t rankedAt_ = 0;  // the mesh's change count
};

void printFlight(const FlightSummary& flight, const RunSummary& run, bool asJson) {
  if (asJson) {
    auto json = nlohmann::ordered_json::parse(toJson(run));
    json["frames"] = flight.frames;
    json["frames_of_path"] = flight.framesOfPath;
    json["settled_frames"] = flight.settledFrames;
    if (flight.lowestPsnr) json["lowest_psnr"] = *flight.lowestPsnr;
    if (flight.meanPsnr) json["mean_psnr"] = *flight.meanPsnr;
    std::cout << json.dump() << std::endl;
    return;
  }
  std::cout << "frames     " << flight.frames << " of " << flight.framesOfPath << ", "
            << flight.settledFrames << " settled\n";
  if (flight.lowestPsnr) {
    std::cout << std::fixed << std::setprecision(2) << "PSNR       " << *flight.meanPsnr
              << " dB in the mean, " << *flight.lowestPsnr << " dB at the lowest\n";
  }
  std::cout << toText(run) << std::flush;
}

Result<bool> flyPath(const ViewOptions& options, const std::string& renderer) {
  const auto start = PathClock::now();
  FlownMeshes mesh(options, start);
  if (Result<void> connected = mesh.connect(); !connected) return tl::unexpected(connected.error());
  const auto path = CameraPath::place(*options.path, mesh.bounds(), options.size.aspect());
  if (!path) return tl::unexpected(path.error());
  ProgressLine progress;
  FlightOptions flightOptions;
  flightOptions.pace = options.pace;
  flightOptions.frames = options.frames;
  flightOptions.log = options.pathLog;
  flightOptions.ended = [&mesh] { return mesh.ended(); };
  flightOptions.progress = [&](uint64_t frame, uint64_t frames) {
    progress.showFrames(secondsSince(start), frame, frames);
  };
  const auto flight = fly(*path, mesh, flightOptions);
  progress.clear();
  if (!flight) return tl::unexpected(flight.error());
  RunSummary summary = summaryOf(mesh.status(), options, secondsSince(start));
  summary.renderer = renderer;
  const uint64_t last = std::max<uint64_t>(flight->frames, 1) - 1;
  summary.camera = formatCamera(path->at(path->frameTime(last)));
  const bool whole = flight->frames == flight->framesOfPath;
  if (!whole && mesh.ended()) summary.state = interrupted() ? "interrupted" : "timed out";
  printFlight(*flight, summary, options.json);
  if (!summary.reason.empty()) std::cerr << "meshfront-view: " << summary.reason << '\n';
  return whole && !flight->stuck && summary.reason.empty();
}

}  // namespace

int runPath(const ViewOptions& options) {
  auto context = GlContext::createHeadless();
  const auto flown = context ? flyPath(options, context->description())
                             : Result<bool>(tl::unexpected(context.error()));
  if (!flown) {
    std::cerr << "meshfront-view: " << flown.error().message << '\n';
    return 1;
  }
  return *flown ? 0 : 1;
}

}  // namespace meshfront
