#include "shared/http/server/exchange.h"

#include <algorithm>

#include "shared/http/server/refusal.h"

namespace meshfront {

Exchange::Exchange(Serving& serving)
    : reader(serving.limits.maxHeader),
      serving_(serving),
      receivedMemory_(serving.inFlight),
      answerMemory_(serving.inFlight) {}

void Exchange::start() {
  started_ = true;
  began_ = Clock::now();
  serving_.inFlight.requests.fetch_add(1);
}

HttpRequest Exchange::request() const {
  const RequestHead& asked = reader.head();
  return {asked.method,      asked.target, asked.ifNoneMatch,
          asked.contentType, received_,    contentTooLarge_};
}

void Exchange::keep(std::string_view piece) {
  contentSeen_ += piece.size();
  if (contentSeen_ > serving_.limits.maxContent) contentTooLarge_ = true;
  if (!contentTooLarge_ && refusal_ == Refusal::none) {
    if (makeRoom(piece.size()))
      received_.insert(received_.end(), piece.begin(), piece.end());
    else
      refusal_ = Refusal::memory;
  }
  if (contentTooLarge_ || refusal_ != Refusal::none) {
    received_ = {};
    receivedMemory_.giveBack();
  }
}

// For `size` more octets of content; what is allocated counts.
bool Exchange::makeRoom(size_t size) {
  const size_t needed = received_.size() + size;
  if (needed <= received_.capacity()) return true;
  const uint64_t announced = reader.head().contentLength;
  const uint64_t expected =
      std::min<uint64_t>(announced > 0 ? announced : UINT64_MAX, serving_.limits.maxContent);
  const size_t capacity =
      std::max(needed, std::min(2 * received_.capacity(), static_cast<size_t>(expected)));
  if (!receivedMemory_.take(capacity - received_.capacity())) return false;
  received_.reserve(capacity);
  return true;
}

void Exchange::admit(HttpResponse made) {
  response = std::move(made);
  if (answerMemory_.take(response.content.size())) return;
  refusal_ = Refusal::memory;
  answerRefusal();
}

void Exchange::answer() {
  admit(serving_.handler.answer(request()));
}

bool Exchange::answerAtOnce() {
  auto made = serving_.handler.answerAtOnce(request());
  if (!made) return false;
  admit(std::move(*made));
  return true;
}

void Exchange::answerOverloaded() {
  response = serving_.handler.overloaded(request());
}

void Exchange::answerRefusal() {
  serving_.metrics.refused(refusal_).add();
  response = refusalResponse(refusal_);
}

void Exchange::answerDefect(const RequestDefect& defect) {
  refusal_ = refusalFor(defect);
  serving_.metrics.refused(refusal_).add();
  response = defectResponse(defect, serving_.limits);
}

void Exchange::finish(bool whole, unsigned status, const ClientAddress& address) {
  if (!withWorker) {  // else at its end
    receivedMemory_.giveBack();
    answerMemory_.giveBack();
  }
  if (!whole) serving_.metrics.unfinished.add();
  const Clock::duration duration = Clock::now() - began_;
  serving_.metrics.requestSeconds.observe(duration);
  if (serving_.accessLog != nullptr)
    serving_.accessLog->add({.address = address.text(),
                             .method = reader.head().method,
                             .target = reader.head().target,
                             .version10 = reader.head().version10,
                             .status = head.empty() ? status : response.status,
                             .bytes = content.size(),
                             .seconds = std::chrono::duration<double>(duration).count(),
                             .whole = whole});
  // Whoever waits for the last one holds the lock while it counts.
  if (serving_.inFlight.requests.fetch_sub(1) == 1 && serving_.ending) {
    const std::scoped_lock lock(serving_.mutex);
    serving_.ended.notify_all();
  }
}

}  // namespace meshfront
