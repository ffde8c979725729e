// What a receiver makes of a link's round trip and bandwidth.
#include "shared/receiver/link_meter.h"

#include <gtest/gtest.h>

#include "shared/receiver/cache_verdict.h"
#include "tests/unit/delayed_service.h"
#include "tests/unit/receiver_fixture.h"

namespace meshfront {
namespace {

using std::chrono::milliseconds;

FetchResponse timedAnswer(milliseconds sent, milliseconds firstByte, milliseconds done,
                          uint64_t bytes) {
  const FetchTiming::Clock::time_point zero{std::chrono::hours(1)};
  FetchResponse response;
  response.status = 200;
  response.traffic.bodyBytesDown = bytes;
  response.timing = {zero + sent, zero + firstByte, zero + done};
  return response;
}

TEST(LinkMeter, TellsTheShortestRoundTripAndTheGreatestThroughput) {
  LinkMeter meter;
  EXPECT_FALSE(meter.roundTrip());
  EXPECT_EQ(meter.productBytes(), 0);
  meter.observe(timedAnswer(milliseconds(0), milliseconds(100), milliseconds(200), 1'000));
  meter.observe(timedAnswer(milliseconds(300), milliseconds(350), milliseconds(400), 4'000));
  meter.observe(timedAnswer(milliseconds(500), milliseconds(580), milliseconds(700), 100));
  EXPECT_EQ(meter.roundTrip(), milliseconds(50));
  EXPECT_NEAR(*meter.bytesPerSecond(), 40'000, 1);
  EXPECT_NEAR(meter.productBytes(), 2'000, 1);
  // Two answers under way together share the link: 3,000 and 5,000 octets in 400 ms.
  meter.observe(timedAnswer(milliseconds(1'000), milliseconds(1'100), milliseconds(1'200), 5'000));
  meter.observe(timedAnswer(milliseconds(1'100), milliseconds(1'200), milliseconds(1'200), 3'000));
  EXPECT_NEAR(*meter.bytesPerSecond(), 80'000, 1);
}

TEST(LinkMeter, ForgetsAfterAWhileAndIgnoresWhatTellsNothing) {
  LinkMeter meter;
  meter.observe(timedAnswer(milliseconds(0), milliseconds(10), milliseconds(20), 1'000));
  FetchResponse refused = timedAnswer(milliseconds(20), milliseconds(21), milliseconds(22), 9);
  refused.status = 503;
  meter.observe(refused);
  meter.observe(FetchResponse{});
  EXPECT_EQ(meter.roundTrip(), milliseconds(10));
  meter.observe(
      timedAnswer(milliseconds(15'000), milliseconds(15'090), milliseconds(15'100), 1'000));
  EXPECT_EQ(meter.roundTrip(), milliseconds(90));
}

TEST(LinkMeter, SizesTheWindowByTheProduct) {
  LinkMeter meter;
  EXPECT_FALSE(meter.window(1'000));
  meter.observe(timedAnswer(milliseconds(0), milliseconds(100), milliseconds(200), 8'000));
  EXPECT_EQ(meter.window(1'000), 6U);  // 4,000 octets on their way, a quarter more, and one
  EXPECT_EQ(meter.window(1e9), 2U);
  EXPECT_EQ(meter.window(10), LinkMeter::kWidestWindow);
  EXPECT_FALSE(meter.window(0));
}

TEST(CacheVerdict, ReadsWhatCachesSay) {
  const auto verdict = [](std::map<std::string, std::string, std::less<>> headers) {
    FetchResponse response;
    response.headers = std::move(headers);
    return cameFromCache(response);
  };
  EXPECT_FALSE(verdict({}));
  EXPECT_TRUE(verdict({{"cache-status", "nginx; hit"}}));
  EXPECT_FALSE(verdict({{"cache-status", "varnish; fwd=uri-miss"}, {"age", "7"}}));
  EXPECT_TRUE(verdict({{"x-cache", "HIT from squid"}}));
  EXPECT_FALSE(verdict({{"x-cache", "MISS from squid"}}));
  EXPECT_TRUE(verdict({{"age", "12"}, {"via", "1.1 varnish"}}));
  EXPECT_FALSE(verdict({{"age", "0"}}));
  EXPECT_FALSE(verdict({{"age", "12"}, {"via", "1.1 meshfront"}}));
}

class LinkTest : public ReceiverTest {
 protected:
  struct Ride {
    double seconds = 0;
    size_t most = 0;
    ReceiverStatistics statistics;
    std::vector<std::string> urls;
  };
  // Everything is visible, and the nearer the coarser, as in a view.
  Ride ride(ReceiverOptions options, double roundTrip, double bytesPerSecond) {
    DelayedService link(service_, DelayedService::Seconds(roundTrip), bytesPerSecond);
    options.freshRanking = false;
    options.clock = [&link] { return link.now(); };
    const auto begin = link.now();
    Receiver receiver(url(), options, link);
    while (receiver.isAtWork()) {
      const bool moved = link.deliver() || receiver.waitForArrival(milliseconds(0));
      if (!moved && !receiver.wantsRanking()) break;
      receiver.advance();
      if (receiver.mesh() == nullptr) continue;
      const auto vertices = static_cast<uint32_t>(receiver.mesh()->vertexSlotCount());
      receiver.rank(everywhere(receiver, std::max(1U, 200'000 / vertices)));
    }
    EXPECT_EQ(receiver.state(), ReceiverState::complete) << receiver.reason();
    return {DelayedService::Seconds(link.now() - begin).count(), link.most, receiver.statistics(),
            link.urls};
  }
};

TEST_F(LinkTest, KeepsALongLinkBusyAndAShortOneFree) {
  ReceiverOptions options;
  options.batch = 20;
  options.descendants = false;
  EXPECT_GT(ride(options, 0.2, 1e6).most, 4U);
  EXPECT_LE(ride(options, 0.2, 1e6).most, LinkMeter::kWidestWindow);
  EXPECT_LE(ride(options, 0.0001, 1e5).most, 3U);
  options.window = 3;
  EXPECT_EQ(ride(options, 0.2, 1e6).most, 3U);
}

TEST_F(LinkTest, AsksForDescendantsWhereRoundTripsAreLong) {
  ReceiverOptions without;
  without.descendants = false;
  const ReceiverOptions with;
  const Ride slow = ride(without, 0.3, 1e6);
  const Ride fast = ride(with, 0.3, 1e6);
  EXPECT_EQ(slow.statistics.expanded, 0U);
  EXPECT_GT(fast.statistics.expanded, 0U);
  EXPECT_LT(fast.seconds, 0.8 * slow.seconds);
  // Within a round trip of a millisecond there is nothing to gain but for the first request.
  EXPECT_LE(ride(with, 0.0005, 1e5).statistics.expanded, 1U);
}

TEST_F(LinkTest, FirstAsksForAllUpToALevelAndForFinerOnesWhereRoundTripsAreLong) {
  const auto level = [](const Ride& ride) -> int {
    for (const std::string& url : ride.urls)
      if (url.find("/splits") != std::string::npos) {
        const size_t at = url.find("?significance=");
        return at == std::string::npos ? -1 : std::stoi(url.substr(at + 14));
      }
    return -1;
  };
  const int near = level(ride({}, 0.005, 1e6));
  EXPECT_GE(near, 0);
  EXPECT_GT(level(ride({}, 0.2, 1e6)), near);
  ReceiverOptions without;
  without.descendants = false;
  EXPECT_EQ(level(ride(without, 0.2, 1e6)), -1);
}

TEST_F(LinkTest, AsksForNoDescendantsBeyondWhatIsAllowedOrSeen) {
  ReceiverOptions limited;
  limited.limits.records = 1'000'000;
  EXPECT_EQ(ride(limited, 0.3, 1e6).statistics.expanded, 0U);
  Receiver& receiver = connect();
  runToTheEnd(receiver);
  EXPECT_EQ(receiver.statistics().expanded, 0U);  // one pixel each
}

}  // namespace
}  // namespace meshfront
