// Whether a condition of a script holds for the status that a window tells.
#pragma once

#include <string>

#include "viewer/script/script.h"

namespace meshfront {

struct ConditionOutcome {
  bool holds = false;
  std::string found;  // the field's value, or that there is none
};
// `json`: toJson(PanelStatus). Numbers are compared as numbers, all else as text; `size` behind a
// list is its length.
[[nodiscard]] ConditionOutcome testStatus(const StatusCondition& condition,
                                          const std::string& json);

}  // namespace meshfront
