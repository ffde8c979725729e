#include "viewer/run/monotone_curve.h"

#include <algorithm>
#include <utility>

namespace meshfront {
namespace {

// Between two secants of lengths `before` and `after`; 0 where they differ in direction.
double slopeBetween(double left, double before, double right, double after) {
  if (!(left * right > 0)) return 0;
  const double a = 2 * after + before;
  const double b = after + 2 * before;
  return (a + b) / (a / left + b / right);
}

}  // namespace

MonotoneCurve::MonotoneCurve(std::vector<double> times, std::vector<double> values, bool smooth,
                             Ends ends)
    : times_(std::move(times)), values_(std::move(values)) {
  const size_t spans = times_.size() - 1;
  if (!smooth || spans == 0) return;
  std::vector<double> length(spans);
  std::vector<double> secant(spans);
  for (size_t i = 0; i < spans; ++i) {
    length[i] = times_[i + 1] - times_[i];
    secant[i] = (values_[i + 1] - values_[i]) / length[i];
  }
  slopes_.resize(spans + 1);
  for (size_t i = 1; i < spans; ++i) {
    slopes_[i] = slopeBetween(secant[i - 1], length[i - 1], secant[i], length[i]);
  }
  const double sign = ends == Ends::mirrored ? -1 : 1;
  const double joined =
      slopeBetween(secant[spans - 1], length[spans - 1], sign * secant[0], length[0]);
  slopes_.front() = ends == Ends::open ? secant.front() : sign * joined;
  slopes_.back() = ends == Ends::open ? secant.back() : joined;
}

double MonotoneCurve::at(double time) const {
  if (values_.empty()) return 0;
  if (!(time > times_.front())) return values_.front();
  if (time >= times_.back()) return values_.back();
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const auto i = static_cast<size_t>(after - times_.begin()) - 1;
  const double span = times_[i + 1] - times_[i];
  const double s = (time - times_[i]) / span;
  if (slopes_.empty()) return values_[i] + s * (values_[i + 1] - values_[i]);
  const double u = 1 - s;
  return values_[i] * u * u * (1 + 2 * s) + values_[i + 1] * s * s * (3 - 2 * s) +
         span * (slopes_[i] * s * u * u - slopes_[i + 1] * s * s * u);
}

}  // namespace meshfront
