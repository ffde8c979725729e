// What both ends say first: the server the mesh, the client perhaps a camera in the words of a
// command line, which saves it the round trip of learning the bounds.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/camera/camera.h"
#include "shared/mesh/quantization.h"
#include "shared/result.h"
#include "tests/evaluation/sender_driven/view_request.h"

namespace meshfront::evaluation {

struct MeshHello {
  Quantization quantization;
  std::array<double, 3> boundsMin{};  // world
  std::array<double, 3> boundsMax{};
  std::vector<uint8_t> base;  // base_mesh.h

  [[nodiscard]] std::vector<uint8_t> toBytes() const;
  [[nodiscard]] static Result<MeshHello> fromBytes(std::span<const uint8_t> bytes);  // untrusted
};

struct CameraHello {
  std::string camera;  // camera_spec.h, at most 1,000 octets
  PixelSize picture;   // at most 16,384 a side
  float tolerance = 0;

  [[nodiscard]] std::vector<uint8_t> toBytes() const;
  [[nodiscard]] static Result<CameraHello> fromBytes(std::span<const uint8_t> bytes);  // untrusted
  // The view that it means for a mesh.
  [[nodiscard]] Result<ViewRequest> viewOf(const MeshHello& mesh) const;
};

}  // namespace meshfront::evaluation
