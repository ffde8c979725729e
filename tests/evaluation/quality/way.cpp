#include "tests/evaluation/quality/way.h"

#include <algorithm>
#include <utility>

namespace meshfront::evaluation {

Result<FollowedCurve> followCurve(Way& way, const Picture& reference, const CurveOptions& options) {
  FollowedCurve followed;
  MeasuringPoints points(way.cost().bytesDown, options.factor);
  bool more = true;
  for (;;) {
    const Cost cost = way.cost();
    const uint64_t kept = options.pictureAtBytes.value_or(0);
    // Answers are not known in length before they are there: near it, each one is looked at.
    const bool nearKept = 10 * cost.bytesDown >= 9 * kept && cost.bytesDown <= kept;
    if (points.isDue(cost.bytesDown) || nearKept || !more) {
      Result<Picture> picture = way.canvas().draw();
      if (!picture) return tl::unexpected(picture.error());
      const Result<double> psnr = psnrOf(*picture, reference);
      if (!psnr) return tl::unexpected(psnr.error());
      if (followed.curve.empty() || followed.curve.back().bytesDown < cost.bytesDown)
        followed.curve.push_back({cost.bytesDown, cost.bytesUp, cost.records, *psnr});
      points.measuredAt(cost.bytesDown);
      const bool goodEnough =
          options.pictureAtPsnr && followed.kept.rgb.empty() && *psnr >= *options.pictureAtPsnr;
      if (cost.bytesDown <= kept || goodEnough) {
        followed.kept = std::move(*picture);
        followed.keptAtBytes = cost.bytesDown;
        followed.keptPsnr = *psnr;
      }
      if (*psnr >= options.stopAt && cost.bytesDown >= kept) break;
      if (cost.bytesDown >= options.stopAtBytes) break;
    }
    if (!more) break;
    const uint64_t until = cost.bytesDown < kept ? std::min(points.next(), kept) : points.next();
    const Result<bool> advanced = way.advance(until);
    if (!advanced) return tl::unexpected(advanced.error());
    more = *advanced;
  }
  followed.ended = !more;
  return followed;
}

}  // namespace meshfront::evaluation
