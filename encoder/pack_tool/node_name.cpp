#include "encoder/pack_tool/node_name.h"

#include <charconv>

namespace meshfront {

Result<NodeId> parseNodeName(std::string_view text) {
  const auto wrong = [&](const std::string& what) {
    return fail("'" + std::string(text.substr(0, 100)) + "' " + what +
                "; a node is TREE:PATH, for example 17:0110 or, for a root, 17:");
  };
  const size_t colon = text.find(':');
  if (colon == std::string_view::npos) return wrong("has no colon");
  const std::string_view tree = text.substr(0, colon);
  NodeId node;
  const auto [end, error] = std::from_chars(tree.data(), tree.data() + tree.size(), node.tree);
  if (error != std::errc() || end != tree.data() + tree.size())
    return wrong("has no tree number in front of the colon");
  for (const char step : text.substr(colon + 1)) {
    if (step != '0' && step != '1') return wrong("has a step that is neither 0 nor 1");
    if (node.depth == kMaxDepth)
      return wrong("is deeper than the " + std::to_string(kMaxDepth) + " steps of any tree");
    node = node.child(step == '1');
  }
  return node;
}

std::string nodeName(const NodeId& node) {
  std::string name = std::to_string(node.tree) + ":";
  for (unsigned depth = 0; depth < node.depth; ++depth)
    name.push_back(node.step(depth) ? '1' : '0');
  return name;
}

}  // namespace meshfront
