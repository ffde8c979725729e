#include "shared/http/http_front.h"

#include <microhttpd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "shared/http/connection_watch.h"
#include "shared/http/front_metrics.h"
#include "shared/http/problem.h"
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
constexpr size_t kDescriptorsKept = 128;  // for files, upstream connections and the epoll sets
using Phase = ConnectionWatch::Phase;
using Clock = std::chrono::steady_clock;

constexpr unsigned kRequestTimeout = 408;       // in the log, where a request was cut
constexpr unsigned kClientClosedRequest = 499;  // in the log, as other servers write it
constexpr std::chrono::seconds kGrace(3);       // for what is under way when the server ends

// One request, from its first line until its response has been sent.
struct Exchange {
  std::string target;
  std::string method;
  std::string ifNoneMatch;
  std::string contentType;
  std::vector<uint8_t> content;
  size_t expected = 0;  // octets of content: as announced, or the most that is kept
  uint64_t contentSeen = 0;
  bool started = false;
  bool tooLarge = false;
  bool version10 = false;
  Refusal refusal = Refusal::none;
  ConnectionWatch::Connection* connection = nullptr;
  Clock::time_point began = Clock::now();
  size_t held = 0;                       // octets taken of what may be in flight
  unsigned status = 0;                   // once the response is queued
  uint64_t answerSize = 0;               // likewise: octets of content to be sent
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

MHD_Result queue(MHD_Connection* connection, Exchange& exchange, HttpResponse response) {
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
  exchange.status = response.status;
  exchange.answerSize =
      response.status == MHD_HTTP_NOT_MODIFIED || exchange.method == "HEAD" ? 0 : bytes.size();
  const MHD_Result result = MHD_queue_response(connection, response.status, out);
  MHD_destroy_response(out);
  return result;
}

HttpResponse refusalResponse(Refusal refusal, const ServerLimits& limits) {
  HttpResponse response;
  switch (refusal) {
    case Refusal::header:
      response = problem(431, "the request's fields are longer than " +
                                  std::to_string(limits.maxHeader) + " octets");
      break;
    case Refusal::address:
      response = problem(429, "too many connections from this address; use fewer of them");
      break;
    default:
      response = problem(503, "the server is busy; try again later");
      break;
  }
  if (refusal != Refusal::header) response.set("Retry-After", "2");
  if (refusal != Refusal::memory) response.set("Connection", "close");
  response.set("Access-Control-Allow-Origin", "*");
  return response;
}

// The limits with as many connections as the system has descriptors for, those included that are
// only refused.
ServerLimits grantedLimits(ServerLimits limits) {
  rlimit system{};
  if (getrlimit(RLIMIT_NOFILE, &system) != 0) return limits;
  system.rlim_cur = system.rlim_max;
  setrlimit(RLIMIT_NOFILE, &system);
  getrlimit(RLIMIT_NOFILE, &system);
  const size_t all = system.rlim_cur;
  const size_t granted = all > 2 * kDescriptorsKept ? all - kDescriptorsKept : all / 2;
  if (limits.maxConnections + refusedAtMost(limits.maxConnections) > granted)
    limits.maxConnections = std::max<size_t>(granted - std::min<size_t>(granted / 4, 1024), 1);
  return limits;
}

}  // namespace

struct HttpFront::Server {
  HttpHandler& handler;
  const Options options;
  const ServerLimits limits;
  std::optional<WorkerPool> workers;
  MHD_Daemon* daemon = nullptr;
  std::optional<Metrics> ownMetrics;  // where nobody wants to see them
  const std::shared_ptr<InFlight> inFlight;
  FrontMetrics metrics;
  ConnectionWatch watch;
  std::mutex mutex;
  std::condition_variable ended;
  std::atomic<bool> ending = false;

  Server(HttpHandler& h, const Options& o)
      : handler(h),
        options(o),
        limits(grantedLimits(o.limits)),
        inFlight(std::make_shared<InFlight>(o.limits.memoryInFlight)),
        metrics(o.metrics != nullptr ? *o.metrics : ownMetrics.emplace(), inFlight),
        watch(limits, [this](const ConnectionWatch::Connection& connection, Phase phase) {
          noteCut(connection, phase);
        }) {
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
      ending = true;
      std::unique_lock lock(mutex);
      ended.wait_for(lock, kGrace, [this] { return inFlight->requests == 0; });
    }
    MHD_stop_daemon(daemon);
    if (listener != MHD_INVALID_SOCKET) ::close(listener);
  }

  MHD_Result receive(MHD_Connection* connection, Exchange& exchange, size_t* contentSize,
                     const char* content) {
    if (exchange.answered.load(std::memory_order_acquire)) {
      // A daemon that is being stopped takes a response, drops it and asks again.
      if (!exchange.response) return MHD_NO;
      return queue(connection, exchange, *std::exchange(exchange.response, {}));
    }
    if (!exchange.started) return start(connection, exchange);
    if (*contentSize > 0) {
      const size_t size = std::exchange(*contentSize, 0);
      return keep(exchange, content, size) ? MHD_YES : MHD_NO;
    }
    return respond(connection, exchange);
  }

  // All fields are there.
  MHD_Result start(MHD_Connection* connection, Exchange& exchange) {
    exchange.started = true;
    MHD_get_connection_values(connection, MHD_HEADER_KIND, &readField, &exchange);
    exchange.refusal = refusalOf(connection, exchange);
    const uint64_t announced = announcedContent(connection);
    exchange.tooLarge = announced > limits.maxContent;
    exchange.expected =
        std::min<uint64_t>(announced > 0 ? announced : limits.maxContent, limits.maxContent);
    if (announced > 0 && !exchange.connection->enter(Phase::content)) return MHD_NO;
    return announced > kMaxDroppedContent ? respond(connection, exchange) : MHD_YES;
  }

  Refusal refusalOf(MHD_Connection* connection, const Exchange& exchange) const {
    switch (exchange.connection->admission()) {
      case ConnectionWatch::Admission::tooMany:
        return Refusal::connections;
      case ConnectionWatch::Admission::tooManyFromAddress:
        return Refusal::address;
      case ConnectionWatch::Admission::granted:
        break;
    }
    const MHD_ConnectionInfo* info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE);
    // A long target is for the handler to refuse.
    return info != nullptr && info->header_size > limits.maxHeader + exchange.target.size()
               ? Refusal::header
               : Refusal::none;
  }

  // Content beyond the limits is read and dropped. False: no more of it.
  bool keep(Exchange& exchange, const char* content, size_t size) {
    if (exchange.contentSeen == 0 && !exchange.connection->enter(Phase::content)) return false;
    exchange.contentSeen += size;
    if (exchange.contentSeen > kMaxDroppedContent) return false;
    if (exchange.contentSeen > limits.maxContent) exchange.tooLarge = true;
    if (!exchange.tooLarge && exchange.refusal == Refusal::none) {
      if (makeRoom(exchange, size))
        exchange.content.insert(exchange.content.end(), content, content + size);
      else
        exchange.refusal = Refusal::memory;
    }
    if (exchange.tooLarge || exchange.refusal != Refusal::none) exchange.content = {};
    return true;
  }

  // For `size` more octets of content; what is allocated counts.
  bool makeRoom(Exchange& exchange, size_t size) {
    std::vector<uint8_t>& held = exchange.content;
    const size_t needed = held.size() + size;
    if (needed <= held.capacity()) return true;
    const size_t capacity = std::max(needed, std::min(2 * held.capacity(), exchange.expected));
    if (!inFlight->take(capacity - held.capacity())) return false;
    exchange.held += capacity - held.capacity();
    held.reserve(capacity);
    return true;
  }

  MHD_Result respond(MHD_Connection* connection, Exchange& exchange) {
    if (!exchange.connection->enter(Phase::answer)) return MHD_NO;
    if (exchange.refusal != Refusal::none) return queue(connection, exchange, refuse(exchange));
    if (!workers)
      return queue(connection, exchange, admit(exchange, handler.answer(exchange.request())));
    if (auto response = handler.answerAtOnce(exchange.request()))
      return queue(connection, exchange, admit(exchange, std::move(*response)));
    MHD_suspend_connection(connection);
    const bool taken = workers->submit([this, connection, &exchange] {
      exchange.response = admit(exchange, handler.answer(exchange.request()));
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

  HttpResponse refuse(const Exchange& exchange) {
    metrics.refused(exchange.refusal).add();
    return refusalResponse(exchange.refusal, limits);
  }

  // The response, or a refusal where its content does not fit into the memory of all answers.
  HttpResponse admit(Exchange& exchange, HttpResponse response) {
    const size_t size = response.content.size();
    if (inFlight->take(size)) {
      exchange.held += size;
      return response;
    }
    exchange.refusal = Refusal::memory;
    return refuse(exchange);
  }

  // The last of a request, whether it was answered or not.
  void complete(Exchange& exchange, bool whole) {
    const bool cut = !exchange.connection->enter(Phase::idle);
    inFlight->giveBack(exchange.held);
    if (!whole) metrics.unfinished.add();
    if (exchange.status == 0) exchange.status = cut ? kRequestTimeout : kClientClosedRequest;
    const Clock::duration duration = Clock::now() - exchange.began;
    metrics.requestSeconds.observe(duration);
    if (options.accessLog == nullptr) return;
    options.accessLog->add({.address = exchange.connection->address(),
                            .method = exchange.method,
                            .target = exchange.target,
                            .version10 = exchange.version10,
                            .status = exchange.status,
                            .bytes = exchange.answerSize,
                            .seconds = std::chrono::duration<double>(duration).count(),
                            .whole = whole});
  }

  // From the watch. Where a request has got beyond its first line, complete() logs it.
  void noteCut(const ConnectionWatch::Connection& connection, Phase phase) {
    metrics.cut(phase).add();
    if (options.accessLog != nullptr && phase == Phase::line)
      options.accessLog->add({.address = connection.address(),
                              .method = {},
                              .target = {},
                              .status = kRequestTimeout,
                              .seconds = limits.headerTimeout});
  }

  // --- what libmicrohttpd calls ---
  static void onConnection(void* self, MHD_Connection* connection, void** context,
                           MHD_ConnectionNotificationCode what) {
    auto& server = *static_cast<Server*>(self);
    if (what == MHD_CONNECTION_NOTIFY_CLOSED) {
      server.inFlight->connections.fetch_sub(1);
      server.watch.close(static_cast<ConnectionWatch::Connection*>(*context));
      return;
    }
    server.inFlight->connections.fetch_add(1);
    server.metrics.connections.add();
    const auto* socket = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    const auto* peer = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    *context = server.watch.open(socket->connect_fd, peer != nullptr ? peer->client_addr : nullptr);
  }
  static void* onTarget(void* self, const char* target, MHD_Connection* connection) {
    auto* exchange = new Exchange;
    exchange->target = target;
    const auto* context = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    exchange->connection = static_cast<ConnectionWatch::Connection*>(context->socket_context);
    (void)exchange->connection->enter(Phase::header);  // respond() asks again
    static_cast<Server*>(self)->inFlight->requests.fetch_add(1);
    return exchange;
  }
  static MHD_Result onRequest(void* self, MHD_Connection* connection, const char*,
                              const char* method, const char* version, const char* content,
                              size_t* contentSize, void** closure) {
    auto& exchange = *static_cast<Exchange*>(*closure);
    if (!exchange.started) {
      exchange.method = method;
      exchange.version10 = std::strcmp(version, MHD_HTTP_VERSION_1_0) == 0;
    }
    return static_cast<Server*>(self)->receive(connection, exchange, contentSize, content);
  }
  static void onCompleted(void* self, MHD_Connection*, void** closure,
                          MHD_RequestTerminationCode reason) {
    auto* exchange = static_cast<Exchange*>(*closure);
    if (exchange == nullptr) return;
    auto& server = *static_cast<Server*>(self);
    // A daemon that stops completes what a worker has answered without asking for it again.
    (void)exchange->answered.load(std::memory_order_acquire);
    server.complete(*exchange, reason == MHD_REQUEST_TERMINATED_COMPLETED_OK);
    delete exchange;
    *closure = nullptr;
    // Whoever waits for the last one holds the lock while it counts.
    if (server.inFlight->requests.fetch_sub(1) == 1 && server.ending) {
      const std::scoped_lock lock(server.mutex);
      server.ended.notify_all();
    }
  }
};

HttpFront::HttpFront(std::unique_ptr<Server> server) : server_(std::move(server)) {}
HttpFront::~HttpFront() = default;

Result<std::unique_ptr<HttpFront>> HttpFront::start(HttpHandler& handler, const Options& options) {
  auto server = std::make_unique<Server>(handler, options);
  const ServerLimits& limits = server->limits;
  const size_t connections = std::max<size_t>(
      limits.maxConnections + refusedAtMost(limits.maxConnections), options.threads);
  std::vector<MHD_OptionItem> items{
      {MHD_OPTION_CONNECTION_MEMORY_LIMIT, static_cast<intptr_t>(kConnectionMemory), nullptr},
      {MHD_OPTION_CONNECTION_LIMIT, static_cast<intptr_t>(connections), nullptr},
      {MHD_OPTION_CONNECTION_TIMEOUT, static_cast<intptr_t>(std::ceil(limits.idleTimeout)),
       nullptr},
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
      &Server::onCompleted, server.get(), MHD_OPTION_NOTIFY_CONNECTION, &Server::onConnection,
      server.get(), MHD_OPTION_SOCK_ADDR, &options.address.socketAddress, MHD_OPTION_ARRAY,
      items.data(), MHD_OPTION_END);
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

size_t HttpFront::maxConnections() const {
  return server_->limits.maxConnections;
}

}  // namespace meshfront
