// Turns polygons and triangle strips into triangles.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "shared/mesh/indexed_mesh.h"

namespace meshfront {

// A fan around the first corner; nothing for fewer than three corners.
inline void appendFan(std::span<const uint32_t> corners, std::vector<Triangle>& triangles) {
  for (size_t i = 2; i < corners.size(); ++i)
    triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

// A strip fed corner by corner: each makes a triangle with the two before it, every other one
// turned round. Triangles with two equal corners only stitch strips together and are left out.
class TriangleStrip {
 public:
  void restart() { length_ = 0; }
  void append(uint32_t corner, std::vector<Triangle>& triangles) {
    if (length_ >= 2 && before_ != last_ && last_ != corner && corner != before_) {
      if (length_ % 2 == 0)
        triangles.push_back({before_, last_, corner});
      else
        triangles.push_back({last_, before_, corner});
    }
    before_ = std::exchange(last_, corner);
    ++length_;
  }

 private:
  uint64_t length_ = 0;  // corners since the restart
  uint32_t before_ = 0;
  uint32_t last_ = 0;
};

}  // namespace meshfront
