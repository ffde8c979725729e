#include "shared/http/server/connection.h"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "shared/http/server/event_loop.h"
#include "shared/http/server/refusal.h"
#include "shared/http/server/response_head.h"

namespace meshfront {
namespace {

// What is read and dropped of a request that is refused: a client that does not read before it has
// written would otherwise see a reset instead of the answer.
constexpr uint64_t kMaxDropped = uint64_t{16} << 20;
constexpr int kRequestsATurn = 32;  // that came in one read

constexpr unsigned kRequestTimeout = 408;       // in the log, where a request was cut
constexpr unsigned kClientClosedRequest = 499;  // in the log, as other servers write it

}  // namespace

Connection::Connection(EventLoop& loop, int socket, const ClientAddress& address,
                       Admission admission)
    : loop_(loop),
      serving_(loop.serving()),
      socket_(socket),
      admission_(admission),
      address_(address) {
  serving_.inFlight.connections.fetch_add(1);
  serving_.metrics.connections.add();
  setDeadlines();
}

Connection::~Connection() {
  finish(false, kClientClosedRequest);
  ::close(socket_);
  serving_.addresses.close(address_.origin());
  serving_.inFlight.connections.fetch_sub(1);
}

bool Connection::ready(uint32_t events) {
  constexpr uint32_t kEnds = EPOLLRDHUP | EPOLLHUP | EPOLLERR;
  if ((events & (EPOLLIN | kEnds)) != 0) readable_ = true;
  if ((events & kEnds) != 0) hungUp_ = true;
  return proceed();
}

bool Connection::answered() {
  exchange_->withWorker = false;
  startSending();
  return proceed();
}

bool Connection::goOn() {
  return proceed();
}

// One read a turn, so that no connection keeps the others waiting.
bool Connection::proceed() {
  if (state_ == State::sending) send();
  if (state_ == State::reading && !following_.empty()) {
    const std::string bytes = std::exchange(following_, {});
    consume(bytes);
  }
  if ((state_ == State::reading && following_.empty()) || state_ == State::lingering)
    if (readable_) read();
  if (state_ == State::ended) return false;
  const bool reads = state_ == State::reading || state_ == State::lingering;
  if (reads && (readable_ || !following_.empty()))
    loop_.deadlines().turns.set(turn_, loop_.now());
  else
    turn_.clear();
  setDeadlines();
  return true;
}

void Connection::read() {
  const std::span<char> buffer = loop_.buffer();
  const ssize_t got = ::recv(socket_, buffer.data(), buffer.size(), 0);
  if (got <= 0) {
    if (got < 0 && errno == EINTR) return;
    readable_ = false;
    if (got == 0 || errno != EAGAIN) onEnd();
    return;
  }
  const auto octets = static_cast<size_t>(got);
  // What comes later is told of, but for an end that has been told of already.
  if (octets < buffer.size() && !hungUp_) readable_ = false;
  if (state_ == State::lingering) return discard(octets);
  consume({buffer.data(), octets});
}

void Connection::onEnd() {
  finish(false, kClientClosedRequest);
  state_ = State::ended;
}

void Connection::consume(std::string_view bytes) {
  int requests = 0;
  while (state_ == State::reading && !bytes.empty()) {
    if (!exchange_) {
      if (++requests > kRequestsATurn) break;
      exchange_ = std::make_shared<Exchange>(serving_);
      exchange_->connection = this;
    }
    if (exchange_->contentReader)
      takeContent(bytes);
    else
      takeHead(bytes);
  }
  if (state_ == State::lingering) return discard(bytes.size());
  if (state_ != State::ended && !bytes.empty()) following_ = bytes;
}

void Connection::takeHead(std::string_view& bytes) {
  RequestHeadReader& reader = exchange_->reader;
  reader.take(bytes);
  if (reader.state() != RequestHeadReader::State::line && !exchange_->started()) exchange_->start();
  if (reader.state() == RequestHeadReader::State::defective) return refuseDefect(reader.defect());
  if (reader.state() == RequestHeadReader::State::whole) onHead();
}

void Connection::onHead() {
  const RequestHead& head = exchange_->reader.head();
  const ContentReader& content = exchange_->contentReader.emplace(head, serving_.limits.maxHeader);
  if (admission_ != Admission::granted) {
    exchange_->refuse(admission_ == Admission::tooMany ? Refusal::connections : Refusal::address);
    return respondUnread();
  }
  if (content.whole()) return respond();
  if (head.contentLength > serving_.limits.maxContent) {
    exchange_->setContentTooLarge();
    // It would have to be read, or waited for, in vain.
    if (head.contentLength > kMaxDropped || head.expectsContinue) return respondUnread();
  }
  if (!head.expectsContinue) return;
  constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
  // Where there is no room for it, the client goes on after a while.
  (void)::send(socket_, kContinue.data(), kContinue.size(), MSG_NOSIGNAL);
}

void Connection::takeContent(std::string_view& bytes) {
  ContentReader& reader = *exchange_->contentReader;
  const std::string_view piece = reader.take(bytes);
  if (!piece.empty()) exchange_->keep(piece);
  if (reader.defect().status != 0) return refuseDefect(reader.defect());
  if (reader.whole()) return respond();
  if (exchange_->contentSeen() > kMaxDropped) respondUnread();
}

void Connection::respondUnread() {
  unread_ = true;
  respond();
}

void Connection::refuseDefect(const RequestDefect& defect) {
  unread_ = true;
  exchange_->answerDefect(defect);
  startSending();
}

void Connection::respond() {
  clearPhaseDeadline();
  if (exchange_->refusal() != Refusal::none) {
    exchange_->answerRefusal();
  } else if (!serving_.workers) {
    exchange_->answer();
  } else if (!exchange_->answerAtOnce()) {
    state_ = State::waiting;
    exchange_->withWorker = true;
    const bool taken = serving_.workers->submit([exchange = exchange_, &loop = loop_] {
      exchange->answer();
      loop.post(exchange);
    });
    if (taken) return;
    exchange_->withWorker = false;
    exchange_->answerOverloaded();
  }
  startSending();
}

void Connection::startSending() {
  Exchange& exchange = *exchange_;
  const RequestHead& asked = exchange.reader.head();
  exchange.closeAfter = unread_ || !asked.keepAlive || serving_.ending;
  const Persistence persistence = exchange.closeAfter ? Persistence::close
                                  : asked.version10   ? Persistence::keep
                                                      : Persistence::usual;
  exchange.head = responseHead(exchange.response, loop_.dateField(), persistence);
  if (asked.method != "HEAD" && mayHaveContent(exchange.response.status))
    exchange.content = exchange.response.content.bytes();
  state_ = State::sending;
  send();
}

void Connection::send() {
  Exchange& exchange = *exchange_;
  const size_t whole = exchange.head.size() + exchange.content.size();
  const size_t headLeft = exchange.head.size() - std::min(exchange.sent, exchange.head.size());
  const size_t contentSent = exchange.sent - (exchange.head.size() - headLeft);
  std::array<iovec, 2> parts{
      iovec{exchange.head.data() + (exchange.head.size() - headLeft), headLeft},
      iovec{const_cast<uint8_t*>(exchange.content.data()) + contentSent,
            exchange.content.size() - contentSent}};
  msghdr message{};
  message.msg_iov = headLeft > 0 ? parts.data() : &parts[1];
  message.msg_iovlen = headLeft > 0 && parts[1].iov_len > 0 ? 2 : 1;
  ssize_t taken = 0;
  do {
    taken = ::sendmsg(socket_, &message, MSG_NOSIGNAL);
  } while (taken < 0 && errno == EINTR);
  if (taken < 0) {
    if (errno != EAGAIN) onEnd();
    return;
  }
  exchange.sent += static_cast<size_t>(taken);
  // Where less was taken there is no room; when there is again is told.
  if (exchange.sent == whole) onSent();
}

void Connection::onSent() {
  const bool close = exchange_->closeAfter;
  finish(true, 0);
  clearPhaseDeadline();
  if (!close)
    state_ = State::reading;
  else if (unread_ || !following_.empty() || readable_)
    linger();
  else
    state_ = State::ended;
}

// Closing a socket that has unread octets would take the answer back.
void Connection::linger() {
  ::shutdown(socket_, SHUT_WR);
  clearPhaseDeadline();
  state_ = State::lingering;
  discard(following_.size());
  following_ = {};
}

void Connection::discard(size_t octets) {
  discarded_ += octets;
  if (discarded_ > kMaxDropped) state_ = State::ended;
}

void Connection::finish(bool whole, unsigned status) {
  if (!exchange_) return;
  exchange_->connection = nullptr;
  if (exchange_->started()) exchange_->finish(whole, status, address_);
  exchange_.reset();
}

ConnectionPhase Connection::phase() const {
  if (state_ == State::waiting || state_ == State::sending) return ConnectionPhase::answer;
  if (!exchange_) return ConnectionPhase::idle;
  if (exchange_->contentReader) return ConnectionPhase::content;
  return exchange_->started() ? ConnectionPhase::header : ConnectionPhase::line;
}

DeadlineList* Connection::phaseList() const {
  if (state_ == State::lingering) return &loop_.deadlines().header;
  switch (phase()) {
    case ConnectionPhase::idle:  // refused, it is not kept for long
      return admission_ == Admission::granted ? nullptr : &loop_.deadlines().header;
    case ConnectionPhase::content:
      return &loop_.deadlines().content;
    case ConnectionPhase::answer:
      return &loop_.deadlines().answer;
    default:
      return &loop_.deadlines().header;
  }
}

void Connection::clearPhaseDeadline() {
  phaseDeadline_.clear();
  timedBy_ = nullptr;
}

void Connection::setDeadlines() {
  if (DeadlineList* list = phaseList(); list != timedBy_) {
    clearPhaseDeadline();
    if (list != nullptr) list->set(phaseDeadline_, loop_.now());
    timedBy_ = list;
  }
  // While a worker makes the answer neither side can say anything.
  if (state_ == State::waiting)
    silence_.clear();
  else
    loop_.deadlines().silence.set(silence_, loop_.now());
}

bool Connection::tooLate() {
  const bool refusedInVain = phase() == ConnectionPhase::idle && admission_ != Admission::granted;
  if (state_ == State::lingering || (phase() == ConnectionPhase::idle && !refusedInVain))
    return false;
  cut();
  return state_ != State::ended;
}

void Connection::cut() {
  const ConnectionPhase phase = this->phase();
  serving_.metrics.cut(phase).add();  // first: who sees the end may ask what was counted
  if (phase == ConnectionPhase::line && serving_.accessLog != nullptr)
    serving_.accessLog->add({.address = address_.text(),
                             .status = kRequestTimeout,
                             .seconds = serving_.limits.headerTimeout});
  finish(false, kRequestTimeout);
  state_ = State::ended;
  if (phase == ConnectionPhase::idle) return;
  if (phase == ConnectionPhase::answer) {
    // What the client does not take is not kept by the kernel either.
    const ::linger none{1, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &none, sizeof none);
    return;
  }
  const HttpResponse response = tooSlowResponse();
  const auto content = response.content.bytes();
  const std::string text = responseHead(response, loop_.dateField(), Persistence::close)
                               .append(content.begin(), content.end());
  // Nothing else has been sent for this request, so there is room.
  (void)::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
  linger();
  setDeadlines();
}

}  // namespace meshfront
