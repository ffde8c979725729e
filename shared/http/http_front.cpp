#include "shared/http/http_front.h"

#include <microhttpd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "shared/http/worker_pool.h"

namespace meshfront {
namespace {

// A request's line and fields must fit with the response's, so that a URL that is too long gets our
// own answer; the library's speaks no problem+json.
constexpr size_t kConnectionMemory = 128 * 1024;
// Content beyond the limit is read and dropped up to here: a client that does not read before it
// has written would otherwise see a reset instead of the answer.
constexpr uint64_t kMaxDroppedContent = uint64_t{16} << 20;
constexpr unsigned kBacklog = 1024;
constexpr unsigned kMaxConnections = 16384;
constexpr unsigned kDescriptorsKept = 128;  // for files, upstream connections and the epoll sets
constexpr std::chrono::seconds kGrace(3);   // for what is under way when the server ends

// One request, from its first line until its response has been sent.
struct Exchange {
  std::string target;
  std::string method;
  std::string ifNoneMatch;
  std::string contentType;
  std::vector<uint8_t> content;
  uint64_t contentSeen = 0;
  bool started = false;
  bool tooLarge = false;
  std::optional<HttpResponse> response;  // set by a worker, which then sets `answered`
  std::atomic<bool> answered = false;    // hands the response over to the connection's thread

  [[nodiscard]] HttpRequest request() const {
    return {method, target, ifNoneMatch, contentType, content, tooLarge};
  }
};

bool sameName(const char* a, const char* b) {
  return ::strcasecmp(a, b) == 0;
}

MHD_Result readField(void* context, MHD_ValueKind, const char* name, const char* value) {
  auto& exchange = *static_cast<Exchange*>(context);
  if (name == nullptr || value == nullptr) return MHD_YES;
  if (sameName(name, MHD_HTTP_HEADER_IF_NONE_MATCH)) {
    if (!exchange.ifNoneMatch.empty()) exchange.ifNoneMatch += ", ";
    exchange.ifNoneMatch += value;
  } else if (sameName(name, MHD_HTTP_HEADER_CONTENT_TYPE)) {
    exchange.contentType = value;
  }
  return MHD_YES;
}

uint64_t announcedContent(MHD_Connection* connection) {
  const char* text =
      MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_CONTENT_LENGTH);
  if (text == nullptr) return 0;
  uint64_t length = 0;
  const auto [end, error] = std::from_chars(text, text + std::strlen(text), length);
  return error == std::errc() ? length : UINT64_MAX;
}

MHD_Result queue(MHD_Connection* connection, HttpResponse response) {
  auto* owner = new HeldBytes(std::move(response.content));
  const std::span<const uint8_t> bytes = owner->bytes();
  MHD_Response* out = MHD_create_response_from_buffer_with_free_callback_cls(
      bytes.size(), const_cast<uint8_t*>(bytes.data()),
      [](void* held) { delete static_cast<HeldBytes*>(held); }, owner);
  if (out == nullptr) {
    delete owner;
    return MHD_NO;
  }
  for (const auto& [name, value] : response.headers)
    MHD_add_response_header(out, name, value.c_str());
  const MHD_Result result = MHD_queue_response(connection, response.status, out);
  MHD_destroy_response(out);
  return result;
}

unsigned connectionLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 512;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
  getrlimit(RLIMIT_NOFILE, &limit);
  const auto most = std::min<rlim_t>(limit.rlim_cur, kMaxConnections + kDescriptorsKept);
  return static_cast<unsigned>(most > 2 * kDescriptorsKept ? most - kDescriptorsKept : most / 2);
}

}  // namespace

struct HttpFront::Server {
  HttpHandler& handler;
  const Options options;
  std::optional<WorkerPool> workers;
  MHD_Daemon* daemon = nullptr;
  std::mutex mutex;
  std::condition_variable ended;
  size_t underWay = 0;  // exchanges; guarded by `mutex`

  Server(HttpHandler& h, const Options& o) : handler(h), options(o) {
    if (options.waitingThreads > 0)
      workers.emplace(options.waitingThreads, options.maxWaitingRequests);
  }

  ~Server() {
    if (daemon == nullptr) return;
    const MHD_socket listener = MHD_quiesce_daemon(daemon);
    // Every suspended connection is resumed by its worker; only then the daemon may stop, which
    // drops what has not been sent.
    if (workers) workers->finish();
    {
      std::unique_lock lock(mutex);
      ended.wait_for(lock, kGrace, [this] { return underWay == 0; });
    }
    MHD_stop_daemon(daemon);
    if (listener != MHD_INVALID_SOCKET) ::close(listener);
  }

  MHD_Result receive(MHD_Connection* connection, Exchange& exchange, const char* method,
                     size_t* contentSize, const char* content) {
    if (exchange.answered.load(std::memory_order_acquire)) {
      // A daemon that is being stopped takes a response, drops it and asks again.
      if (!exchange.response) return MHD_NO;
      return queue(connection, *std::exchange(exchange.response, {}));
    }
    if (!exchange.started) {
      exchange.started = true;
      exchange.method = method;
      MHD_get_connection_values(connection, MHD_HEADER_KIND, &readField, &exchange);
      const uint64_t announced = announcedContent(connection);
      exchange.tooLarge = announced > options.maxContentBytes;
      return announced > kMaxDroppedContent ? respond(connection, exchange) : MHD_YES;
    }
    if (*contentSize > 0) {
      exchange.contentSeen += *contentSize;
      if (exchange.contentSeen > kMaxDroppedContent) return MHD_NO;
      if (exchange.contentSeen > options.maxContentBytes) {
        exchange.tooLarge = true;
        exchange.content = {};
      }
      if (!exchange.tooLarge)
        exchange.content.insert(exchange.content.end(), content, content + *contentSize);
      *contentSize = 0;
      return MHD_YES;
    }
    return respond(connection, exchange);
  }

  MHD_Result respond(MHD_Connection* connection, Exchange& exchange) {
    if (!workers) return queue(connection, handler.answer(exchange.request()));
    if (auto response = handler.answerAtOnce(exchange.request()))
      return queue(connection, std::move(*response));
    MHD_suspend_connection(connection);
    const bool taken = workers->submit([this, connection, &exchange] {
      exchange.response = handler.answer(exchange.request());
      exchange.answered.store(true, std::memory_order_release);
      MHD_resume_connection(connection);
    });
    if (!taken) {
      exchange.response = handler.overloaded(exchange.request());
      exchange.answered.store(true, std::memory_order_release);
      MHD_resume_connection(connection);
    }
    return MHD_YES;
  }

  // --- what libmicrohttpd calls ---
  static void* onTarget(void* self, const char* target, MHD_Connection*) {
    auto* exchange = new Exchange;
    exchange->target = target;
    auto& server = *static_cast<Server*>(self);
    const std::scoped_lock lock(server.mutex);
    ++server.underWay;
    return exchange;
  }
  static MHD_Result onRequest(void* self, MHD_Connection* connection, const char*,
                              const char* method, const char*, const char* content,
                              size_t* contentSize, void** exchange) {
    return static_cast<Server*>(self)->receive(connection, *static_cast<Exchange*>(*exchange),
                                               method, contentSize, content);
  }
  static void onCompleted(void* self, MHD_Connection*, void** closure, MHD_RequestTerminationCode) {
    const auto* exchange = static_cast<Exchange*>(*closure);
    if (exchange == nullptr) return;
    // A daemon that stops completes what a worker has answered without asking for it again.
    (void)exchange->answered.load(std::memory_order_acquire);
    delete exchange;
    *closure = nullptr;
    auto& server = *static_cast<Server*>(self);
    const std::scoped_lock lock(server.mutex);
    if (--server.underWay == 0) server.ended.notify_all();
  }
};

HttpFront::HttpFront(std::unique_ptr<Server> server) : server_(std::move(server)) {}
HttpFront::~HttpFront() = default;

Result<std::unique_ptr<HttpFront>> HttpFront::start(HttpHandler& handler, const Options& options) {
  auto server = std::make_unique<Server>(handler, options);
  const unsigned connections = connectionLimit();
  std::vector<MHD_OptionItem> items{
      {MHD_OPTION_CONNECTION_MEMORY_LIMIT, static_cast<intptr_t>(kConnectionMemory), nullptr},
      {MHD_OPTION_CONNECTION_LIMIT, static_cast<intptr_t>(connections), nullptr},
      {MHD_OPTION_CONNECTION_TIMEOUT, static_cast<intptr_t>(options.idleSeconds), nullptr},
      {MHD_OPTION_LISTEN_BACKLOG_SIZE, static_cast<intptr_t>(kBacklog), nullptr},
  };
  if (options.threads > 1)
    items.push_back({MHD_OPTION_THREAD_POOL_SIZE, static_cast<intptr_t>(options.threads), nullptr});
  items.push_back({MHD_OPTION_END, 0, nullptr});

  unsigned flags = MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME;
  if (options.address.socketAddress.ss_family == AF_INET6) flags |= MHD_USE_IPv6;
  server->daemon = MHD_start_daemon(
      flags, options.address.port, nullptr, nullptr, &Server::onRequest, server.get(),
      MHD_OPTION_URI_LOG_CALLBACK, &Server::onTarget, server.get(), MHD_OPTION_NOTIFY_COMPLETED,
      &Server::onCompleted, server.get(), MHD_OPTION_SOCK_ADDR, &options.address.socketAddress,
      MHD_OPTION_ARRAY, items.data(), MHD_OPTION_END);
  if (server->daemon == nullptr)
    return fail(ErrorCode::unavailable, "cannot listen on " + options.address.host + ":" +
                                            std::to_string(options.address.port) +
                                            "; is the port taken?");
  return std::unique_ptr<HttpFront>(new HttpFront(std::move(server)));
}

uint16_t HttpFront::port() const {
  const MHD_DaemonInfo* info = MHD_get_daemon_info(server_->daemon, MHD_DAEMON_INFO_BIND_PORT);
  return info == nullptr ? 0 : info->port;
}

}  // namespace meshfront
