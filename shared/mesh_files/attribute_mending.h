// Colours and normals as files spell them, made those of an IndexedMesh. Files are allowed odd
// values here: they are mended and counted, since a wrong colour is no reason to refuse a mesh.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

inline constexpr Colour kNoColour = {255, 255, 255, 255};  // of a vertex that has none among others

// Finds out whether text gives channels as 0 .. 1 or as 0 .. 255, which both is usual in OBJ and
// OFF: the latter if all are whole numbers and one is larger than 1.
class ChannelScale {
 public:
  void see(double channel) {
    allWhole_ = allWhole_ && std::floor(channel) == channel;
    largerThanOne_ = largerThanOne_ || channel > 1;
  }
  [[nodiscard]] double full() const { return allWhole_ && largerThanOne_ ? 255 : 1; }

 private:
  bool allWhole_ = true;
  bool largerThanOne_ = false;
};

class VertexAttributeMending {
 public:
  // Channels of 0 .. full, alpha too, become 0 .. 255; what lies outside is clamped, NaN is 0.
  Colour colour(const std::array<double, 4>& channels, double full) {
    Colour out{};
    bool wrong = false;
    for (size_t i = 0; i < out.size(); ++i) {
      const double scaled = channels[i] * (255 / full);
      wrong = wrong || !(scaled > -0.5 && scaled < 255.5);
      out[i] = static_cast<uint8_t>(std::fmin(std::fmax(scaled, 0), 255) + 0.5);
    }
    if (wrong) ++wrongColours_;
    return out;
  }
  // A normal that is not finite, as floats, is none.
  std::array<float, 3> normal(const std::array<double, 3>& components) {
    std::array<float, 3> out{};
    for (size_t i = 0; i < out.size(); ++i) {
      if (!(std::fabs(components[i]) <= std::numeric_limits<float>::max())) {
        ++wrongNormals_;
        return {};
      }
      out[i] = static_cast<float>(components[i]);
    }
    return out;
  }
  // Says in `mesh` what was mended.
  void report(IndexedMesh& mesh) const {
    if (wrongColours_ > 0)
      mesh.notCarried.push_back("colours: " + std::to_string(wrongColours_) +
                                " are out of range and were clamped");
    if (wrongNormals_ > 0)
      mesh.notCarried.push_back("normals: " + std::to_string(wrongNormals_) + " are not finite");
  }

 private:
  uint64_t wrongColours_ = 0;
  uint64_t wrongNormals_ = 0;
};

}  // namespace meshfront
