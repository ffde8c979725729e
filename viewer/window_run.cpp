// The way of a turn of the window's loop, none of which waits for the network:
//   mesh    apply what has arrived, for a few milliseconds at most
//   (draw)
//   drawn   count pixels where a ranking is due: the view changed, a second has gone by, or the
//   last
//           ranking is used up; then rank and request
#include "viewer/window_run.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "shared/program/interrupt.h"
#include "shared/receiver/http_fetcher.h"
#include "shared/receiver/receiver.h"
#include "viewer/export_mesh.h"
#include "viewer/mesh_picture.h"
#include "viewer/run/trace.h"
#include "viewer/run_summary.h"
#include "viewer/window/viewer_window.h"

namespace meshfront {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kApplyingTime{4};     // of a turn, at most
constexpr size_t kSplitsBetweenLooks = 100;  // at the clock
constexpr milliseconds kRankingInterval{1'000};
constexpr milliseconds kResumeInterval{5'000};  // after a server was lost

std::string grouped(uint64_t number) {
  std::string digits = std::to_string(number);
  for (size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

class WindowRun {
 public:
  explicit WindowRun(const ViewOptions& options)
      : options_(options), receiver_(options.url, receiverOptions(options), http_) {}

  Result<void> run() {
    if (options_.trace) {
      auto trace = TraceWriter::create(*options_.trace);
      if (!trace) return tl::unexpected(trace.error());
      trace_.emplace(std::move(*trace));
    }
    if (Result<void> connected = connect(); !connected || !receiver_.mesh()) return connected;
    const MeshMetadata& metadata = *receiver_.metadata();
    WindowOptions windowOptions;
    windowOptions.style.colours = options_.colours;
    windowOptions.title = metadata.name + " - meshfront";
    windowOptions.size = options_.size;
    windowOptions.camera = options_.camera;
    windowOptions.bounds = Bounds::of(metadata.boundsMin, metadata.boundsMax);
    auto window = ViewerWindow::open(windowOptions);
    if (!window) return tl::unexpected(window.error());
    window_.emplace(std::move(*window));
    counter_.emplace(PixelCounter::create(options_.countOnCpu ? PixelCounter::Method::readBack
                                                              : PixelCounter::Method::compute));
    WindowCallbacks callbacks;
    callbacks.mesh = [this] { return applyAnswers(); };
    callbacks.drawn = [this](const DrawnView& view) { lookAt(view); };
    callbacks.status = [this] { return statusLines(); };
    callbacks.finished = [] { return interrupted(); };
    if (Result<void> ran = window_->run(callbacks); !ran) return ran;
    return writeResults(windowOptions.bounds);
  }

  void report() const {
    RunSummary summary = summaryOf(receiver_, options_.urlText, seconds());
    if (window_) {
      summary.camera = formatCamera(window_->camera());
      summary.renderer = window_->context().description();
    }
    std::cout << (options_.json ? toJson(summary) + "\n" : toText(summary)) << std::flush;
  }

 private:
  static ReceiverOptions receiverOptions(const ViewOptions& options) {
    ReceiverOptions result;
    result.mode = options.mode;
    result.order = options.order;
    result.batch = options.batch;
    result.window = options.window;
    result.freshRanking = false;  // a ranking serves for a second, so that frames stay short
    result.onArrival = [] { ViewerWindow::wake(); };
    return result;
  }

  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

  Result<void> connect() {
    while (receiver_.state() == ReceiverState::connecting && !interrupted()) {
      (void)receiver_.waitForArrival(milliseconds(50));
      (void)receiver_.advance();
    }
    if (receiver_.state() == ReceiverState::degraded)
      return fail(ErrorCode::unavailable, receiver_.reason());
    return {};
  }

  MeshArrays applyAnswers() {
    const Clock::time_point deadline = Clock::now() + kApplyingTime;
    while (true) {
      const uint64_t before = receiver_.statistics().records;
      const bool finished = receiver_.advance(kSplitsBetweenLooks);
      if (finished && trace_) writeTrace();
      const bool moved = finished || receiver_.statistics().records != before;
      if (!moved || Clock::now() >= deadline) break;
    }
    const SelectivelyRefinedMesh& mesh = *receiver_.mesh();
    // Nothing is drawn while nothing changes: what was counted last still holds.
    if (receiver_.wantsRanking() && countedAt_ == mesh.changeCount()) receiver_.rank(pixels_);
    if (receiver_.state() == ReceiverState::degraded) tryToResume();
    return {receiver_.metadata()->quantization, mesh.positions(), mesh.drawnCorners(),
            mesh.changeCount(), mesh.coloured()};
  }

  void tryToResume() {
    const Clock::time_point now = Clock::now();
    if (now - resumedAt_ < kResumeInterval) return;
    resumedAt_ = now;
    (void)receiver_.resume();
  }

  void lookAt(const DrawnView& view) {
    const Clock::time_point now = Clock::now();
    if (!view.viewChanged && !receiver_.wantsRanking() && now - rankedAt_ < kRankingInterval)
      return;
    rankedAt_ = now;
    counter_->count(view.target, view.mesh, pixels_);
    countedAt_ = receiver_.mesh()->changeCount();
    receiver_.rank(pixels_);
  }

  void writeTrace() {
    const ReceiverStatistics& statistics = receiver_.statistics();
    trace_->write({seconds(), statistics.requests, statistics.records, statistics.traffic.bytesUp,
                   statistics.traffic.bytesDown(), receiver_.mesh()->drawnTriangleCount(),
                   receiver_.visibleCandidateCount(), std::nullopt});
  }

  std::vector<std::string> statusLines() const {
    const ReceiverStatistics& statistics = receiver_.statistics();
    const SelectivelyRefinedMesh& mesh = *receiver_.mesh();
    std::vector<std::string> lines{
        std::string("state\t") + stateName(receiver_.state()),
        "records\t" + grouped(statistics.records) + " of " + grouped(mesh.splitCount()),
        "triangles\t" + grouped(mesh.drawnTriangleCount()),
        "bytes down\t" + grouped(statistics.traffic.bytesDown()),
        "bytes up\t" + grouped(statistics.traffic.bytesUp),
        "requests\t" + grouped(statistics.requests) + ", " +
            std::to_string(receiver_.requestsUnderWay()) + " under way",
    };
    if (!receiver_.reason().empty()) lines.push_back(receiver_.reason());
    return lines;
  }

  Result<void> writeResults(const Bounds& bounds) {
    const SelectivelyRefinedMesh& mesh = *receiver_.mesh();
    if (options_.screenshot) {
      auto picture = MeshPicture::create(window_->pictureSize(), receiver_.metadata()->quantization,
                                         bounds, PixelCounter::Method::readBack);
      if (!picture) return tl::unexpected(picture.error());
      if (Result<void> drawn = picture->draw(mesh, window_->camera(), {}); !drawn) return drawn;
      if (Result<void> written = writePng(picture->read(), *options_.screenshot); !written)
        return written;
    }
    if (options_.exportPly) {
      if (Result<void> written =
              exportMesh(mesh, receiver_.metadata()->quantization, *options_.exportPly);
          !written)
        return written;
    }
    return trace_ ? trace_->close() : Result<void>();
  }

  const ViewOptions& options_;
  const Clock::time_point start_ = Clock::now();
  // The fetcher's thread wakes the window, and so ends before it.
  std::optional<ViewerWindow> window_;
  std::optional<PixelCounter> counter_;  // GL: ends before the window
  HttpFetcher http_;
  Receiver receiver_;
  std::optional<TraceWriter> trace_;
  std::vector<uint32_t> pixels_;
  std::optional<uint64_t> countedAt_;  // the mesh's change count
  Clock::time_point rankedAt_;
  Clock::time_point resumedAt_;
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
