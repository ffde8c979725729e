#include "proxy/document_cache.h"

#include <charconv>

namespace meshfront {
namespace {

constexpr size_t kEntryOverhead = 512;  // key twice, nodes of the containers, allocation

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace

std::chrono::seconds freshnessLifetime(std::string_view cacheControl) {
  constexpr std::string_view kMaxAge = "max-age=";
  uint32_t seconds = 0;
  while (!cacheControl.empty()) {
    const size_t comma = cacheControl.find(',');
    const std::string_view directive = trimmed(cacheControl.substr(0, comma));
    cacheControl.remove_prefix(comma == std::string_view::npos ? cacheControl.size() : comma + 1);
    if (directive == "no-store" || directive == "no-cache" || directive == "private")
      return std::chrono::seconds(0);
    if (directive.starts_with(kMaxAge)) {
      const char* begin = directive.data() + kMaxAge.size();
      const char* end = directive.data() + directive.size();
      if (std::from_chars(begin, end, seconds).ec != std::errc()) seconds = 0;
    }
  }
  return std::chrono::seconds(seconds);
}

DocumentCache::DocumentCache(Upstream& upstream, MemoryBudget& budget, ProxyCounters& counters,
                             std::function<Clock::time_point()> now)
    : upstream_(upstream), budget_(budget), counters_(counters), now_(std::move(now)) {
  budget_.join(this);
}

DocumentCache::~DocumentCache() {
  budget_.leave(this);
}

Document DocumentCache::documentOf(const Entry& entry) const {
  const auto since = std::chrono::duration_cast<std::chrono::seconds>(now_() - entry.received);
  return {entry.content, entry.ageReceived + since};
}

bool DocumentCache::isFresh(const Entry& entry) const {
  return documentOf(entry).age < entry.lifetime;
}

Result<Document> DocumentCache::get(const std::string& target, RouteKind kind, Waiting waiting,
                                    const Check& check) {
  std::unique_lock lock(mutex_);
  const auto it = entries_.find(target);
  if (it != entries_.end() && isFresh(it->second)) {
    recent_.splice(recent_.begin(), recent_, it->second.order);
    counters_.documentHits.add();
    if (!it->second.found) return fail(ErrorCode::notFound, "no such resource");
    return documentOf(it->second);
  }
  if (waiting == Waiting::refused) return fail(ErrorCode::unavailable, "has to be fetched");
  if (const auto running = fetches_.find(target); running != fetches_.end()) {
    const Fetch fetch = running->second;
    lock.unlock();
    return fetch.get();
  }
  counters_.documentMisses.add();
  std::promise<Result<Document>> promise;
  fetches_.emplace(target, promise.get_future().share());
  const std::string etag =
      it != entries_.end() && it->second.found ? it->second.etag : std::string();
  lock.unlock();

  auto result = fetch(target, kind, check, etag);
  lock.lock();
  fetches_.erase(target);
  lock.unlock();
  promise.set_value(result);
  budget_.enforce();
  return result;
}

Result<Document> DocumentCache::fetch(const std::string& target, RouteKind kind, const Check& check,
                                      const std::string& etag) {
  auto response = sendChecked(target, kind, check, etag);
  if (!response) return staleOr(target, response.error());
  return keep(target, std::move(*response));
}

Result<UpstreamResponse> DocumentCache::sendChecked(const std::string& target, RouteKind kind,
                                                    const Check& check, const std::string& etag) {
  constexpr int kAttempts = 2;  // a wrong answer is asked for once more
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    UpstreamRequest request;
    request.target = target;
    request.ifNoneMatch = etag;
    counters_.upstreamRequests(kind).add();
    auto response = upstream_.send(request);
    if (!response) return response;
    if (response->status == 404 || (response->status == 304 && !etag.empty())) return response;
    if (response->status == 200 && check(response->content)) return response;
    if (response->status != 200)
      return fail(response->status == 504 ? ErrorCode::timedOut : ErrorCode::unavailable,
                  "upstream: status " + std::to_string(response->status));
    counters_.wrongAnswers.add();
  }
  return fail(ErrorCode::unavailable, "upstream: a damaged answer, twice");
}

Result<Document> DocumentCache::staleOr(const std::string& target, const Error& error) {
  if (!isAway(error)) return tl::unexpected(error);
  const std::scoped_lock lock(mutex_);
  const auto it = entries_.find(target);
  if (it == entries_.end() || !it->second.found) return tl::unexpected(error);
  counters_.staleDocuments.add();
  return documentOf(it->second);
}

Result<Document> DocumentCache::keep(const std::string& target, UpstreamResponse response) {
  const std::scoped_lock lock(mutex_);
  const auto it = entries_.find(target);
  Entry entry;
  entry.found = response.status != 404;
  if (response.status == 304 && it != entries_.end()) {
    entry.content = it->second.content;
    entry.etag = it->second.etag;
  } else if (response.status == 304) {  // its entry was evicted meanwhile
    return fail(ErrorCode::unavailable, "upstream: not modified since what is no longer known");
  } else if (entry.found) {
    entry.content = HeldBytes::of(std::move(response.content));
    entry.etag = std::move(response.etag);
  }
  entry.ageReceived = response.age;
  entry.lifetime = freshnessLifetime(response.cacheControl);
  entry.received = now_();
  removeLocked(target);
  if (entry.lifetime.count() > 0) {
    recent_.push_front(target);
    entry.order = recent_.begin();
    bytes_ += entry.content.size() + kEntryOverhead + 2 * target.size();
    entries_.emplace(target, entry);
  }
  if (!entry.found) return fail(ErrorCode::notFound, "no such resource");
  return documentOf(entry);
}

void DocumentCache::removeLocked(const std::string& target) {
  const auto it = entries_.find(target);
  if (it == entries_.end()) return;
  bytes_ -= it->second.content.size() + kEntryOverhead + 2 * target.size();
  recent_.erase(it->second.order);
  entries_.erase(it);
}

void DocumentCache::release(size_t bytes) {
  const std::scoped_lock lock(mutex_);
  const size_t before = bytes_;
  const size_t goal = before > bytes ? before - bytes : 0;
  while (!recent_.empty() && bytes_ > goal) removeLocked(std::string(recent_.back()));
}

}  // namespace meshfront
