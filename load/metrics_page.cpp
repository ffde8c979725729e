#include "load/metrics_page.h"

#include <charconv>
#include <utility>

#include "load/immediate_fetch.h"

namespace meshfront {
namespace {

constexpr size_t kMostMetricsBytes = size_t{4} << 20;

}  // namespace

MetricsPage MetricsPage::parse(std::string_view text) {
  MetricsPage page;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    const size_t close = line.rfind('}');
    const size_t space = line.find(' ', close == std::string_view::npos ? 0 : close);
    if (space == std::string_view::npos) continue;
    const std::string_view number = line.substr(space + 1);
    double value = 0;
    if (std::from_chars(number.data(), number.data() + number.size(), value).ec == std::errc())
      page.samples_[std::string(line.substr(0, space))] = value;
  }
  return page;
}

Result<MetricsPage> MetricsPage::fetch(const std::string& origin, Transport& transport) {
  FetchRequest request;
  request.url = origin;
  while (request.url.ends_with('/')) request.url.pop_back();
  request.url += "/metrics";
  request.maxBodyBytes = kMostMetricsBytes;
  const std::string url = request.url;
  const Result<FetchResponse> answer = fetchNow(std::move(request), transport);
  if (!answer) return tl::unexpected(answer.error());
  const FetchResponse& response = *answer;
  if (response.status != 200)
    return fail(ErrorCode::unavailable,
                url + " answers with status " + std::to_string(response.status));
  return parse({reinterpret_cast<const char*>(response.body.data()), response.body.size()});
}

double MetricsPage::sum(std::string_view name, std::string_view label) const {
  double total = 0;
  for (const auto& [key, value] : samples_) {
    const std::string_view sample = key;
    const std::string_view own = sample.substr(0, sample.find('{'));
    if (own == name && sample.find(label) != std::string_view::npos) total += value;
  }
  return total;
}

}  // namespace meshfront
