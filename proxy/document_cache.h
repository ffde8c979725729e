// Whole responses by URL: catalogue, metadata, base meshes, chunk indexes, chunks, and that
// something does not exist. Obeys Cache-Control (RFC 9111): fresh ones are answered, older ones
// revalidated, and kept on when the upstream is away. A URL being fetched is fetched once.
//
// Locking: mutex_ guards the entries and the fetches under way; nothing is sent while it is held.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <list>
#include <mutex>
#include <string>
#include <unordered_map>

#include "proxy/proxy_counters.h"
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
  // Whether the content is what its URL promises; asked before anything is kept or answered.
  using Check = std::function<bool(std::span<const uint8_t>)>;

  // All references must outlive the cache. `now` lets tests move time.
  DocumentCache(Upstream& upstream, MemoryBudget& budget, ProxyCounters& counters,
                std::function<Clock::time_point()> now = Clock::now);
  ~DocumentCache() override;

  // Errors: notFound as the upstream said; unavailable, timedOut.
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
    std::list<std::string>::iterator order;  // in recent_
  };
  using Fetch = std::shared_future<Result<Document>>;

  [[nodiscard]] Document documentOf(const Entry& entry) const;
  [[nodiscard]] bool isFresh(const Entry& entry) const;
  [[nodiscard]] Result<Document> fetch(const std::string& target, RouteKind kind,
                                       const Check& check, const std::string& etag);
  [[nodiscard]] Result<UpstreamResponse> sendChecked(const std::string& target, RouteKind kind,
                                                     const Check& check, const std::string& etag);
  Result<Document> keep(const std::string& target, UpstreamResponse response);
  [[nodiscard]] Result<Document> staleOr(const std::string& target, const Error& error);

  void removeLocked(const std::string& target);
  [[nodiscard]] size_t heldBytes() const override { return bytes_.load(); }
  void release(size_t bytes) override;

  Upstream& upstream_;
  MemoryBudget& budget_;
  ProxyCounters& counters_;
  const std::function<Clock::time_point()> now_;

  std::mutex mutex_;
  std::unordered_map<std::string, Entry> entries_;
  std::list<std::string> recent_;  // most recently used first
  std::unordered_map<std::string, Fetch> fetches_;
  std::atomic<size_t> bytes_{0};
};

// max-age of a Cache-Control field; zero where there is none or nothing may be kept.
[[nodiscard]] std::chrono::seconds freshnessLifetime(std::string_view cacheControl);

}  // namespace meshfront
