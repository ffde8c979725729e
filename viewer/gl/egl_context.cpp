#include "viewer/gl/egl_context.h"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstdio>
#include <string_view>

namespace meshfront {
namespace {

bool listed(const char* list, std::string_view name) {
  std::string_view rest = list == nullptr ? "" : list;
  while (!rest.empty()) {
    const size_t end = rest.find(' ');
    if (rest.substr(0, end) == name) {
      return true;
    }
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
  }
  return false;
}

std::string eglErrorText() {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%04x", static_cast<unsigned>(eglGetError()));
  return "EGL error " + std::string(text.data());
}

// A config only where the driver cannot do without one; nothing is ever drawn to a surface.
EGLConfig configFor(EGLDisplay display) {
  if (listed(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_no_config_context")) {
    return EGL_NO_CONFIG_KHR;
  }
  const std::array<EGLint, 5> wanted = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                        EGL_PBUFFER_BIT, EGL_NONE};
  EGLConfig config = EGL_NO_CONFIG_KHR;
  EGLint count = 0;
  eglChooseConfig(display, wanted.data(), &config, 1, &count);
  return config;
}

}  // namespace

std::vector<EglPlatform> eglPlatforms() {
  std::vector<EglPlatform> hardware;
  std::vector<EglPlatform> software;
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto queryDevices =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  const auto queryDeviceString = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(
      eglGetProcAddress("eglQueryDeviceStringEXT"));
  if (listed(client, "EGL_EXT_platform_device") && queryDevices != nullptr &&
      queryDeviceString != nullptr) {
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    if (queryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE) {
      for (EGLint i = 0; i < count; ++i) {
        EGLDeviceEXT device = devices.at(static_cast<size_t>(i));
        const bool isSoftware =
            listed(queryDeviceString(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
        auto& list = isSoftware ? software : hardware;
        list.push_back({EGL_PLATFORM_DEVICE_EXT, device,
                        "EGL device " + std::to_string(i) + (isSoftware ? " (software)" : "")});
      }
    }
  }
  if (listed(client, "EGL_MESA_platform_surfaceless")) {
    hardware.push_back(
        {EGL_PLATFORM_SURFACELESS_MESA, EGL_NO_DEVICE_EXT, "EGL surfaceless platform"});
  }
  hardware.insert(hardware.end(), software.begin(), software.end());
  return hardware;
}

EglContext::~EglContext() {
  if (context_ != EGL_NO_CONTEXT) {
    if (eglGetCurrentContext() == context_) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    eglDestroyContext(display_, context_);
  }
  // The display stays initialised: a process has one a device, and others may be using it.
}

std::string EglContext::open(const EglPlatform& platform) {
  const auto getDisplay = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (getDisplay == nullptr) {
    return "eglGetPlatformDisplayEXT is missing";
  }
  display_ = getDisplay(platform.platform, platform.device, nullptr);
  if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) != EGL_TRUE) {
    return "no display, " + eglErrorText();
  }
  if (!listed(eglQueryString(display_, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
    return "EGL_KHR_surfaceless_context is missing";
  }
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
    return "no desktop OpenGL, " + eglErrorText();
  }
  const std::array<EGLint, 7> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                            4,
                                            EGL_CONTEXT_MINOR_VERSION,
                                            5,
                                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                            EGL_NONE};
  context_ = eglCreateContext(display_, configFor(display_), EGL_NO_CONTEXT, attributes.data());
  if (context_ == EGL_NO_CONTEXT) {
    return "no OpenGL 4.5 core context, " + eglErrorText();
  }
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
    return "the context cannot be made current, " + eglErrorText();
  }
  return {};
}

}  // namespace meshfront
