// How many records the next request may ask for.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace meshfront {

// Limits beyond which a receiver asks for nothing more; nullopt = none.
struct ReceiverLimits {
  std::optional<uint64_t> records;    // exact: records applied in all
  std::optional<uint64_t> bytesDown;  // headers and bodies of every answer; met to within a few
                                      // records, because records differ in length
};

inline constexpr uint32_t kSmallestAdaptiveBatch = 200;
inline constexpr uint32_t kLargestAdaptiveBatch = 2'000;  // some 2,600 octets of URL: see below

// Small while each record shows and the ranking changes fast; larger when single ones hardly show,
// which keeps round trips and request bytes (fewer bits an ID in larger sets) down. Depends on the
// mesh alone, not on time, so that equal views ask for equal sets. A quarter: one such request
// under way needs fewer octets to a picture than two of half the size, of which the second goes by
// counts that the first has made old (tests/evaluation/quality).
[[nodiscard]] inline uint32_t adaptiveBatch(uint64_t splitsApplied) {
  return static_cast<uint32_t>(
      std::clamp<uint64_t>(splitsApplied / 4, kSmallestAdaptiveBatch, kLargestAdaptiveBatch));
}

// Learns the size of answers and says how many records fit under the limits.
class RequestBudget {
 public:
  RequestBudget() = default;
  explicit RequestBudget(ReceiverLimits limits) : limits_(limits) {}

  void observeAnswer(uint64_t headerBytes, uint64_t bodyBytes, uint64_t records) {
    headerBytes_ = headerBytes;
    if (records == 0) return;
    bodyBytes_ += bodyBytes;
    records_ += records;
  }
  [[nodiscard]] uint64_t recordsLeft(uint64_t recordsApplied) const {
    if (!limits_.records) return UINT64_MAX;
    return *limits_.records > recordsApplied ? *limits_.records - recordsApplied : 0;
  }
  // Of answers that come whole, such as chunks: whether one more fits, if none is longer than
  // `bodyBytes`.
  [[nodiscard]] bool answerAllowed(uint64_t bytesDown, uint64_t pendingAnswers,
                                   uint64_t bodyBytes) const {
    return !limits_.bytesDown ||
           bytesDown + (pendingAnswers + 1) * (headerBytes_ + bodyBytes) <= *limits_.bytesDown;
  }
  // On average so far, without headers.
  [[nodiscard]] double bytesPerRecord() const {
    return records_ == 0 ? kFirstGuess
                         : static_cast<double>(bodyBytes_) / static_cast<double>(records_);
  }
  [[nodiscard]] bool limited() const { return limits_.records || limits_.bytesDown; }

  // `pendingRecords` in `pendingAnswers` are under way and not yet in the other two figures.
  [[nodiscard]] uint64_t recordsAllowed(uint64_t recordsApplied, uint64_t bytesDown,
                                        uint64_t pendingRecords, uint64_t pendingAnswers) const {
    uint64_t allowed = UINT64_MAX;
    if (limits_.records) {
      const uint64_t used = recordsApplied + pendingRecords;
      allowed = *limits_.records > used ? *limits_.records - used : 0;
    }
    if (limits_.bytesDown) {
      const double perRecord = bytesPerRecord();
      const double used = static_cast<double>(bytesDown) +
                          static_cast<double>((pendingAnswers + 1) * headerBytes_) +
                          static_cast<double>(pendingRecords) * perRecord * kMargin;
      const double left = static_cast<double>(*limits_.bytesDown) - used;
      const double fits = left / (perRecord * kMargin);
      allowed = std::min(allowed, fits < 1 ? 0 : static_cast<uint64_t>(fits));
    }
    return allowed;
  }

 private:
  static constexpr double kFirstGuess = 6;  // bytes a record
  static constexpr double kMargin = 1.05;
  ReceiverLimits limits_;
  uint64_t headerBytes_ = 400;  // of the last answer
  uint64_t bodyBytes_ = 0;
  uint64_t records_ = 0;
};

}  // namespace meshfront
