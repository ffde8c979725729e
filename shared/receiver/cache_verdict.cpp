#include "shared/receiver/cache_verdict.h"

#include <string_view>

namespace meshfront {
namespace {

std::string_view headerOf(const FetchResponse& response, std::string_view name) {
  const auto found = response.headers.find(name);
  return found == response.headers.end() ? std::string_view() : std::string_view(found->second);
}

}  // namespace

bool cameFromCache(const FetchResponse& response) {
  const std::string_view status = headerOf(response, "cache-status");
  if (!status.empty()) return status.find("; hit") != std::string_view::npos || status == "HIT";
  const std::string_view squid = headerOf(response, "x-cache");
  if (!squid.empty()) return squid.starts_with("HIT");
  if (headerOf(response, "via").find("meshfront") != std::string_view::npos) return false;
  const std::string_view age = headerOf(response, "age");
  return !age.empty() && age != "0";
}

}  // namespace meshfront
