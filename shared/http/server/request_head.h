// A request's line and fields, read from octets that come in pieces of any size (RFC 9112). The
// outcome does not depend on how they are cut.
//
// No more is held than one line and what is kept of a head. What is too long is refused as soon as
// that is known, so that neither an endless URL nor an endless field costs memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/http/server/line_reader.h"

namespace meshfront {

// Longer targets than a handler takes are handed to it, so that it refuses them in its own words;
// lines beyond this are refused here.
inline constexpr size_t kMaxRequestLine = size_t{64} << 10;

struct RequestHead {
  std::string method;  // empty: there was none that could be read
  std::string target;  // as received
  std::string ifNoneMatch;
  std::string contentType;
  uint64_t contentLength = 0;  // UINT64_MAX: that or more
  bool hasLength = false;
  bool chunked = false;
  bool keepAlive = true;
  bool expectsContinue = false;
  bool version10 = false;

  [[nodiscard]] bool announcesContent() const { return chunked || contentLength > 0; }
};

// Why a request is not read on, and the status that says so.
struct RequestDefect {
  unsigned status = 0;  // 0: none
  const char* detail = "";
};

class RequestHeadReader {
 public:
  enum class State : uint8_t { line, fields, whole, defective };

  // `maxFields`: octets of all fields, line ends included; 431 beyond.
  explicit RequestHeadReader(size_t maxFields) : maxFields_(maxFields) {}

  // Takes octets off the front of `bytes`, up to the end of the head or to a defect. They are
  // untrusted.
  void take(std::string_view& bytes);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const RequestDefect& defect() const { return defect_; }
  // Complete when whole. Method and target are there from State::fields on, and when defective as
  // far as they could be told apart, with whatever octets they have.
  [[nodiscard]] const RequestHead& head() const { return head_; }

 private:
  void takeLine(std::string_view& bytes);
  void takeField(std::string_view& bytes);
  void parseLine(std::string_view line);
  void parseField(std::string_view line);
  void parseLength(std::string_view value);
  void parseCoding(std::string_view value);
  void parseConnection(std::string_view value);
  void finish();
  void refuse(unsigned status, const char* detail);

  const size_t maxFields_;
  size_t fieldOctets_ = 0;
  State state_ = State::line;
  bool skippedEmptyLine_ = false;
  bool hasHost_ = false;
  bool asksToClose_ = false;
  bool asksToKeep_ = false;
  RequestDefect defect_;
  RequestHead head_;
  LineReader lines_;
};

}  // namespace meshfront
