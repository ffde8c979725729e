// Proof by trial that a pack is exact: whatever the order of refinement, the mesh at every front is
// the one that the hierarchy defines, and at the full front it is the input.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "shared/mesh/grid_mesh.h"
#include "shared/result.h"
#include "shared/store/record_store.h"

namespace meshfront {

struct OrderResult {
  std::string order;
  uint64_t seed = 0;
  size_t batch = 0;            // records an answer, at most
  unsigned frontsChecked = 0;  // intermediate ones
  unsigned frontsWrong = 0;
  uint64_t requestBits = 0;  // of all requests: sets of IDs as bitstrings
  uint64_t collapses = 0;    // splits undone and done again on the way
  bool finalExact = false;
  [[nodiscard]] bool exact() const { return frontsWrong == 0 && finalExact; }
};

// Runs `orders` orders, the kinds of RefinementOrder in turn, with answers of 1, 37, 2,000 and
// 100,000 records; some collapse parts of the mesh on the way. Calls `report` behind each. An Error
// if the pack cannot be decoded at all or its full mesh is not `expected`.
[[nodiscard]] Result<std::vector<OrderResult>> verifyOrders(
    RecordStore& store, const GridMesh& expected, unsigned orders,
    const std::function<void(const OrderResult&)>& report);

}  // namespace meshfront
