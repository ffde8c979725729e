#include "tests/evaluation/sender_driven/view_request.h"

#include <bit>
#include <cmath>
#include <glm/mat4x4.hpp>

namespace meshfront::evaluation {
namespace {

void putNumber(std::vector<uint8_t>& out, uint32_t value, size_t bytes) {
  for (size_t i = 0; i < bytes; ++i) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

uint32_t takeNumber(std::span<const uint8_t>& in, size_t bytes) {
  uint32_t value = 0;
  for (size_t i = 0; i < bytes; ++i) value |= static_cast<uint32_t>(in[i]) << (8 * i);
  in = in.subspan(bytes);
  return value;
}

constexpr uint16_t kEverything = 0x8000;  // beside the height
constexpr float kMostFov = 3.1F;
constexpr float kMostAspect = 1000;

// Rows of unit length, about.
bool isRotation(const std::array<float, 12>& rows) {
  for (size_t row = 0; row < 3; ++row) {
    float square = 0;
    for (size_t i = 0; i < 3; ++i) square += rows[4 * row + i] * rows[4 * row + i];
    if (!(std::abs(square - 1) < 0.01F) || !std::isfinite(rows[4 * row + 3])) return false;
  }
  return true;
}

}  // namespace

ViewRequest ViewRequest::of(const Camera& camera, PixelSize picture,
                            const Quantization& quantization, float tolerance) {
  ViewRequest request;
  const ViewAxes axes = viewAxes(camera);
  const std::array<glm::dvec3, 3> rows{axes.right, axes.upward, -axes.forward};
  const glm::dvec3 origin(quantization.origin[0], quantization.origin[1], quantization.origin[2]);
  const glm::dvec3 eye = (camera.eye - origin) / quantization.step;
  for (size_t row = 0; row < 3; ++row) {
    for (int i = 0; i < 3; ++i)
      request.viewFromGrid[4 * row + static_cast<size_t>(i)] = static_cast<float>(rows[row][i]);
    request.viewFromGrid[4 * row + 3] = static_cast<float>(-glm::dot(rows[row], eye));
  }
  request.verticalFov = static_cast<float>(camera.verticalFov);
  request.aspect = static_cast<float>(picture.aspect());
  request.tolerance = tolerance;
  request.pictureHeight = static_cast<uint16_t>(picture.height);
  return request;
}

std::vector<uint8_t> ViewRequest::toBytes() const {
  std::vector<uint8_t> out;
  out.reserve(kBytes);
  for (const float value : viewFromGrid) putNumber(out, std::bit_cast<uint32_t>(value), 4);
  for (const float value : {verticalFov, aspect, tolerance})
    putNumber(out, std::bit_cast<uint32_t>(value), 4);
  putNumber(out, pictureHeight | (everything ? kEverything : 0U), 2);
  return out;
}

Result<ViewRequest> ViewRequest::fromBytes(std::span<const uint8_t> bytes) {
  if (bytes.size() != kBytes) return fail("a view takes 62 octets");
  ViewRequest request;
  for (float& value : request.viewFromGrid) value = std::bit_cast<float>(takeNumber(bytes, 4));
  for (float* value : {&request.verticalFov, &request.aspect, &request.tolerance})
    *value = std::bit_cast<float>(takeNumber(bytes, 4));
  const uint32_t height = takeNumber(bytes, 2);
  request.everything = (height & kEverything) != 0;
  request.pictureHeight = static_cast<uint16_t>(height & (kEverything - 1));
  // Written so that NaN is refused.
  if (!isRotation(request.viewFromGrid)) return fail("the view's matrix is no rotation");
  if (!(request.verticalFov > 0 && request.verticalFov < kMostFov))
    return fail("the view's angle is not between 0 and pi");
  if (!(request.aspect > 0 && request.aspect < kMostAspect) || request.pictureHeight == 0)
    return fail("the view's picture has no size");
  if (!(request.tolerance >= 0)) return fail("the view's tolerance is negative");
  return request;
}

}  // namespace meshfront::evaluation
