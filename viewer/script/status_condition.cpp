#include "viewer/script/status_condition.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace meshfront {
namespace {

using nlohmann::json;

std::optional<double> numberOf(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);
  return code == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

// The value that a path of names and numbers leads to.
std::optional<json> fieldOf(const json& status, std::string_view path) {
  json at = status;
  while (true) {
    const size_t dot = path.find('.');
    const std::string name(path.substr(0, dot));
    if (at.is_object() && at.contains(name)) {
      at = json(at.at(name));
    } else if (at.is_array() && name == "size") {
      at = json(at.size());
    } else {
      const auto place = numberOf(name);
      if (!at.is_array() || !place || *place < 0 || *place >= static_cast<double>(at.size()) ||
          *place != std::floor(*place))
        return std::nullopt;
      at = json(at.at(static_cast<size_t>(*place)));
    }
    if (dot == std::string_view::npos) return at;
    path.remove_prefix(dot + 1);
  }
}

bool compareNumbers(double a, StatusCondition::Operator is, double b) {
  using Operator = StatusCondition::Operator;
  switch (is) {
    case Operator::equal:
      return a == b;
    case Operator::unequal:
      return a != b;
    case Operator::less:
      return a < b;
    case Operator::atMost:
      return a <= b;
    case Operator::greater:
      return a > b;
    case Operator::atLeast:
      return a >= b;
    case Operator::contains:
      break;
  }
  return false;
}

}  // namespace

ConditionOutcome testStatus(const StatusCondition& condition, const std::string& text) {
  using Operator = StatusCondition::Operator;
  const json status = json::parse(text, nullptr, false);
  const auto field = fieldOf(status, condition.field);
  if (!field) return {false, "not there"};
  const std::string found = field->is_string() ? field->get<std::string>() : field->dump();
  const auto wanted = numberOf(condition.value);
  if (field->is_number() && wanted && condition.is != Operator::contains)
    return {compareNumbers(field->get<double>(), condition.is, *wanted), found};
  switch (condition.is) {
    case Operator::equal:
      return {found == condition.value, found};
    case Operator::unequal:
      return {found != condition.value, found};
    case Operator::contains:
      return {found.find(condition.value) != std::string::npos, found};
    default:
      return {false, found + ", which cannot be compared so"};
  }
}

}  // namespace meshfront
