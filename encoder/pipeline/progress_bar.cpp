#include "encoder/pipeline/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

namespace meshfront {
namespace {

constexpr auto kSilentTime = std::chrono::seconds(2);
constexpr auto kRedrawTime = std::chrono::milliseconds(100);
constexpr size_t kWidth = 30;
constexpr double kFirstGuess = 0.05;

struct PhaseShare {
  std::string_view name;
  double share;
};
constexpr std::array<PhaseShare, 6> kPhases = {{{"read", 0.03},
                                                {"clean", 0.08},
                                                {"simplify", 0.53},
                                                {"hierarchy", 0.03},
                                                {"code", 0.30},
                                                {"write", 0.03}}};

std::string duration(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  return whole < 60 ? fmt::format("{} s", whole)
                    : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

}  // namespace

double overallShare(const std::string& phase, double done) {
  double before = 0;
  for (const PhaseShare& each : kPhases) {
    if (each.name == phase) return before + each.share * std::clamp(done, 0.0, 1.0);
    before += each.share;
  }
  return 0;
}

std::string progressLine(const std::string& phase, double overall, double seconds) {
  const double share = std::clamp(overall, 0.0, 1.0);
  const auto filled = static_cast<size_t>(share * kWidth);
  std::string line = fmt::format("{:<10} [{:=<{}}{: <{}}] {:3.0f} %", phase, "", filled, "",
                                 kWidth - filled, share * 100);
  if (share >= kFirstGuess)
    line += fmt::format(", about {} left", duration(seconds / share * (1 - share)));
  return line;
}

ProgressBar::ProgressBar()
    : onTerminal_(isatty(STDERR_FILENO) == 1), started_(std::chrono::steady_clock::now()) {}

void ProgressBar::clear() {
  if (shown_) fmt::print(stderr, "\r\033[K");
  shown_ = false;
}

void ProgressBar::show(const std::string& phase, double done) {
  const auto now = std::chrono::steady_clock::now();
  if (!onTerminal_ || now - started_ < kSilentTime || now - drawn_ < kRedrawTime) return;
  drawn_ = now;
  shown_ = true;
  const double seconds = std::chrono::duration<double>(now - started_).count();
  fmt::print(stderr, "\r\033[K{}", progressLine(phase, overallShare(phase, done), seconds));
  std::fflush(stderr);
}

}  // namespace meshfront
