// One connection: reads requests, has them answered, sends the answers in the order of the
// requests. Everything here happens on the thread of its event loop.
//
// A connection that is idle holds nothing but this object: octets are read into a buffer of the
// loop and copied only where a request is not whole or others follow it in the same read.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "shared/http/server/client_address.h"
#include "shared/http/server/deadlines.h"
#include "shared/http/server/exchange.h"

namespace meshfront {

class EventLoop;

class Connection {
 public:
  // Takes the socket, which is non-blocking and watched edge-triggered by the loop.
  Connection(EventLoop& loop, int socket, const ClientAddress& address, Admission admission);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // What the loop tells. False: the connection has ended and is to be destroyed.
  [[nodiscard]] bool ready(uint32_t events);  // of epoll
  [[nodiscard]] bool answered();              // by a worker
  [[nodiscard]] bool tooLate();               // a deadline has passed
  [[nodiscard]] bool goOn();                  // it is its turn again

  [[nodiscard]] int socket() const { return socket_; }

 private:
  enum class State : uint8_t { reading, waiting, sending, lingering, ended };

  [[nodiscard]] bool proceed();
  void read();
  void onEnd();
  void consume(std::string_view bytes);
  void takeHead(std::string_view& bytes);
  void takeContent(std::string_view& bytes);
  void onHead();
  void respondUnread();
  void refuseDefect(const RequestDefect& defect);
  void respond();
  void startSending();
  void send();
  void onSent();
  void discard(size_t octets);
  void linger();
  void cut();
  void finish(bool whole, unsigned status);
  void setDeadlines();
  void clearPhaseDeadline();
  [[nodiscard]] DeadlineList* phaseList() const;
  [[nodiscard]] ConnectionPhase phase() const;

  EventLoop& loop_;
  Serving& serving_;
  const int socket_;
  State state_ = State::reading;
  const Admission admission_;
  bool readable_ = false;
  bool hungUp_ = false;  // the other side sends no more
  bool unread_ = false;  // the request is not read to its end, so the connection cannot go on
  DeadlineList* timedBy_ = nullptr;  // that `phaseDeadline_` is in
  const ClientAddress address_;
  std::shared_ptr<Exchange> exchange_;  // none: idle
  std::string following_;               // octets behind a request that is being answered
  size_t discarded_ = 0;
  Deadline phaseDeadline_{this};
  Deadline silence_{this};
  Deadline turn_{this};
};

}  // namespace meshfront
