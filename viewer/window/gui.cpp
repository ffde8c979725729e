#include "viewer/window/gui.h"

#include <imgui.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

namespace meshfront {
namespace {

constexpr double kTextUnits = 14;
constexpr double kHeadingUnits = 19;
// fonts-dejavu-core; without it ImGui's own bitmap font serves, larger where the scale asks for it.
constexpr const char* kTextFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

// ImGui's buttons: left, right, middle.
size_t buttonPlace(PointerButton button) {
  constexpr std::array<size_t, 3> kPlaces = {0, 2, 1};
  return kPlaces.at(static_cast<size_t>(button));
}

ImVec4 grey(float value, float alpha) {
  return {value, value * 1.02F, value * 1.05F, alpha};
}

void setStyle(double scale) {
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.WindowRounding = 8;
  style.FrameRounding = 4;
  style.WindowBorderSize = 0;
  style.FrameBorderSize = 0;
  style.WindowPadding = ImVec2(14, 12);
  style.FramePadding = ImVec2(8, 3);
  style.ItemSpacing = ImVec2(8, 5);
  style.CellPadding = ImVec2(6, 1.5F);
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.09F, 0.10F, 0.12F, 0.86F);
  style.Colors[ImGuiCol_Text] = grey(0.90F, 1);
  style.Colors[ImGuiCol_TextDisabled] = grey(0.60F, 1);
  style.Colors[ImGuiCol_Separator] = grey(0.50F, 0.25F);
  style.Colors[ImGuiCol_Button] = grey(0.50F, 0.22F);
  style.Colors[ImGuiCol_ButtonHovered] = grey(0.60F, 0.40F);
  style.Colors[ImGuiCol_ButtonActive] = grey(0.70F, 0.50F);
  style.Colors[ImGuiCol_PlotHistogram] = ImVec4(0.42F, 0.62F, 0.82F, 1);
  style.Colors[ImGuiCol_FrameBg] = grey(0.50F, 0.18F);
  style.ScaleAllSizes(static_cast<float>(scale));
  ImGui::GetStyle() = style;
}

}  // namespace

Gui::Gui(const char* glslVersion, double scale) : scale_(scale) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // leaves no file behind
  io.BackendPlatformName = "meshfront";
  setStyle(scale_);
  makeFonts();
  ImGui_ImplOpenGL3_Init(glslVersion);
}

Gui::~Gui() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void Gui::makeFonts() const {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  std::error_code ignored;
  const bool there = std::filesystem::is_regular_file(kTextFont, ignored);
  for (const double units : {kTextUnits, kHeadingUnits}) {
    const auto size = static_cast<float>(std::round(units * scale_));
    if (there && fonts.AddFontFromFileTTF(kTextFont, size) != nullptr) continue;
    ImFontConfig config;
    config.SizePixels = size;
    fonts.AddFontDefault(&config);
  }
}

void Gui::setScale(double scale) {
  if (scale == scale_) return;
  scale_ = scale;
  setStyle(scale);
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  makeFonts();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Gui::take(const InputEvent& event) {
  ImGuiIO& io = ImGui::GetIO();
  if (const auto* moved = std::get_if<PointerMoved>(&event)) {
    io.MousePos = ImVec2(static_cast<float>(moved->place.x), static_cast<float>(moved->place.y));
  } else if (const auto* pressed = std::get_if<PointerPressed>(&event)) {
    down_.at(buttonPlace(pressed->button)) = true;
    pressed_.at(buttonPlace(pressed->button)) = true;
  } else if (const auto* released = std::get_if<PointerReleased>(&event)) {
    down_.at(buttonPlace(released->button)) = false;
  } else if (const auto* scrolled = std::get_if<Scrolled>(&event)) {
    io.MouseWheel += static_cast<float>(scrolled->steps.y);
    io.MouseWheelH += static_cast<float>(scrolled->steps.x);
  }
}

bool Gui::takesPointer() {
  return ImGui::GetIO().WantCaptureMouse;
}

void Gui::begin(PixelSize picture, double seconds) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(picture.width), static_cast<float>(picture.height));
  io.DeltaTime = static_cast<float>(std::clamp(seconds - lastFrame_, 1e-4, 1.0));
  lastFrame_ = seconds;
  for (size_t i = 0; i < down_.size(); ++i) {
    io.MouseDown[i] = down_[i] || pressed_[i];
    pressed_[i] = false;
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
}

void Gui::end() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

float Gui::pixels(double units) {
  return static_cast<float>(units * ImGui::GetFontSize() / kTextUnits);
}

ImFont* Gui::headingFont() {
  return ImGui::GetIO().Fonts->Fonts.back();
}

}  // namespace meshfront
