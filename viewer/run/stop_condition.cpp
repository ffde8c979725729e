#include "viewer/run/stop_condition.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

namespace meshfront {
namespace {

struct Unit {
  std::string_view name;
  double octets;
};
constexpr std::array<Unit, 9> kUnits{{{"", 1},
                                      {"B", 1},
                                      {"kB", 1e3},
                                      {"KB", 1e3},
                                      {"MB", 1e6},
                                      {"GB", 1e9},
                                      {"KiB", 1024.0},
                                      {"MiB", 1024.0 * 1024},
                                      {"GiB", 1024.0 * 1024 * 1024}}};
constexpr double kMostOctets = 1e18;

tl::unexpected<Error> wrong(std::string_view text) {
  std::string message = "no stop condition: '";
  message.append(text.substr(0, 60));
  message.append("'; expected settled, complete, a number of bytes (20000, 20kB, 64KiB), ");
  message.append("records:N or psnr:DB");
  return fail(std::move(message));
}

// The number at the front of `text`, which is left with the rest.
bool takeNumber(std::string_view& text, double& number) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || !std::isfinite(number) || number < 0) return false;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return true;
}

}  // namespace

Result<StopCondition> parseStopCondition(std::string_view text) {
  using Kind = StopCondition::Kind;
  if (text == "settled") return StopCondition{Kind::settled, 0, 0};
  if (text == "complete") return StopCondition{Kind::complete, 0, 0};
  std::string_view rest = text;
  double number = 0;
  if (text.starts_with("records:")) {
    rest.remove_prefix(8);
    if (!takeNumber(rest, number) || !rest.empty() || number != std::floor(number) ||
        number > kMostOctets)
      return wrong(text);
    return StopCondition{Kind::records, static_cast<uint64_t>(number), 0};
  }
  if (text.starts_with("psnr:")) {
    rest.remove_prefix(5);
    if (!takeNumber(rest, number) || !(rest.empty() || rest == "dB")) return wrong(text);
    return StopCondition{Kind::psnr, 0, number};
  }
  if (!takeNumber(rest, number)) return wrong(text);
  for (const Unit& unit : kUnits) {
    if (rest != unit.name) continue;
    const double octets = std::round(number * unit.octets);
    if (octets > kMostOctets) return wrong(text);
    return StopCondition{Kind::bytes, static_cast<uint64_t>(octets), 0};
  }
  return wrong(text);
}

}  // namespace meshfront
