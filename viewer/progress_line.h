// One line on a terminal's stderr that tells how far a run is; silent elsewhere and in the first
// two seconds.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>

namespace meshfront {

class ProgressLine {
 public:
  ProgressLine() : onTerminal_(isatty(STDERR_FILENO) == 1) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(double seconds, uint64_t records, uint64_t splits, uint64_t bytesDown) {
    if (!isDue(seconds)) return;
    std::fprintf(stderr, "\r%llu of %llu records, %.1f kB\033[K",
                 static_cast<unsigned long long>(records), static_cast<unsigned long long>(splits),
                 static_cast<double>(bytesDown) / 1000);
  }
  void showFrames(double seconds, uint64_t frame, uint64_t frames) {
    if (!isDue(seconds)) return;
    std::fprintf(stderr, "\rframe %llu of %llu\033[K", static_cast<unsigned long long>(frame),
                 static_cast<unsigned long long>(frames));
  }
  void clear() {
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
  }

 private:
  bool isDue(double seconds) {
    if (!onTerminal_ || seconds < 2 || seconds < next_) return false;
    next_ = seconds + 0.2;
    shown_ = true;
    return true;
  }

  bool onTerminal_;
  bool shown_ = false;
  double next_ = 0;
};

}  // namespace meshfront
