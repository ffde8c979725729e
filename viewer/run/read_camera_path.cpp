#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>

#include "viewer/run/camera_path.h"

namespace meshfront {
namespace {

using nlohmann::json;

constexpr int kDeepestNesting = 8;
constexpr double kLongestPath = 86'400;  // seconds
constexpr double kMostFramesPerSecond = 240;
constexpr double kLeastFramesPerSecond = 0.01;
constexpr uint32_t kMostRounds = 1'000;

std::string shortened(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

// A number in a range; none with `problem` said.
std::optional<double> numberIn(const json& value, const char* what, double low, double high,
                               std::string& problem) {
  if (value.is_number()) {
    const auto number = value.get<double>();
    if (std::isfinite(number) && number >= low && number <= high) return number;
  }
  problem = std::string("expected ") + what + ", not " + shortened(value);
  return std::nullopt;
}

bool onlyKnown(const json& object, std::initializer_list<std::string_view> known,
               std::string& problem) {
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    problem = "'" + key.substr(0, 60) + "' is unknown; expected";
    for (const std::string_view name : known) problem += " " + std::string(name);
    return false;
  }
  return true;
}

// "X,Y,Z" of three numbers, as --camera takes it.
std::optional<std::string> vectorSetting(const json& value, const std::string& name,
                                         std::string& problem) {
  bool fine = value.is_array() && value.size() == 3;
  for (size_t i = 0; fine && i < 3; ++i)
    fine = value[i].is_number() && std::isfinite(value[i].get<double>());
  if (!fine) {
    problem = "expected \"" + name + "\": [X, Y, Z], not " + shortened(value);
    return std::nullopt;
  }
  return name + "=" + value[0].dump() + "," + value[1].dump() + "," + value[2].dump() + ";";
}

std::optional<std::string> cameraText(const json& frame, std::string& problem) {
  if (frame.contains("camera")) {
    if (frame.size() > 2) {
      problem = "\"camera\" says it all: leave out eye, target, up and fov";
      return std::nullopt;
    }
    if (frame["camera"].is_string()) return frame["camera"].get<std::string>();
    problem = "expected \"camera\": \"SPEC\", not " + shortened(frame["camera"]);
    return std::nullopt;
  }
  if (!frame.contains("eye")) {
    problem = "expected \"camera\": \"SPEC\" or \"eye\": [X, Y, Z]";
    return std::nullopt;
  }
  std::string text;
  for (const char* name : {"eye", "target", "up"}) {
    if (!frame.contains(name)) continue;
    const auto setting = vectorSetting(frame[name], name, problem);
    if (!setting) return std::nullopt;
    text += *setting;
  }
  if (frame.contains("fov")) {
    if (!frame["fov"].is_number()) {
      problem = "expected \"fov\": DEGREES, not " + shortened(frame["fov"]);
      return std::nullopt;
    }
    text += "fov=" + frame["fov"].dump();
  }
  return text;
}

std::optional<PathKeyFrame> readKeyFrame(const json& frame, std::string& problem) {
  if (!frame.is_object()) {
    problem = "expected an object, not " + shortened(frame);
    return std::nullopt;
  }
  if (!onlyKnown(frame, {"time", "camera", "eye", "target", "up", "fov"}, problem))
    return std::nullopt;
  PathKeyFrame read;
  const auto time = numberIn(frame.contains("time") ? frame["time"] : json(nullptr),
                             "\"time\": SECONDS, 0 to 86400", 0, kLongestPath, problem);
  if (!time) return std::nullopt;
  read.time = *time;
  const auto text = cameraText(frame, problem);
  if (!text) return std::nullopt;
  auto spec = parseCameraSpec(*text);
  if (!spec) {
    problem = spec.error().message;
    return std::nullopt;
  }
  read.camera = *spec;
  return read;
}

std::optional<CameraPathSpec> readHeader(const json& root, std::string& problem) {
  CameraPathSpec path;
  if (!onlyKnown(root, {"frames_per_second", "key_frames", "interpolation", "loop", "rounds"},
                 problem))
    return std::nullopt;
  if (root.contains("frames_per_second")) {
    const auto rate = numberIn(root["frames_per_second"], "\"frames_per_second\": 0.01 to 240",
                               kLeastFramesPerSecond, kMostFramesPerSecond, problem);
    if (!rate) return std::nullopt;
    path.framesPerSecond = *rate;
  }
  if (root.contains("interpolation")) {
    const json& kind = root["interpolation"];
    path.smooth = kind == "smooth";
    if (!path.smooth && kind != "linear") {
      problem = R"(expected "interpolation": "smooth" or "linear", not )" + shortened(kind);
      return std::nullopt;
    }
  }
  if (root.contains("loop")) {
    if (!root["loop"].is_boolean()) {
      problem = "expected \"loop\": true or false, not " + shortened(root["loop"]);
      return std::nullopt;
    }
    path.loop = root["loop"].get<bool>();
  }
  if (root.contains("rounds")) {
    const auto rounds = numberIn(root["rounds"], "\"rounds\": 1 to 1000", 1, kMostRounds, problem);
    if (!rounds || *rounds != std::floor(*rounds) || !path.loop) {
      problem = "expected \"rounds\": a whole number, 1 to 1000, with \"loop\": true";
      return std::nullopt;
    }
    path.rounds = static_cast<uint32_t>(*rounds);
  }
  return path;
}

}  // namespace

Result<CameraPathSpec> parseCameraPath(std::string_view text, const std::string& name) {
  const auto wrong = [&name](const std::string& what) { return fail(name + ": " + what); };
  if (text.size() > kMaxPathBytes) return fail(ErrorCode::tooLarge, name + ": longer than 4 MiB");
  bool tooDeep = false;
  const auto depthCheck = [&tooDeep](int depth, json::parse_event_t, json&) {
    tooDeep = tooDeep || depth > kDeepestNesting;
    return !tooDeep;
  };
  json root;
  try {
    root = json::parse(text, depthCheck);
  } catch (const json::parse_error& error) {
    return wrong("no JSON at octet " + std::to_string(error.byte));
  } catch (const json::exception& error) {
    return wrong(std::string("no JSON that can be read: ") + error.what());
  }
  if (tooDeep) return wrong("nested too deep for a camera path");
  if (!root.is_object()) return wrong("expected a JSON object with \"key_frames\"");
  std::string problem;
  auto path = readHeader(root, problem);
  if (!path) return wrong(problem);
  if (!root.contains("key_frames") || !root["key_frames"].is_array() ||
      root["key_frames"].empty() || root["key_frames"].size() > kMaxKeyFrames)
    return wrong("expected \"key_frames\": a list of 1 to " + std::to_string(kMaxKeyFrames));
  for (const json& frame : root["key_frames"]) {
    const std::string place = "key frame " + std::to_string(path->keyFrames.size()) + ": ";
    auto read = readKeyFrame(frame, problem);
    if (!read) return wrong(place + problem);
    if (path->keyFrames.empty() ? read->time != 0 : read->time <= path->keyFrames.back().time)
      return wrong(place + "times begin with 0 and ascend, this one is " +
                   shortened(frame["time"]));
    path->keyFrames.push_back(*read);
  }
  if (path->loop && path->keyFrames.size() < 2) return wrong("a loop needs two key frames or more");
  const double frames = path->keyFrames.back().time * path->rounds * path->framesPerSecond;
  if (frames >= static_cast<double>(kMaxPathFrames))
    return fail(ErrorCode::tooLarge,
                name + ": more than " + std::to_string(kMaxPathFrames) + " frames");
  return *std::move(path);
}

Result<CameraPathSpec> readCameraPath(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(ErrorCode::notFound, "cannot read the camera path " + file.string());
  std::string text;
  std::array<char, 1 << 16> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    text.append(block.data(), static_cast<size_t>(in.gcount()));
    if (text.size() > kMaxPathBytes) break;
  }
  if (in.bad()) return fail(ErrorCode::unavailable, "cannot read the camera path " + file.string());
  return parseCameraPath(text, file.string());
}

}  // namespace meshfront
