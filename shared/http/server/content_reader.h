// A request's content, taken out of octets that come in pieces of any size: so many as announced,
// or chunked (RFC 9112 section 7.1). Holds no more than one line of the coding.
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/http/server/line_reader.h"
#include "shared/http/server/request_head.h"

namespace meshfront {

class ContentReader {
 public:
  // `maxTrailer`: octets of the fields behind a chunked content, which are checked and dropped.
  ContentReader(const RequestHead& head, size_t maxTrailer);

  // Takes octets off the front of `bytes`, up to the end of the content or to a defect, and gives
  // the next piece of content; empty: there is no more in `bytes`. Untrusted.
  [[nodiscard]] std::string_view take(std::string_view& bytes);

  [[nodiscard]] bool whole() const { return state_ == State::whole; }
  [[nodiscard]] const RequestDefect& defect() const { return defect_; }

 private:
  enum class State : uint8_t { counted, size, chunk, chunkEnd, trailer, whole, defective };
  void takeLine(std::string_view& bytes);
  void parseLine(std::string_view line);
  void parseSize(std::string_view line);
  void refuse(unsigned status, const char* detail);

  State state_;
  uint64_t left_ = 0;  // octets of the content or of the chunk
  size_t trailerLeft_;
  RequestDefect defect_;
  LineReader lines_;
};

}  // namespace meshfront
