// How long the GPU takes for a pass, by timer queries that nobody waits for.
//
//   timer.begin(); ...draw...; timer.end();
//   if (auto ms = timer.milliseconds()) ...   // of the latest pass whose time has arrived
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "viewer/gl/gl_object.h"

namespace meshfront {

class PassTimer {
 public:
  // Passes do not nest, also not those of different timers. A pass that would be one too many on
  // the way is not measured.
  void begin();
  void end();
  // Nothing before the first one has arrived.
  [[nodiscard]] std::optional<double> milliseconds();

 private:
  static constexpr size_t kQueries = 4;
  void collect();

  std::array<GlQuery, kQueries> queries_;
  size_t first_ = 0;  // the oldest on its way
  size_t onTheWay_ = 0;
  bool running_ = false;
  std::optional<double> latest_;
};

}  // namespace meshfront
