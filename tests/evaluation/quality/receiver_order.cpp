#include "tests/evaluation/quality/receiver_order.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "shared/scene/likely_error.h"
#include "tests/evaluation/quality/ring_shape.h"

namespace meshfront::evaluation {

ReceiverOrder scoredOrder(std::string name, std::string what, CandidateScore score) {
  const auto keep = [score = std::move(score)](const RankContext& context,
                                               std::vector<Candidate>& candidates, size_t count) {
    std::vector<std::pair<double, size_t>> scores;
    scores.reserve(candidates.size());
    for (size_t i = 0; i < candidates.size(); ++i)
      scores.emplace_back(score(context, candidates[i]), i);
    const auto before = [&candidates](const auto& a, const auto& b) {
      if (a.first != b.first) return a.first > b.first;
      return candidates[a.second].id < candidates[b.second].id;
    };
    count = std::min(count, scores.size());
    std::partial_sort(scores.begin(), scores.begin() + static_cast<ptrdiff_t>(count), scores.end(),
                      before);
    std::vector<Candidate> kept;
    kept.reserve(count);
    for (size_t i = 0; i < count; ++i) kept.push_back(candidates[scores[i].second]);
    candidates = std::move(kept);
  };
  return {std::move(name), std::move(what), false, false, keep};
}

ReceiverOrder shippedOrder(RankOrder order) {
  ReceiverOrder shipped;
  if (order == RankOrder::pixels) {
    shipped.name = "pixels";
    shipped.what = "pixels covered, as published";
    shipped.keepFirst = [](const RankContext&, std::vector<Candidate>& candidates, size_t count) {
      meshfront::keepFirst(candidates, count, RankOrder::pixels);
    };
    return shipped;
  }
  shipped.name = "level, likely error, pixels";
  shipped.what = "level less the likely error in levels, then pixels covered, as shipped";
  shipped.withRim = true;
  shipped.keepFirst = [](const RankContext& context, std::vector<Candidate>& candidates,
                         size_t count) {
    std::vector<uint8_t> lift;
    liftByLikelyError(
        context.mesh(), context.pixels,
        eyeOnGrid(context.view.camera, context.refined.pack().metadata().quantization),
        pixelsAtOne(context.view.camera, context.picture), lift);
    for (Candidate& candidate : candidates)
      candidate.level =
          static_cast<uint8_t>(candidate.level + kMostErrorLift -
                               (candidate.slot < lift.size() ? lift[candidate.slot] : 0));
    meshfront::keepFirst(candidates, count, RankOrder::significance);
  };
  return shipped;
}

namespace {

RingShape shapeOf(const RankContext& context, const Candidate& candidate) {
  const Quantization& grid = context.refined.pack().metadata().quantization;
  return ringShape(context.mesh(), candidate.slot, eyeOnGrid(context.view.camera, grid),
                   pixelsAtOne(context.view.camera, context.picture));
}

// Squared differences of colour that a split is likely to take away, up to a factor: inside, what
// the normals vary within the ring; at the silhouette, the pixels between an edge and the arc that
// it stands for, which differ much more.
double likelyError(const RankContext& context, const Candidate& candidate, double contrast) {
  const RingShape shape = shapeOf(context, candidate);
  const double inside = candidate.pixels * shape.normalVariance;
  const double sagitta = shape.edgeLength * shape.pixelsAStep * std::sqrt(shape.normalVariance) / 8;
  return inside + contrast * shape.silhouettePixels * sagitta;
}

// log2 of it.
double errorOctaves(const RankContext& context, const Candidate& candidate) {
  return std::log2(likelyError(context, candidate, 4) + 1e-6);
}

}  // namespace

ReceiverOrder likelyErrorOrder() {
  ReceiverOrder made = scoredOrder("level x likely error",
                                   "what normals and silhouettes tell, halved for each level",
                                   [](const RankContext& context, const Candidate& c) {
                                     return errorOctaves(context, c) - c.level;
                                   });
  made.withRim = true;
  return made;
}

std::vector<ReceiverOrder> furtherOrders() {
  std::vector<ReceiverOrder> orders;
  ReceiverOrder levels;
  levels.name = "level, pixels";
  levels.what = "significance level, then pixels covered";
  levels.keepFirst = [](const RankContext&, std::vector<Candidate>& candidates, size_t count) {
    keepFirst(candidates, count, RankOrder::significance);
  };
  orders.push_back(std::move(levels));
  orders.push_back(scoredOrder(
      "pixels x error", "pixels covered, halved for each level",
      [](const RankContext&, const Candidate& c) { return std::log2(c.pixels) - c.level; }));
  orders.push_back(scoredOrder(
      "pixels x squared error", "pixels covered, quartered for each level",
      [](const RankContext&, const Candidate& c) { return std::log2(c.pixels) - 2.0 * c.level; }));
  orders.push_back(scoredOrder("thresholds",
                               "level, one later below 4 pixels, two below 2; then pixels",
                               [](const RankContext&, const Candidate& c) {
                                 const int late = c.pixels < 2 ? 2 : c.pixels < 4 ? 1 : 0;
                                 return std::log2(c.pixels) / 32 - (c.level + late);
                               }));
  orders.push_back(scoredOrder("level, normals",
                               "level, then the variance of normals in the ring times pixels",
                               [](const RankContext& context, const Candidate& c) {
                                 const double error = c.pixels * shapeOf(context, c).normalVariance;
                                 return std::log2(error + 1e-6) / 64 - c.level;
                               }));
  orders.push_back(scoredOrder("silhouettes", "level, two earlier at a silhouette; then pixels",
                               [](const RankContext& context, const Candidate& c) {
                                 const bool edge = shapeOf(context, c).silhouettePixels > 0;
                                 return std::log2(c.pixels) / 32 - c.level + (edge ? 2 : 0);
                               }));
  orders.push_back(scoredOrder(
      "likely error", "what normals and silhouettes tell, and no level",
      [](const RankContext& context, const Candidate& c) { return likelyError(context, c, 4); }));
  orders.push_back(likelyErrorOrder());
  return orders;
}

namespace {

// By record.
using FineLevels = std::shared_ptr<const std::vector<float>>;

FineLevels levelsByRank(const PackRecords& pack, std::span<const RecordIndex> order,
                        double levelsAnOctave) {
  const auto levels = std::make_shared<std::vector<float>>(pack.records().size());
  const double roots = std::max<double>(1, static_cast<double>(pack.base().roots.size()));
  for (size_t rank = 0; rank < order.size(); ++rank)
    (*levels)[order[rank]] = static_cast<float>(
        std::floor(levelsAnOctave * std::log2((roots + static_cast<double>(rank)) / roots)));
  return levels;
}

}  // namespace

ReceiverOrder relevelledOrder(std::string name, std::string what, const PackRecords& pack,
                              std::span<const RecordIndex> order, double levelsAnOctave) {
  const FineLevels levels = levelsByRank(pack, order, levelsAnOctave);
  ReceiverOrder made = scoredOrder(std::move(name), std::move(what),
                                   [levels](const RankContext& context, const Candidate& c) {
                                     const RecordIndex record = context.refined.recordOf(c.node);
                                     return std::log2(c.pixels) / 32 - (*levels)[record];
                                   });
  made.oracle = true;
  return made;
}

ReceiverOrder relevelledLikelyErrorOrder(std::string name, std::string what,
                                         const PackRecords& pack,
                                         std::span<const RecordIndex> order,
                                         double levelsAnOctave) {
  const FineLevels levels = levelsByRank(pack, order, levelsAnOctave);
  ReceiverOrder made =
      scoredOrder(std::move(name), std::move(what),
                  [levels, levelsAnOctave](const RankContext& context, const Candidate& c) {
                    const RecordIndex record = context.refined.recordOf(c.node);
                    return errorOctaves(context, c) - (*levels)[record] / levelsAnOctave;
                  });
  made.oracle = true;
  made.withRim = true;
  return made;
}

}  // namespace meshfront::evaluation
