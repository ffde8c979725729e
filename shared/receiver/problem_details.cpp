#include "shared/receiver/problem_details.h"

#include <nlohmann/json.hpp>

namespace meshfront {
namespace {

std::string printable(const std::string& text) {
  std::string result;
  for (const char c : text.substr(0, 200)) result += c >= ' ' && c <= '~' ? c : ' ';
  return result;
}

}  // namespace

std::string describeRefusal(const FetchResponse& response) {
  std::string message = "HTTP " + std::to_string(response.status);
  const auto problem =
      nlohmann::json::parse(response.body.begin(), response.body.end(), nullptr, false);
  if (!problem.is_object()) return message;
  for (const char* member : {"title", "detail"}) {
    const auto found = problem.find(member);
    if (found != problem.end() && found->is_string())
      message += ": " + printable(found->get_ref<const std::string&>());
  }
  return message;
}

}  // namespace meshfront
