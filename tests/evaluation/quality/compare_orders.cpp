// Experiment 5.
#include <array>
#include <cstdio>
#include <string>
#include <utility>

#include "tests/evaluation/quality/exact_greedy.h"
#include "tests/evaluation/quality/experiment_folder.h"
#include "tests/evaluation/quality/experiments.h"
#include "tests/evaluation/quality/listed_way.h"
#include "tests/evaluation/quality/receiver_way.h"

namespace meshfront::evaluation {
namespace {

constexpr std::array<double, 3> kOrderTargets = {30, 35, 40};
constexpr double kStopAt = 40.5;  // dB
constexpr double kFactor = 1.1;   // of the records between two pictures
// The small mesh for the exact order: so many records of the view-independent order are all there
// is.
constexpr size_t kSmallMesh = 1'200;
constexpr size_t kSmallMeshShort = 300;
constexpr PixelSize kSmallPicture{250, 250};
constexpr uint32_t kSmallBatch = 10;
constexpr uint32_t kSeed = 1;

constexpr const char* kOrderCurves = "order_curves.csv";
constexpr const char* kOrderTargetsCsv = "records_to_psnr.csv";

class OrdersComparison {
 public:
  OrdersComparison(Easel& easel, const QualityOptions& options, ExperimentFolder folder)
      : easel_(easel), options_(options), folder_(std::move(folder)) {
    folder_.startCsv(kOrderCurves, {"mesh", "view", "order", "records", "psnr"});
    folder_.startCsv(kOrderTargetsCsv, {"mesh", "view", "order", "psnr", "records"});
  }

  Result<void> compare(EvaluatedMesh& mesh) {
    for (const EvaluatedView& view : mesh.views()) {
      if (options_.isShort && view.view.name != "whole") continue;
      std::vector<std::string> names;
      for (const ReceiverOrder& order : ordersFor(mesh)) {
        auto way = ReceiverWay::create(mesh.pack(), order, easel_, view.view, {});
        if (!way) return tl::unexpected(way.error());
        auto followed = followCurve(**way, view.full, curveOptions());
        if (!followed) return tl::unexpected(followed.error());
        note(mesh.name(), view.view.name, order.name, order.what, followed->curve);
        names.push_back(order.name);
      }
      for (const auto& [name, what, listed] : listsFor(mesh)) {
        auto way = ListedWay::create(mesh.pack(), listed, easel_, view.view, nullptr);
        if (!way) return tl::unexpected(way.error());
        auto followed = followCurve(**way, view.full, curveOptions());
        if (!followed) return tl::unexpected(followed.error());
        note(mesh.name(), view.view.name, name, what, followed->curve);
        names.push_back(name);
      }
      addPlot(mesh.name(), view.view.name, names, "500x500 pixels, batches as the viewer's");
    }
    return {};
  }

  // The exact order by true image error beside the others, each with as fresh rankings.
  Result<void> compareSmall(EvaluatedMesh& mesh) {
    const size_t count =
        std::min(options_.isShort ? kSmallMeshShort : kSmallMesh, mesh.errorOrder().size());
    const std::vector<RecordIndex> small(mesh.errorOrder().begin(),
                                         mesh.errorOrder().begin() + static_cast<ptrdiff_t>(count));
    std::vector<uint8_t> allowed(mesh.pack().records().size(), 0);
    for (const RecordIndex record : small) allowed[record] = 1;
    const std::string name = mesh.name() + ", " + std::to_string(count) + " records";
    auto easel = Easel::create(kSmallPicture, easel_.counter().method());
    if (!easel) return tl::unexpected(easel.error());
    auto view = viewNamed("whole", mesh.pack().metadata(), kSmallPicture);
    if (!view) return tl::unexpected(view.error());
    auto full = RefinedPack::fromBase(mesh.pack());
    if (!full) return tl::unexpected(full.error());
    if (Result<void> done = full->splitAll(small); !done) return done;
    Canvas canvas(*easel, full->mesh(), mesh.pack().metadata().quantization, *view);
    const Result<Picture> reference = canvas.draw();
    if (!reference) return tl::unexpected(reference.error());

    std::vector<std::string> names;
    ReceiverWayOptions receiver;
    receiver.batch = kSmallBatch;
    receiver.window = 1;
    receiver.allowed = allowed;
    for (const ReceiverOrder& order : ordersFor(mesh)) {
      auto way = ReceiverWay::create(mesh.pack(), order, *easel, *view, receiver);
      if (!way) return tl::unexpected(way.error());
      auto followed = followCurve(**way, *reference, curveOptions());
      if (!followed) return tl::unexpected(followed.error());
      note(name, "whole", order.name, order.what, followed->curve);
      names.push_back(order.name);
    }
    auto way = ListedWay::create(mesh.pack(), small, *easel, *view, nullptr);
    if (!way) return tl::unexpected(way.error());
    auto followed = followCurve(**way, *reference, curveOptions());
    if (!followed) return tl::unexpected(followed.error());
    note(name, "whole", "view-independent", "largest geometric error first", followed->curve);
    names.emplace_back("view-independent");
    for (const bool lookAhead : {false, true}) {
      auto greedy =
          exactGreedyOrder(mesh.pack(), allowed, *easel, *view, *reference, kStopAt, lookAhead);
      if (!greedy) return tl::unexpected(greedy.error());
      const std::string order = lookAhead ? "exact, looking ahead" : "exact";
      note(name, "whole", order,
           "always the split that makes the picture best, tried with " +
               std::to_string(greedy->pictures) + " pictures" +
               (lookAhead ? "; with its children's where that is worth more a record" : ""),
           greedy->curve);
      names.push_back(order);
    }
    addPlot(name, "whole", names,
            "250x250 pixels, batches of 10; the full mesh is what so many records of the "
            "view-independent order give");
    return {};
  }

  Result<void> close() { return folder_.close(); }

 private:
  struct NamedList {
    std::string name;
    std::string what;
    std::vector<RecordIndex> order;
  };

  [[nodiscard]] std::vector<ReceiverOrder> ordersFor(const EvaluatedMesh& mesh) const {
    std::vector<ReceiverOrder> orders = {shippedOrder(RankOrder::significance),
                                         shippedOrder(RankOrder::pixels)};
    for (ReceiverOrder& order : furtherOrders()) orders.push_back(std::move(order));
    orders.push_back(relevelledOrder("levels by distance",
                                     "octaves of the view-independent order's ranks, then pixels",
                                     mesh.pack(), mesh.errorOrder(), 1));
    orders.push_back(relevelledOrder("levels by distance, in quarters",
                                     "quarter octaves of the same, then pixels", mesh.pack(),
                                     mesh.errorOrder(), 4));
    orders.push_back(relevelledOrder("levels by normals",
                                     "octaves of the ranks by lost normals, then pixels",
                                     mesh.pack(), mesh.normalOrder(), 1));
    orders.push_back(relevelledLikelyErrorOrder(
        "level x likely error, by distance in eighths",
        "level x likely error with eighths of octaves of the view-independent order's ranks",
        mesh.pack(), mesh.errorOrder(), 8));
    return orders;
  }
  [[nodiscard]] static std::vector<NamedList> listsFor(const EvaluatedMesh& mesh) {
    return {{"view-independent", "largest geometric error first", mesh.errorOrder()},
            {"view-independent, normals", "largest loss of normals first", mesh.normalOrder()},
            {"random", "any split that can be made", randomOrder(mesh.pack().records(), kSeed)}};
  }
  [[nodiscard]] static CurveOptions curveOptions() {
    CurveOptions curve;
    curve.stopAt = kStopAt;
    curve.factor = kFactor;
    return curve;
  }

  void note(const std::string& mesh, const std::string& view, const std::string& order,
            const std::string& what, const QualityCurve& curve) {
    for (const CurvePoint& point : curve)
      folder_.addCsv(kOrderCurves,
                     {mesh, view, order, std::to_string(point.records), numberText(point.psnr)});
    std::string line;
    for (const double target : kOrderTargets) {
      const std::optional<double> records = recordsTo(curve, target);
      const std::string decibels = numberText(target, 0);
      if (records)
        folder_.addCsv(kOrderTargetsCsv, {mesh, view, order, decibels, numberText(*records, 0)});
      Figure figure;
      figure.table = "Records to a PSNR, " + mesh + ", " + view + " view";
      figure.row = order;
      figure.column = decibels + " dB";
      figure.value = records;
      figure.unit = "records";
      figure.csv = kOrderTargetsCsv;
      figure.note = records ? what : what + "; not reached";
      folder_.add(std::move(figure));
      line += " " + decibels + " dB " + (records ? numberText(*records, 0) : std::string("-"));
    }
    std::printf("%s %s, %s:%s\n", mesh.c_str(), view.c_str(), order.c_str(), line.c_str());
    std::fflush(stdout);
  }

  void addPlot(const std::string& mesh, const std::string& view,
               const std::vector<std::string>& orders, const std::string& caption) {
    Plot plot;
    plot.file = "orders_" + view + "_" + mesh.substr(0, mesh.find(',')) +
                (mesh.find(',') == std::string::npos ? "" : "_small");
    plot.title = mesh + ", " + view + " view";
    plot.x = "records";
    plot.y = "PSNR, dB";
    plot.csv = kOrderCurves;
    plot.xColumn = "records";
    plot.yColumn = "psnr";
    for (const std::string& order : orders)
      plot.lines.push_back({order, {{"mesh", mesh}, {"view", view}, {"order", order}}});
    plot.caption = caption;
    folder_.add(std::move(plot));
  }

  Easel& easel_;
  const QualityOptions& options_;
  ExperimentFolder folder_;
};

}  // namespace

Result<void> compareOrders(const std::vector<std::unique_ptr<EvaluatedMesh>>& meshes, Easel& easel,
                           const QualityOptions& options) {
  auto folder = ExperimentFolder::create(options.output, "order_quality", 5);
  if (!folder) return tl::unexpected(folder.error());
  OrdersComparison comparison(easel, options, std::move(*folder));
  bool small = false;
  for (const auto& mesh : meshes) {
    if (mesh->name() != "bunny" && mesh->name() != "igea" && meshes.size() > 1) continue;
    if (Result<void> done = comparison.compare(*mesh); !done) return done;
    if (std::exchange(small, true)) continue;
    if (Result<void> done = comparison.compareSmall(*mesh); !done) return done;
  }
  return comparison.close();
}

}  // namespace meshfront::evaluation
