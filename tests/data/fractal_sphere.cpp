#include "tests/data/fractal_sphere.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <system_error>

namespace meshfront {

namespace {

constexpr double kRelief = 0.25;      // of the largest octave
constexpr double kLargestWave = 0.7;  // length of the largest octave
constexpr double kWaveOfEdges = 4;    // the smallest octave is not finer than so many edges
constexpr double kRoughness = 0.5;    // how an octave's height follows from the last one's

uint64_t hash(uint64_t x) {  // splitmix64
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

// -1 .. 1
double fraction(uint64_t bits) {
  return static_cast<double>(static_cast<int64_t>(bits) >> 11) * 0x1p-52;
}

double smooth(double t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

// Value noise: random at grid points, smooth in between; -1 .. 1.
double noiseAt(const std::array<double, 3>& p, uint64_t seed) {
  std::array<int64_t, 3> cell{};
  std::array<double, 3> t{};
  for (size_t i = 0; i < 3; ++i) {
    const double floor = std::floor(p[i]);
    cell[i] = static_cast<int64_t>(floor);
    t[i] = smooth(p[i] - floor);
  }
  const auto value = [&](int64_t x, int64_t y, int64_t z) {
    const uint64_t key = static_cast<uint64_t>(cell[0] + x) * 0x8DA6B343U ^
                         static_cast<uint64_t>(cell[1] + y) * 0xD8163841U << 16 ^
                         static_cast<uint64_t>(cell[2] + z) * 0xCB1AB31FU << 32;
    return fraction(hash(key ^ seed));
  };
  const auto mix = [](double a, double b, double share) { return a + (b - a) * share; };
  const auto line = [&](int64_t y, int64_t z) { return mix(value(0, y, z), value(1, y, z), t[0]); };
  return mix(mix(line(0, 0), line(1, 0), t[1]), mix(line(0, 1), line(1, 1), t[1]), t[2]);
}

// Collects bytes and writes them in large pieces.
class ByteStream {
 public:
  explicit ByteStream(const std::filesystem::path& path)
      : file_(path, std::ios::binary | std::ios::trunc) {}
  template <typename Number>
  void put(Number number) {
    static_assert(std::endian::native == std::endian::little);
    const size_t at = buffer_.size();
    buffer_.resize(at + sizeof number);
    std::memcpy(buffer_.data() + at, &number, sizeof number);
    if (buffer_.size() >= kPiece) flush();
  }
  void put(const std::string& text) {
    for (const char c : text) put(c);
  }
  [[nodiscard]] bool close() {
    flush();
    file_.close();
    return !file_.fail();
  }

 private:
  static constexpr size_t kPiece = size_t{1} << 20;
  void flush() {
    file_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  std::vector<char> buffer_;
  std::ofstream file_;
};

}  // namespace

FractalSphere::FractalSphere(uint64_t vertices, uint64_t seed, double scannerNoise)
    : seed_(hash(seed)) {
  while (vertexCount() < vertices) ++perEdge_;
  const double golden = (1 + std::sqrt(5.0)) / 2;
  uint32_t next = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    for (const double one : {1.0, -1.0}) {
      for (const double other : {golden, -golden}) {
        corners_[next][axis] = 0;
        corners_[next][(axis + 1) % 3] = one;
        corners_[next][(axis + 2) % 3] = other;
        ++next;
      }
    }
  }
  // Corners are neighbours at distance 2; three of them in turn are a face, seen from outside.
  const auto adjacent = [&](uint32_t a, uint32_t b) {
    double length2 = 0;
    for (size_t i = 0; i < 3; ++i)
      length2 += (corners_[a][i] - corners_[b][i]) * (corners_[a][i] - corners_[b][i]);
    return length2 < 5;
  };
  const auto outside = [&](const Triangle& t) {
    const Vector& a = corners_[t[0]];
    const Vector& b = corners_[t[1]];
    const Vector& c = corners_[t[2]];
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]) >
           0;
  };
  for (uint32_t a = 0; a < kCorners; ++a) {
    for (uint32_t b = a + 1; b < kCorners; ++b) {
      if (!adjacent(a, b)) continue;
      edgeOf_[a][b] = static_cast<uint32_t>(edges_.size());
      edges_.push_back({a, b});
      for (uint32_t c = b + 1; c < kCorners; ++c) {
        if (!adjacent(a, c) || !adjacent(b, c)) continue;
        faces_.push_back(outside({a, b, c}) ? Triangle{a, b, c} : Triangle{a, c, b});
      }
    }
  }
  const double edge = 1.2 / perEdge_;  // about, on the sphere
  noise_ = scannerNoise * edge;
  for (double wave = kLargestWave / 2; wave > kWaveOfEdges * edge; wave /= 2) ++octaves_;
}

FractalSphere::Vector FractalSphere::between(const Vector& a, uint32_t weightA, const Vector& b,
                                             uint32_t weightB, const Vector& c, uint32_t weightC) {
  Vector out{};
  for (size_t i = 0; i < 3; ++i) out[i] = a[i] * weightA + b[i] * weightB + c[i] * weightC;
  return out;
}

FractalSphere::Vector FractalSphere::at(const Vector& direction, uint32_t index) const {
  Vector out = direction;
  const double length = std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
  for (double& c : out) c /= length;
  double radius = 1 + noise_ * fraction(hash(seed_ + index));
  double height = kRelief;
  double scale = 1 / kLargestWave;
  for (unsigned octave = 0; octave < octaves_; ++octave) {
    radius += height * noiseAt({out[0] * scale, out[1] * scale, out[2] * scale}, seed_ ^ octave);
    height *= kRoughness;
    scale *= 2;
  }
  for (double& c : out) c *= radius;
  return out;
}

uint32_t FractalSphere::onEdge(uint32_t from, uint32_t to, uint32_t steps) const {
  if (from > to) {
    std::swap(from, to);
    steps = perEdge_ - steps;
  }
  return kCorners + edgeOf_[from][to] * (perEdge_ - 1) + steps - 1;
}

uint32_t FractalSphere::indexAt(uint32_t face, uint32_t i, uint32_t j) const {
  const auto [a, b, c] = faces_[face];
  const uint32_t n = perEdge_;
  if (i == 0 && j == 0) return a;
  if (i == n) return b;
  if (j == n) return c;
  if (j == 0) return onEdge(a, b, i);
  if (i == 0) return onEdge(a, c, j);
  if (i + j == n) return onEdge(b, c, j);
  const uint32_t inside = (n - 1) * (n - 2) / 2;  // of a face
  const uint32_t before = (j - 1) * (2 * n - 2 - j) / 2;
  return kCorners + static_cast<uint32_t>(edges_.size()) * (n - 1) + face * inside + before + i - 1;
}

Result<void> writeFractalSphere(const std::filesystem::path& path, const FractalSphere& sphere) {
  ByteStream out(path);
  out.put("ply\nformat binary_little_endian 1.0\nelement vertex " +
          std::to_string(sphere.vertexCount()) +
          "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
          std::to_string(sphere.triangleCount()) +
          "\nproperty list uchar int vertex_indices\nend_header\n");
  sphere.forEachVertex([&](const std::array<double, 3>& p) {
    for (const double c : p) out.put(static_cast<float>(c));
  });
  sphere.forEachTriangle([&](const Triangle& t) {
    out.put(uint8_t{3});
    for (const uint32_t v : t) out.put(v);
  });
  if (out.close()) return {};
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
  return fail(ErrorCode::unavailable, path.string() + ": cannot be written; is the disk full?");
}

}  // namespace meshfront
