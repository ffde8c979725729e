// Threads and lifetime: callers only touch the mailbox (mutex_): jobs that arrive, ids to cancel
// and the order to stop. Everything else - slots, waiting jobs, curl - belongs to the loop's
// thread. The destructor sets stop_, wakes the thread and joins it; jobs die with the loop,
// uncalled.
#include "shared/receiver/http_fetcher.h"

#include <curl/curl.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <charconv>
#include <deque>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <unordered_set>
#include <utility>

namespace meshfront {
namespace {

using Clock = std::chrono::steady_clock;

struct Job {
  FetchId id = 0;
  FetchRequest request;
  Transport::Completion completion;
  unsigned attempts = 0;
  Traffic traffic;        // of all attempts
  Clock::time_point due;  // not before
};

// One request in progress. Its address is known to curl: slots never move.
struct Slot {
  CURL* easy = nullptr;
  curl_slist* headers = nullptr;
  std::optional<Job> job;
  FetchResponse response;
  // By the debug stream too: curl's own times of a kept connection tell little.
  Clock::time_point sentAt;  // the request's last octet
  std::optional<Clock::time_point> firstByteAt;
  size_t headerBytes = 0;
  size_t maxHeaderBytes = 0;
  bool bodyTooLong = false;
  bool headersTooLong = false;
};

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

void countReceived(const Slot& slot, size_t count) {
  if (slot.job->request.received) *slot.job->request.received += count;
}

size_t onBody(char* data, size_t, size_t count, void* user) {
  auto& slot = *static_cast<Slot*>(user);
  countReceived(slot, count);
  if (count > slot.job->request.maxBodyBytes - slot.response.body.size()) {
    slot.bodyTooLong = true;
    return 0;
  }
  slot.response.body.insert(slot.response.body.end(), data, data + count);
  return count;
}

size_t onHeader(char* data, size_t, size_t count, void* user) {
  auto& slot = *static_cast<Slot*>(user);
  countReceived(slot, count);
  slot.headerBytes += count;
  if (slot.headerBytes > slot.maxHeaderBytes) {
    slot.headersTooLong = true;
    return 0;
  }
  const std::string_view line(data, count);
  // A status line begins a message: what an interim answer (1xx) said does not count.
  if (line.starts_with("HTTP/")) slot.response.headers.clear();
  const size_t colon = line.find(':');
  if (colon != std::string_view::npos) {
    slot.response.headers.insert_or_assign(lowerCase(trimmed(line.substr(0, colon))),
                                           std::string(trimmed(line.substr(colon + 1))));
  }
  return count;
}

// curl's own counters mix headers and content; its debug stream tells them apart exactly.
int onTraffic(CURL*, curl_infotype type, char*, size_t count, void* user) {
  auto& slot = *static_cast<Slot*>(user);
  if (!slot.job) return 0;  // a kept connection is being closed
  Traffic& traffic = slot.job->traffic;
  if (type == CURLINFO_HEADER_OUT || type == CURLINFO_DATA_OUT) {
    traffic.bytesUp += count;
    slot.sentAt = Clock::now();
    slot.firstByteAt.reset();
  }
  if (type == CURLINFO_HEADER_IN) {
    traffic.headerBytesDown += count;
    if (!slot.firstByteAt) slot.firstByteAt = Clock::now();
  }
  if (type == CURLINFO_DATA_IN) traffic.bodyBytesDown += count;
  return 0;
}

bool isWorthRetrying(CURLcode code) {
  switch (code) {
    case CURLE_COULDNT_CONNECT:
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_RESOLVE_PROXY:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_GOT_NOTHING:
    case CURLE_PARTIAL_FILE:
    case CURLE_OPERATION_TIMEDOUT:
      return true;
    default:
      return false;
  }
}

bool isWorthRetrying(unsigned status) {
  return status == 408 || status == 429 || status == 500 || status == 502 || status == 503 ||
         status == 504;
}

std::chrono::milliseconds retryAfter(const FetchResponse& response) {
  const auto found = response.headers.find("retry-after");
  if (found == response.headers.end()) return {};
  unsigned seconds = 0;
  const std::string& text = found->second;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (code != std::errc() || end != text.data() + text.size()) return {};
  return std::chrono::seconds(std::min(seconds, 3600U));
}

std::string hostOf(const std::string& url) {
  const size_t begin = url.find("://") + 3;
  return url.substr(begin, url.find('/', begin) - begin);
}

bool isLoopback(const std::string& url) {
  const std::string host = hostOf(url);
  return host.starts_with("127.") || host.starts_with("[::1]") || host == "localhost" ||
         host.starts_with("localhost:");
}

void initializeCurl() {
  static const CURLcode kCode = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (kCode != CURLE_OK) throw std::runtime_error("libcurl cannot be initialised");
}

}  // namespace

class HttpFetcher::Loop {
 public:
  explicit Loop(HttpFetcherOptions options)
      : options_(std::move(options)), schedule_(options_.retry, std::random_device{}()) {
    initializeCurl();
    multi_ = curl_multi_init();
    if (multi_ == nullptr) throw std::runtime_error("libcurl gives no multi handle");
    const unsigned count = std::max(1U, options_.slots);
    curl_multi_setopt(multi_, CURLMOPT_MAXCONNECTS, static_cast<long>(count));
    for (unsigned i = 0; i < count; ++i) {
      Slot& slot = slots_.emplace_back();
      slot.easy = curl_easy_init();
      slot.maxHeaderBytes = options_.maxHeaderBytes;
      if (slot.easy == nullptr) throw std::runtime_error("libcurl gives no handle");
    }
    thread_ = std::thread([this] { run(); });
  }

  ~Loop() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    curl_multi_wakeup(multi_);
    thread_.join();
    for (Slot& slot : slots_) {
      if (slot.job) curl_multi_remove_handle(multi_, slot.easy);
      curl_easy_cleanup(slot.easy);
      curl_slist_free_all(slot.headers);
    }
    curl_multi_cleanup(multi_);
  }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  FetchId send(FetchRequest request, Completion completion) {
    Job job;
    job.id = ++lastId_;
    job.request = std::move(request);
    job.completion = std::move(completion);
    const FetchId id = job.id;
    {
      const std::lock_guard lock(mutex_);
      arrived_.push_back(std::move(job));
    }
    curl_multi_wakeup(multi_);
    return id;
  }

  void cancel(FetchId id) {
    {
      const std::lock_guard lock(mutex_);
      canceled_.insert(id);
    }
    curl_multi_wakeup(multi_);
  }

 private:
  void run() {
    while (takeMail()) {
      startWhatIsDue();
      int running = 0;
      curl_multi_perform(multi_, &running);
      int left = 0;
      bool finished = false;
      while (const CURLMsg* message = curl_multi_info_read(multi_, &left)) {
        if (message->msg != CURLMSG_DONE) continue;
        finish(message->easy_handle, message->data.result);
        finished = true;
      }
      if (!finished) curl_multi_poll(multi_, nullptr, 0, pollTimeout(), nullptr);
    }
  }

  // False: stop.
  bool takeMail() {
    std::unordered_set<FetchId> canceled;
    {
      const std::lock_guard lock(mutex_);
      if (stop_) return false;
      for (Job& job : arrived_) waiting_.push_back(std::move(job));
      arrived_.clear();
      canceled.swap(canceled_);
    }
    if (canceled.empty()) return true;
    std::erase_if(waiting_, [&](const Job& job) { return canceled.contains(job.id); });
    for (Slot& slot : slots_)
      if (slot.job && canceled.contains(slot.job->id)) release(slot);
    return true;
  }

  void startWhatIsDue() {
    const Clock::time_point now = Clock::now();
    for (auto job = waiting_.begin(); job != waiting_.end();) {
      if (job->due > now) {
        ++job;
        continue;
      }
      const auto slot = std::find_if(slots_.begin(), slots_.end(),
                                     [](const Slot& candidate) { return !candidate.job; });
      if (slot == slots_.end()) return;
      slot->job = std::move(*job);
      job = waiting_.erase(job);
      start(*slot);
    }
  }

  int pollTimeout() const {
    int timeout = 1'000;
    const Clock::time_point now = Clock::now();
    for (const Job& job : waiting_) {
      if (job.due <= now) continue;  // waits for a slot
      const auto wait = std::chrono::ceil<std::chrono::milliseconds>(job.due - now).count();
      timeout = std::min<int>(timeout, static_cast<int>(wait));
    }
    return timeout;
  }

  void start(Slot& slot) {
    const FetchRequest& request = slot.job->request;
    ++slot.job->attempts;
    ++slot.job->traffic.attempts;
    slot.response = {};
    slot.sentAt = Clock::now();
    slot.firstByteAt.reset();
    slot.headerBytes = 0;
    slot.bodyTooLong = slot.headersTooLong = false;

    CURL* easy = slot.easy;
    curl_easy_reset(easy);  // keeps connections
    curl_easy_setopt(easy, CURLOPT_URL, request.url.c_str());
    curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(easy, CURLOPT_PATH_AS_IS, 1L);
    curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, millis(options_.connectTimeout));
    curl_easy_setopt(easy, CURLOPT_TIMEOUT_MS, millis(options_.totalTimeout));
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(easy, CURLOPT_LOW_SPEED_TIME,
                     std::max(1L, millis(options_.stallTimeout) / 1'000));
    curl_easy_setopt(easy, CURLOPT_USERAGENT, options_.userAgent.c_str());
    if (isLoopback(request.url)) curl_easy_setopt(easy, CURLOPT_PROXY, "");
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, &onBody);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, &slot);
    curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, &onHeader);
    curl_easy_setopt(easy, CURLOPT_HEADERDATA, &slot);
    curl_easy_setopt(easy, CURLOPT_DEBUGFUNCTION, &onTraffic);
    curl_easy_setopt(easy, CURLOPT_DEBUGDATA, &slot);
    curl_easy_setopt(easy, CURLOPT_VERBOSE, 1L);

    curl_slist_free_all(slot.headers);
    slot.headers = curl_slist_append(nullptr, "Accept:");  // every octet up counts
    if (request.method == FetchRequest::Method::query) {
      curl_easy_setopt(easy, CURLOPT_CUSTOMREQUEST, "QUERY");
      curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE_LARGE,
                       static_cast<curl_off_t>(request.content.size()));
      curl_easy_setopt(easy, CURLOPT_POSTFIELDS, request.content.data());
      slot.headers =
          curl_slist_append(slot.headers, ("Content-Type: " + request.contentType).c_str());
      slot.headers = curl_slist_append(slot.headers, "Expect:");  // no round trip in front
    }
    if (request.bypassCaches)
      slot.headers = curl_slist_append(slot.headers, "Cache-Control: no-cache");
    curl_easy_setopt(easy, CURLOPT_HTTPHEADER, slot.headers);
    curl_multi_add_handle(multi_, easy);
  }

  void finish(CURL* easy, CURLcode code) {
    const auto slot = std::find_if(slots_.begin(), slots_.end(), [easy](const Slot& candidate) {
      return candidate.easy == easy;
    });
    long status = 0;
    curl_easy_getinfo(easy, CURLINFO_RESPONSE_CODE, &status);
    Job job = std::move(*slot->job);
    FetchResponse response = std::move(slot->response);
    response.timing = {slot->sentAt, slot->firstByteAt.value_or(Clock::now()), Clock::now()};
    release(*slot);

    response.status = static_cast<unsigned>(status);
    const bool again = code == CURLE_OK ? isWorthRetrying(response.status) : isWorthRetrying(code);
    if (again && schedule_.mayRetry(job.attempts)) {
      job.due = Clock::now() + schedule_.delay(job.attempts, retryAfter(response));
      waiting_.push_back(std::move(job));
      return;
    }
    if (code != CURLE_OK) {
      response.status = 0;
      response.body.clear();
      response.error = explain(*slot, job, code);
    }
    response.traffic = job.traffic;
    if (job.completion) job.completion(std::move(response));
  }

  Error explain(const Slot& slot, const Job& job, CURLcode code) const {
    const std::string host = hostOf(job.request.url);
    if (slot.bodyTooLong) {
      return {ErrorCode::tooLarge, host + " answers with more than the " +
                                       std::to_string(job.request.maxBodyBytes) +
                                       " octets that the request can need"};
    }
    if (slot.headersTooLong)
      return {ErrorCode::tooLarge, host + " answers with headers beyond all measure"};
    std::string message = "no answer from " + host + ": " + curl_easy_strerror(code);
    if (code == CURLE_COULDNT_CONNECT) message += "; is the service running there?";
    if (job.attempts > 1) message += " (after " + std::to_string(job.attempts) + " attempts)";
    return {ErrorCode::unavailable, std::move(message)};
  }

  void release(Slot& slot) {
    curl_multi_remove_handle(multi_, slot.easy);
    slot.job.reset();
  }

  static long millis(std::chrono::milliseconds duration) {
    return static_cast<long>(duration.count());
  }

  const HttpFetcherOptions options_;
  CURLM* multi_ = nullptr;
  std::atomic<FetchId> lastId_{0};

  std::mutex mutex_;  // guards the mailbox
  std::vector<Job> arrived_;
  std::unordered_set<FetchId> canceled_;
  bool stop_ = false;

  RetrySchedule schedule_;
  std::deque<Slot> slots_;
  std::deque<Job> waiting_;
  std::thread thread_;  // last: starts when everything else is there
};

HttpFetcher::HttpFetcher(HttpFetcherOptions options)
    : loop_(std::make_unique<Loop>(std::move(options))) {}
HttpFetcher::~HttpFetcher() = default;

FetchId HttpFetcher::send(FetchRequest request, Completion completion) {
  return loop_->send(std::move(request), std::move(completion));
}
void HttpFetcher::cancel(FetchId id) {
  loop_->cancel(id);
}

}  // namespace meshfront
