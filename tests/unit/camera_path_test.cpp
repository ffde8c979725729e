#include "viewer/run/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "tests/data/temporary_folder.h"
#include "viewer/run/flight.h"

namespace meshfront {
namespace {

const Bounds kFlownBox{{-1, -1, -1}, {1, 1, 1}};

CameraPath pathOf(const std::string& json) {
  auto spec = parseCameraPath(json, "tour");
  EXPECT_TRUE(spec) << spec.error().message;
  auto path = CameraPath::place(spec.value_or(CameraPathSpec{}), kFlownBox, 1);
  EXPECT_TRUE(path) << path.error().message;
  return std::move(*path);
}

std::string errorOfPath(std::string_view json) {
  const auto spec = parseCameraPath(json, "tour");
  return spec ? "" : spec.error().message;
}

// Of two views, whichever way their `up` is written.
double difference(const Camera& a, const Camera& b) {
  return glm::length(a.eye - b.eye) + glm::length(viewAxes(a).upward - viewAxes(b).upward) +
         glm::length(viewAxes(a).forward - viewAxes(b).forward) +
         std::abs(a.verticalFov - b.verticalFov);
}

TEST(CameraPath, PassesThroughItsKeyFrames) {
  for (const char* ups : {R"("up": [0, 1, 0])", R"("up": [0.3, 1, 0.2])"}) {
    const std::string json =
        R"({"key_frames": [{"time": 0, "camera": "azimuth=10;elevation=20;up=y"},
            {"time": 0.5, "eye": [2, 3, 4], "target": [0.1, 0, 0], "fov": 50, )" +
        std::string(ups) + R"(}, {"time": 3, "eye": [-2, 3, 4], "up": [0, 1, 0]}]})";
    const auto spec = parseCameraPath(json, "tour");
    ASSERT_TRUE(spec) << spec.error().message;
    const CameraPath path = pathOf(json);
    for (const PathKeyFrame& key : spec->keyFrames) {
      EXPECT_LT(difference(path.at(key.time), placeCamera(key.camera, kFlownBox, 1)), 1e-7)
          << ups << " at " << key.time;
    }
    EXPECT_LT(difference(path.at(-5), path.at(0)), 1e-12);
    EXPECT_LT(difference(path.at(99), path.at(3)), 1e-12);
    EXPECT_EQ(path.frameCount(), 91U);
    EXPECT_NEAR(path.frameTime(90), 3, 1e-12);
  }
}

TEST(CameraPath, MovesWithoutJumpsOrCorners) {
  for (const char* last : {"up=y", "up=0.5,1,0"}) {
    const CameraPath path = pathOf(
        R"({"key_frames": [{"time": 0, "camera": "azimuth=0;elevation=0;up=y"},
            {"time": 1, "camera": "azimuth=80;elevation=40;up=y"},
            {"time": 3, "camera": "azimuth=120;elevation=10;zoom=2;up=y"},
            {"time": 3.5, "camera": "azimuth=200;elevation=10;)" +
        std::string(last) + R"("}]})");
    glm::dvec3 speedBefore(0);
    for (int i = 1; i <= 3500; ++i) {
      const double h = 1e-3;
      const glm::dvec3 speed = (path.at(h * i).eye - path.at(h * (i - 1)).eye) / h;
      EXPECT_LT(glm::length(speed), 40) << i;
      if (i > 1) {
        EXPECT_LT(glm::length(speed - speedBefore), 1) << i;  // continuous
      }
      speedBefore = speed;
    }
  }
}

TEST(CameraPath, GoesRoundAsItIsWrittenAtOneDistance) {
  for (const char* kind : {"smooth", "linear"}) {
    const CameraPath path =
        pathOf(R"({"frames_per_second": 10, "loop": true, "rounds": 2, "interpolation": ")" +
               std::string(kind) +
               R"(", "key_frames": [{"time": 0, "camera": "azimuth=0;elevation=20;distance=3"},
                             {"time": 4, "camera": "azimuth=360;elevation=20;distance=3"}]})");
    EXPECT_EQ(path.frameCount(), 81U);
    EXPECT_EQ(path.duration(), 8);
    for (const double time : {0.5, 1.0, 2.7, 3.9, 4.5, 6.7, 8.0}) {
      const double azimuth = std::fmod(90 * time, 360.0);
      const auto spec =
          parseCameraSpec("elevation=20;distance=3;azimuth=" + std::to_string(azimuth));
      EXPECT_LT(difference(path.at(time), placeCamera(*spec, kFlownBox, 1)), 1e-5) << time;
    }
  }
}

TEST(CameraPath, EyesTakeTheShorterWayAround) {
  const CameraPath path = pathOf(
      R"({"key_frames": [{"time": 0, "eye": [-1, 0, -5], "target": [0, 0, 0], "up": [0, 1, 0]},
                         {"time": 1, "eye": [1, 0, -5], "target": [0, 0, 0], "up": [0, 1, 0]}]})");
  EXPECT_LT(path.at(0.5).eye.z, -5);  // behind, not around the front
  EXPECT_NEAR(glm::length(path.at(0.3).eye), std::sqrt(26.0), 1e-9);
}

TEST(CameraPath, StandsStillBetweenEqualKeyFrames) {
  const CameraPath path = pathOf(
      R"({"key_frames": [{"time": 0, "camera": "azimuth=0"}, {"time": 1, "camera": "azimuth=40"},
                         {"time": 2, "camera": "azimuth=40"}, {"time": 3, "camera": "azimuth=90"}]})");
  EXPECT_LT(difference(path.at(1), path.at(1.5)), 1e-12);
}

TEST(CameraPath, OneKeyFrameIsOneFrame) {
  const CameraPath path = pathOf(R"({"key_frames": [{"time": 0, "camera": ""}]})");
  EXPECT_EQ(path.frameCount(), 1U);
  EXPECT_LT(difference(path.at(0), placeCamera({}, kFlownBox, 1)), 1e-9);
}

TEST(CameraPath, LoopsMustClose) {
  const auto spec = parseCameraPath(
      R"({"loop": true, "key_frames": [{"time": 0, "camera": "azimuth=0"},
                                       {"time": 1, "camera": "azimuth=10"}]})",
      "tour");
  ASSERT_TRUE(spec);
  const auto path = CameraPath::place(*spec, kFlownBox, 1);
  ASSERT_FALSE(path);
  EXPECT_NE(path.error().message.find("first one's camera"), std::string::npos);
}

TEST(CameraPath, ErrorsSayWhereAndWhat) {
  const std::string one = R"({"key_frames": [{"time": 0, "camera": "azimuth=0"}], )";
  const std::pair<std::string, const char*> wrong[] = {
      {"", "no JSON"},
      {"[1]", "JSON object"},
      {"{\"key_frames\": []}", "a list of 1"},
      {"{}", "a list of 1"},
      {one + R"("speed": 3})", "'speed' is unknown"},
      {one + R"("frames_per_second": 0})", "0.01 to 240"},
      {one + R"("frames_per_second": "30"})", "0.01 to 240"},
      {one + R"("interpolation": "cubic"})", "smooth"},
      {one + R"("loop": 1})", "true or false"},
      {one + R"("loop": true})", "two key frames"},
      {one + R"("rounds": 2})", "with \"loop\": true"},
      {R"({"key_frames": [3]})", "key frame 0: expected an object"},
      {R"({"key_frames": [{"camera": ""}]})", "\"time\": SECONDS"},
      {R"({"key_frames": [{"time": 1, "camera": ""}]})", "begin with 0"},
      {R"({"key_frames": [{"time": 0, "camera": ""}, {"time": 0, "camera": ""}]})", "key frame 1"},
      {R"({"key_frames": [{"time": 1e9, "camera": ""}]})", "0 to 86400"},
      {R"({"key_frames": [{"time": 0}]})", "\"eye\": [X, Y, Z]"},
      {R"({"key_frames": [{"time": 0, "eye": [1, 2]}]})", "[X, Y, Z], not [1,2]"},
      {R"({"key_frames": [{"time": 0, "eye": [1, 2, 1e999]}]})", ""},
      {R"({"key_frames": [{"time": 0, "camera": "zoom=0"}]})", "zoom=FACTOR"},
      {R"({"key_frames": [{"time": 0, "camera": 7}]})", "SPEC"},
      {R"({"key_frames": [{"time": 0, "camera": "", "fov": 3}]})", "leave out"},
      {R"({"key_frames": [{"time": 0, "eye": [0, 0, 1], "fov": 200}]})", "fov"},
      {R"({"key_frames": [{"time": 0, "eye": [0, 0, 1], "roll": 2}]})", "'roll' is unknown"},
      {R"({"key_frames": [{"time": 0, "camera": ""}, {"time": 86400, "camera": ""}],
           "frames_per_second": 240})",
       "1000000 frames"},
      {std::string(100, '['), ""},
      {std::string(kMaxPathBytes + 1, ' '), "4 MiB"},
  };
  for (const auto& [json, part] : wrong) {
    const std::string message = errorOfPath(json);
    EXPECT_NE(message, "") << json.substr(0, 100);
    EXPECT_NE(message.find(part), std::string::npos) << json.substr(0, 100) << ": " << message;
  }
}

// Settles a view in three looks.
class CountedScene final : public FlownScene {
 public:
  int looks = 0;
  int pictures = 0;
  uint64_t bytes = 0;
  bool stuck = false;
  std::optional<Camera> seen;
  int left = 0;

  Result<Outlook> look(const Camera& camera) override {
    ++looks;
    if (stuck) return Outlook::stuck;
    if (seen != camera) left = 3;
    seen = camera;
    if (left > 0) {
      --left;
      bytes += 10;
    }
    return left > 0 ? Outlook::more : Outlook::settled;
  }
  void wait(std::chrono::milliseconds /*longest*/) override {}
  Result<Picture> picture(const Camera& /*camera*/) override {
    ++pictures;
    return Picture{1, 1, {1, 2, 3}};
  }
  Result<std::optional<double>> psnr(const Camera& /*camera*/, const Picture&) override {
    return std::optional(30.0 + pictures);
  }
  FlightRow row() const override {
    FlightRow row;
    row.bytesDown = bytes;
    row.state = left > 0 ? "refining" : "settled";
    return row;
  }
};

const char* const kShortPath =
    R"({"frames_per_second": 100, "key_frames": [{"time": 0, "camera": "azimuth=0"},
                                                 {"time": 0.04, "camera": "azimuth=40"}]})";

TEST(Flight, WritesFramesAndLog) {
  const TemporaryFolder folder;
  CountedScene scene;
  FlightOptions options;
  options.pace = FlightPace::settled;
  options.frames = folder / "made/frames";
  options.log = folder / "log.csv";
  const auto summary = fly(pathOf(kShortPath), scene, options);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->frames, 5U);
  EXPECT_EQ(summary->settledFrames, 5U);
  EXPECT_EQ(scene.looks, 15);
  EXPECT_EQ(summary->lowestPsnr, 31);
  EXPECT_EQ(summary->meanPsnr, 33);
  EXPECT_TRUE(std::filesystem::exists(folder / "made/frames/frame-00004.png"));
  std::ifstream log(folder / "log.csv");
  std::string line;
  std::getline(log, line);
  EXPECT_EQ(line,
            "frame,time,bytes_down,bytes_up,splits,triangles,psnr,state,collapses,resplits,memory,"
            "final_share");
  std::getline(log, line);
  std::getline(log, line);
  EXPECT_EQ(line, "1,0.0100,60,0,0,0,32.000,settled,0,0,0,0.0000");
}

TEST(Flight, EndsWhereItIsStuckOrToldTo) {
  CountedScene scene;
  scene.stuck = true;
  FlightOptions options;
  options.pace = FlightPace::settled;
  auto summary = fly(pathOf(kShortPath), scene, options);
  ASSERT_TRUE(summary);
  EXPECT_TRUE(summary->stuck);
  EXPECT_EQ(summary->frames, 1U);
  scene.stuck = false;
  options.pace = FlightPace::real;
  int asked = 0;
  options.ended = [&asked] { return ++asked > 6; };
  summary = fly(pathOf(kShortPath), scene, options);
  ASSERT_TRUE(summary);
  EXPECT_LT(summary->frames, 5U);
  options.ended = nullptr;
  options.log = "/nonexistent/log.csv";
  EXPECT_FALSE(fly(pathOf(kShortPath), scene, options));
}

}  // namespace
}  // namespace meshfront
