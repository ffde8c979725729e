// The small graph of quality over time, and the colours of states. Draws by Dear ImGui into the
// current window.
#pragma once

#include <string_view>
#include <vector>

#include "viewer/window/panel_status.h"

struct ImVec4;

namespace meshfront {

// Nothing with fewer than two samples.
void drawQualityGraph(const std::vector<QualitySample>& quality);
[[nodiscard]] ImVec4 stateColour(std::string_view state);

}  // namespace meshfront
