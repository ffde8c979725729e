// The values behind a PLY header, one after the other, in text or binary. Both classes offer the
// same, so that the reader is written once. Each call reads one value of the given type and returns
// false at the file's end or on anything else than such a value; problem() then says what and
// where.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "shared/mesh_files/ply_header.h"
#include "shared/mesh_files/text_cursor.h"

namespace meshfront {

class AsciiPlyBody {
 public:
  AsciiPlyBody(std::string_view file, size_t offset) : text_(file, offset) {}

  bool real(PlyScalar /*type*/, double& value) {
    expected_ = "finite number";
    text_.skipSpace();
    return text_.real(value);
  }
  bool number(PlyScalar /*type*/, double& value) {  // also one that is not finite
    expected_ = "number";
    text_.skipSpace();
    return text_.number(value);
  }
  bool integer(PlyScalar /*type*/, int64_t& value) {
    expected_ = "whole number";
    text_.skipSpace();
    return text_.integer(value);
  }
  bool skip(PlyScalar /*type*/) {
    text_.skipSpace();
    return !text_.word().empty();
  }
  // Whether `count` times `values` values of type can still follow. A value takes a digit and a
  // space.
  [[nodiscard]] bool canHold(uint64_t count, uint64_t bytesEach, uint64_t valuesEach) const {
    return bytesEach == 0 || count <= (text_.left() + 1) / (2 * valuesEach);
  }
  [[nodiscard]] std::string place() const { return text_.place(); }
  [[nodiscard]] std::string problem() const { return text_.problem(expected_); }

 private:
  const char* expected_ = "number";  // by the last call
  TextCursor text_;
};

template <std::endian Order>
class BinaryPlyBody {
 public:
  BinaryPlyBody(std::string_view file, size_t offset) : file_(file), at_(offset) {}

  // A finite number.
  bool real(PlyScalar type, double& value) { return number(type, value) && std::isfinite(value); }
  bool number(PlyScalar type, double& value) {  // also one that is not finite
    switch (type) {
      case PlyScalar::float32:
        return take<uint32_t, float>(value);
      case PlyScalar::float64:
        return take<uint64_t, double>(value);
      default:
        break;
    }
    int64_t whole = 0;
    if (!integer(type, whole)) return false;
    value = static_cast<double>(whole);
    return true;
  }
  // A whole number; as a float too if it is one.
  bool integer(PlyScalar type, int64_t& value) {
    switch (type) {
      case PlyScalar::int8:
        return take<uint8_t, int8_t>(value);
      case PlyScalar::uint8:
        return take<uint8_t, uint8_t>(value);
      case PlyScalar::int16:
        return take<uint16_t, int16_t>(value);
      case PlyScalar::uint16:
        return take<uint16_t, uint16_t>(value);
      case PlyScalar::int32:
        return take<uint32_t, int32_t>(value);
      case PlyScalar::uint32:
        return take<uint32_t, uint32_t>(value);
      case PlyScalar::float32:
      case PlyScalar::float64:
        break;
    }
    double number = 0;
    if (!real(type, number) || std::floor(number) != number || std::fabs(number) >= 0x1p53)
      return false;
    value = static_cast<int64_t>(number);
    return true;
  }
  bool skip(PlyScalar type) {
    valueAt_ = at_;
    if (file_.size() - at_ < byteLength(type)) return false;
    at_ += byteLength(type);
    return true;
  }
  [[nodiscard]] bool canHold(uint64_t count, uint64_t bytesEach, uint64_t /*valuesEach*/) const {
    return bytesEach == 0 || count <= (file_.size() - at_) / bytesEach;
  }
  [[nodiscard]] std::string place() const { return "byte " + std::to_string(valueAt_); }
  [[nodiscard]] std::string problem() const {
    return place() +
           (valueAt_ == at_ ? ": the file ends early" : ": not a number that can stand here");
  }

 private:
  // Reads the bytes of an Unsigned, which are a Stored.
  template <typename Unsigned, typename Stored, typename Value>
  bool take(Value& value) {
    valueAt_ = at_;
    if (file_.size() - at_ < sizeof(Unsigned)) return false;
    Unsigned bits = 0;
    if constexpr (Order == std::endian::native) {
      std::memcpy(&bits, file_.data() + at_, sizeof bits);
    } else {
      for (size_t i = 0; i < sizeof bits; ++i)
        bits |=
            static_cast<Unsigned>(static_cast<Unsigned>(static_cast<uint8_t>(file_[at_ + i]))
                                  << (8 * (Order == std::endian::big ? sizeof bits - 1 - i : i)));
    }
    at_ += sizeof bits;
    value = std::bit_cast<Stored>(bits);  // NOLINT(bugprone-signed-char-misuse): a number
    return true;
  }

  std::string_view file_;
  size_t at_;           // the next value
  size_t valueAt_ = 0;  // the one read last
};

}  // namespace meshfront
