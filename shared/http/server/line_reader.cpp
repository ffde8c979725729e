#include "shared/http/server/line_reader.h"

#include <algorithm>
#include <utility>

namespace meshfront {

std::optional<std::string_view> LineReader::take(std::string_view& bytes, size_t longest) {
  if (std::exchange(whole_, false)) begun_ = {};  // a long one is not kept
  if (tooLong_) return std::nullopt;
  const size_t room = longest > begun_.size() ? longest - begun_.size() : 0;
  const size_t end = bytes.substr(0, room).find('\n');
  const size_t count = end != std::string_view::npos ? end + 1 : std::min(bytes.size(), room);
  const std::string_view piece = bytes.substr(0, count);
  tooLong_ = end == std::string_view::npos && bytes.size() > room;
  bytes.remove_prefix(count);
  if (end != std::string_view::npos && begun_.empty()) return piece;
  begun_ += piece;
  if (end == std::string_view::npos) return std::nullopt;
  whole_ = true;
  return begun_;
}

}  // namespace meshfront
