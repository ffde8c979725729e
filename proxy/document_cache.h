// Whole responses by URL: catalogue, metadata, base meshes, chunk indexes, chunks, and that
// something does not exist. Obeys Cache-Control (RFC 9111): fresh ones are answered, older ones
// revalidated. A URL being fetched is fetched once. Which ones go when memory lacks: S3Fifo.
//
// While the upstream is away, old content is answered as it is (RFC 9111 section 4.2.4, RFC 5861:
// stale-if-error), with its Age. It is refreshed by a thread of the cache's own; the first request
// that finds it old waits for that, but only shortly, and once an attempt has failed none waits:
// the refreshing goes on behind the answers, one attempt for all every few seconds.
//
// Locking: mutex_ guards the entries, the fetches under way and the queue of the refreshing thread;
// nothing is sent while it is held.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_map>

#include "proxy/proxy_counters.h"
#include "proxy/s3_fifo.h"
#include "proxy/upstream.h"
#include "shared/store/held_bytes.h"
#include "shared/store/memory_budget.h"
#include "shared/store/record_store.h"

namespace meshfront {

struct Document {
  HeldBytes content;
  std::chrono::seconds age{0};  // since it left its origin
};

class DocumentCache final : private MemoryBudget::Member {
 public:
  using Clock = std::chrono::steady_clock;
  // Whether the content is what its URL promises; asked before anything is kept or answered, also
  // later and on another thread.
  using Check = std::function<bool(const UpstreamResponse&)>;
  struct Options {
    std::chrono::milliseconds refreshWait{300};  // what a request for old content waits at most
    std::chrono::seconds refreshPause{2};        // from a failed attempt to the next
    std::function<Clock::time_point()> now = Clock::now;  // lets tests move time
  };

  // All references must outlive the cache; the upstream is to fail soon when the cache ends.
  DocumentCache(Upstream& upstream, MemoryBudget& budget, FetchMemory& memory,
                ProxyCounters& counters, Options options);
  ~DocumentCache() override;

  // Errors: notFound as the upstream said; unavailable, timedOut, overloaded.
  [[nodiscard]] Result<Document> get(const std::string& target, RouteKind kind, Waiting waiting,
                                     const Check& check);
  [[nodiscard]] size_t bytes() const { return bytes_.load(); }

 private:
  struct Entry {
    bool found = true;  // false: 404
    HeldBytes content;
    std::string etag;
    std::chrono::seconds ageReceived{0};
    std::chrono::seconds lifetime{0};
    Clock::time_point received;
    bool refreshFails = false;
    Clock::time_point refreshNext{};  // not before
    S3Fifo::Place place;
  };
  using Fetch = std::shared_future<Result<Document>>;
  struct Job {
    std::string target;
    RouteKind kind{};
    Check check;
    std::string etag;
    std::promise<Result<Document>> promise;
  };

  [[nodiscard]] Document documentOf(const Entry& entry) const;
  [[nodiscard]] bool isFresh(const Entry& entry) const;
  // Old content: revalidated if that is quick. Takes the lock and gives it up.
  [[nodiscard]] Result<Document> getOld(std::unique_lock<std::mutex> lock,
                                        const std::string& target, RouteKind kind, Waiting waiting,
                                        const Check& check);
  [[nodiscard]] Job jobLocked(const std::string& target, RouteKind kind, const Check& check);
  void perform(Job& job);
  void refresh();  // the thread
  [[nodiscard]] Result<UpstreamResponse> sendChecked(const Job& job);
  Result<Document> keep(const std::string& target, UpstreamResponse response);
  [[nodiscard]] Result<Document> staleOr(const std::string& target, const Error& error);

  void removeLocked(const std::string& target);
  [[nodiscard]] size_t heldBytes() const override { return bytes_.load(); }
  [[nodiscard]] size_t unprovenBytes() const override { return unproven_.load(); }
  void release(size_t bytes) override;
  void countLocked();

  Upstream& upstream_;
  MemoryBudget& budget_;
  FetchMemory& memory_;
  ProxyCounters& counters_;
  const Options options_;

  std::mutex mutex_;
  std::condition_variable changed_;  // jobs_, ending_
  std::unordered_map<std::string, Entry> entries_;
  S3Fifo order_;
  std::unordered_map<std::string, Fetch> fetches_;
  std::deque<Job> jobs_;
  bool ending_ = false;
  std::atomic<size_t> bytes_{0};
  std::atomic<size_t> unproven_{0};
  std::thread refresher_;  // last: starts when everything else is there
};

// max-age of a Cache-Control field; zero where there is none or nothing may be kept.
[[nodiscard]] std::chrono::seconds freshnessLifetime(std::string_view cacheControl);

}  // namespace meshfront
