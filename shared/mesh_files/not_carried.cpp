#include "shared/mesh_files/not_carried.h"

namespace meshfront {

std::string printableName(std::string_view name) {
  constexpr size_t kLongest = 40;
  std::string shown(name.substr(0, kLongest));
  for (char& c : shown)
    if (c < ' ' || c > '~') c = '?';
  if (name.size() > kLongest) shown += "...";
  return shown;
}

std::string NameList::text() const {
  std::string out;
  for (const std::string& name : shown_) out += (out.empty() ? "" : ", ") + name;
  if (count_ > kShown) out += " and " + std::to_string(count_ - kShown) + " more";
  return out;
}

void addNotCarried(std::vector<std::string>& sentences, std::string_view what,
                   const NameList& names) {
  if (!names.empty()) sentences.push_back(std::string(what) + ": " + names.text());
}

void addNotCarried(std::vector<std::string>& sentences, std::string_view what, uint64_t count) {
  if (count > 0) sentences.push_back(std::string(what) + ": " + std::to_string(count));
}

}  // namespace meshfront
