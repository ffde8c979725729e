#include "tests/evaluation/quality/quality_curve.h"

#include <algorithm>
#include <cmath>

namespace meshfront::evaluation {
namespace {

template <typename AmountOf>
std::optional<double> amountTo(std::span<const CurvePoint> curve, double decibels,
                               const AmountOf& amountOf) {
  for (size_t i = 0; i < curve.size(); ++i) {
    if (curve[i].psnr < decibels) continue;
    const auto here = static_cast<double>(amountOf(curve[i]));
    if (i == 0) return here;
    const auto before = static_cast<double>(amountOf(curve[i - 1]));
    const double part = (decibels - curve[i - 1].psnr) / (curve[i].psnr - curve[i - 1].psnr);
    if (before <= 0) return before + part * (here - before);
    return before * std::pow(here / before, part);
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> bytesTo(std::span<const CurvePoint> curve, double decibels) {
  return amountTo(curve, decibels, [](const CurvePoint& point) { return point.bytesDown; });
}

std::optional<double> recordsTo(std::span<const CurvePoint> curve, double decibels) {
  return amountTo(curve, decibels, [](const CurvePoint& point) { return point.records; });
}

void MeasuringPoints::measuredAt(uint64_t amount) {
  // 1,000 times 1.1 is not 1,101.
  constexpr double kRounding = 1e-6;
  const double grown = static_cast<double>(amount) * factor_ - kRounding;
  const auto scaled = static_cast<uint64_t>(std::ceil(grown));
  next_ = std::max(scaled, amount + 1);
}

}  // namespace meshfront::evaluation
