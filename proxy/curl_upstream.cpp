#include "proxy/curl_upstream.h"

#include <curl/curl.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace meshfront {
namespace {

struct Reception {
  std::vector<uint8_t> content;
  size_t maxBytes = 0;
  FetchMemory::Share memory;
  std::optional<tl::unexpected<Error>> refusal;

  [[nodiscard]] bool makeRoom(size_t bytes) {
    if (bytes > maxBytes - content.size()) {
      refusal = fail(ErrorCode::tooLarge, "upstream: more than was asked for");
    } else if (content.size() + bytes > content.capacity()) {
      const size_t room =
          std::min(std::max(2 * content.capacity(), content.size() + bytes), maxBytes);
      if (memory.take(room - content.capacity())) {
        content.reserve(room);
      } else {
        refusal = noFetchMemory();
      }
    }
    return !refusal;
  }
};

size_t receive(char* data, size_t size, size_t count, void* context) {
  auto& reception = *static_cast<Reception*>(context);
  const size_t bytes = size * count;
  if (!reception.makeRoom(bytes)) return 0;  // ends the transfer
  reception.content.insert(reception.content.end(), data, data + bytes);
  return bytes;
}

int stopRequested(void* context, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<const std::atomic<bool>*>(context)->load() ? 1 : 0;
}

// The last field of that name, or nothing.
std::string fieldOf(CURL* curl, const char* name) {
  curl_header* header = nullptr;
  if (curl_easy_header(curl, name, 0, CURLH_HEADER, -1, &header) != CURLHE_OK) return {};
  if (header->amount > 1)
    static_cast<void>(curl_easy_header(curl, name, header->amount - 1, CURLH_HEADER, -1, &header));
  return header->value;
}

}  // namespace

struct CurlUpstream::Handle {
  Handle() : curl(curl_easy_init()) {}
  ~Handle() {
    curl_slist_free_all(fields);
    if (curl != nullptr) curl_easy_cleanup(curl);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  void addField(const std::string& line) { fields = curl_slist_append(fields, line.c_str()); }
  void reset() {
    curl_easy_reset(curl);  // connections stay
    curl_slist_free_all(fields);
    fields = nullptr;
  }
  CURL* curl;
  curl_slist* fields = nullptr;
};

CurlUpstream::CurlUpstream(Options options) : options_(std::move(options)) {}
CurlUpstream::~CurlUpstream() = default;

Result<std::unique_ptr<CurlUpstream>> CurlUpstream::make(Options options) {
  static const CURLcode kReady = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (kReady != CURLE_OK) return fail(ErrorCode::unavailable, "libcurl cannot be initialised");
  while (!options.url.empty() && options.url.back() == '/') options.url.pop_back();
  const std::string& url = options.url;
  if (!(url.starts_with("http://") && url.size() > 7) &&
      !(url.starts_with("https://") && url.size() > 8))
    return fail("upstream \"" + url + "\": must be http://HOST:PORT or https://HOST");
  if (url.find_first_of("?# \r\n") != std::string::npos)
    return fail("upstream \"" + url + "\": must end with the host or a path");
  return std::unique_ptr<CurlUpstream>(new CurlUpstream(std::move(options)));
}

std::unique_ptr<CurlUpstream::Handle> CurlUpstream::take() {
  const std::scoped_lock lock(mutex_);
  if (idle_.empty()) return std::make_unique<Handle>();
  auto handle = std::move(idle_.back());
  idle_.pop_back();
  return handle;
}

void CurlUpstream::giveBack(std::unique_ptr<Handle> handle) {
  handle->reset();
  const std::scoped_lock lock(mutex_);
  idle_.push_back(std::move(handle));
}

// It goes into answers of this proxy's own, so nothing but what such a field may hold.
void CurlUpstream::noteVia(const std::string& via) {
  constexpr size_t kMostOctets = 256;
  const bool isPlain =
      std::all_of(via.begin(), via.end(), [](char c) { return c >= ' ' && c <= '~'; });
  const std::string value = isPlain && via.size() <= kMostOctets ? via : std::string();
  const auto known = via_.load();
  if ((known ? *known : std::string()) != value)
    via_.store(std::make_shared<const std::string>(value));
}

Result<UpstreamResponse> CurlUpstream::send(const UpstreamRequest& request) {
  if (stopping_) return fail(ErrorCode::unavailable, "the proxy is ending");
  auto handle = take();
  CURL* curl = handle->curl;
  if (curl == nullptr) return fail(ErrorCode::unavailable, "libcurl gave no handle");
  Reception reception;
  reception.maxBytes = request.maxBytes;
  if (request.memory != nullptr) reception.memory = request.memory->share();
  const std::string url = options_.url + request.target;
  curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_PATH_AS_IS, 1L);
  curl_easy_setopt(curl, CURLOPT_NOPROXY, "*");  // the upstream is what the operator named
  curl_easy_setopt(curl, CURLOPT_HTTP_VERSION, CURL_HTTP_VERSION_1_1);
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_TCP_NODELAY, 1L);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS,
                   static_cast<long>(options_.connectTimeout.count()));
  curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, static_cast<long>(options_.timeout.count()));
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &receive);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &reception);
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, &stopRequested);
  curl_easy_setopt(curl, CURLOPT_XFERINFODATA, &stopping_);
  if (!options_.via.empty()) handle->addField("Via: " + options_.via);
  if (!request.ifNoneMatch.empty()) handle->addField("If-None-Match: " + request.ifNoneMatch);
  if (request.query) {
    handle->addField("Content-Type: application/octet-stream");
    handle->addField("Expect:");
    curl_easy_setopt(curl, CURLOPT_POST, 1L);
    curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, "QUERY");
    curl_easy_setopt(curl, CURLOPT_POSTFIELDS, request.content.data());
    curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE,
                     static_cast<curl_off_t>(request.content.size()));
  }
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, handle->fields);

  const CURLcode status = curl_easy_perform(curl);
  if (status != CURLE_OK) {
    giveBack(std::move(handle));
    if (reception.refusal) return *reception.refusal;
    const ErrorCode code =
        status == CURLE_OPERATION_TIMEDOUT ? ErrorCode::timedOut : ErrorCode::unavailable;
    return fail(code, std::string("upstream: ") + curl_easy_strerror(status));
  }
  UpstreamResponse response;
  long httpStatus = 0;
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &httpStatus);
  response.status = static_cast<unsigned>(httpStatus);
  response.etag = fieldOf(curl, "ETag");
  response.cacheControl = fieldOf(curl, "Cache-Control");
  noteVia(fieldOf(curl, "Via"));
  response.age = ageOf(fieldOf(curl, "Age"));
  response.content = std::move(reception.content);
  response.memory = std::move(reception.memory);
  giveBack(std::move(handle));
  return response;
}

}  // namespace meshfront
