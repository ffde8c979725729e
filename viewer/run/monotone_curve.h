// A number over time through given values: smooth, and between two of them never beyond either
// (Fritsch and Carlson, Monotone piecewise cubic interpolation, SIAM J. Numer. Anal. 17, 1980;
// slopes as Fritsch and Butland's weighted harmonic means).
#pragma once

#include <vector>

namespace meshfront {

class MonotoneCurve {
 public:
  MonotoneCurve() = default;
  enum class Ends {
    open,
    closed,   // the curve goes on behind its end as at its beginning (moved by a constant)
    mirrored  // likewise, with the sign turned: quaternions of one rotation may be opposite
  };
  // As many times, ascending, as values; one or more.
  MonotoneCurve(std::vector<double> times, std::vector<double> values, bool smooth, Ends ends);

  // Before the first time the first value, after the last one the last.
  [[nodiscard]] double at(double time) const;

 private:
  std::vector<double> times_;
  std::vector<double> values_;
  std::vector<double> slopes_;  // empty: straight lines
};

}  // namespace meshfront
