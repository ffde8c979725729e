// The way of a turn of the window's loop, none of which waits for the network or for a mesh:
//   turn    take what the refinement thread has told, upload some of it
//   draw    the scene, then start counting the pixels of what was drawn
//   turn    hand the counts that have arrived to the refinement thread, which ranks and requests
#include "viewer/window_run.h"

#include <chrono>
#include <iostream>
#include <optional>
#include <string>
#include <utility>

#include "shared/program/interrupt.h"
#include "shared/receiver/http_fetcher.h"
#include "shared/scene/local_error.h"
#include "shared/scene/refinement_thread.h"
#include "shared/scene/view_prediction.h"
#include "viewer/export_mesh.h"
#include "viewer/panel_numbers.h"
#include "viewer/run/trace.h"
#include "viewer/run_summary.h"
#include "viewer/scene_drawing.h"
#include "viewer/scene_options.h"
#include "viewer/window/message_window.h"
#include "viewer/window/trouble_message.h"
#include "viewer/window/viewer_window.h"
#include "viewer/window_stage.h"

namespace meshfront {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSpotRadius = 0.05;         // of the scene's radius: what "refine here" raises
constexpr double kPredictedAhead = 0.5;      // seconds
constexpr double kPredictionInterval = 0.4;  // seconds between counts of predicted views
constexpr int kPredictionDivisor = 4;        // of the picture's resolution

constexpr std::chrono::milliseconds kDescriptionWait{100};

// Digits behind the point that tell neighbouring grid points apart.
int decimalsOf(double step) {
  int decimals = 0;
  for (double unit = 1; unit > step && decimals < 12; unit /= 10) ++decimals;
  return decimals;
}

std::string nodeText(const NodeId& id) {
  std::string text = std::to_string(id.tree) + ":";
  for (unsigned i = 0; i < id.depth; ++i) text += id.step(i) ? '1' : '0';
  return text;
}

Colouring colouringOf(ColouringMode mode) {
  switch (mode) {
    case ColouringMode::own:
    case ColouringMode::clay:
      return Colouring::surface;
    case ColouringMode::tree:
      return Colouring::tree;
    case ColouringMode::level:
      return Colouring::level;
    case ColouringMode::pixels:
      return Colouring::pixels;
    case ColouringMode::missing:
      return Colouring::missing;
  }
  return Colouring::surface;
}

HttpFetcherOptions fetcherOptions() {
  HttpFetcherOptions options;
  options.slots = LinkMeter::kWidestWindow;
  return options;
}

class WindowRun {
 public:
  explicit WindowRun(const ViewOptions& options) : options_(options) {}

  Result<void> run() {
    if (options_.trace) {
      auto trace = TraceWriter::create(*options_.trace);
      if (!trace) return tl::unexpected(trace.error());
      trace_.emplace(std::move(*trace));
    }
    if (Result<void> opened = open(); !opened) return opened;
    thread_.emplace(options_.scene, windowSceneOptions(options_), http_,
                    [] { ViewerWindow::wake(); });
    WindowCallbacks callbacks;
    callbacks.turn = [this] { return turn(); };
    callbacks.draw = [this](const ViewToDraw& view) { return draw(view); };
    callbacks.status = [this] { return status(); };
    callbacks.pick = [this](const SurfacePlace& place) { return pick(place); };
    callbacks.refineHere = [this](const SurfacePlace& place) { return refineHere(place); };
    callbacks.say = [this](const std::string& text) {
      (options_.json ? std::cerr : std::cout) << text << std::endl;
    };
    callbacks.finished = [this] { return interrupted() || failure_ || scriptEnded(); };
    std::optional<WindowStage> stage;
    if (!options_.script.empty()) {
      stage.emplace(*window_);
      script_.emplace(options_.script, options_.scriptFile);
      callbacks.turnEnd = [this, &stage] { (void)script_->turn(*stage); };
    }
    Result<void> ran = window_->run(callbacks);
    final_ = thread_->status();
    SceneReceiver& scene = thread_->stop();
    if (!ran) return ran;
    if (failure_) return tl::unexpected(*failure_);
    if (script_ && script_->state() == ScriptPlayer::State::failed) return fail(script_->message());
    return writeResults(scene);
  }

  void report() const {
    RunSummary summary = summaryOf(final_, options_, seconds());
    if (window_) {
      summary.camera = formatCamera(window_->camera());
      summary.renderer = window_->context().description();
    }
    std::cout << (options_.json ? toJson(summary) + "\n" : toText(summary)) << std::flush;
  }

 private:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

  Result<void> open() {
    WindowOptions windowOptions;
    windowOptions.title = titleOf(options_) + " - meshfront";
    windowOptions.size = options_.size;
    windowOptions.camera = options_.camera;
    windowOptions.interfaceScale = options_.interfaceScale;
    windowOptions.scripted = !options_.script.empty();
    windowOptions.switches.colouring = options_.colours ? ColouringMode::own : ColouringMode::clay;
    windowOptions.switches.geomorph = options_.geomorph;
    auto window = ViewerWindow::open(windowOptions);
    if (!window) {
      if (window.error().code == ErrorCode::invalid && options_.script.empty()) {
        (void)showMessageWindow(windowOptions.title, missingOpenGlMessage(window.error().message),
                                interrupted);
      }
      return tl::unexpected(window.error());
    }
    window_.emplace(std::move(*window));
    auto drawing = SceneDrawing::create(
        options_.scene, options_.countOnCpu ? PixelCounter::Method::readBack
                                            : PixelCounter::preferred(window_->context()));
    if (!drawing) return tl::unexpected(drawing.error());
    drawing_.emplace(std::move(*drawing));
    return {};
  }

  [[nodiscard]] bool scriptEnded() const {
    return script_ && script_->state() != ScriptPlayer::State::playing;
  }

  SceneTurn turn() {
    if (auto counts = drawing_->takeCounts()) thread_->see(std::move(*counts));
    if (auto counts = drawing_->takePass()) thread_->see(std::move(*counts));
    const Result<bool> changed = drawing_->take(thread_->takeNews(), seconds());
    if (!changed) failure_ = changed.error();
    status_ = thread_->status();
    numbers_.observe(status_, seconds());
    if (trace_) writeTrace();
    const bool atWork =
        status_.state == ReceiverState::connecting || status_.state == ReceiverState::refining;
    if (!drawing_->bounds()) return {false, false, atWork};
    window_->setScene({*drawing_->bounds(), drawing_->hasColours()});
    const bool slides =
        window_->switches().geomorph && seconds() < drawing_->slidesUntil(kDefaultSlide);
    return {changed.value_or(false), slides || drawing_->isUploading(),
            atWork || drawing_->isCounting()};
  }

  Result<void> draw(const ViewToDraw& view) {
    const DrawStyle style = styleOf(view.switches);
    drawing_->draw(view.target, view.camera, view.bounds, style, view.switches.missingBounds,
                   seconds());
    target_ = &view.target;
    bounds_ = view.bounds;
    if (options_.itemDivisor == 1) {
      (void)drawing_->startCount(view.target, view.camera);
    } else if (auto started = drawing_->startPass(view.camera, view.bounds, view.target.size(),
                                                  options_.itemDivisor, style, seconds(), false);
               !started) {
      return tl::unexpected(started.error());
    }
    prediction_.see(seconds(), view.camera);
    return options_.prefetch ? lookAhead(view, style) : Result<void>();
  }

  // Where the movement leads to, now and then, while nothing is wanted for the view itself.
  Result<void> lookAhead(const ViewToDraw& view, const DrawStyle& style) {
    const bool spare =
        status_.state == ReceiverState::settled || status_.state == ReceiverState::limitReached;
    if (!spare || seconds() - lookedAhead_ < kPredictionInterval) return {};
    const std::optional<Camera> ahead = prediction_.ahead(kPredictedAhead);
    if (!ahead) return {};
    lookedAhead_ = seconds();
    const auto started = drawing_->startPass(*ahead, view.bounds, view.target.size(),
                                             kPredictionDivisor, style, seconds(), true);
    if (!started) return tl::unexpected(started.error());
    return {};
  }

  [[nodiscard]] DrawStyle styleOf(const ViewSwitches& switches) const {
    DrawStyle style;
    style.flatShading = switches.flatShading;
    style.wireframe = switches.wireframe;
    style.colours = switches.colouring != ColouringMode::clay;
    style.colouring = colouringOf(switches.colouring);
    style.slideSeconds = switches.geomorph ? kDefaultSlide : 0;
    return style;
  }

  PickedPoint pick(const SurfacePlace& place) {
    PickedPoint point;
    if (target_ == nullptr) return point;
    const auto found =
        drawing_->placeAt(*target_, window_->camera(), bounds_, static_cast<int>(place.pixel.x),
                          static_cast<int>(place.pixel.y));
    if (!found) return point;
    const MeshMetadata& metadata = drawing_->metadata(found->mesh);
    point.decimals = decimalsOf(metadata.quantization.step);
    point.mesh = options_.scene[found->mesh].name;
    point.localError = found->vertex.isLeaf != 0 ? 0 : localError(metadata, found->vertex.level);
    if (const auto described = thread_->describe(found->mesh, found->slot, kDescriptionWait))
      point.node = nodeText(described->node);
    return point;
  }

  std::string refineHere(const SurfacePlace& place) {
    thread_->refineFirst(RefinedSpot{place.world, kSpotRadius * bounds_.radius()});
    return "refining here first";
  }

  PanelStatus status() {
    PanelStatus status = numbers_.status(seconds(), drawing_->countSeconds());
    status.legend = legendOf(colouringOf(window_->switches().colouring), drawing_->finestLevel());
    return status;
  }

  void writeTrace() {
    const ReceiverStatistics& is = status_.statistics;
    if (is.answers == tracedAnswers_) return;
    tracedAnswers_ = is.answers;
    trace_->write({seconds(), is.requests, is.records, is.traffic.bytesUp, is.traffic.bytesDown(),
                   status_.triangles, status_.visibleCandidates, std::nullopt});
  }

  Result<void> writeResults(SceneReceiver& scene) {
    if (!scene.bounds()) {  // closed before there was anything to see
      if (final_.state != ReceiverState::degraded) return {};
      return fail(ErrorCode::unavailable, final_.reason);
    }
    if (options_.screenshot) {
      auto target = RenderTarget::create(window_->pictureSize());
      if (!target) return tl::unexpected(target.error());
      if (auto taken = drawing_->take(scene.takeNews(), seconds(), GpuMesh::kNoLimit); !taken)
        return tl::unexpected(taken.error());
      DrawStyle style;
      style.colours = options_.colours;
      drawing_->draw(*target, window_->camera(), *drawing_->bounds(), style, false, seconds());
      if (Result<void> written = writePng(target->readPicture(), *options_.screenshot); !written)
        return written;
    }
    if (options_.exportPly) {
      if (Result<void> written = exportMesh(scene, *options_.exportPly); !written) return written;
    }
    return trace_ ? trace_->close() : Result<void>();
  }

  const ViewOptions& options_;
  const Clock::time_point start_ = Clock::now();
  // The refinement thread and the fetcher's wake the window, and so end before it.
  std::optional<ViewerWindow> window_;
  std::optional<SceneDrawing> drawing_;  // GL: ends before the window
  HttpFetcher http_{fetcherOptions()};
  std::optional<RefinementThread> thread_;
  std::optional<TraceWriter> trace_;
  std::optional<ScriptPlayer> script_;
  std::optional<Error> failure_;  // of a turn
  SceneStatus status_;            // of this turn
  SceneStatus final_;             // after the last one
  PanelNumbers numbers_{options_};
  ViewPrediction prediction_;
  double lookedAhead_ = 0;                // seconds
  const RenderTarget* target_ = nullptr;  // the window's, as it was drawn last
  Bounds bounds_;                         // that it was drawn with
  uint64_t tracedAnswers_ = 0;
};

}  // namespace

int runWindow(const ViewOptions& options) {
  WindowRun run(options);
  const Result<void> ran = run.run();
  if (!ran) {
    std::cerr << "meshfront-view: " << ran.error().message << '\n';
    return 1;
  }
  run.report();
  return 0;
}

}  // namespace meshfront
