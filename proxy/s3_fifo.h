// Which cached documents have to go: S3-FIFO (Yang, Zhang, Qiu, Yue, Rashmi: FIFO queues are all
// you need for cache eviction, SOSP 2023). New ones wait in a small queue, a tenth of the bytes.
// From there those that were asked for again go to the main queue, the others out; who comes back
// soon after that is put into the main queue at once. A scan passes through the small queue alone,
// and so do names that do not exist.
//
// Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <unordered_set>

namespace meshfront {

class S3Fifo {
 public:
  struct Member {
    std::string key;
    size_t bytes = 0;
    uint8_t uses = 0;  // since it came or was last spared, up to kMostUses
    bool isMain = false;
  };
  using Place = std::list<Member>::iterator;

  [[nodiscard]] Place insert(std::string key, size_t bytes) {
    const bool wasHere = ghosts_.erase(hashOf(key)) > 0;
    std::list<Member>& queue = wasHere ? main_ : small_;
    (wasHere ? mainBytes_ : smallBytes_) += bytes;
    queue.push_front({std::move(key), bytes, 0, wasHere});
    return queue.begin();
  }
  void use(Place place) {
    if (place->uses < kMostUses) ++place->uses;
  }
  void resize(Place place, size_t bytes) {
    size_t& sum = place->isMain ? mainBytes_ : smallBytes_;
    sum = sum - place->bytes + bytes;
    place->bytes = bytes;
  }
  void erase(Place place) {
    (place->isMain ? mainBytes_ : smallBytes_) -= place->bytes;
    (place->isMain ? main_ : small_).erase(place);
  }
  // Who goes next, which erase() then has to be told. Nothing where there is none.
  [[nodiscard]] std::optional<Place> next() {
    while (!small_.empty() || !main_.empty()) {
      const bool fromSmall =
          main_.empty() || (!small_.empty() && smallBytes_ * kSmallShare > bytes());
      if (fromSmall) {
        const Place oldest = std::prev(small_.end());
        if (oldest->uses == 0) {
          remember(oldest->key);
          return oldest;
        }
        oldest->uses = 0;
        oldest->isMain = true;
        smallBytes_ -= oldest->bytes;
        mainBytes_ += oldest->bytes;
        main_.splice(main_.begin(), small_, oldest);
      } else {
        const Place oldest = std::prev(main_.end());
        if (oldest->uses == 0) return oldest;
        --oldest->uses;
        main_.splice(main_.begin(), main_, oldest);
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] size_t bytes() const { return smallBytes_ + mainBytes_; }
  [[nodiscard]] size_t smallBytes() const { return smallBytes_; }

 private:
  static constexpr size_t kSmallShare = 10;  // one in so many bytes
  static constexpr uint8_t kMostUses = 3;
  static constexpr size_t kMostGhosts = 4096;

  static size_t hashOf(const std::string& key) { return std::hash<std::string>()(key); }
  void remember(const std::string& key) {
    const size_t hash = hashOf(key);
    if (!ghosts_.insert(hash).second) return;
    ghostOrder_.push_back(hash);
    if (ghostOrder_.size() <= kMostGhosts) return;
    ghosts_.erase(ghostOrder_.front());
    ghostOrder_.pop_front();
  }

  std::list<Member> small_;  // newest first
  std::list<Member> main_;   // likewise
  size_t smallBytes_ = 0;
  size_t mainBytes_ = 0;
  std::unordered_set<size_t> ghosts_;  // hashes of who left the small queue lately
  std::deque<size_t> ghostOrder_;      // oldest first, also of those that came back
};

}  // namespace meshfront
