// The parts that lines of HTTP/1.1 consist of (RFC 9110 section 5, RFC 9112 section 5). Untrusted.
//
// Strict, since what two servers in a row read differently lets a client smuggle requests past the
// first: lines end in CR LF, no other control octets but tabs in values, no blanks before a colon,
// no lines that go on in the next one.
#pragma once

#include <optional>
#include <string_view>

namespace meshfront {

struct FieldLine {
  std::string_view name;   // a token
  std::string_view value;  // without blanks around it
};

// `line` without its end.
[[nodiscard]] std::optional<FieldLine> parseFieldLine(std::string_view line);
// The line without CR LF; nothing where it ends otherwise.
[[nodiscard]] std::optional<std::string_view> withoutLineEnd(std::string_view line);

[[nodiscard]] bool isToken(std::string_view text);
[[nodiscard]] bool isTokenOctet(char c);
// Whether there are no control octets in it, tabs aside.
[[nodiscard]] bool isText(std::string_view text);
// `lower` is in lower case.
[[nodiscard]] bool equalsIgnoringCase(std::string_view text, std::string_view lower);
// Takes the next element off a list that commas separate, without blanks around it.
[[nodiscard]] std::string_view nextInList(std::string_view& list);

}  // namespace meshfront
