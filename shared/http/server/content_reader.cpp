#include "shared/http/server/content_reader.h"

#include <algorithm>
#include <charconv>

#include "shared/http/field_line.h"

namespace meshfront {
namespace {

constexpr size_t kMaxSizeLine = 1024;  // extensions, which nobody uses, included

}  // namespace

ContentReader::ContentReader(const RequestHead& head, size_t maxTrailer)
    : state_(State::whole), left_(head.contentLength), trailerLeft_(maxTrailer) {
  if (head.chunked)
    state_ = State::size;
  else if (left_ > 0)
    state_ = State::counted;
}

void ContentReader::refuse(unsigned status, const char* detail) {
  state_ = State::defective;
  defect_ = {status, detail};
}

std::string_view ContentReader::take(std::string_view& bytes) {
  while (!bytes.empty() && state_ != State::whole && state_ != State::defective) {
    if (state_ != State::counted && state_ != State::chunk) {
      takeLine(bytes);
      continue;
    }
    const auto count = static_cast<size_t>(std::min<uint64_t>(left_, bytes.size()));
    const std::string_view piece = bytes.substr(0, count);
    bytes.remove_prefix(count);
    left_ -= count;
    if (left_ == 0) state_ = state_ == State::counted ? State::whole : State::chunkEnd;
    return piece;
  }
  return {};
}

void ContentReader::takeLine(std::string_view& bytes) {
  const auto line = lines_.take(bytes, state_ == State::trailer ? trailerLeft_ : kMaxSizeLine);
  if (lines_.tooLong()) {
    if (state_ == State::trailer) return refuse(431, "the fields behind the content are too long");
    return refuse(400, "the size of a chunk is too long");
  }
  if (!line) return;
  const auto text = withoutLineEnd(*line);
  if (!text) return refuse(400, "a line of the chunked content does not end in CR LF");
  if (state_ == State::trailer) trailerLeft_ -= line->size();
  parseLine(*text);
}

void ContentReader::parseLine(std::string_view line) {
  if (state_ == State::size) return parseSize(line);
  if (state_ == State::trailer) {
    if (line.empty())
      state_ = State::whole;
    else if (!parseFieldLine(line))
      refuse(400, "a field behind the content is malformed");
    return;
  }
  if (!line.empty()) return refuse(400, "a chunk is longer than it says");
  state_ = State::size;
}

void ContentReader::parseSize(std::string_view line) {
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), left_, 16);
  std::string_view extension = line.substr(static_cast<size_t>(end - line.data()));
  extension.remove_prefix(std::min(extension.find_first_not_of(" \t"), extension.size()));
  if (error != std::errc() || (!extension.empty() && extension.front() != ';') ||
      !isText(extension))
    return refuse(400, "the size of a chunk is no hexadecimal number");
  state_ = left_ > 0 ? State::chunk : State::trailer;
}

}  // namespace meshfront
