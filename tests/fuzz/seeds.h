// Seeds for the targets: valid inputs, cut ones and odd ones, each under 4 KB. Those in the formats
// of this project follow the format as it is when they are made.
#pragma once

#include <string>
#include <vector>

namespace meshfront::fuzz {

struct Seed {
  std::string target;  // name of the target
  std::string name;    // "valid-..." if the target accepts it
  std::string content;
};

[[nodiscard]] std::vector<Seed> textMeshSeeds();    // PLY, OBJ, STL, OFF
[[nodiscard]] std::vector<Seed> binaryMeshSeeds();  // of the same, and glTF, GLB, compressed
[[nodiscard]] std::vector<Seed> httpSeeds();
// What an upstream says to a proxy; `metadata`: JSON of a mesh "torus".
[[nodiscard]] std::vector<Seed> upstreamSeeds(const std::string& metadata);
[[nodiscard]] std::vector<Seed> formatSeeds();  // everything that is this project's own

}  // namespace meshfront::fuzz
