#include "shared/http/server/http_front.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <vector>

#include "shared/http/server/event_loop.h"

namespace meshfront {
namespace {

constexpr int kBacklog = 4096;
constexpr size_t kDescriptorsKept = 128;   // for files, upstream connections and the epoll sets
constexpr std::chrono::seconds kGrace(3);  // for what is under way when the server ends

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

class ListeningSocket {
 public:
  ListeningSocket() = default;
  ~ListeningSocket() {
    if (socket_ >= 0) ::close(socket_);
  }
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;

  // False: errno says why.
  [[nodiscard]] bool listen(const sockaddr_storage& address) {
    const bool sixth = address.ss_family == AF_INET6;
    socket_ = ::socket(address.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) return false;
    set(SOL_SOCKET, SO_REUSEADDR);
    if (sixth) set(IPPROTO_IPV6, IPV6_V6ONLY);
    set(IPPROTO_TCP, TCP_NODELAY);  // accepted ones inherit it
    return ::bind(socket_, reinterpret_cast<const sockaddr*>(&address),
                  sixth ? sizeof(sockaddr_in6) : sizeof(sockaddr_in)) == 0 &&
           ::listen(socket_, kBacklog) == 0;
  }
  void refuseFromNowOn() const { ::shutdown(socket_, SHUT_RDWR); }
  [[nodiscard]] int descriptor() const { return socket_; }
  [[nodiscard]] uint16_t port() const {
    sockaddr_storage own{};
    socklen_t length = sizeof own;
    if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &length) != 0) return 0;
    return ntohs(own.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(own).sin6_port
                                           : reinterpret_cast<const sockaddr_in&>(own).sin_port);
  }

 private:
  void set(int level, int option) const {
    const int on = 1;
    ::setsockopt(socket_, level, option, &on, sizeof on);
  }
  int socket_ = -1;
};

}  // namespace

struct HttpFront::Server {
  const std::shared_ptr<InFlight> inFlight;
  std::optional<Metrics> ownMetrics;  // where nobody wants to see them
  Serving serving;
  ListeningSocket listener;
  std::vector<std::unique_ptr<EventLoop>> loops;

  Server(HttpHandler& handler, const Options& options, const ServerLimits& limits)
      : inFlight(std::make_shared<InFlight>(limits.memoryInFlight)),
        serving{.handler = handler,
                .limits = limits,
                .inFlight = *inFlight,
                .metrics = FrontMetrics(
                    options.metrics != nullptr ? *options.metrics : ownMetrics.emplace(), inFlight),
                .addresses = AddressCount(limits),
                .accessLog = options.accessLog} {
    if (options.waitingThreads > 0)
      serving.workers.emplace(options.waitingThreads, options.maxWaitingRequests);
  }

  ~Server() {
    serving.ending = true;
    listener.refuseFromNowOn();
    for (const auto& loop : loops) loop->wake();
    // All answers that are being made are posted; the loops send them.
    if (serving.workers) serving.workers->finish();
    {
      std::unique_lock lock(serving.mutex);
      serving.ended.wait_for(lock, kGrace, [this] { return inFlight->requests == 0; });
    }
    loops.clear();
  }
};

HttpFront::HttpFront(std::unique_ptr<Server> server) : server_(std::move(server)) {}
HttpFront::~HttpFront() = default;

Result<std::unique_ptr<HttpFront>> HttpFront::start(HttpHandler& handler, const Options& options) {
  auto server = std::make_unique<Server>(handler, options, grantedLimits(options.limits));
  const ListenAddress& address = options.address;
  if (!server->listener.listen(address.socketAddress))
    return fail(ErrorCode::unavailable, "cannot listen on " + address.host + ":" +
                                            std::to_string(address.port) + ": " +
                                            std::strerror(errno) + "; is the port taken?");
  for (unsigned i = 0; i < std::max(options.threads, 1U); ++i) {
    auto loop = EventLoop::start(server->serving, server->listener.descriptor());
    if (!loop) return tl::unexpected(loop.error());
    server->loops.push_back(std::move(*loop));
  }
  return std::unique_ptr<HttpFront>(new HttpFront(std::move(server)));
}

uint16_t HttpFront::port() const {
  return server_->listener.port();
}

size_t HttpFront::maxConnections() const {
  return server_->serving.limits.maxConnections;
}

}  // namespace meshfront
