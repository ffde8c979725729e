// A picture's quality against what was received for it, as measured at some moments of a stream.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace meshfront::evaluation {

struct CurvePoint {
  uint64_t bytesDown = 0;
  uint64_t bytesUp = 0;
  uint64_t records = 0;
  double psnr = 0;  // dB
};
using QualityCurve = std::vector<CurvePoint>;  // by bytesDown, ascending

// Identical pictures have an infinite PSNR; this is written instead.
inline constexpr double kIdenticalPicturesPsnr = 99;

// How much had been received, bytes down or records, when the curve first came to `decibels`:
// between two points the PSNR is taken to be a straight line over the logarithm of the amount. A
// curve that starts there has needed its first point's amount. nullopt where it never comes to it.
[[nodiscard]] std::optional<double> bytesTo(std::span<const CurvePoint> curve, double decibels);
[[nodiscard]] std::optional<double> recordsTo(std::span<const CurvePoint> curve, double decibels);

// Says when the next picture is worth drawing: amounts that grow by a factor, so that a curve over
// the logarithm has its points evenly.
class MeasuringPoints {
 public:
  // `factor` > 1.
  MeasuringPoints(uint64_t first, double factor) : next_(first), factor_(factor) {}
  [[nodiscard]] uint64_t next() const { return next_; }
  [[nodiscard]] bool isDue(uint64_t amount) const { return amount >= next_; }
  void measuredAt(uint64_t amount);

 private:
  uint64_t next_;
  double factor_;
};

}  // namespace meshfront::evaluation
