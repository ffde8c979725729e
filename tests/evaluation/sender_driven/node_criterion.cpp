#include "tests/evaluation/sender_driven/node_criterion.h"

#include <algorithm>
#include <cmath>

#include "shared/bits/integer_codes.h"

namespace meshfront::evaluation {
namespace {

constexpr double kAxisSteps = 31;

uint8_t logarithm(float value) {
  if (value <= 0) return 0;
  return static_cast<uint8_t>(std::clamp(std::ceil(4 * std::log2(value) + 64), 1.0F, 255.0F));
}

void writeDifference(BitWriter& out, int value, int from) {
  const int difference = value - from;
  writeExpGolomb(out, static_cast<uint64_t>(difference > 0 ? 2 * difference - 1 : -2 * difference),
                 1);
}

int readDifference(BitReader& in, int from, int least, int most) {
  const auto code = static_cast<int64_t>(readExpGolomb(in, 1));
  const int64_t value = from + ((code & 1) != 0 ? (code + 1) / 2 : -code / 2);
  if (value < least || value > most) in.fail();
  return static_cast<int>(std::clamp<int64_t>(value, least, most));
}

}  // namespace

NodeCriterion NodeCriterion::of(const ViewCriteria& criteria) {
  NodeCriterion result;
  result.error = logarithm(criteria.error);
  result.radius = logarithm(criteria.radius);
  if (criteria.sine == ViewCriteria::kNoCone) return result;
  result.sine = static_cast<uint8_t>(std::min(criteria.sine / 1024 + 1, 31));
  const double x = criteria.axis[0];
  const double y = criteria.axis[1];
  const double z = criteria.axis[2];
  const double sum = std::max(std::abs(x) + std::abs(y) + std::abs(z), 1.0);
  double u = x / sum;
  double v = y / sum;
  if (z < 0) {
    const double folded = (1 - std::abs(v)) * (u < 0 ? -1 : 1);
    v = (1 - std::abs(u)) * (v < 0 ? -1 : 1);
    u = folded;
  }
  result.axis = {static_cast<int8_t>(std::lround(u * kAxisSteps)),
                 static_cast<int8_t>(std::lround(v * kAxisSteps))};
  return result;
}

void NodeCriterion::write(BitWriter& out, const NodeCriterion& parent) const {
  writeDifference(out, error, parent.error);
  writeDifference(out, radius, parent.radius);
  writeDifference(out, sine, parent.sine);
  if (sine == 32) return;
  for (size_t i = 0; i < 2; ++i) writeDifference(out, axis[i], parent.axis[i]);
}

NodeCriterion NodeCriterion::read(BitReader& in, const NodeCriterion& parent) {
  NodeCriterion result;
  result.error = static_cast<uint8_t>(readDifference(in, parent.error, 0, 255));
  result.radius = static_cast<uint8_t>(readDifference(in, parent.radius, 0, 255));
  result.sine = static_cast<uint8_t>(readDifference(in, parent.sine, 0, 32));
  if (result.sine == 32) return result;
  for (size_t i = 0; i < 2; ++i)
    result.axis[i] = static_cast<int8_t>(readDifference(in, parent.axis[i], -31, 31));
  return result;
}

}  // namespace meshfront::evaluation
