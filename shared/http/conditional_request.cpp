#include "shared/http/conditional_request.h"

namespace meshfront {
namespace {

void skipBlanks(std::string_view& text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t' || text.front() == ','))
    text.remove_prefix(1);
}

}  // namespace

bool ifNoneMatchHolds(std::string_view field, std::string_view etag) {
  skipBlanks(field);
  if (field.starts_with('*')) return true;
  while (!field.empty()) {
    if (field.starts_with("W/")) field.remove_prefix(2);  // compared weakly: the mark is ignored
    if (!field.starts_with('"')) return false;
    const size_t end = field.find('"', 1);
    if (end == std::string_view::npos) return false;
    if (field.substr(0, end + 1) == etag) return true;
    field.remove_prefix(end + 1);
    skipBlanks(field);
  }
  return false;
}

}  // namespace meshfront
