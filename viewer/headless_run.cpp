// The way of a run: connect -> [draw, count -> rank -> request -> wait -> apply]* -> write.
#include "viewer/headless_run.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <optional>

#include "shared/program/interrupt.h"
#include "shared/receiver/http_fetcher.h"
#include "shared/scene/scene_receiver.h"
#include "viewer/export_mesh.h"
#include "viewer/gl/gl_context.h"
#include "viewer/picture/picture.h"
#include "viewer/progress_line.h"
#include "viewer/reference_picture.h"
#include "viewer/run/trace.h"
#include "viewer/run_summary.h"
#include "viewer/scene_options.h"
#include "viewer/scene_picture.h"

namespace meshfront {
namespace {

using Kind = StopCondition::Kind;

DrawStyle styleOf(const ViewOptions& options) {
  DrawStyle style;
  style.colours = options.colours;
  return style;
}

class HeadlessRun {
 public:
  HeadlessRun(const ViewOptions& options, std::string renderer)
      : options_(options),
        style_(styleOf(options)),
        renderer_(std::move(renderer)),
        target_(options.until.kind == Kind::psnr ? options.until.decibels : options.psnrTarget),
        scene_(options.scene, pictureSceneOptions(options), http_) {}

  int run() {
    Result<void> done = refine();
    progress_.clear();
    if (done && picture_) done = writeResults();
    if (done && trace_) done = trace_->close();
    const RunSummary result = summary();
    std::cout << (options_.json ? toJson(result) + "\n" : toText(result)) << std::flush;
    if (!done) {
      std::cerr << "meshfront-view: " << done.error().message << '\n';
      return 1;
    }
    if (!result.reason.empty()) std::cerr << "meshfront-view: " << result.reason << '\n';
    return succeeded() ? 0 : 1;
  }

 private:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  Result<void> refine() {
    if (options_.trace) {
      auto trace = TraceWriter::create(*options_.trace);
      if (!trace) return tl::unexpected(trace.error());
      trace_.emplace(std::move(*trace));
    }
    while (scene_.isAtWork() && !stopped()) {
      (void)scene_.waitForArrival(std::chrono::milliseconds(50));
      const bool applied = scene_.advance();
      if (!scene_.allHere()) continue;
      if (!picture_) {
        if (Result<void> prepared = prepare(); !prepared) return prepared;
        if (Result<void> looked = look(); !looked) return looked;
      } else if (applied) {
        if (Result<void> looked = look(); !looked) return looked;
      }
      if (!scene_.wantsRanking() || stopped()) continue;
      const auto counts = picture_->count(scene_, camera_, style_);
      if (!counts) return tl::unexpected(counts.error());
      scene_.rank(*counts);
    }
    return {};
  }

  // When the meshes are here.
  Result<void> prepare() {
    camera_ = placeCamera(options_.camera, *scene_.bounds(), options_.size.aspect());
    auto picture = ScenePicture::create(
        options_.size, options_.scene,
        options_.countOnCpu ? PixelCounter::Method::readBack : PixelCounter::Method::compute);
    if (!picture) return tl::unexpected(picture.error());
    picture_.emplace(std::move(*picture));
    if (!options_.reference) return {};
    if (Result<void> drawn = picture_->draw(scene_, camera_, style_); !drawn) return drawn;
    auto reference = drawReference(*options_.reference, *picture_, camera_, options_.colours,
                                   scene_.receiver(0).mesh()->attributeLayout().normalBits);
    if (!reference) return tl::unexpected(reference.error());
    reference_ = std::move(*reference);
    return {};
  }

  // What an answer gained: PSNR where it is asked for, and a line of the trace.
  Result<void> look() {
    const SceneStatus status = scene_.status();
    const ReceiverStatistics& statistics = status.statistics;
    const bool wantsPsnr = reference_ && (trace_ || (target_ && !targetReached_));
    if (wantsPsnr) {
      if (Result<void> measured = measure(); !measured) return measured;
      if (target_ && !targetReached_ && *psnr_ >= *target_)
        targetReached_ = milestone(statistics, seconds());
    }
    if (trace_) {
      trace_->write({seconds(), statistics.requests, statistics.records, statistics.traffic.bytesUp,
                     statistics.traffic.bytesDown(), status.triangles, status.visibleCandidates,
                     wantsPsnr ? psnr_ : std::nullopt});
    }
    progress_.show(seconds(), statistics.records, status.splitCount,
                   statistics.traffic.bytesDown());
    return {};
  }

  Result<void> measure() {
    if (Result<void> drawn = picture_->draw(scene_, camera_, style_); !drawn) return drawn;
    const Result<double> psnr = peakSignalToNoise(picture_->read(), *reference_);
    if (!psnr) return tl::unexpected(psnr.error());
    psnr_ = std::min(*psnr, kIdenticalPsnr);
    return {};
  }

  Result<void> writeResults() {
    if (reference_) {
      if (Result<void> measured = measure(); !measured) return measured;
    }
    if (options_.screenshot) {
      if (Result<void> drawn = picture_->draw(scene_, camera_, style_); !drawn) return drawn;
      if (Result<void> written = writePng(picture_->read(), *options_.screenshot); !written)
        return written;
    }
    if (options_.exportPly) return exportMesh(scene_, *options_.exportPly);
    return {};
  }

  [[nodiscard]] bool stopped() const {
    return interrupted() || timedOut() ||
           (options_.until.kind == Kind::psnr && targetReached_.has_value());
  }
  [[nodiscard]] bool timedOut() const {
    return options_.timeout > 0 && seconds() >= options_.timeout;
  }

  [[nodiscard]] RunSummary summary() const {
    RunSummary summary = summaryOf(scene_.status(), options_, seconds());
    summary.renderer = renderer_;
    summary.psnr = psnr_;
    summary.psnrTarget = target_;
    summary.targetReached = targetReached_;
    if (picture_) summary.camera = formatCamera(camera_);
    if (scene_.isAtWork()) {
      if (options_.until.kind == Kind::psnr && targetReached_) {
        summary.state = "target reached";
      } else if (interrupted()) {
        summary.state = "interrupted";
      } else if (timedOut()) {
        summary.state = "timed out";
      }
    }
    return summary;
  }

  // A mesh that is complete, or settled, before it costs what it may cost has met its limit too.
  [[nodiscard]] bool succeeded() const {
    const ReceiverState state = scene_.status().state;
    if (options_.until.kind == Kind::psnr) return targetReached_.has_value();
    return state == ReceiverState::complete || state == ReceiverState::limitReached ||
           (state == ReceiverState::settled && options_.until.kind == Kind::settled);
  }

  const ViewOptions& options_;
  DrawStyle style_;
  const std::string renderer_;
  const std::optional<double> target_;  // dB
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  HttpFetcher http_;
  SceneReceiver scene_;
  std::optional<ScenePicture> picture_;
  std::optional<Picture> reference_;
  std::optional<TraceWriter> trace_;
  Camera camera_;
  std::optional<double> psnr_;  // of the last picture measured
  std::optional<Milestone> targetReached_;
  ProgressLine progress_;
};

}  // namespace

int runHeadless(const ViewOptions& options) {
  auto context = GlContext::createHeadless();
  if (!context) {
    std::cerr << "meshfront-view: " << context.error().message << '\n';
    return 1;
  }
  return HeadlessRun(options, context->description()).run();
}

}  // namespace meshfront
