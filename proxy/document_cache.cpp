#include "proxy/document_cache.h"

#include <charconv>
#include <utility>

#include "shared/http/field_line.h"

namespace meshfront {
namespace {

constexpr size_t kEntryOverhead = 512;  // key twice, nodes of the containers, allocation

// Far above what any mesh needs.
size_t mostBytes(RouteKind kind) {
  switch (kind) {
    case RouteKind::base:
      return size_t{1} << 30;
    case RouteKind::chunks:
      return size_t{64} << 20;
    case RouteKind::catalogue:
      return size_t{16} << 20;
    default:
      return size_t{1} << 20;
  }
}

size_t costOf(const std::string& target, const HeldBytes& content) {
  return content.size() + kEntryOverhead + 2 * target.size();
}

}  // namespace

std::chrono::seconds freshnessLifetime(std::string_view cacheControl) {
  constexpr std::string_view kMaxAge = "max-age=";
  uint32_t seconds = 0;
  while (!cacheControl.empty()) {
    const std::string_view directive = nextInList(cacheControl);
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

DocumentCache::DocumentCache(Upstream& upstream, MemoryBudget& budget, FetchMemory& memory,
                             ProxyCounters& counters, Options options)
    : upstream_(upstream),
      budget_(budget),
      memory_(memory),
      counters_(counters),
      options_(std::move(options)),
      refresher_([this] { refresh(); }) {
  budget_.join(this);
}

DocumentCache::~DocumentCache() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  refresher_.join();
  budget_.leave(this);
}

Document DocumentCache::documentOf(const Entry& entry) const {
  const auto since =
      std::chrono::duration_cast<std::chrono::seconds>(options_.now() - entry.received);
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
    order_.use(it->second.place);
    counters_.documentHits.add();
    if (!it->second.found) return fail(ErrorCode::notFound, "no such resource");
    return documentOf(it->second);
  }
  if (it != entries_.end() && it->second.found)
    return getOld(std::move(lock), target, kind, waiting, check);
  if (waiting == Waiting::refused) return fail(ErrorCode::unavailable, "has to be fetched");
  if (const auto running = fetches_.find(target); running != fetches_.end()) {
    const Fetch fetch = running->second;
    lock.unlock();
    return fetch.get();
  }
  Job job = jobLocked(target, kind, check);
  const Fetch fetch = fetches_.at(target);
  lock.unlock();
  perform(job);
  return fetch.get();
}

Result<Document> DocumentCache::getOld(std::unique_lock<std::mutex> lock, const std::string& target,
                                       RouteKind kind, Waiting waiting, const Check& check) {
  Entry& entry = entries_.at(target);
  order_.use(entry.place);
  if (!entry.refreshFails && waiting == Waiting::refused)
    return fail(ErrorCode::unavailable, "has to be fetched");
  if (!fetches_.contains(target) && options_.now() >= entry.refreshNext) {
    jobs_.push_back(jobLocked(target, kind, check));
    changed_.notify_all();
  }
  const Document old = documentOf(entry);
  if (!entry.refreshFails && fetches_.contains(target)) {
    const Fetch fetch = fetches_.at(target);
    lock.unlock();
    if (fetch.wait_for(options_.refreshWait) == std::future_status::ready) return fetch.get();
    lock.lock();
    const auto it = entries_.find(target);
    // Others need not wait for the same again.
    if (it != entries_.end() && fetches_.contains(target)) it->second.refreshFails = true;
  }
  counters_.staleDocuments.add();
  return old;
}

DocumentCache::Job DocumentCache::jobLocked(const std::string& target, RouteKind kind,
                                            const Check& check) {
  counters_.documentMisses.add();
  const auto it = entries_.find(target);
  Job job{target, kind, check, {}, {}};
  if (it != entries_.end() && it->second.found) job.etag = it->second.etag;
  fetches_.emplace(target, job.promise.get_future().share());
  return job;
}

void DocumentCache::perform(Job& job) {
  auto response = sendChecked(job);
  Result<Document> result =
      response ? keep(job.target, std::move(*response)) : staleOr(job.target, response.error());
  {
    const std::scoped_lock lock(mutex_);
    fetches_.erase(job.target);
  }
  job.promise.set_value(std::move(result));
  budget_.enforce();
}

void DocumentCache::refresh() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    const bool ending = ending_;
    lock.unlock();
    if (ending) {
      job.promise.set_value(fail(ErrorCode::unavailable, "the proxy is ending"));
    } else {
      perform(job);
    }
    lock.lock();
  }
}

Result<UpstreamResponse> DocumentCache::sendChecked(const Job& job) {
  constexpr int kAttempts = 2;  // a wrong answer is asked for once more
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    UpstreamRequest request;
    request.target = job.target;
    request.ifNoneMatch = job.etag;
    request.maxBytes = mostBytes(job.kind);
    request.memory = &memory_;
    counters_.upstreamRequests(job.kind).add();
    auto response = upstream_.send(request);
    if (!response && response.error().code != ErrorCode::tooLarge) return response;
    if (response) {
      const unsigned status = response->status;
      if (status == 404 || (status == 304 && !job.etag.empty())) return response;
      if (status == 200 && job.check(*response)) return response;
      if (status != 200)
        return fail(status == 504 ? ErrorCode::timedOut : ErrorCode::unavailable,
                    "upstream: status " + std::to_string(status));
    }
    counters_.wrongAnswers.add();
  }
  return fail(ErrorCode::unavailable, "upstream: a damaged answer, twice");
}

Result<Document> DocumentCache::staleOr(const std::string& target, const Error& error) {
  if (!isAway(error) && error.code != ErrorCode::overloaded) return tl::unexpected(error);
  const std::scoped_lock lock(mutex_);
  const auto it = entries_.find(target);
  if (it == entries_.end() || !it->second.found) return tl::unexpected(error);
  it->second.refreshFails = true;
  it->second.refreshNext = options_.now() + options_.refreshPause;
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
    response.content.shrink_to_fit();
    entry.content = HeldBytes::of(std::move(response.content));
    entry.etag = std::move(response.etag);
  }
  entry.ageReceived = response.age;
  entry.lifetime = freshnessLifetime(response.cacheControl);
  entry.received = options_.now();
  const Document document = documentOf(entry);
  const bool found = entry.found;
  if (entry.lifetime.count() == 0) {
    removeLocked(target);
  } else if (it != entries_.end()) {  // keeps its place, and its uses
    S3Fifo::Place place = it->second.place;
    order_.resize(place, costOf(target, entry.content));
    entry.place = place;
    it->second = std::move(entry);
  } else {
    entry.place = order_.insert(target, costOf(target, entry.content));
    entries_.emplace(target, std::move(entry));
  }
  countLocked();
  if (!found) return fail(ErrorCode::notFound, "no such resource");
  return document;
}

void DocumentCache::removeLocked(const std::string& target) {
  const auto it = entries_.find(target);
  if (it == entries_.end()) return;
  order_.erase(it->second.place);
  entries_.erase(it);
}

void DocumentCache::countLocked() {
  bytes_ = order_.bytes();
  unproven_ = order_.smallBytes();
}

void DocumentCache::release(size_t bytes) {
  const std::scoped_lock lock(mutex_);
  const size_t goal = order_.bytes() > bytes ? order_.bytes() - bytes : 0;
  while (order_.bytes() > goal) {
    const auto next = order_.next();
    if (!next) break;
    removeLocked(std::string((*next)->key));
  }
  countLocked();
}

}  // namespace meshfront
