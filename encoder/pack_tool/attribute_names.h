// What vertices carry beside a position, in words.
#pragma once

#include <string>
#include <vector>

#include "shared/mesh/vertex_attributes.h"

namespace meshfront {

[[nodiscard]] inline std::vector<std::string> attributeNames(const AttributeLayout& layout) {
  std::vector<std::string> names;
  if (layout.colours) names.emplace_back("colours");
  if (layout.normalBits != 0)
    names.push_back("normals of " + std::to_string(layout.normalBits) + " bits");
  return names;
}

}  // namespace meshfront
