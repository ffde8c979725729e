#include "shared/http/server/response_head.h"

#include <array>
#include <charconv>

#include "shared/http/problem.h"

namespace meshfront {
namespace {

void appendNumber(std::string& out, uint64_t number) {
  std::array<char, 20> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  out.append(digits.data(), end);
}

}  // namespace

const std::string& DateField::text(time_t now) {
  if (now == time_) return text_;
  // strftime would write in the language of the process.
  constexpr std::array<const char*, 7> kDays{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr std::array<const char*, 12> kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  tm parts{};
  gmtime_r(&now, &parts);
  const auto twoDigits = [](int number) {
    return std::string{static_cast<char>('0' + number / 10), static_cast<char>('0' + number % 10)};
  };
  text_ = std::string("Date: ") + kDays[static_cast<size_t>(parts.tm_wday)] + ", " +
          twoDigits(parts.tm_mday) + " " + kMonths[static_cast<size_t>(parts.tm_mon)] + " " +
          std::to_string(parts.tm_year + 1900) + " " + twoDigits(parts.tm_hour) + ":" +
          twoDigits(parts.tm_min) + ":" + twoDigits(parts.tm_sec) + " GMT\r\n";
  time_ = now;
  return text_;
}

std::string responseHead(const HttpResponse& response, const std::string& dateField,
                         Persistence persistence) {
  std::string head;
  head.reserve(512);
  head += "HTTP/1.1 ";
  appendNumber(head, response.status);
  head.append(" ").append(reasonPhrase(response.status)).append("\r\n").append(dateField);
  if (response.status != 204) {
    head += "Content-Length: ";
    appendNumber(head, response.content.size());
    head += "\r\n";
  }
  if (persistence == Persistence::close) head += "Connection: close\r\n";
  if (persistence == Persistence::keep) head += "Connection: keep-alive\r\n";
  for (const auto& [name, value] : response.headers)
    head.append(name).append(": ").append(value).append("\r\n");
  return head.append("\r\n");
}

}  // namespace meshfront
