// What the window tells of the work behind its picture: plain data, the same for people (the panel)
// and for tests and scripts (toJson).
//
// Times are in seconds, shares 0 to 1; what is not known is left out, and the panel leaves its line
// out. What stands below "the window's own" is filled in by ViewerWindow.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace meshfront {

// For a person, in large letters where there is no picture yet, else above it.
struct WindowMessage {
  std::string title;   // what is: "The server is away"
  std::string detail;  // why, and since when or until when; may be empty
  std::string advice;  // what to do; may be empty
  bool operator==(const WindowMessage&) const = default;
};

struct BudgetUse {
  uint64_t used = 0;
  uint64_t limit = 0;  // 0: none
  bool operator==(const BudgetUse&) const = default;
};

struct QualitySample {
  double seconds = 0;  // since the start, ascending
  double share = 0;    // of the covered pixels, those whose triangles are final
  bool operator==(const QualitySample&) const = default;
};

// One mesh of a scene.
struct MeshStatus {
  std::string name;
  std::string state;
  uint64_t trianglesShown = 0;
  uint64_t trianglesOfMesh = 0;
  std::string reason;  // of degraded
  bool operator==(const MeshStatus&) const = default;
};

struct LegendEntry {
  std::array<float, 3> colour{};  // sRGB, 0 .. 1
  std::string text;               // may be empty within a ramp
  bool operator==(const LegendEntry&) const = default;
};
// Of the colouring that is shown; empty for own colours and clay.
struct Legend {
  std::string title;
  std::vector<LegendEntry> entries;
  bool ramp = false;  // the colours between neighbouring entries have a meaning too
  bool operator==(const Legend&) const = default;
};

// A point of the surface that a person has clicked.
struct PickedPoint {
  glm::dvec3 world{0};
  int decimals = 6;  // digits behind the point that the mesh's grid can tell apart
  std::string mesh;
  std::string node;                  // of the front, nearest corner: TREE:PATH, e.g. "17:0110"
  std::optional<double> localError;  // world units: how far the surface may still move; 0: final
  bool operator==(const PickedPoint&) const = default;
};

struct FrameTimes {
  double median = 0;
  double slow = 0;    // 95th percentile
  size_t frames = 0;  // that these are of
  bool operator==(const FrameTimes&) const = default;
};

struct PanelStatus {
  std::string state = "connecting";  // or refining, settled, complete, degraded ...
  std::string reason;                // of degraded
  bool offline = false;              // only what the disk cache has is shown
  std::optional<double> retryIn;     // until a server that is away is asked again
  std::optional<WindowMessage> message;

  uint64_t trianglesShown = 0;
  uint64_t trianglesHeld = 0;    // those too that the view does not need, split or collapsed
  uint64_t trianglesOfMesh = 0;  // 0: not known yet
  uint64_t records = 0;          // held
  uint64_t recordsOfMesh = 0;
  BudgetUse triangleBudget;
  BudgetUse byteBudget;  // memory, CPU and GPU together

  uint64_t bytesDown = 0;  // headers included
  uint64_t bytesUp = 0;
  uint64_t requests = 0;
  uint64_t requestsUnderWay = 0;
  uint64_t collapses = 0;  // by budgets, or because nothing was seen of it
  uint64_t resplits = 0;   // from what was kept
  std::optional<double> splitsPerSecond;
  std::optional<double> bitsPerSplit;
  std::optional<double> cacheShare;         // of the records, those that the disk cache gave
  std::optional<double> networkCacheShare;  // of the answers, those out of caches on the way
  std::optional<double> roundTrip;
  std::optional<double> rankingTime;

  std::vector<QualitySample> quality;  // the last minutes
  std::vector<MeshStatus> meshes;      // shown from two on
  Legend legend;

  // --- the window's own --------------------------------------------------------------------------
  std::optional<FrameTimes> frame;  // of pictures drawn in the last seconds
  uint64_t picturesDrawn = 0;
  std::array<int, 2> pictureSize{};  // pixels
  std::string camera;                // an exact --camera SPEC; empty while there is no scene
  std::string shading;               // "smooth" or "flat"
  std::string colouring;             // colouringModeName()
  bool wireframe = false;
  bool missingBounds = false;
  bool geomorph = true;
  bool panelShown = true;
  bool helpShown = false;
  std::vector<PickedPoint> picks;      // at most the last two
  uint64_t picksMade = 0;              // ever
  std::optional<double> pickDistance;  // between two picks, world units
  std::string note;                    // the last thing done: "saved meshfront-0001.png"

  bool operator==(const PanelStatus&) const = default;
};

// One object; keys as the members, in snake_case; what is not known is null.
[[nodiscard]] std::string toJson(const PanelStatus& status);

}  // namespace meshfront
