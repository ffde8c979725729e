// Which view each simulated receiver looks from: lines of a file, drawn by a law.
//
//   zipf:FILE   line k (from 1) with a probability proportional to 1 / k^exponent: many look at the
//               first views and few at the last ones, as at anything published
//   each:FILE   line after line, from the first again after the last
#pragma once

#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "shared/camera/camera_spec.h"
#include "shared/result.h"

namespace meshfront {

class ViewChoice {
 public:
  // `text` as above. The file holds a camera a line (kCameraSpecHelp); empty lines and those that
  // begin with '#' are passed over. `exponent` >= 0; 0 draws all alike.
  [[nodiscard]] static Result<ViewChoice> read(std::string_view text, double exponent,
                                               uint64_t seed);

  [[nodiscard]] size_t size() const { return views_.size(); }
  [[nodiscard]] const CameraSpec& view(size_t index) const { return views_[index]; }
  // Of the next receiver. The sequence depends on file, law and seed alone.
  [[nodiscard]] size_t next();

 private:
  explicit ViewChoice(std::vector<CameraSpec> views) : views_(std::move(views)) {}

  std::vector<CameraSpec> views_;
  std::vector<double> upTo_;  // of zipf: cumulated probabilities
  std::mt19937_64 random_;
  size_t next_ = 0;  // of each
};

}  // namespace meshfront
