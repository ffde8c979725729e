// A made-up mesh for tests of stores and services: a sound base, trees of random records that
// parse, chunks and index. Its cut regions hold noise, so it cannot be refined, only served.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "shared/codec/answer.h"
#include "shared/codec/base_mesh.h"
#include "shared/codec/chunk.h"
#include "shared/store/pack.h"

namespace meshfront {

struct SyntheticMesh {
  BaseMesh base;
  std::vector<RecordEntry> entries;  // all records, in preorder; offsets into bits
  std::vector<uint8_t> bits;
  PackContent content;

  // The answer to a request, put together from the definition of an expansion, record by record.
  [[nodiscard]] std::vector<uint8_t> answerTo(std::span<const NodeId> wanted,
                                              const Expansion& expansion) const;
  [[nodiscard]] const RecordEntry* find(const NodeId& node) const;
  // All nodes with a record at a depth: an antichain in preorder.
  [[nodiscard]] std::vector<NodeId> nodesAtDepth(unsigned depth) const;
};

struct SyntheticOptions {
  std::string name = "synthetic";
  uint32_t seed = 1;
  uint32_t roots = 12;  // >= 5; two of them are leaves
  unsigned maxDepth = 12;
  uint32_t recordsPerChunk = 20;
};
[[nodiscard]] SyntheticMesh makeSyntheticMesh(const SyntheticOptions& options = {});

}  // namespace meshfront
