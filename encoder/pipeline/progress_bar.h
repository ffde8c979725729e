// A progress bar on stderr: only on a terminal, only for work of over two seconds.
//
//   simplify   [==============                ]  47 %, about 1:10 min left
#pragma once

#include <chrono>
#include <string>

namespace meshfront {

// The share of the whole encoding that is done, 0 .. 1, when `done` of this phase is. Phases take
// the shares of the time that they took on scans of a million vertices.
[[nodiscard]] double overallShare(const std::string& phase, double done);

// The bar's line. The time that is left is told once it can be guessed: from 5 % on.
[[nodiscard]] std::string progressLine(const std::string& phase, double overall, double seconds);

class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  // `done` of the phase, 0 .. 1. Cheap to call often.
  void show(const std::string& phase, double done);
  void clear();

 private:
  bool onTerminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point started_;
  std::chrono::steady_clock::time_point drawn_;
};

}  // namespace meshfront
