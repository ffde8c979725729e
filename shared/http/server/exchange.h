// One request and its answer, and what all connections of a server share.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "shared/http/message.h"
#include "shared/http/server/access_log.h"
#include "shared/http/server/address_count.h"
#include "shared/http/server/content_reader.h"
#include "shared/http/server/front_metrics.h"
#include "shared/http/server/request_head.h"
#include "shared/http/server/server_limits.h"
#include "shared/http/server/worker_pool.h"

namespace meshfront {

class Connection;

// Of a server, for all its connections; outlives them.
struct Serving {
  HttpHandler& handler;
  const ServerLimits limits;
  InFlight& inFlight;
  FrontMetrics metrics;
  AddressCount addresses;
  AccessLog* accessLog;                 // or null
  std::optional<WorkerPool> workers{};  // none: the handler never waits

  std::atomic<bool> ending = false;  // no more is accepted, and connections close when they can
  std::mutex mutex{};
  std::condition_variable ended{};  // no request is in flight any more
};

// Octets taken of what all requests may hold, given back at the end.
class HeldMemory {
 public:
  explicit HeldMemory(InFlight& inFlight) : inFlight_(inFlight) {}
  ~HeldMemory() { giveBack(); }
  HeldMemory(const HeldMemory&) = delete;
  HeldMemory& operator=(const HeldMemory&) = delete;

  // False, without taking any, where they do not fit.
  [[nodiscard]] bool take(size_t octets) {
    if (!inFlight_.take(octets)) return false;
    octets_ += octets;
    return true;
  }
  void giveBack() { inFlight_.giveBack(std::exchange(octets_, 0)); }

 private:
  InFlight& inFlight_;
  size_t octets_ = 0;
};

// From a request's first octet until its answer has been sent, or its connection has ended. Belongs
// to the connection's thread, but to a worker from when it is handed to it until it is posted back.
class Exchange {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Exchange(Serving& serving);

  // The request is known to be one: from here on it is counted, timed and logged.
  void start();
  [[nodiscard]] bool started() const { return started_; }

  // A piece of content; what lies beyond the limits is dropped.
  void keep(std::string_view piece);
  // What the content has come to, dropped or not.
  [[nodiscard]] uint64_t contentSeen() const { return contentSeen_; }
  // The content will be, or is, more than allowed.
  void setContentTooLarge() { contentTooLarge_ = true; }
  [[nodiscard]] bool contentTooLarge() const { return contentTooLarge_; }
  void refuse(Refusal reason) { refusal_ = reason; }
  [[nodiscard]] Refusal refusal() const { return refusal_; }

  // Makes the response, on a thread that may wait.
  void answer();
  // The same where that takes no wait; false: it does.
  [[nodiscard]] bool answerAtOnce();
  void answerOverloaded();
  void answerRefusal();
  void answerDefect(const RequestDefect& defect);

  // The last of it: memory given back, counted and logged. `status`: what is logged where no
  // response was being sent.
  void finish(bool whole, unsigned status, const ClientAddress& address);

  RequestHeadReader reader;
  std::optional<ContentReader> contentReader;  // once the head is whole
  HttpResponse response;
  // For the connection's thread alone.
  Connection* connection = nullptr;  // null once that has ended
  bool withWorker = false;

  // Of what is being sent.
  std::string head;
  std::span<const uint8_t> content;
  size_t sent = 0;  // octets of both
  bool closeAfter = false;

 private:
  [[nodiscard]] HttpRequest request() const;
  [[nodiscard]] bool makeRoom(size_t size);
  // Takes the response, or a refusal where its content does not fit into the memory of all answers.
  void admit(HttpResponse made);

  Serving& serving_;
  std::vector<uint8_t> received_;
  HeldMemory receivedMemory_;
  HeldMemory answerMemory_;
  uint64_t contentSeen_ = 0;
  bool contentTooLarge_ = false;
  bool started_ = false;
  Refusal refusal_ = Refusal::none;
  Clock::time_point began_{};
};

}  // namespace meshfront
