// The proxy's cache of whole responses: what is old while the upstream is away, what is wrong, what
// goes when memory lacks.
#include "proxy/document_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>

namespace meshfront {
namespace {

using std::chrono::seconds;

// Answers, once let, what the test says.
class PlainUpstream final : public Upstream {
 public:
  Result<UpstreamResponse> send(const UpstreamRequest& request) override {
    std::unique_lock lock(mutex_);
    ++calls;
    changed_.wait(lock, [this] { return open_; });
    last = request;
    if (away) return fail(ErrorCode::unavailable, "away");
    UpstreamResponse response;
    response.status = status;
    response.cacheControl = cacheControl;
    response.age = age;
    response.content.assign(size, 'x');
    return response;
  }
  void setOpen(bool open) {
    {
      const std::scoped_lock lock(mutex_);
      open_ = open;
    }
    changed_.notify_all();
  }
  std::atomic<int> calls{0};
  std::atomic<bool> away{false};
  unsigned status = 200;
  std::string cacheControl = "public, max-age=10";
  seconds age{0};
  size_t size = 100;
  UpstreamRequest last;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = true;
};

class DocumentCacheTest : public ::testing::Test {
 protected:
  ~DocumentCacheTest() override { upstream_.setOpen(true); }
  DocumentCache& make(std::chrono::milliseconds refreshWait, size_t budget = size_t{1} << 20) {
    cache_.reset();
    budget_ = std::make_unique<MemoryBudget>(budget);
    cache_ = std::make_unique<DocumentCache>(
        upstream_, *budget_, memory_, counters_,
        DocumentCache::Options{.refreshWait = refreshWait, .now = [this] { return now_.load(); }});
    return *cache_;
  }
  Result<Document> get(const std::string& target, Waiting waiting = Waiting::allowed) {
    return cache_->get(target, RouteKind::mesh, waiting, [](const UpstreamResponse& response) {
      return response.content.size() > 9;
    });
  }
  void pass(seconds time) { now_ = now_.load() + time; }
  void waitForCalls(int calls) {
    while (upstream_.calls < calls) std::this_thread::yield();
  }

  PlainUpstream upstream_;
  Metrics metrics_;
  ProxyCounters counters_{metrics_};
  FetchMemory memory_{size_t{1} << 20};
  std::unique_ptr<MemoryBudget> budget_;
  std::atomic<DocumentCache::Clock::time_point> now_{DocumentCache::Clock::time_point{}};
  std::unique_ptr<DocumentCache> cache_;
};

TEST_F(DocumentCacheTest, OldContentIsAnsweredAtOnceWhileTheUpstreamIsAway) {
  make(std::chrono::hours(1));
  upstream_.age = seconds(4);
  ASSERT_TRUE(get("/a"));
  pass(seconds(60));
  upstream_.away = true;
  EXPECT_FALSE(get("/a", Waiting::refused));  // might still be there: somebody has to ask
  const auto first = get("/a");
  ASSERT_TRUE(first);
  EXPECT_EQ(first->age, seconds(64));
  EXPECT_EQ(upstream_.calls, 2);
  // From now on nobody waits, and nobody asks for a while.
  for (int i = 0; i < 5; ++i) {
    const auto old = get("/a", Waiting::refused);
    ASSERT_TRUE(old);
    EXPECT_EQ(old->age, seconds(64));
  }
  EXPECT_EQ(upstream_.calls, 2);
  // Then one attempt behind the answers, for all.
  pass(seconds(3));
  upstream_.setOpen(false);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(get("/a", Waiting::refused));
  waitForCalls(3);
  EXPECT_TRUE(get("/a"));
  EXPECT_EQ(upstream_.calls, 3);
  EXPECT_EQ(counters_.staleDocuments.value(), 12U);
  // It is back.
  upstream_.away = false;
  upstream_.age = seconds(0);
  upstream_.setOpen(true);
  while (true) {
    const auto fresh = get("/a", Waiting::refused);
    ASSERT_TRUE(fresh);
    if (fresh->age == seconds(0)) break;
    std::this_thread::yield();
  }
  EXPECT_EQ(upstream_.calls, 3);
}

TEST_F(DocumentCacheTest, ASilentUpstreamHoldsNobodyUp) {
  make(std::chrono::milliseconds(1));
  ASSERT_TRUE(get("/a"));
  pass(seconds(11));
  upstream_.setOpen(false);
  const auto old = get("/a");
  ASSERT_TRUE(old);
  EXPECT_EQ(old->age, seconds(11));
  EXPECT_TRUE(get("/a", Waiting::refused));
  upstream_.setOpen(true);
}

TEST_F(DocumentCacheTest, WhatWasNeverThereIsNotMadeUp) {
  make(std::chrono::hours(1));
  upstream_.status = 404;
  for (int i = 0; i < 3; ++i) {
    const auto missing = get("/none");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::notFound);
  }
  EXPECT_EQ(upstream_.calls, 1);  // kept, for its time
  pass(seconds(11));
  upstream_.away = true;
  const auto unknown = get("/none");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::unavailable);
  upstream_.away = false;
  upstream_.status = 200;
  EXPECT_TRUE(get("/none"));
}

TEST_F(DocumentCacheTest, KeepsNothingThatFailsItsCheckOrMayNotBeKept) {
  make(std::chrono::hours(1));
  upstream_.size = 5;
  EXPECT_FALSE(get("/a"));
  EXPECT_EQ(upstream_.calls, 2);  // asked once more
  upstream_.size = 100;
  EXPECT_TRUE(get("/a"));
  upstream_.cacheControl = "no-store";
  EXPECT_TRUE(get("/b"));
  EXPECT_FALSE(get("/b", Waiting::refused));
  EXPECT_LE(upstream_.last.maxBytes, size_t{1} << 20);
}

TEST_F(DocumentCacheTest, ADownloadOfEverythingLeavesWhatIsAskedForAgain) {
  make(std::chrono::hours(1), 200'000);
  upstream_.size = 1'000;
  upstream_.cacheControl = "max-age=31536000";
  const auto askForHotOnes = [this] {
    for (int i = 0; i < 50; ++i) EXPECT_TRUE(get("/hot/" + std::to_string(i)));
  };
  askForHotOnes();
  askForHotOnes();
  for (int i = 0; i < 5'000; ++i) {
    EXPECT_TRUE(get("/scan/" + std::to_string(i)));
    EXPECT_LE(budget_->bytes(), 200'000U);
  }
  const int before = upstream_.calls;
  askForHotOnes();
  EXPECT_EQ(upstream_.calls, before);
}

TEST(FreshnessLifetime, TakesWhatItUnderstands) {
  EXPECT_EQ(freshnessLifetime("public, max-age=10"), seconds(10));
  EXPECT_EQ(freshnessLifetime("max-age=10, no-store"), seconds(0));
  EXPECT_EQ(freshnessLifetime("private, max-age=10"), seconds(0));
  for (const char* odd : {"", ",", "max-age=", "max-age=-1", "max-age=99999999999999", "x"})
    EXPECT_EQ(freshnessLifetime(odd), seconds(0)) << odd;
}

}  // namespace
}  // namespace meshfront
