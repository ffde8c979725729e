#include "encoder/pipeline/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace meshfront {
namespace {

constexpr auto kSilentTime = std::chrono::seconds(2);
constexpr auto kRedrawTime = std::chrono::milliseconds(100);
constexpr size_t kWidth = 30;

}  // namespace

ProgressBar::ProgressBar()
    : onTerminal_(isatty(STDERR_FILENO) == 1), started_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
  if (shown_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::show(const std::string& phase, double done) {
  const auto now = std::chrono::steady_clock::now();
  if (!onTerminal_ || now - started_ < kSilentTime || now - drawn_ < kRedrawTime) return;
  drawn_ = now;
  shown_ = true;
  const double share = std::clamp(done, 0.0, 1.0);
  const auto filled = static_cast<size_t>(share * kWidth);
  fmt::print(stderr, "\r\033[K{:<10} [{:=<{}}{: <{}}] {:3.0f} %", phase, "", filled, "",
             kWidth - filled, share * 100);
  std::fflush(stderr);
}

}  // namespace meshfront
