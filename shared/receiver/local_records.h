// The records that need no request: those that the mesh keeps of nodes that were split before, and
// those in the disk cache.
#pragma once

#include "shared/receiver/record_source.h"

namespace meshfront {

class LocalRecords {
 public:
  explicit LocalRecords(const SourceSurroundings& to) : to_(to) {}

  [[nodiscard]] bool has(NodeIndex node) const;
  // Splits an active node. False: there is none that applies (any more).
  bool split(NodeIndex node);
  // Takes in a record that has come for the node. It has been applied or is kept in the mesh.
  void keep(const NodeId& node, std::span<const uint8_t> bytes, uint64_t bitOffset,
            uint32_t bitLength);

 private:
  const SourceSurroundings& to_;
};

}  // namespace meshfront
