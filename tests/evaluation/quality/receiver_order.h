// Orders in which a receiver may ask for the vertices that it sees: the shipped ones, and others to
// compare with. All but the oracles know no more than a receiver does: the mesh as it is, the
// pixels counted, the camera.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/receiver/ranking.h"
#include "tests/evaluation/quality/easel.h"
#include "tests/evaluation/view_independent/pack_records.h"

namespace meshfront::evaluation {

struct RankContext {
  const RefinedPack& refined;
  std::span<const uint32_t> pixels;  // by vertex slot
  const EvaluationView& view;
  PixelSize picture;

  [[nodiscard]] const SelectivelyRefinedMesh& mesh() const { return refined.mesh(); }
};

struct ReceiverOrder {
  std::string name;      // of a row
  std::string what;      // a line
  bool oracle = false;   // goes by what no receiver can know beforehand
  bool withRim = false;  // ranks the rim with what is seen (shared/scene/seen_rim.h)
  // Leaves the `count` best ones, best first.
  std::function<void(const RankContext&, std::vector<Candidate>&, size_t count)> keepFirst;
};

// Larger comes first; ties by ID.
using CandidateScore = std::function<double(const RankContext&, const Candidate&)>;
[[nodiscard]] ReceiverOrder scoredOrder(std::string name, std::string what, CandidateScore score);

// The viewer's: --rank significance and --rank pixels.
[[nodiscard]] ReceiverOrder shippedOrder(RankOrder order);
// The best one found that a receiver can follow: what normals and silhouettes tell is likely to be
// wrong in the picture, halved for each level.
[[nodiscard]] ReceiverOrder likelyErrorOrder();
// What a receiver could do instead.
[[nodiscard]] std::vector<ReceiverOrder> furtherOrders();
// Levels as if the octaves were of the ranks in this order of all records, then pixels: what other
// levels in the records would bring. `order` as errorOrder() gives it.
[[nodiscard]] ReceiverOrder relevelledOrder(std::string name, std::string what,
                                            const PackRecords& pack,
                                            std::span<const RecordIndex> order,
                                            double levelsAnOctave);
// likelyErrorOrder() with such levels in the place of the records' own: what records that told
// their error as finely as `levelsAnOctave` would bring beside what the viewer sees for itself.
// (The rim, where it joins, is not a level behind then.)
[[nodiscard]] ReceiverOrder relevelledLikelyErrorOrder(std::string name, std::string what,
                                                       const PackRecords& pack,
                                                       std::span<const RecordIndex> order,
                                                       double levelsAnOctave);

}  // namespace meshfront::evaluation
