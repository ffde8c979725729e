#include "viewer/window/trouble_message.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace meshfront {
namespace {

bool holds(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

std::string titleOf(TroubleKind kind, bool shown) {
  switch (kind) {
    case TroubleKind::serverAway:
      return shown ? "The server is away" : "No server answers";
    case TroubleKind::noSuchMesh:
      return shown ? "The mesh is gone" : "No such mesh";
    case TroubleKind::wrongInterface:
      return "This is not a mesh that the viewer can read";
    case TroubleKind::publishedAnew:
      return "There is a newer revision of this mesh";
    case TroubleKind::other:
      break;
  }
  return shown ? "Refining has stopped" : "The mesh cannot be shown";
}

std::string adviceOf(TroubleKind kind, const std::string& url, bool shown) {
  switch (kind) {
    case TroubleKind::serverAway:
      return shown ? "What is here stays usable, and refining goes on when the server is back."
                   : "Check the address " + url + " and that meshfront-serve runs there.";
    case TroubleKind::noSuchMesh:
      return "See /v1/meshes of that server for what it has, and check the end of the URL.";
    case TroubleKind::wrongInterface:
      return "Check that the URL is a mesh's, http://HOST:PORT/v1/meshes/NAME, and that server and "
             "viewer are of the same version.";
    case TroubleKind::publishedAnew:
      return "Start the viewer again to see it. What is here stays usable.";
    case TroubleKind::other:
      break;
  }
  return "";
}

std::string wholeSeconds(double seconds) {
  return std::to_string(static_cast<int>(std::ceil(std::clamp(seconds, 0.0, 1e6)))) + " s";
}

}  // namespace

TroubleKind troubleKindOf(const std::string& reason) {
  if (holds(reason, "no answer from")) return TroubleKind::serverAway;
  if (holds(reason, "there is no mesh")) return TroubleKind::noSuchMesh;
  if (holds(reason, "no mesh of the v1 interface") || holds(reason, "of another version")) {
    return TroubleKind::wrongInterface;
  }
  if (holds(reason, "published anew")) return TroubleKind::publishedAnew;
  return TroubleKind::other;
}

WindowMessage troubleMessage(TroubleKind kind, const std::string& reason, const std::string& url,
                             bool shown, std::optional<double> retryIn) {
  WindowMessage message{titleOf(kind, shown), reason, adviceOf(kind, url, shown)};
  if (retryIn) {
    message.advice += (message.advice.empty() ? "" : "\n");
    message.advice += "Next attempt in " + wholeSeconds(*retryIn) + ".";
  }
  return message;
}

WindowMessage connectingMessage(const std::string& url, double sinceSeconds) {
  constexpr double kSoon = 2;  // seconds that need no word
  WindowMessage message{"Connecting ...", url, ""};
  if (sinceSeconds >= kSoon) {
    message.advice = "No answer for " + wholeSeconds(std::floor(sinceSeconds)) + " so far.";
  }
  return message;
}

WindowMessage missingOpenGlMessage(const std::string& reason) {
  // What to do is said below, for a window.
  return {"OpenGL 4.5 is missing", reason.substr(0, reason.find(". Update")),
          "Update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1 to draw by the CPU, or use "
          "--headless. Any key closes this window."};
}

}  // namespace meshfront
