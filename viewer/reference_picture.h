// The picture that a streamed one is measured against: the mesh file as it is, drawn with the same
// camera and shading. Its coordinates are taken on the finest grid (20 bits, far below a pixel),
// not on the published one, so that the quantisation's loss counts. Vertices at equal coordinates
// are one, as in the published mesh: else seams in the file would be shaded as edges. Where the
// published mesh carries normals, of `normalBits`, the file's own are used, packed alike.
#pragma once

#include <filesystem>

#include "shared/result.h"
#include "viewer/scene_picture.h"

namespace meshfront {

[[nodiscard]] Result<Picture> drawReference(const std::filesystem::path& meshFile,
                                            ScenePicture& picture, const Camera& camera,
                                            bool colours, unsigned normalBits);

}  // namespace meshfront
