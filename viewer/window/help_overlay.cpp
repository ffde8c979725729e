#include <imgui.h>

#include <algorithm>
#include <string>

#include "viewer/controls/control_lines.h"
#include "viewer/window/gui.h"
#include "viewer/window/overlays.h"

namespace meshfront {
namespace {

std::string textOf(std::string_view view) {
  return std::string(view);
}

// The lines [begin, end), headings over their groups.
void drawGroups(const char* name, size_t begin, size_t end) {
  ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, ImVec2(Gui::pixels(6), Gui::pixels(3)));
  const bool begun = ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingFixedFit);
  ImGui::PopStyleVar();
  if (!begun) return;
  for (size_t i = begin; i < end; ++i) {
    const ControlLine& line = kControlLines.at(i);
    if (line.input.empty() && i > begin) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::Dummy(ImVec2(0, Gui::pixels(5)));
    }
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    if (line.input.empty()) {
      ImGui::TextColored(ImVec4(0.55F, 0.75F, 0.95F, 1), "%s", textOf(line.meaning).c_str());
      continue;
    }
    ImGui::TextUnformatted(line.input.begin(), line.input.end());
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", textOf(line.meaning).c_str());
  }
  ImGui::EndTable();
}

// Where the second column begins: the heading nearest to the middle.
size_t middleHeading() {
  size_t best = kControlLines.size();
  const auto distance = [](size_t i) {
    const size_t middle = (kControlLines.size() + 1) / 2;
    return i > middle ? i - middle : middle - i;
  };
  for (size_t i = 1; i < kControlLines.size(); ++i) {
    if (kControlLines.at(i).input.empty() && distance(i) < distance(best)) best = i;
  }
  return best;
}

}  // namespace

bool drawHelp(PixelSize picture) {
  const ImVec2 size(static_cast<float>(picture.width), static_cast<float>(picture.height));
  ImGui::GetBackgroundDrawList()->AddRectFilled(ImVec2(0, 0), size, IM_COL32(0, 0, 0, 90));
  ImGui::SetNextWindowPos(ImVec2(0.5F * size.x, 0.5F * size.y), ImGuiCond_Always,
                          ImVec2(0.5F, 0.5F));
  ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(0.98F * size.x, 0.98F * size.y));
  ImGui::SetNextWindowFocus();
  ImGui::SetNextWindowBgAlpha(0.96F);
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav |
                                      ImGuiWindowFlags_NoSavedSettings;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(Gui::pixels(24), Gui::pixels(18)));
  bool stays = true;
  if (ImGui::Begin("help", nullptr, kFlags)) {
    ImGui::PushFont(Gui::headingFont());
    ImGui::TextUnformatted("Controls");
    ImGui::PopFont();
    ImGui::Dummy(ImVec2(0, Gui::pixels(4)));
    const size_t middle = middleHeading();
    const bool wide = size.x > Gui::pixels(860);
    if (wide) {
      ImGui::BeginGroup();
      drawGroups("first", 0, middle);
      ImGui::EndGroup();
      ImGui::SameLine(0, Gui::pixels(36));
      ImGui::BeginGroup();
      drawGroups("second", middle, kControlLines.size());
      ImGui::EndGroup();
    } else {
      drawGroups("all", 0, kControlLines.size());
    }
    stays = !ImGui::IsMouseClicked(ImGuiMouseButton_Left) ||
            ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows);
  }
  ImGui::End();
  ImGui::PopStyleVar();
  return stays;
}

}  // namespace meshfront
