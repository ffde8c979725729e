#include "proxy/retrying_upstream.h"

#include <gtest/gtest.h>

#include <thread>

namespace meshfront {
namespace {

using std::chrono::milliseconds;

// Fails a number of times, then answers.
class FlakyUpstream final : public Upstream {
 public:
  explicit FlakyUpstream(int failures) : failures_(failures) {}
  Result<UpstreamResponse> send(const UpstreamRequest&) override {
    ++calls;
    if (failures_-- > 0) return fail(code, "away");
    UpstreamResponse response;
    response.status = status;
    return response;
  }
  int calls = 0;
  unsigned status = 200;
  ErrorCode code = ErrorCode::unavailable;

 private:
  int failures_;
};

TEST(RetryingUpstream, BridgesAFewFailures) {
  FlakyUpstream flaky(4);
  RetryingUpstream upstream(flaky, {milliseconds(60000), milliseconds(1), milliseconds(2)});
  const auto response = upstream.send({});
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, 200U);
  EXPECT_EQ(flaky.calls, 5);
}

TEST(RetryingUpstream, GivesUpAndThenTriesOnce) {
  FlakyUpstream flaky(1000000);
  RetryingUpstream upstream(flaky, {milliseconds(30), milliseconds(1), milliseconds(2)});
  EXPECT_FALSE(upstream.send({}));
  EXPECT_GT(flaky.calls, 1);
  std::this_thread::sleep_for(milliseconds(40));
  flaky.calls = 0;
  EXPECT_FALSE(upstream.send({}));
  EXPECT_EQ(flaky.calls, 1);
}

TEST(RetryingUpstream, DoesNotRepeatTimeoutsAndAnswers) {
  FlakyUpstream slow(1);
  slow.code = ErrorCode::timedOut;
  RetryingUpstream patient(slow, {milliseconds(60000), milliseconds(1), milliseconds(2)});
  EXPECT_FALSE(patient.send({}));
  EXPECT_EQ(slow.calls, 1);
  FlakyUpstream strict(0);
  strict.status = 404;
  RetryingUpstream upstream(strict, {milliseconds(60000), milliseconds(1), milliseconds(2)});
  ASSERT_TRUE(upstream.send({}));
  EXPECT_EQ(strict.calls, 1);
}

TEST(RetryingUpstream, EndsItsPausesWhenStopped) {
  FlakyUpstream flaky(1000000);
  RetryingUpstream upstream(flaky,
                            {milliseconds(600000), milliseconds(600000 / 2), milliseconds(600000)});
  upstream.stop();
  EXPECT_FALSE(upstream.send({}));  // at once, or the test hangs
  EXPECT_EQ(flaky.calls, 1);
}

}  // namespace
}  // namespace meshfront
