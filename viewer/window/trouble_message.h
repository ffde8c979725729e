// What a window says when it cannot show, or go on refining, what was asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "viewer/window/panel_status.h"

namespace meshfront {

enum class TroubleKind : uint8_t {
  serverAway,      // no answer: refused connection, unknown host, time-out
  noSuchMesh,      // it answers, and has no mesh of this name
  wrongInterface,  // what answers is no mesh of an interface that this program speaks
  publishedAnew,   // there is a new revision
  other,
};

// What a receiver's reason (of degraded) tells of.
[[nodiscard]] TroubleKind troubleKindOf(const std::string& reason);

// `shown`: there is a picture already. `retryIn`: seconds until the next attempt; none: there is
// none.
[[nodiscard]] WindowMessage troubleMessage(TroubleKind kind, const std::string& reason,
                                           const std::string& url, bool shown,
                                           std::optional<double> retryIn);
[[nodiscard]] WindowMessage connectingMessage(const std::string& url, double sinceSeconds);
// The display lacks OpenGL 4.5; `reason`: what the driver said.
[[nodiscard]] WindowMessage missingOpenGlMessage(const std::string& reason);

}  // namespace meshfront
