// The experiments on pictures: what a way of streaming shows for what it has sent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "shared/result.h"
#include "tests/evaluation/quality/evaluated_mesh.h"

namespace meshfront::evaluation {

struct QualityOptions {
  std::filesystem::path output;
  bool isShort = false;  // fewer orders, a smaller mesh for the exact one
  double factor = 1.1;   // of the bytes between two pictures
  double stopAt = 50;    // dB
  PixelSize size{500, 500};
};

// Experiments 3 and 4: PSNR against received bytes for each mesh, view and way, and what is wrong
// in the picture when all that it shows has been split. Writes OUTPUT/quality_against_bytes and
// OUTPUT/visible_only.
Result<void> compareWays(const std::vector<std::unique_ptr<EvaluatedMesh>>& meshes, Easel& easel,
                         const QualityOptions& options);

// Experiment 5: how many records each order needs. Writes OUTPUT/order_quality.
Result<void> compareOrders(const std::vector<std::unique_ptr<EvaluatedMesh>>& meshes, Easel& easel,
                           const QualityOptions& options);

}  // namespace meshfront::evaluation
