#include "load/view_choice.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

namespace meshfront {
namespace {

constexpr size_t kMostViews = 1'000'000;

Result<std::vector<CameraSpec>> readViews(const std::string& path) {
  std::ifstream in(path);
  if (!in) return fail("views: '" + path + "' cannot be read");
  std::vector<CameraSpec> views;
  std::string line;
  for (size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(' ') == std::string::npos || line.front() == '#') continue;
    if (std::any_of(line.begin(), line.end(), [](char c) { return c < ' ' || c > '~'; }))
      return fail("views: " + path + ", line " + std::to_string(number) +
                  " is no text; expected a camera a line");
    auto view = parseCameraSpec(line);
    if (!view)
      return fail("views: " + path + ", line " + std::to_string(number) + ": " +
                  view.error().message);
    if (views.size() == kMostViews) return fail("views: more than a million in '" + path + "'");
    views.push_back(*view);
  }
  if (views.empty()) return fail("views: there is none in '" + path + "'");
  return views;
}

}  // namespace

Result<ViewChoice> ViewChoice::read(std::string_view text, double exponent, uint64_t seed) {
  const size_t colon = text.find(':');
  const std::string_view law = text.substr(0, colon);
  if (colon == std::string_view::npos || (law != "zipf" && law != "each"))
    return fail("views: expected zipf:FILE or each:FILE, not '" + std::string(text) + "'");
  auto views = readViews(std::string(text.substr(colon + 1)));
  if (!views) return tl::unexpected(views.error());
  ViewChoice choice(std::move(*views));
  choice.random_.seed(seed);
  if (law == "zipf") {
    double sum = 0;
    for (size_t k = 1; k <= choice.views_.size(); ++k) {
      sum += std::pow(static_cast<double>(k), -exponent);
      choice.upTo_.push_back(sum);
    }
    for (double& value : choice.upTo_) value /= sum;
  }
  return choice;
}

size_t ViewChoice::next() {
  if (upTo_.empty()) return next_++ % views_.size();
  // 53 bits of the generator: the same numbers with every standard library.
  const double drawn = static_cast<double>(random_() >> 11) * 0x1p-53;
  const auto found = std::upper_bound(upTo_.begin(), upTo_.end(), drawn);
  return std::min<size_t>(static_cast<size_t>(found - upTo_.begin()), views_.size() - 1);
}

}  // namespace meshfront
