// Words for what of a file's mesh is not carried (IndexedMesh::notCarried).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace meshfront {

// A name from an untrusted file: printable ASCII ('?' for all else), at most 40 characters.
[[nodiscard]] std::string printableName(std::string_view name);

// Names for a sentence: "confidence, intensity", of many the first dozen and how many more.
class NameList {
 public:
  void add(std::string_view name) {
    if (count_++ < kShown) shown_.push_back(printableName(name));
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::string text() const;

 private:
  static constexpr uint64_t kShown = 12;
  std::vector<std::string> shown_;
  uint64_t count_ = 0;
};

// Appends "what: names", or "what: count", unless there are none.
void addNotCarried(std::vector<std::string>& sentences, std::string_view what,
                   const NameList& names);
void addNotCarried(std::vector<std::string>& sentences, std::string_view what, uint64_t count);

}  // namespace meshfront
