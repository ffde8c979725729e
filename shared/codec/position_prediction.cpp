#include "shared/codec/position_prediction.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace meshfront {
namespace {

using Vector = std::array<int64_t, 3>;

// floor(sqrt(value)). The double only proposes; integers decide.
uint64_t integerSqrt(uint64_t value) {
  auto root = static_cast<uint64_t>(std::sqrt(static_cast<double>(value)));
  while (root > 0xFFFFFFFFULL || root * root > value) --root;
  while (root < 0xFFFFFFFFULL && (root + 1) * (root + 1) <= value) ++root;
  return root;
}

// Halves away from zero. The numerator is below 2^45 and the denominator below 2^31, or below 2^37
// and 2^15: then a double holds the numerator, and its quotient is never rounded across an integer.
int64_t divideRounded(int64_t numerator, int64_t denominator) {
  const int64_t divisor = std::llabs(denominator);
  const int64_t half = divisor / 2;
  const auto magnitude = static_cast<int64_t>(static_cast<double>(std::llabs(numerator) + half) /
                                              static_cast<double>(divisor));
  return (numerator < 0) != (denominator < 0) ? -magnitude : magnitude;
}

struct Scaled {
  Vector vector;   // components below 2^30
  unsigned shift;  // the bits dropped
};

Scaled scaleDown(const Vector& v) {
  uint64_t largest = 0;
  for (const int64_t x : v) largest |= static_cast<uint64_t>(std::llabs(x));
  const auto width = static_cast<unsigned>(std::bit_width(largest));
  const unsigned shift = width > 30 ? width - 30 : 0;
  Scaled out{{}, shift};
  for (size_t i = 0; i < 3; ++i) out.vector[i] = v[i] >= 0 ? v[i] >> shift : -(-v[i] >> shift);
  return out;
}

uint64_t lengthOf(const Vector& v) {
  return integerSqrt(static_cast<uint64_t>(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
}

PredictedNormal normalised(const Vector& v, uint64_t length) {
  PredictedNormal out{};
  for (size_t i = 0; i < 3; ++i)
    out[i] =
        static_cast<int16_t>(divideRounded(v[i] * kNormalLength, static_cast<int64_t>(length)));
  return out;
}

}  // namespace

int32_t predictedAlong(const PredictedNormal& normal, unsigned axis, int32_t deltaB,
                       int32_t deltaC) {
  const int64_t other =
      int64_t{normal[(axis + 1) % 3]} * deltaB + int64_t{normal[(axis + 2) % 3]} * deltaC;
  return static_cast<int32_t>(divideRounded(-other, normal[axis]));
}

PredictedNormal normalAfter(const PredictedNormal& normal, const GridPosition& delta) {
  int64_t dot = 0;
  int64_t square = 0;
  for (size_t i = 0; i < 3; ++i) {
    dot += int64_t{normal[i]} * delta[i];
    square += int64_t{delta[i]} * delta[i];
  }
  if (square == 0) return normal;
  Vector rest{};
  for (size_t i = 0; i < 3; ++i) rest[i] = normal[i] * square - delta[i] * dot;
  const Scaled scaled = scaleDown(rest);
  const uint64_t length = lengthOf(scaled.vector);
  const uint64_t whole = static_cast<uint64_t>(square) << 14 >> scaled.shift;
  if (length == 0 || length * 5 < whole) return normal;
  return normalised(scaled.vector, length);
}

std::vector<PredictedNormal> baseNormals(std::span<const GridPosition> positions,
                                         std::span<const Triangle> triangles) {
  std::vector<Vector> sums(positions.size());
  for (const Triangle& t : triangles) {
    if (t[0] >= positions.size() || t[1] >= positions.size() || t[2] >= positions.size()) continue;
    Vector a{};
    Vector b{};
    for (size_t i = 0; i < 3; ++i) {
      a[i] = positions[t[1]][i] - positions[t[0]][i];
      b[i] = positions[t[2]][i] - positions[t[0]][i];
    }
    // Below 2^42; halved so that any number of faces a 32-bit index can name still fits.
    const Vector cross{(a[1] * b[2] - a[2] * b[1]) / 2, (a[2] * b[0] - a[0] * b[2]) / 2,
                       (a[0] * b[1] - a[1] * b[0]) / 2};
    for (const uint32_t corner : t)
      for (size_t i = 0; i < 3; ++i) {
        constexpr int64_t kLimit = int64_t{1} << 61;
        sums[corner][i] = std::clamp(sums[corner][i] + cross[i], -kLimit, kLimit);
      }
  }
  std::vector<PredictedNormal> normals(positions.size(), {0, 0, kNormalLength});
  for (size_t v = 0; v < sums.size(); ++v) {
    const Vector scaled = scaleDown(sums[v]).vector;
    const uint64_t length = lengthOf(scaled);
    if (length > 0) normals[v] = normalised(scaled, length);
  }
  return normals;
}

}  // namespace meshfront
