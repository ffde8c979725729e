#include "viewer/window/quality_graph.h"

#include <imgui.h>

#include <algorithm>

#include "viewer/window/gui.h"

namespace meshfront {
namespace {

constexpr double kHeight = 38;       // units
constexpr double kShortestSpan = 5;  // seconds: what the graph's width is at least

}  // namespace

ImVec4 stateColour(std::string_view state) {
  if (state == "settled" || state == "complete") return {0.45F, 0.78F, 0.53F, 1};
  if (state == "degraded") return {0.95F, 0.66F, 0.32F, 1};
  if (state == "refining") return {0.47F, 0.70F, 0.93F, 1};
  return {0.65F, 0.67F, 0.70F, 1};
}

void drawQualityGraph(const std::vector<QualitySample>& quality) {
  if (quality.size() < 2) return;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::GetContentRegionAvail().x, Gui::pixels(kHeight));
  const ImVec4 tone = stateColour("refining");
  const ImU32 line = ImGui::GetColorU32(tone);
  const ImU32 area = ImGui::GetColorU32(ImVec4(tone.x, tone.y, tone.z, 0.22F));
  const ImU32 frame = ImGui::GetColorU32(ImVec4(1, 1, 1, 0.06F));
  list.AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), frame, Gui::pixels(4));

  const double end = quality.back().seconds;
  const double begin = std::min(quality.front().seconds, end - kShortestSpan);
  const auto place = [&](const QualitySample& sample) {
    const auto x = static_cast<float>((sample.seconds - begin) / (end - begin));
    const auto y = static_cast<float>(std::clamp(sample.share, 0.0, 1.0));
    const float inset = Gui::pixels(2);
    return ImVec2(at.x + x * size.x, at.y + inset + (1 - y) * (size.y - 2 * inset));
  };
  for (size_t i = 1; i < quality.size(); ++i) {
    const ImVec2 a = place(quality[i - 1]);
    const ImVec2 b = place(quality[i]);
    const float bottom = at.y + size.y;
    list.AddQuadFilled(a, b, ImVec2(b.x, bottom), ImVec2(a.x, bottom), area);
    list.AddLine(a, b, line, Gui::pixels(1.5));
  }
  ImGui::Dummy(size);
}

}  // namespace meshfront
