// A response's line and fields as they are sent.
#pragma once

#include <ctime>
#include <string>

#include "shared/http/message.h"

namespace meshfront {

enum class Persistence : uint8_t {
  usual,  // as the version of HTTP has it
  keep,   // said, for HTTP/1.0
  close,  // said
};

// The Date field with its line end, made anew once a second.
class DateField {
 public:
  [[nodiscard]] const std::string& text(time_t now);

 private:
  time_t time_ = -1;
  std::string text_;
};

// With Date and, but for 204, the length of the response's content, whether that is sent or not.
[[nodiscard]] std::string responseHead(const HttpResponse& response, const std::string& dateField,
                                       Persistence persistence);
// 204 and 304 have none.
[[nodiscard]] inline bool mayHaveContent(unsigned status) {
  return status != 204 && status != 304;
}

}  // namespace meshfront
