// Which splits a client has been sent, a bit each, in moving windows (Kim, Lee and Kobbelt 2004):
// nodes are numbered coarse to fine, so that a front has a region in which all have been sent, one
// in which none has, and a window between them. Only the window is stored: its left part is freed
// as it fills, its right end grows as it is reached. There is one window for each level of the
// hierarchy, since a view refines several levels at once.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace meshfront::evaluation {

class ActiveTags {
 public:
  // The first tag of each level, and behind the last (SenderModel::levelTags()).
  explicit ActiveTags(std::span<const uint32_t> levelTags) {
    for (size_t i = 0; i + 1 < levelTags.size(); ++i)
      windows_.push_back({levelTags[i], levelTags[i + 1], 0, {}});
  }

  [[nodiscard]] bool has(unsigned level, uint32_t tag) const {
    const Window& window = windows_[level];
    const uint32_t at = tag - window.begin;
    const size_t word = at / 64;
    if (word < window.firstWord) return true;
    if (word - window.firstWord >= window.words.size()) return false;
    return (window.words[word - window.firstWord] >> (at % 64) & 1) != 0;
  }
  // A tag that has it not yet.
  void set(unsigned level, uint32_t tag) {
    Window& window = windows_[level];
    const uint32_t at = tag - window.begin;
    const size_t word = at / 64 - window.firstWord;
    if (word >= window.words.size()) grow(window, word + 1);
    window.words[word] |= uint64_t{1} << (at % 64);
    if (word == window.full) moveOn(window);
  }
  void clear() {
    for (Window& window : windows_) window = {window.begin, window.end, 0, {}};
  }

  [[nodiscard]] size_t memoryBytes() const {
    size_t bytes = windows_.capacity() * sizeof(Window);
    for (const Window& window : windows_) bytes += window.words.capacity() * sizeof(uint64_t);
    return bytes;
  }
  // What one window over all levels would hold, in whole words: from the first tag that has not
  // been sent to the last that has.
  [[nodiscard]] size_t singleWindowBytes() const {
    uint64_t first = UINT64_MAX;
    uint64_t last = 0;
    for (const Window& window : windows_) {
      const uint64_t full = window.begin + 64 * (window.firstWord + window.full);
      if (first == UINT64_MAX && full < window.end) first = full;
      if (window.firstWord + window.words.size() > 0)
        last = std::min<uint64_t>(window.begin + 64 * (window.firstWord + window.words.size()),
                                  window.end);
    }
    return last > first ? (last - first + 63) / 64 * sizeof(uint64_t) : 0;
  }

 private:
  struct Window {
    uint32_t begin = 0;  // tags of the level
    uint32_t end = 0;
    size_t firstWord = 0;  // words in front of it are all ones and not stored
    std::vector<uint64_t> words;
    size_t full = 0;  // words at the front that are all ones
  };
  // By an eighth, never beyond the level.
  static void grow(Window& window, size_t words) {
    if (words > window.words.capacity()) {
      const size_t all = (window.end - window.begin + 63) / 64 - window.firstWord;
      window.words.reserve(std::min(all, words + words / 8));
    }
    window.words.resize(words);
  }
  // Frees the left part once it is half of the window, so that each word is moved once or twice.
  static void moveOn(Window& window) {
    while (window.full < window.words.size() && isFull(window, window.full)) ++window.full;
    if (window.full == 0 || 2 * window.full < window.words.size()) return;
    window.words.erase(window.words.begin(),
                       window.words.begin() + static_cast<std::ptrdiff_t>(window.full));
    window.firstWord += window.full;
    window.full = 0;
    window.words.shrink_to_fit();
  }
  [[nodiscard]] static bool isFull(const Window& window, size_t word) {
    const uint64_t tags = window.end - window.begin - 64 * (window.firstWord + word);
    return window.words[word] == (tags >= 64 ? ~uint64_t{0} : (uint64_t{1} << tags) - 1);
  }

  std::vector<Window> windows_;
};

}  // namespace meshfront::evaluation
