#include "viewer/window/panel_status.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/data/temporary_folder.h"
#include "viewer/window/frame_clock.h"
#include "viewer/window/number_text.h"
#include "viewer/window/quality_series.h"
#include "viewer/window/screenshot_file.h"
#include "viewer/window/trouble_message.h"

namespace meshfront {
namespace {

TEST(PanelStatus, JsonHasEveryNumber) {
  PanelStatus status;
  status.state = "degraded";
  status.reason = "no answer \xff";  // no UTF-8
  status.message = WindowMessage{"The server is away", "why", "what"};
  status.retryIn = 4.5;
  status.trianglesShown = 12;
  status.triangleBudget = {7, 9};
  status.splitsPerSecond = 1e6;
  status.quality = {{0, 0.25}, {1, 0.75}};
  status.meshes = {{"bunny", "settled", 1, 2, ""}};
  status.legend = {"level", {{{1, 0, 0}, "0"}, {{0, 0, 1}, "9"}}, true};
  status.frame = FrameTimes{0.01, 0.02, 30};
  status.picks = {{{1, 2, 3}, 4, "bunny", "17:0110", 0.5}};
  const auto json = nlohmann::json::parse(toJson(status));
  EXPECT_EQ(json["state"], "degraded");
  EXPECT_EQ(json["message"]["title"], "The server is away");
  EXPECT_EQ(json["retry_in"], 4.5);
  EXPECT_EQ(json["triangles_shown"], 12);
  EXPECT_EQ(json["triangle_budget"]["limit"], 9);
  EXPECT_TRUE(json["byte_budget"]["limit"].is_null());
  EXPECT_EQ(json["splits_per_second"], 1e6);
  EXPECT_TRUE(json["round_trip"].is_null());
  EXPECT_EQ(json["quality"], 0.75);
  EXPECT_EQ(json["quality_series"].size(), 2U);
  EXPECT_EQ(json["meshes"][0]["state"], "settled");
  EXPECT_EQ(json["legend"]["entries"][1]["text"], "9");
  EXPECT_EQ(json["frame_95"], 0.02);
  EXPECT_EQ(json["picks"][0]["node"], "17:0110");
  EXPECT_EQ(json["picks"][0]["world"][2], 3);
  EXPECT_TRUE(nlohmann::json::parse(toJson(PanelStatus{}))["quality"].is_null());
}

TEST(FrameClock, TellsMedianAndSlowOfTheLastSeconds) {
  FrameClock clock;
  EXPECT_FALSE(clock.times(0));
  for (int i = 1; i <= 100; ++i) clock.add(0.01 * i, 0.001 * i);
  const auto times = clock.times(1);
  ASSERT_TRUE(times);
  EXPECT_NEAR(times->median, 0.050, 1e-12);
  EXPECT_NEAR(times->slow, 0.095, 1e-12);
  EXPECT_EQ(times->frames, 100U);
  EXPECT_FALSE(clock.times(20));
  clock.add(20, 0.5);
  EXPECT_EQ(clock.times(20)->frames, 1U);
  EXPECT_EQ(clock.times(20)->slow, 0.5);
}

TEST(QualitySeries, KeepsAFewSamplesAndTheNewest) {
  QualitySeries series;
  for (int i = 0; i <= 100'000; ++i) series.add(0.01 * i, 1e-5 * i);
  EXPECT_LT(series.samples().size(), 500U);
  EXPECT_GT(series.samples().size(), 400U);
  EXPECT_EQ(series.samples().back().share, 1);
  EXPECT_GE(series.samples().front().seconds, 1000 - QualitySeries::kRemembered);
  for (size_t i = 1; i < series.samples().size(); ++i)
    EXPECT_LT(series.samples()[i - 1].seconds, series.samples()[i].seconds);
}

TEST(RateMeter, MeasuresTheLastSeconds) {
  RateMeter meter;
  meter.add(0, 0);
  EXPECT_FALSE(meter.perSecond());
  for (int i = 1; i <= 100; ++i) meter.add(0.1 * i, static_cast<uint64_t>(50 * i));
  EXPECT_NEAR(*meter.perSecond(), 500, 1e-6);
  for (int i = 1; i <= 50; ++i) meter.add(10 + 0.1 * i, 5000);  // nothing more
  EXPECT_EQ(*meter.perSecond(), 0);
}

TEST(NumberText, IsShortAndTrue) {
  EXPECT_EQ(groupedText(0), "0");
  EXPECT_EQ(groupedText(999), "999");
  EXPECT_EQ(groupedText(1'234'567), "1,234,567");
  EXPECT_EQ(byteText(812), "812 B");
  EXPECT_EQ(byteText(1'240'000), "1.24 MB");
  EXPECT_EQ(byteText(999'999), "1.00 MB");
  EXPECT_EQ(byteText(12'345), "12.3 kB");
  EXPECT_EQ(durationText(0.0008), "0.8 ms");
  EXPECT_EQ(durationText(0.0123), "12 ms");
  EXPECT_EQ(durationText(1.44), "1.4 s");
  EXPECT_EQ(shareText(1), "100 %");
  EXPECT_EQ(shareText(0.99999), "99.9 %");
  EXPECT_EQ(shareText(0.874), "87 %");
  EXPECT_EQ(fixedText(1.25, 3), "1.250");
  EXPECT_EQ(fixedText(1e300, 2).size(), 304U);
}

TEST(TroubleMessage, SaysWhatIsAndWhatToDo) {
  const std::string url = "http://127.0.0.1:9/v1/meshes/bunny";
  const std::string away = "no answer from 127.0.0.1:9: Couldn't connect to server";
  EXPECT_EQ(troubleKindOf(away), TroubleKind::serverAway);
  EXPECT_EQ(troubleKindOf("there is no mesh 'x' at http://h"), TroubleKind::noSuchMesh);
  EXPECT_EQ(troubleKindOf("http://h is no mesh of the v1 interface: no JSON"),
            TroubleKind::wrongInterface);
  EXPECT_EQ(troubleKindOf("something else"), TroubleKind::other);
  const auto message = troubleMessage(TroubleKind::serverAway, away, url, false, 4.2);
  EXPECT_NE(message.title, "");
  EXPECT_EQ(message.detail, away);
  EXPECT_NE(message.advice.find(url), std::string::npos);
  EXPECT_NE(message.advice.find("Next attempt in 5 s"), std::string::npos);
  EXPECT_NE(troubleMessage(TroubleKind::serverAway, away, url, true, {}).title, message.title);
  EXPECT_EQ(connectingMessage(url, 0.1).advice, "");
  EXPECT_NE(connectingMessage(url, 9.5).advice.find("9 s"), std::string::npos);
}

TEST(NumberedScreenshot, NeverOverwrites) {
  const TemporaryFolder folder;
  const Picture picture{1, 1, {1, 2, 3}};
  const auto first = writeNumberedScreenshot(picture, folder.path());
  const auto second = writeNumberedScreenshot(picture, folder.path());
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->filename(), "meshfront-0001.png");
  EXPECT_EQ(second->filename(), "meshfront-0002.png");
  EXPECT_EQ(*readPng(*second), picture);
  const auto nowhere = writeNumberedScreenshot(picture, folder.path() / "none");
  ASSERT_FALSE(nowhere);
  EXPECT_NE(nowhere.error().message.find("folder of yours"), std::string::npos);
  EXPECT_FALSE(writeNumberedScreenshot(Picture{}, folder.path()));  // leaves nothing behind
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "meshfront-0003.png"));
}

}  // namespace
}  // namespace meshfront
