// How people name a node: TREE:PATH, the path in steps from the root, 0 = left, 1 = right. 17:0110
// is four steps below the root of tree 17, which is 17: itself.
#pragma once

#include <string>
#include <string_view>

#include "shared/hierarchy/node_id.h"
#include "shared/result.h"

namespace meshfront {

[[nodiscard]] Result<NodeId> parseNodeName(std::string_view text);
[[nodiscard]] std::string nodeName(const NodeId& node);

}  // namespace meshfront
