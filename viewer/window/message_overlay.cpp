#include <imgui.h>

#include <algorithm>

#include "viewer/window/gui.h"
#include "viewer/window/overlays.h"

namespace meshfront {
namespace {

constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav |
                                    ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoInputs;

void drawText(const WindowMessage& message, double widthInUnits, PixelSize picture) {
  const float width = std::min(Gui::pixels(widthInUnits), 0.8F * static_cast<float>(picture.width));
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width);
  ImGui::PushFont(Gui::headingFont());
  ImGui::TextUnformatted(message.title.c_str());
  ImGui::PopFont();
  if (!message.detail.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextUnformatted(message.detail.c_str());
    ImGui::PopStyleColor();
  }
  if (!message.advice.empty()) {
    ImGui::Dummy(ImVec2(0, Gui::pixels(2)));
    ImGui::TextUnformatted(message.advice.c_str());
  }
  ImGui::PopTextWrapPos();
}

}  // namespace

void drawMessage(const WindowMessage& message, PixelSize picture, bool inTheMiddle) {
  const auto width = static_cast<float>(picture.width);
  const auto height = static_cast<float>(picture.height);
  if (inTheMiddle) {
    ImGui::SetNextWindowPos(ImVec2(0.5F * width, 0.5F * height), ImGuiCond_Always,
                            ImVec2(0.5F, 0.5F));
  } else {
    ImGui::SetNextWindowPos(ImVec2(width - Gui::pixels(12), Gui::pixels(12)), ImGuiCond_Always,
                            ImVec2(1, 0));
  }
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, inTheMiddle
                                                       ? ImVec2(Gui::pixels(28), Gui::pixels(22))
                                                       : ImVec2(Gui::pixels(14), Gui::pixels(10)));
  if (ImGui::Begin("message", nullptr, kFlags)) {
    drawText(message, inTheMiddle ? 460 : 340, picture);
  }
  ImGui::End();
  ImGui::PopStyleVar();
}

void drawNote(const std::string& note, PixelSize picture, bool abovePicks) {
  ImGui::SetNextWindowPos(
      ImVec2(0.5F * static_cast<float>(picture.width),
             static_cast<float>(picture.height) - Gui::pixels(abovePicks ? 84 : 14)),
      ImGuiCond_Always, ImVec2(0.5F, 1));
  if (ImGui::Begin("note", nullptr, kFlags)) {
    const float width = 0.9F * static_cast<float>(picture.width);
    ImGui::PushTextWrapPos(width);
    ImGui::TextUnformatted(note.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::End();
}

}  // namespace meshfront
