// Values for failure. Every boundary that meets untrusted bytes returns Result<T>; nothing aborts.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace meshfront {

enum class ErrorCode {
  invalid,      // the bytes or arguments are wrong: retrying cannot help
  notFound,     // no such mesh, revision, node or file
  tooLarge,     // beyond a stated limit
  unavailable,  // the source (disk, upstream) failed: retrying may help
  timedOut,     // the source did not answer in time
  overloaded,   // this program is at one of its own limits: later it may work
};

struct Error {
  ErrorCode code = ErrorCode::invalid;
  std::string message;  // for people: what was wrong and, where known, what to do
};

template <typename T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}
[[nodiscard]] inline tl::unexpected<Error> fail(std::string message) {
  return fail(ErrorCode::invalid, std::move(message));
}

}  // namespace meshfront
