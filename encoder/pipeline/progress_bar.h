// A progress bar on stderr: only on a terminal, only for work of over two seconds.
#pragma once

#include <chrono>
#include <string>

namespace meshfront {

class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();  // takes the bar away
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  // `done` of the phase, 0 .. 1. Cheap to call often.
  void show(const std::string& phase, double done);

 private:
  bool onTerminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point started_;
  std::chrono::steady_clock::time_point drawn_;
};

}  // namespace meshfront
