// One way of getting a mesh to a viewer, in this process: what has been received, what it cost, and
// the picture that it gives.
#pragma once

#include <cstdint>
#include <optional>

#include "shared/result.h"
#include "tests/evaluation/quality/easel.h"
#include "tests/evaluation/quality/quality_curve.h"
#include "tests/evaluation/view_independent/pack_records.h"

namespace meshfront::evaluation {

struct Cost {
  uint64_t bytesDown = 0;  // all that came, base mesh and protocol included
  uint64_t bytesUp = 0;
  uint64_t records = 0;
};

class Way {
 public:
  virtual ~Way() = default;
  Way(const Way&) = delete;
  Way& operator=(const Way&) = delete;

  // Takes in one answer, or, where a stream has none, what comes until at least `untilBytes` are
  // there. False: there was nothing more to come.
  [[nodiscard]] virtual Result<bool> advance(uint64_t untilBytes) = 0;
  [[nodiscard]] const Cost& cost() const { return cost_; }
  [[nodiscard]] Canvas& canvas() { return canvas_; }
  [[nodiscard]] const RefinedPack& refined() const { return refined_; }

 protected:
  Way(RefinedPack refined, Easel& easel, const EvaluationView& view)
      : refined_(std::move(refined)),
        canvas_(easel, refined_.mesh(), refined_.pack().metadata().quantization, view) {}

  RefinedPack refined_;
  Canvas canvas_;
  Cost cost_;
};

struct CurveOptions {
  double stopAt = 50;    // dB
  double factor = 1.08;  // of the amounts between two pictures, > 1
  uint64_t stopAtBytes = UINT64_MAX;
  // Keeps the last picture that no more than so many bytes gave.
  std::optional<uint64_t> pictureAtBytes;
  // Keeps the first picture that is as good as that, dB.
  std::optional<double> pictureAtPsnr;
};

struct FollowedCurve {
  QualityCurve curve;
  bool ended = false;  // nothing more was to come before stopAt
  Picture kept;        // where a picture was to be kept
  uint64_t keptAtBytes = 0;
  double keptPsnr = 0;
};

// From the base mesh on.
[[nodiscard]] Result<FollowedCurve> followCurve(Way& way, const Picture& reference,
                                                const CurveOptions& options);

}  // namespace meshfront::evaluation
