#include "viewer/window/status_panel.h"

#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>

namespace meshfront {
namespace {

constexpr float kMargin = 12;

void drawLines(const std::vector<std::string>& lines) {
  if (lines.empty() || !ImGui::BeginTable("status", 2, ImGuiTableFlags_SizingFixedFit)) {
    return;
  }
  for (const std::string& line : lines) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const size_t tab = line.find('\t');
    ImGui::TextUnformatted(line.c_str(), line.c_str() + std::min(tab, line.size()));
    if (tab != std::string::npos) {
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(line.c_str() + tab + 1);
    }
  }
  ImGui::EndTable();
  ImGui::Separator();
}

void drawHelp() {
  ImGui::Separator();
  ImGui::TextUnformatted(
      "left drag            orbit\n"
      "middle, right drag   pan (or shift + left)\n"
      "wheel                zoom to the cursor\n"
      "F fit   R reset   S shading   W wireframe   C colours\n"
      "H help  Q, Esc quit");
}

}  // namespace

StatusPanel::StatusPanel(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leaves no file behind
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6;
  style.FrameRounding = 3;
  style.WindowBorderSize = 0;
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.10F, 0.11F, 0.13F, 0.82F);
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 450 core");
}

StatusPanel::~StatusPanel() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

bool StatusPanel::takesPointer() {
  return ImGui::GetIO().WantCaptureMouse;
}

bool StatusPanel::takesKeys() {
  return ImGui::GetIO().WantTextInput;
}

void StatusPanel::draw(const std::vector<std::string>& lines, ViewControls& controls,
                       PixelSize picture) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  ImGui::SetNextWindowPos(ImVec2(kMargin, kMargin), ImGuiCond_FirstUseEver);
  ImGui::Begin("meshfront", nullptr,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoNavInputs);
  drawLines(lines);
  bool flat = controls.flatShading();
  bool edges = controls.wireframe();
  if (ImGui::Checkbox("flat", &flat)) {
    controls.setFlatShading(flat);
  }
  ImGui::SameLine();
  if (ImGui::Checkbox("wireframe", &edges)) {
    controls.setWireframe(edges);
  }
  ImGui::SameLine();
  bool colours = controls.colours();
  if (ImGui::Checkbox("colours", &colours)) {
    controls.setColours(colours);
  }
  ImGui::SameLine();
  if (ImGui::Button("fit")) {
    controls.fit(picture);
  }
  ImGui::SameLine();
  if (ImGui::Button("reset")) {
    controls.reset();
  }
  ImGui::SameLine();
  if (ImGui::Button("help")) {
    controls.key('H', picture);
  }
  if (controls.helpShown()) {
    drawHelp();
  }
  ImGui::End();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace meshfront
