#include "shared/http/server/request_head.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "shared/http/field_line.h"

namespace meshfront {
namespace {

constexpr size_t kMaxMethod = 64;  // the longest registered one has 17 octets

bool isTarget(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    const auto octet = static_cast<uint8_t>(c);
    return octet > 0x20 && octet != 0x7F;
  });
}

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

bool isVersion(std::string_view text) {
  return text.size() == 8 && text.starts_with("HTTP/") && isDigit(text[5]) && text[6] == '.' &&
         isDigit(text[7]);
}

}  // namespace

void RequestHeadReader::refuse(unsigned status, const char* detail) {
  state_ = State::defective;
  defect_ = {status, detail};
}

void RequestHeadReader::take(std::string_view& bytes) {
  while (!bytes.empty() && state_ == State::line) takeLine(bytes);
  while (!bytes.empty() && state_ == State::fields) takeField(bytes);
}

void RequestHeadReader::takeLine(std::string_view& bytes) {
  // What is no HTTP at all, a TLS handshake say, may never end a line.
  if (lines_.begun().empty() && bytes.front() != '\r' && !isTokenOctet(bytes.front()))
    return refuse(400, "this is no request of HTTP/1.1");
  const auto line = lines_.take(bytes, kMaxRequestLine);
  if (lines_.tooLong()) {
    const size_t space = lines_.begun().substr(0, kMaxMethod + 1).find(' ');
    if (space == std::string_view::npos) return refuse(400, "this is no request of HTTP/1.1");
    head_.method = lines_.begun().substr(0, space);
    // For the log, which is not to hold all of it.
    head_.target = std::string(lines_.begun().substr(space + 1, kMaxMethod)) + "...";
    return refuse(414, "the URL is too long; send the set by QUERY");
  }
  if (!line) return;
  const auto text = withoutLineEnd(*line);
  if (!text) return refuse(400, "the request's line does not end in CR LF");
  if (!text->empty()) return parseLine(*text);
  // Some clients send a line end too many behind content (RFC 9112 section 2.2).
  if (std::exchange(skippedEmptyLine_, true)) refuse(400, "empty lines before the request");
}

void RequestHeadReader::parseLine(std::string_view line) {
  const size_t first = line.find(' ');
  const size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last)
    return refuse(400, "the request's line must be a method, a target and a version");
  const std::string_view version = line.substr(last + 1);
  head_.method = line.substr(0, std::min(first, kMaxMethod));
  head_.target = line.substr(first + 1, last - first - 1);
  if (first > kMaxMethod || !isToken(head_.method)) return refuse(400, "the method is no token");
  if (!isTarget(head_.target))
    return refuse(400, "the target is empty or has blanks or control octets in it");
  if (!isVersion(version)) return refuse(400, "the request's line does not end in HTTP/1.1");
  if (version[5] != '1') return refuse(505, "the version of HTTP must be 1.1 or 1.0");
  head_.version10 = version[7] == '0';
  state_ = State::fields;
}

void RequestHeadReader::takeField(std::string_view& bytes) {
  const auto line = lines_.take(bytes, maxFields_ - fieldOctets_);
  // The server puts in how long they may be.
  if (lines_.tooLong()) return refuse(431, "the request's fields are too long");
  if (!line) return;
  fieldOctets_ += line->size();
  const auto text = withoutLineEnd(*line);
  if (!text) return refuse(400, "a field's line does not end in CR LF");
  if (text->empty()) return finish();
  parseField(*text);
}

void RequestHeadReader::parseField(std::string_view line) {
  const auto field = parseFieldLine(line);
  if (!field)
    return refuse(400,
                  "a field must be a name, a colon without blanks before it, and a value "
                  "without control octets");
  const auto is = [&](std::string_view name) { return equalsIgnoringCase(field->name, name); };
  switch (field->name.size()) {
    case 4:
      if (is("host") && std::exchange(hasHost_, true)) refuse(400, "more than one Host");
      break;
    case 6:
      if (is("expect")) head_.expectsContinue = equalsIgnoringCase(field->value, "100-continue");
      break;
    case 10:
      if (is("connection")) parseConnection(field->value);
      break;
    case 12:
      if (is("content-type")) head_.contentType = field->value;
      break;
    case 13:
      if (!is("if-none-match")) break;
      if (!head_.ifNoneMatch.empty()) head_.ifNoneMatch += ", ";
      head_.ifNoneMatch += field->value;
      break;
    case 14:
      if (is("content-length")) parseLength(field->value);
      break;
    case 17:
      if (is("transfer-encoding")) parseCoding(field->value);
      break;
    default:
      break;
  }
}

void RequestHeadReader::parseLength(std::string_view value) {
  if (std::exchange(head_.hasLength, true)) return refuse(400, "more than one Content-Length");
  if (value.empty() || !std::all_of(value.begin(), value.end(), isDigit))
    return refuse(400, "Content-Length is no whole number");
  const auto [end, error] =
      std::from_chars(value.data(), value.data() + value.size(), head_.contentLength);
  if (error != std::errc()) head_.contentLength = UINT64_MAX;
}

void RequestHeadReader::parseCoding(std::string_view value) {
  if (head_.chunked) return refuse(400, "more than one Transfer-Encoding");
  if (!equalsIgnoringCase(value, "chunked"))
    return refuse(501, "of transfer codings only chunked is known");
  head_.chunked = true;
}

void RequestHeadReader::parseConnection(std::string_view value) {
  while (!value.empty()) {
    const std::string_view option = nextInList(value);
    if (equalsIgnoringCase(option, "close")) asksToClose_ = true;
    if (equalsIgnoringCase(option, "keep-alive")) asksToKeep_ = true;
  }
}

void RequestHeadReader::finish() {
  if (head_.chunked && head_.hasLength)
    return refuse(400, "both Transfer-Encoding and Content-Length");
  if (head_.chunked && head_.version10)
    return refuse(400, "HTTP/1.0 does not know Transfer-Encoding");
  if (!hasHost_ && !head_.version10) return refuse(400, "Host is missing");
  head_.keepAlive = !asksToClose_ && (!head_.version10 || asksToKeep_);
  head_.expectsContinue = head_.expectsContinue && !head_.version10;
  state_ = State::whole;
}

}  // namespace meshfront
