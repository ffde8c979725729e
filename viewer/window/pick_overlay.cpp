#include <imgui.h>

#include <glm/vec4.hpp>
#include <optional>
#include <string>

#include "viewer/window/gui.h"
#include "viewer/window/number_text.h"
#include "viewer/window/overlays.h"

namespace meshfront {
namespace {

constexpr ImU32 kMark = IM_COL32(255, 214, 92, 255);
constexpr ImU32 kOutline = IM_COL32(20, 20, 24, 200);

// Where a world point falls in the picture; none behind the eye.
std::optional<ImVec2> placeOf(const glm::dvec3& world, const Projection& projection,
                              PixelSize picture) {
  const glm::dvec3 origin = projection.camera.eye;
  const glm::dvec4 clip = projection.clipFrom(origin) * glm::dvec4(world - origin, 1);
  if (clip.w <= 0) return std::nullopt;
  return ImVec2(static_cast<float>((clip.x / clip.w + 1) * 0.5 * picture.width),
                static_cast<float>((1 - clip.y / clip.w) * 0.5 * picture.height));
}

void drawMarks(const PanelStatus& status, const Projection& projection, PixelSize picture) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  std::optional<ImVec2> last;
  for (const PickedPoint& pick : status.picks) {
    const auto at = placeOf(pick.world, projection, picture);
    if (!at) {
      last.reset();
      continue;
    }
    if (last) {
      list.AddLine(*last, *at, kOutline, Gui::pixels(4));
      list.AddLine(*last, *at, kMark, Gui::pixels(2));
    }
    list.AddCircle(*at, Gui::pixels(5), kOutline, 0, Gui::pixels(4));
    list.AddCircle(*at, Gui::pixels(5), kMark, 0, Gui::pixels(2));
    last = at;
  }
}

std::string coordinates(const PickedPoint& pick) {
  const char* names[] = {"x ", "   y ", "   z "};
  std::string text;
  for (int i = 0; i < 3; ++i) {
    text += names[i];
    text += fixedText(pick.world[i], pick.decimals);
  }
  return text;
}

std::string aboutNode(const PickedPoint& pick) {
  std::string text = pick.mesh;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "   ") + part; };
  if (!pick.node.empty()) add("node " + pick.node);
  if (pick.localError) {
    add(*pick.localError > 0 ? "may still move by " + significantText(*pick.localError)
                             : "final here");
  }
  return text;
}

}  // namespace

void drawPicks(const PanelStatus& status, const Projection& projection, PixelSize picture) {
  if (status.picks.empty()) return;
  drawMarks(status, projection, picture);
  const PickedPoint& pick = status.picks.back();
  ImGui::SetNextWindowPos(ImVec2(0.5F * static_cast<float>(picture.width),
                                 static_cast<float>(picture.height) - Gui::pixels(12)),
                          ImGuiCond_Always, ImVec2(0.5F, 1));
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
      ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoSavedSettings |
      ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoInputs;
  if (ImGui::Begin("picks", nullptr, kFlags)) {
    ImGui::TextUnformatted(coordinates(pick).c_str());
    if (status.pickDistance) {
      ImGui::SameLine(0, Gui::pixels(24));
      ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kMark), "distance %s",
                         fixedText(*status.pickDistance, pick.decimals).c_str());
    }
    const std::string about = aboutNode(pick);
    if (!about.empty()) ImGui::TextDisabled("%s", about.c_str());
  }
  ImGui::End();
}

}  // namespace meshfront
