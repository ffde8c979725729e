#include "shared/http/server/event_loop.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace meshfront {
namespace {

constexpr size_t kBuffer = size_t{64} << 10;
constexpr int kAcceptedATurn = 32;
constexpr int kTurns = 64;  // of connections that have more to read, between two looks at all
constexpr int64_t kAcceptPause = 100;  // ms, where descriptors or places have run out

int64_t coarseMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC_COARSE, &time);
  return int64_t{time.tv_sec} * 1000 + time.tv_nsec / 1'000'000;
}

int64_t inMilliseconds(double seconds) {
  return static_cast<int64_t>(seconds * 1000);
}

bool watch(int epoll, int descriptor, uint32_t events, void* owner) {
  epoll_event event{};
  event.events = events;
  event.data.ptr = owner;
  return ::epoll_ctl(epoll, EPOLL_CTL_ADD, descriptor, &event) == 0;
}

}  // namespace

EventLoop::EventLoop(Serving& serving, int listener, int epoll, int wakeup)
    : serving_(serving),
      listener_(listener),
      epoll_(epoll),
      wakeup_(wakeup),
      buffer_(kBuffer),
      now_(coarseMilliseconds()),
      deadlines_{DeadlineList(inMilliseconds(serving.limits.headerTimeout)),
                 DeadlineList(inMilliseconds(serving.limits.contentTimeout)),
                 DeadlineList(inMilliseconds(serving.limits.answerTimeout)),
                 DeadlineList(inMilliseconds(serving.limits.idleTimeout)), DeadlineList(0)} {}

Result<std::unique_ptr<EventLoop>> EventLoop::start(Serving& serving, int listener) {
  const int epoll = ::epoll_create1(EPOLL_CLOEXEC);
  const int wakeup = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  std::unique_ptr<EventLoop> loop(new EventLoop(serving, listener, epoll, wakeup));
  if (epoll < 0 || wakeup < 0 || !watch(epoll, wakeup, EPOLLIN, &loop->posts_))
    return fail(ErrorCode::unavailable,
                std::string("cannot wait for connections: ") + std::strerror(errno));
  loop->setAccepting(true);
  loop->thread_ = std::thread([&loop = *loop] { loop.run(); });
  return loop;
}

EventLoop::~EventLoop() {
  stopping_ = true;
  wake();
  if (thread_.joinable()) thread_.join();
  connections_.clear();
  if (epoll_ >= 0) ::close(epoll_);
  if (wakeup_ >= 0) ::close(wakeup_);
}

void EventLoop::wake() const {
  const uint64_t one = 1;
  (void)!::write(wakeup_, &one, sizeof one);
}

void EventLoop::post(std::shared_ptr<Exchange> exchange) {
  bool first = false;
  {
    const std::scoped_lock lock(postMutex_);
    first = posts_.empty();
    posts_.push_back(std::move(exchange));
  }
  if (first) wake();
}

const std::string& EventLoop::dateField() {
  return date_.text(std::time(nullptr));
}

void EventLoop::run() {
  while (!stopping_) turn();
}

void EventLoop::turn() {
  std::array<epoll_event, 256> events{};
  const int count = ::epoll_wait(epoll_, events.data(), static_cast<int>(events.size()), timeout());
  now_ = coarseMilliseconds();
  bool clients = false;
  for (int i = 0; i < count; ++i) {
    const epoll_event& event = events[static_cast<size_t>(i)];
    if (event.data.ptr == &listener_) {
      clients = true;
    } else if (event.data.ptr == &posts_) {
      uint64_t ignored = 0;
      (void)!::read(wakeup_, &ignored, sizeof ignored);
    } else {
      auto& connection = *static_cast<Connection*>(event.data.ptr);
      keepOrEnd(connection, connection.ready(event.events));
    }
  }
  takePosts();
  takeTurns();
  takeDeadlines();
  if (clients && accepting_) accept();
  setAccepting(!serving_.ending && now_ >= acceptAgain_ && !serving_.addresses.full());
}

int EventLoop::timeout() const {
  if (deadlines_.turns.next() != INT64_MAX) return 0;
  int64_t next = std::min({deadlines_.header.next(), deadlines_.content.next(),
                           deadlines_.answer.next(), deadlines_.silence.next()});
  // Whether there are places again is told by nobody.
  if (!accepting_ && !serving_.ending) next = std::min(next, now_ + kAcceptPause);
  if (next == INT64_MAX) return -1;
  return static_cast<int>(std::clamp<int64_t>(next - now_, 1, 60'000));
}

void EventLoop::setAccepting(bool accepting) {
  if (accepting == accepting_) return;
  accepting_ = accepting;
  if (accepting)
    // Of several loops not all are woken for one client.
    accepting_ = watch(epoll_, listener_, EPOLLIN | EPOLLEXCLUSIVE, const_cast<int*>(&listener_));
  else
    ::epoll_ctl(epoll_, EPOLL_CTL_DEL, listener_, nullptr);
}

void EventLoop::accept() {
  for (int i = 0; i < kAcceptedATurn && !serving_.addresses.full(); ++i) {
    sockaddr_storage peer{};
    socklen_t length = sizeof peer;
    const int socket = ::accept4(listener_, reinterpret_cast<sockaddr*>(&peer), &length,
                                 SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket >= 0) {
      open(socket, peer);
      continue;
    }
    if (errno == EAGAIN) return;
    if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
      acceptAgain_ = now_ + kAcceptPause;
      return;
    }
    // Else that client has gone.
  }
}

void EventLoop::open(int socket, const sockaddr_storage& peer) {
  const ClientAddress address(peer);
  const Admission admission = serving_.addresses.open(address.origin());
  auto connection = std::make_unique<Connection>(*this, socket, address, admission);
  if (admission == Admission::closedAtOnce ||
      !watch(epoll_, socket, EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET, connection.get()))
    return;
  const auto place = static_cast<size_t>(socket);
  if (connections_.size() <= place) connections_.resize(place + 1);
  connections_[place] = std::move(connection);
}

void EventLoop::keepOrEnd(Connection& connection, bool goesOn) {
  if (!goesOn) connections_[static_cast<size_t>(connection.socket())].reset();
}

void EventLoop::takePosts() {
  std::vector<std::shared_ptr<Exchange>> posts;
  {
    const std::scoped_lock lock(postMutex_);
    posts.swap(posts_);
  }
  for (const auto& exchange : posts) {
    Connection* connection = exchange->connection;
    if (connection != nullptr) keepOrEnd(*connection, connection->answered());
  }
}

void EventLoop::takeTurns() {
  // Those that want another turn come again behind the others.
  for (int i = 0; i < kTurns; ++i) {
    Deadline* next = deadlines_.turns.passed(now_);
    if (next == nullptr) return;
    auto& connection = *static_cast<Connection*>(next->owner());
    keepOrEnd(connection, connection.goOn());
  }
}

void EventLoop::takeDeadlines() {
  for (DeadlineList* list :
       {&deadlines_.header, &deadlines_.content, &deadlines_.answer, &deadlines_.silence})
    while (Deadline* passed = list->passed(now_)) {
      auto& connection = *static_cast<Connection*>(passed->owner());
      keepOrEnd(connection, connection.tooLate());
    }
}

}  // namespace meshfront
