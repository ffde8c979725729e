#include "viewer/scene_options.h"

#include <chrono>
#include <filesystem>

namespace meshfront {
namespace {

using Kind = StopCondition::Kind;

// Of the vertices, those that nothing is seen of, before they are collapsed although there is room:
// they cost time to draw, and are split again from what is kept.
constexpr double kUnneededInWindow = 0.6;

// A person is told soon that a server says nothing; the receiver tries again by itself.
constexpr std::chrono::milliseconds kWindowPatience{6'000};

SceneOptions commonOptions(const ViewOptions& options) {
  SceneOptions result;
  result.receiver.mode = options.mode;
  result.receiver.order = options.order;
  result.receiver.batch = options.batch;
  result.receiver.window = options.window;
  result.rim = options.rim;
  if (options.triangleBudget > 0) result.limits.triangles = options.triangleBudget;
  if (options.memoryBudget > 0) result.limits.bytes = options.memoryBudget;
  if (options.cacheDir) result.receiver.cacheFolder = *options.cacheDir;
  result.receiver.cacheBytes = options.cacheBudget;
  if (options.complete) result.receiver.goal = ReceiverOptions::Goal::complete;
  return result;
}

}  // namespace

SceneOptions windowSceneOptions(const ViewOptions& options) {
  SceneOptions result = commonOptions(options);
  result.foveation.on = options.foveation;
  result.receiver.patience = kWindowPatience;
  // All of it is to be there, seen or not.
  if (!options.complete) result.limits.unneededShare = kUnneededInWindow;
  return result;
}

SceneOptions pictureSceneOptions(const ViewOptions& options) {
  SceneOptions result = commonOptions(options);
  result.receiver.freshRanking = !options.live;
  // A target in dB may need what a settled view does not show: hidden corners of visible triangles.
  if (!options.path && options.until.kind != Kind::settled)
    result.receiver.goal = ReceiverOptions::Goal::complete;
  if (options.until.kind == Kind::records) result.receiver.limits.records = options.until.amount;
  if (options.until.kind == Kind::bytes) result.receiver.limits.bytesDown = options.until.amount;
  return result;
}

std::string titleOf(const ViewOptions& options) {
  if (options.scene.size() == 1) return options.scene.front().name;
  return std::filesystem::path(options.urlText).stem().string();
}

}  // namespace meshfront
