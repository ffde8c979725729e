#include "viewer/window/status_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cstdio>
#include <string>
#include <string_view>

#include "viewer/window/gui.h"
#include "viewer/window/number_text.h"
#include "viewer/window/quality_graph.h"

namespace meshfront {
namespace {

constexpr double kWidth = 296;  // units
constexpr double kMargin = 12;
constexpr double kNameColumn = 84;
constexpr size_t kMostMeshes = 8;

// A name and a value in a table of two columns.
void row(const char* name, const std::string& value) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name);
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(value.c_str());
}

void budgetRow(const char* name, const BudgetUse& use, std::string (*text)(uint64_t)) {
  if (use.limit == 0) return;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name);
  ImGui::TableNextColumn();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const float bottom = at.y + ImGui::GetTextLineHeight();
  const float left = at.x - Gui::pixels(3);
  const float share = std::min(1.0F, static_cast<float>(use.used) / static_cast<float>(use.limit));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float rounding = Gui::pixels(3);
  list.AddRectFilled(ImVec2(left, at.y), ImVec2(at.x + width, bottom), IM_COL32(255, 255, 255, 18),
                     rounding);
  list.AddRectFilled(ImVec2(left, at.y), ImVec2(left + share * (at.x + width - left), bottom),
                     share < 0.98F ? IM_COL32(84, 130, 176, 120) : IM_COL32(190, 130, 60, 140),
                     rounding);
  ImGui::TextUnformatted((text(use.used) + " of " + text(use.limit)).c_str());
}

std::string capitalised(std::string text) {
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z') {
    text.front() = static_cast<char>(text.front() - 'a' + 'A');
  }
  return text;
}

void drawState(const PanelStatus& status) {
  const float radius = Gui::pixels(4.5);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float line = ImGui::GetTextLineHeight();
  const ImVec4 colour = stateColour(status.state);
  ImGui::GetWindowDrawList()->AddCircleFilled(ImVec2(at.x + radius, at.y + 0.55F * line), radius,
                                              ImGui::GetColorU32(colour));
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 2 * radius + Gui::pixels(7));
  ImGui::TextUnformatted((capitalised(status.state) + (status.offline ? ", offline" : "")).c_str());
  if (!status.quality.empty()) {
    const std::string share = shareText(status.quality.back().share) + " final";
    ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(share.c_str()).x);
    ImGui::TextDisabled("%s", share.c_str());
  }
  if (status.message) return;  // which says the rest
  if (!status.reason.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextWrapped("%s", status.reason.c_str());
    ImGui::PopStyleColor();
  }
  if (status.retryIn) {
    ImGui::TextDisabled("next attempt in %.0f s", std::max(0.0, *status.retryIn));
  }
}

void drawTriangles(const PanelStatus& status) {
  row("triangles", groupedText(status.trianglesShown) + " shown");
  std::string held = groupedText(status.trianglesHeld);
  if (status.trianglesOfMesh > 0) held += " of " + groupedText(status.trianglesOfMesh);
  row("", held + " held");
  budgetRow("budget", status.triangleBudget, groupedText);
  budgetRow("memory", status.byteBudget, byteText);
}

void drawTraffic(const PanelStatus& status) {
  row("down, up", byteText(status.bytesDown) + ", " + byteText(status.bytesUp));
  if (status.splitsPerSecond) {
    row("splits", groupedText(static_cast<uint64_t>(std::max(0.0, *status.splitsPerSecond) + 0.5)) +
                      " a second");
  }
  if (status.bitsPerSplit) row("a split", fixedText(*status.bitsPerSplit, 1) + " bits");
  if (status.cacheShare) row("from disk", shareText(*status.cacheShare));
  if (status.networkCacheShare) row("from caches", shareText(*status.networkCacheShare));
  if (status.roundTrip) row("round trip", durationText(*status.roundTrip));
}

void drawTimes(const PanelStatus& status) {
  if (status.frame) {
    row("frame",
        durationText(status.frame->median) + " (95 %: " + durationText(status.frame->slow) + ")");
  }
  if (status.rankingTime) row("ranking", durationText(*status.rankingTime));
}

void drawMeshes(const std::vector<MeshStatus>& meshes) {
  if (meshes.size() < 2) return;
  ImGui::Separator();
  if (!ImGui::BeginTable("meshes", 3, ImGuiTableFlags_SizingStretchProp)) return;
  for (size_t i = 0; i < std::min(meshes.size(), kMostMeshes); ++i) {
    const MeshStatus& mesh = meshes[i];
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(stateColour(mesh.state), "%s", mesh.name.c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(groupedText(mesh.trianglesShown).c_str());
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", mesh.state.c_str());
    if (!mesh.reason.empty() && ImGui::IsItemHovered()) {
      ImGui::SetTooltip("%s", mesh.reason.c_str());
    }
  }
  ImGui::EndTable();
  if (meshes.size() > kMostMeshes) {
    ImGui::TextDisabled("and %zu more", meshes.size() - kMostMeshes);
  }
}

ImU32 colourOf(const LegendEntry& entry) {
  return ImGui::GetColorU32(ImVec4(entry.colour[0], entry.colour[1], entry.colour[2], 1));
}

void drawRamp(const Legend& legend) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = Gui::pixels(9);
  const size_t spans = legend.entries.size() - 1;
  for (size_t i = 0; i < spans; ++i) {
    const float left = at.x + width * static_cast<float>(i) / static_cast<float>(spans);
    const float right = at.x + width * static_cast<float>(i + 1) / static_cast<float>(spans);
    const ImU32 a = colourOf(legend.entries[i]);
    const ImU32 b = colourOf(legend.entries[i + 1]);
    list.AddRectFilledMultiColor(ImVec2(left, at.y), ImVec2(right, at.y + height), a, b, b, a);
  }
  ImGui::Dummy(ImVec2(width, height));
  const float textAt = ImGui::GetCursorPosX();
  for (size_t i = 0; i <= spans; ++i) {
    const std::string& text = legend.entries[i].text;
    if (text.empty()) continue;
    const float share = static_cast<float>(i) / static_cast<float>(spans);
    ImGui::SetCursorPosX(textAt + share * (width - ImGui::CalcTextSize(text.c_str()).x));
    ImGui::TextDisabled("%s", text.c_str());
    if (i < spans) ImGui::SameLine();
  }
}

void drawLegend(const Legend& legend) {
  if (legend.entries.empty()) return;
  ImGui::Separator();
  ImGui::TextDisabled("%s", legend.title.c_str());
  if (legend.ramp && legend.entries.size() > 1) {
    drawRamp(legend);
    return;
  }
  const float side = Gui::pixels(10);
  for (const LegendEntry& entry : legend.entries) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float top = at.y + 0.5F * (ImGui::GetTextLineHeight() - side);
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, top), ImVec2(at.x + side, top + side),
                                              colourOf(entry), Gui::pixels(2));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + side + Gui::pixels(7));
    ImGui::TextUnformatted(entry.text.c_str());
  }
}

// A button that looks pressed while what it switches is on.
bool switchButton(const char* name, bool on) {
  if (on) {
    ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  }
  const bool clicked = ImGui::Button(name);
  if (on) ImGui::PopStyleColor();
  return clicked;
}

void drawButtons(ViewControls& controls, PixelSize picture) {
  ImGui::Separator();
  ViewSwitches& switches = controls.switches();
  const auto space = [] { ImGui::SameLine(0, Gui::pixels(5)); };
  if (ImGui::Button("fit")) controls.fit(picture);
  space();
  if (ImGui::Button("reset")) controls.reset();
  space();
  if (switchButton("flat", switches.flatShading)) switches.flatShading = !switches.flatShading;
  space();
  if (switchButton("edges", switches.wireframe)) switches.wireframe = !switches.wireframe;
  space();
  if (switchButton("slide", switches.geomorph)) switches.geomorph = !switches.geomorph;
  const std::string colouring = "colours: " + std::string(colouringModeName(switches.colouring));
  if (ImGui::Button(colouring.c_str())) controls.nextColouring(false);
  space();
  if (switchButton("missing", switches.missingBounds)) {
    switches.missingBounds = !switches.missingBounds;
  }
  space();
  if (ImGui::Button("?")) switches.help = !switches.help;
}

}  // namespace

void drawStatusPanel(const PanelStatus& status, ViewControls& controls, PixelSize picture) {
  const float margin = Gui::pixels(kMargin);
  const float width = std::min(Gui::pixels(kWidth), static_cast<float>(picture.width) - 2 * margin);
  if (width < Gui::pixels(120)) return;  // no room for it
  ImGui::SetNextWindowPos(ImVec2(margin, margin), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints(
      ImVec2(width, 0), ImVec2(width, static_cast<float>(picture.height) - 2 * margin));
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoResize |
      ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav |
      ImGuiWindowFlags_NoSavedSettings;
  if (ImGui::Begin("status", nullptr, kFlags)) {
    drawState(status);
    drawQualityGraph(status.quality);
    if (status.recordsOfMesh > 0 && ImGui::BeginTable("numbers", 2)) {
      ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, Gui::pixels(kNameColumn));
      ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
      drawTriangles(status);
      drawTraffic(status);
      drawTimes(status);
      ImGui::EndTable();
    }
    drawMeshes(status.meshes);
    drawLegend(status.legend);
    if (status.recordsOfMesh > 0) drawButtons(controls, picture);
  }
  ImGui::End();
}

}  // namespace meshfront
