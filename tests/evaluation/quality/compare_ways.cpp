// Experiments 3 and 4.
#include <array>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "tests/evaluation/quality/experiment_folder.h"
#include "tests/evaluation/quality/experiments.h"
#include "tests/evaluation/quality/listed_way.h"
#include "tests/evaluation/quality/picture_strip.h"
#include "tests/evaluation/quality/receiver_way.h"
#include "tests/evaluation/quality/sender_way.h"

namespace meshfront::evaluation {
namespace {

constexpr std::array<double, 3> kTargets = {30, 35, 40};
constexpr double kMainTarget = 35;
constexpr double kMostPlotted = 55;  // dB; equal pictures would have infinitely many
constexpr double kWholeBesideSender = 0.6;
constexpr double kWholeBesideViewIndependent = 0.7;
constexpr double kWholeBesidePixels = 0.35;
constexpr double kCloseBesideViewIndependent = 0.1;
// By mesh, the whole view's bytes beside Draco's file.
constexpr double kIgeaBesideFile = 0.12;
constexpr double kBunnyBesideFile = 0.3;

constexpr const char* kCurves = "curves.csv";
constexpr const char* kTargetsCsv = "bytes_to_psnr.csv";
constexpr const char* kErrors = "visible_only.csv";
constexpr const char* kSeen = "all that is seen is split";

struct WayName {
  const char* key;    // in CSV
  const char* label;  // for people
};
constexpr WayName kOurs{"receiver", "ours (level, likely error, pixels)"};
constexpr WayName kPixels{"pixels", "receiver-driven, pixels alone"};
constexpr WayName kSender{"sender", "sender-driven, our levels and short IDs"};
constexpr WayName kSenderPublished{"sender-as-published", "sender-driven, as published"};
constexpr WayName kIndependent{"view-independent", "view-independent"};

class WaysComparison {
 public:
  WaysComparison(Easel& easel, const QualityOptions& options, ExperimentFolder quality,
                 ExperimentFolder visible)
      : easel_(easel),
        options_(options),
        quality_(std::move(quality)),
        visible_(std::move(visible)) {
    quality_.startCsv(kCurves, {"mesh", "view", "way", "bytes", "bytes_up", "records", "psnr"});
    quality_.startCsv(kTargetsCsv, {"mesh", "view", "way", "psnr", "bytes", "records"});
    visible_.startCsv(
        kErrors, {"mesh", "view", "after", "records", "share_of_records", "bytes", "psnr",
                  "error_pixels", "share_of_pixels", "share_of_covered", "clear_error_pixels"});
  }

  Result<void> compare(EvaluatedMesh& mesh) {
    const Result<SenderModel> model = SenderModel::load(*mesh.pack().pack());
    if (!model) return tl::unexpected(model.error());
    for (const EvaluatedView& view : mesh.views())
      if (Result<void> done = compareView(mesh, *model, view); !done) return done;
    return {};
  }

  Result<void> close() {
    if (Result<void> done = quality_.close(); !done) return done;
    return visible_.close();
  }

 private:
  struct Reached {
    std::array<std::optional<double>, kTargets.size()> bytes;
    uint64_t atFirst = 0;  // bytes before the first record
    Picture kept;
    uint64_t keptAtBytes = 0;
    std::string keptText;
  };

  Result<void> compareView(EvaluatedMesh& mesh, const SenderModel& model,
                           const EvaluatedView& view) {
    if (Result<void> done = splitSeen(mesh, view); !done) return done;
    auto ours = followOurs(mesh, view);
    if (!ours) return tl::unexpected(ours.error());
    CurveOptions curve = curveOptions();
    if (ours->keptAtBytes > 0) curve.pictureAtBytes = ours->keptAtBytes;

    auto pixelsWay = ReceiverWay::create(mesh.pack(), shippedOrder(RankOrder::pixels), easel_,
                                         view.view, receiverOptions(mesh));
    if (!pixelsWay) return tl::unexpected(pixelsWay.error());
    auto pixels = follow(mesh, view, kPixels, **pixelsWay, curve);
    if (!pixels) return tl::unexpected(pixels.error());

    SenderOptions strongest;
    strongest.order = SenderOrder::significance;
    auto senderWay = SenderWay::create(mesh.pack(), model, strongest, easel_, view.view, true);
    if (!senderWay) return tl::unexpected(senderWay.error());
    auto sender = follow(mesh, view, kSender, **senderWay, curve);
    if (!sender) return tl::unexpected(sender.error());

    SenderOptions publishedIds;
    publishedIds.ids = IdCoding::published;
    auto publishedWay =
        SenderWay::create(mesh.pack(), model, publishedIds, easel_, view.view, true);
    if (!publishedWay) return tl::unexpected(publishedWay.error());
    CurveOptions toLastTarget = curveOptions();
    toLastTarget.stopAt = kTargets.back();
    auto published = follow(mesh, view, kSenderPublished, **publishedWay, toLastTarget);
    if (!published) return tl::unexpected(published.error());

    auto listed =
        ListedWay::create(mesh.pack(), mesh.errorOrder(), easel_, view.view, &mesh.service());
    if (!listed) return tl::unexpected(listed.error());
    auto independent = follow(mesh, view, kIndependent, **listed, curve);
    if (!independent) return tl::unexpected(independent.error());

    addPlot(mesh, view);
    addRatios(mesh, view, kOurs, *ours, *pixels, *sender, *published, *independent);
    if (ours->keptAtBytes == 0 || view.view.name == "half") return {};
    return addPictures(mesh, view, {*ours, *sender, *independent, *pixels});
  }

  [[nodiscard]] CurveOptions curveOptions() const {
    CurveOptions curve;
    curve.stopAt = options_.stopAt;
    curve.factor = options_.factor;
    return curve;
  }
  [[nodiscard]] static ReceiverWayOptions receiverOptions(EvaluatedMesh& mesh) {
    ReceiverWayOptions options;
    options.service = &mesh.service();
    return options;
  }

  // Ours also tells what the others are shown at.
  Result<Reached> followOurs(EvaluatedMesh& mesh, const EvaluatedView& view) {
    auto way = ReceiverWay::create(mesh.pack(), shippedOrder(RankOrder::significance), easel_,
                                   view.view, receiverOptions(mesh));
    if (!way) return tl::unexpected(way.error());
    CurveOptions curve = curveOptions();
    curve.pictureAtPsnr = kMainTarget;
    return follow(mesh, view, kOurs, **way, curve);
  }

  // What is left when only what is seen is split.
  Result<void> splitSeen(EvaluatedMesh& mesh, const EvaluatedView& view) {
    ReceiverWayOptions receiver = receiverOptions(mesh);
    receiver.goal = ReceiverGoal::seen;
    receiver.rim = false;
    auto way = ReceiverWay::create(mesh.pack(), shippedOrder(RankOrder::significance), easel_,
                                   view.view, receiver);
    if (!way) return tl::unexpected(way.error());
    for (const auto& [goal, after] :
         {std::pair(ReceiverGoal::seen, kSeen),
          std::pair(ReceiverGoal::touching, "all that is seen and what touches it is split")}) {
      if (goal != ReceiverGoal::seen) (*way)->goOn(goal);
      if (Result<void> done = toGoal(**way); !done) return done;
      if (Result<void> done = addVisibleOnly(mesh, view, **way, after); !done) return done;
    }
    return {};
  }

  static Result<void> toGoal(Way& way) {
    for (;;) {
      const Result<bool> more = way.advance(0);
      if (!more) return tl::unexpected(more.error());
      if (!*more) return {};
    }
  }

  Result<Reached> follow(EvaluatedMesh& mesh, const EvaluatedView& view, const WayName& name,
                         Way& way, const CurveOptions& curve) {
    auto followed = followCurve(way, view.full, curve);
    if (!followed) return tl::unexpected(followed.error());
    Reached reached = noted(mesh, view, name, followed->curve);
    keep(reached, name, *followed);
    return reached;
  }

  static void keep(Reached& reached, const WayName& name, FollowedCurve& followed) {
    reached.kept = std::move(followed.kept);
    reached.keptAtBytes = followed.keptAtBytes;
    reached.keptText = std::string(name.label) + " " + std::to_string(followed.keptAtBytes) +
                       " B, " + numberText(followed.keptPsnr, 1) + " dB";
  }

  Reached noted(const EvaluatedMesh& mesh, const EvaluatedView& view, const WayName& name,
                const QualityCurve& curve) {
    for (const CurvePoint& point : curve)
      quality_.addCsv(kCurves, {mesh.name(), view.view.name, name.key,
                                std::to_string(point.bytesDown), std::to_string(point.bytesUp),
                                std::to_string(point.records), numberText(point.psnr)});
    Reached reached;
    reached.atFirst = curve.front().bytesDown;
    std::string line = mesh.name() + " " + view.view.name + " " + name.label + ":";
    for (size_t i = 0; i < kTargets.size(); ++i) {
      reached.bytes.at(i) = bytesTo(curve, kTargets.at(i));
      const std::optional<double> records = recordsTo(curve, kTargets.at(i));
      const std::string decibels = numberText(kTargets.at(i), 0);
      if (reached.bytes.at(i))
        quality_.addCsv(kTargetsCsv,
                        {mesh.name(), view.view.name, name.key, decibels,
                         numberText(*reached.bytes.at(i), 0), numberText(*records, 0)});
      Figure figure;
      figure.table = "Bytes down to " + decibels + " dB, " + view.view.name + " view";
      figure.row = mesh.name();
      figure.column = name.label;
      figure.value = reached.bytes.at(i);
      figure.unit = "B";
      figure.csv = kTargetsCsv;
      if (!figure.value) figure.note = "not reached";
      quality_.add(std::move(figure));
      line += " " + decibels + " dB " +
              (reached.bytes.at(i) ? numberText(*reached.bytes.at(i), 0) : std::string("-"));
    }
    std::printf("%s B; last %.1f dB with %llu\n", line.c_str(), curve.back().psnr,
                static_cast<unsigned long long>(curve.back().bytesDown));
    std::fflush(stdout);
    return reached;
  }

  void addRatios(const EvaluatedMesh& mesh, const EvaluatedView& view, const WayName& name,
                 const Reached& ours, const Reached& pixels, const Reached& sender,
                 const Reached& published, const Reached& independent) {
    const bool whole = view.view.name == "whole";
    const bool close = view.view.name == "close";
    const auto goalIf = [](bool is, double goal) {
      return is ? std::optional<double>(goal) : std::nullopt;
    };
    const auto file = mesh.wholeFileBytes();
    const auto fileBytes = file ? std::optional<double>(static_cast<double>(*file)) : std::nullopt;
    std::optional<double> fileGoal;
    if (whole && mesh.name() == "igea") fileGoal = kIgeaBesideFile;
    if (whole && mesh.name() == "bunny") fileGoal = kBunnyBesideFile;
    const std::optional<double> besideSender = goalIf(whole, kWholeBesideSender);
    addRatio(mesh, view, name, kSenderPublished.label, ours.bytes[1], published.bytes[1],
             besideSender, "largest error in pixels first; tree, depth and path with each record");
    addRatio(mesh, view, name, kSender.label, ours.bytes[1], sender.bytes[1], besideSender,
             "the strongest we could make: what our pack tells of significance, then the error in "
             "pixels, which only a sender knows; IDs by an adaptive code");
    const std::optional<double> besideIndependent =
        whole ? goalIf(true, kWholeBesideViewIndependent)
              : goalIf(close, kCloseBesideViewIndependent);
    addRatio(mesh, view, name, "view-independent", ours.bytes[1], independent.bytes[1],
             besideIndependent, "");
    addWanted(mesh, view, kSenderPublished.label, ours, published.bytes[1], besideSender);
    addWanted(mesh, view, kSender.label, ours, sender.bytes[1], besideSender);
    addWanted(mesh, view, "view-independent", ours, independent.bytes[1], besideIndependent);
    if (whole || close)
      addRatio(
          mesh, view, name, "view-independent, before our first record",
          static_cast<double>(ours.atFirst), independent.bytes[1], std::nullopt,
          "metadata and base mesh alone, with their fields: no order of records can do better");
    const std::optional<double> besidePixels = goalIf(whole, kWholeBesidePixels);
    addRatio(mesh, view, name, "pixels alone", ours.bytes[1], pixels.bytes[1], besidePixels, "");
    addWanted(mesh, view, "pixels alone", ours, pixels.bytes[1], besidePixels);
    addRatio(mesh, view, name, "Draco's file", ours.bytes[1], fileBytes, fileGoal,
             "of the file nothing is seen before all of it is there");
  }

  void addRatio(const EvaluatedMesh& mesh, const EvaluatedView& view, const WayName& name,
                const std::string& otherName, const std::optional<double>& ours,
                const std::optional<double>& other, const std::optional<double>& goal,
                const std::string& note) {
    Figure figure;
    figure.table = std::string("Bytes down to 35 dB, ") + name.label + ", beside the other ways, " +
                   view.view.name + " view";
    const std::string column = "/ " + otherName;
    figure.row = mesh.name();
    figure.column = column;
    if (ours && other) figure.value = *ours / *other;
    figure.unit = "ratio";
    figure.csv = kTargetsCsv;
    figure.goal = goal;
    figure.goalIs = "at most";
    figure.note = figure.value ? note : "35 dB were not reached";
    std::printf("%s %s, %s %s: %s%s\n", mesh.name().c_str(), view.view.name.c_str(), name.label,
                column.c_str(), figure.value ? numberText(*figure.value).c_str() : "-",
                goal ? (", goal " + numberText(*goal, 2)).c_str() : "");
    quality_.add(std::move(figure));
  }

  // What a goal leaves for requests' answers, beside what they take now: what it would take to meet
  // it by better orders or smaller records alone.
  void addWanted(const EvaluatedMesh& mesh, const EvaluatedView& view, const std::string& otherName,
                 const Reached& ours, const std::optional<double>& other,
                 const std::optional<double>& goal) {
    if (!goal || !other || !ours.bytes[1]) return;
    const auto first = static_cast<double>(ours.atFirst);
    if (*ours.bytes[1] <= first) return;
    Figure figure;
    figure.table = "What the goals would take: answers' bytes that they leave beside ours, " +
                   view.view.name + " view";
    figure.row = mesh.name();
    figure.column = "/ " + otherName;
    figure.value = (*goal * *other - first) / (*ours.bytes[1] - first);
    figure.unit = "ratio";
    figure.csv = kTargetsCsv;
    figure.note =
        "Bytes to 35 dB less those before the first record (curves.csv), which records cannot "
        "change; 1 and more: met, below 0: not with any record. Experiment 5 tells what is left to "
        "gain by orders: records that told their error eight times as finely take about as many, "
        "the exact order by true error, which nobody can know beforehand, some seven tenths (a "
        "small mesh).";
    quality_.add(std::move(figure));
  }

  void addPlot(const EvaluatedMesh& mesh, const EvaluatedView& view) {
    Plot plot;
    plot.file = "psnr_" + view.view.name + "_" + mesh.name();
    plot.title = mesh.name() + ", " + view.view.name + " view";
    plot.x = "received bytes";
    plot.y = "PSNR, dB";
    plot.csv = kCurves;
    plot.xColumn = "bytes";
    plot.yColumn = "psnr";
    plot.yMost = kMostPlotted;
    for (const WayName& name : {kOurs, kSender, kSenderPublished, kIndependent, kPixels})
      plot.lines.push_back(
          {name.label, {{"mesh", mesh.name()}, {"view", view.view.name}, {"way", name.key}}});
    plot.caption =
        "500x500 pixels against the full mesh; base mesh, protocol and fields included. ";
    if (const auto file = mesh.wholeFileBytes())
      plot.caption += "Draco's file has " + std::to_string(*file) + " bytes: nothing before.";
    quality_.add(std::move(plot));
  }

  Result<void> addPictures(const EvaluatedMesh& mesh, const EvaluatedView& view,
                           const std::array<Reached, 4>& ways) {
    std::vector<Picture> pictures;
    std::string caption = mesh.name() + ", " + view.view.name + " view, from left to right: ";
    for (const Reached& way : ways) {
      pictures.push_back(way.kept);
      caption += way.keptText + "; ";
    }
    pictures.push_back(view.full);
    caption += "the full mesh.";
    const std::string file = "equal_bytes_" + view.view.name + "_" + mesh.name() + ".png";
    if (Result<void> done = writePng(pictureStrip(pictures), quality_.path() / file); !done)
      return done;
    quality_.addPicture(file, caption);
    return {};
  }

  // Experiment 4.
  Result<void> addVisibleOnly(const EvaluatedMesh& mesh, const EvaluatedView& view,
                              ReceiverWay& way, const std::string& after) {
    Result<Picture> picture = way.canvas().draw();
    if (!picture) return tl::unexpected(picture.error());
    const Result<double> psnr = psnrOf(*picture, view.full);
    if (!psnr) return tl::unexpected(psnr.error());
    const PictureDifference wrong = differenceOf(*picture, view.full);
    const auto share = [](uint64_t part, uint64_t of) {
      return static_cast<double>(part) / static_cast<double>(of > 0 ? of : 1);
    };
    const Cost& cost = way.cost();
    const double records = share(cost.records, mesh.pack().records().size());
    visible_.addCsv(
        kErrors,
        {mesh.name(), view.view.name, after, std::to_string(cost.records), numberText(records, 4),
         std::to_string(cost.bytesDown), numberText(*psnr), std::to_string(wrong.pixels),
         numberText(share(wrong.pixels, wrong.all), 5),
         numberText(share(wrong.pixels, wrong.covered), 5), std::to_string(wrong.clearPixels)});
    const auto add = [&](const char* column, double value, const char* unit, const char* note) {
      Figure figure;
      figure.table = "Split: " + after + ", " + view.view.name + " view";
      figure.row = mesh.name();
      figure.column = column;
      figure.value = value;
      figure.unit = unit;
      figure.csv = kErrors;
      figure.note = note;
      visible_.add(std::move(figure));
    };
    add("records", 100 * records, "% of all", "");
    add("error pixels", static_cast<double>(wrong.pixels), "pixels",
        "of 500x500; any difference in any channel");
    add("share of the picture", 100 * share(wrong.pixels, wrong.all), "%", "");
    add("clear error pixels", static_cast<double>(wrong.clearPixels), "pixels",
        "that differ by more than 8 of 255");
    add("PSNR", *psnr, "dB", "");
    std::printf("%s %s, %s: %.1f %% of the records, %llu error pixels (%llu clear), %.1f dB\n",
                mesh.name().c_str(), view.view.name.c_str(), after.c_str(), 100 * records,
                static_cast<unsigned long long>(wrong.pixels),
                static_cast<unsigned long long>(wrong.clearPixels), *psnr);
    // One without errors is not worth a picture.
    if (after != kSeen) return {};
    const std::string file = "visible_only_" + view.view.name + "_" + mesh.name() + ".png";
    const std::array<Picture, 3> strip = {*picture, view.full,
                                          differencePicture(*picture, view.full)};
    if (Result<void> done = writePng(pictureStrip(strip), visible_.path() / file); !done)
      return done;
    visible_.addPicture(file, mesh.name() + ", " + view.view.name +
                                  " view: all that is seen is split; the full mesh; where they "
                                  "differ (darker: more)");
    return {};
  }

  Easel& easel_;
  const QualityOptions& options_;
  ExperimentFolder quality_;
  ExperimentFolder visible_;
};

}  // namespace

Result<void> compareWays(const std::vector<std::unique_ptr<EvaluatedMesh>>& meshes, Easel& easel,
                         const QualityOptions& options) {
  auto quality = ExperimentFolder::create(options.output, "quality_against_bytes", 3);
  if (!quality) return tl::unexpected(quality.error());
  auto visible = ExperimentFolder::create(options.output, "visible_only", 4);
  if (!visible) return tl::unexpected(visible.error());
  WaysComparison comparison(easel, options, std::move(*quality), std::move(*visible));
  for (const auto& mesh : meshes)
    if (Result<void> done = comparison.compare(*mesh); !done) return done;
  return comparison.close();
}

}  // namespace meshfront::evaluation
