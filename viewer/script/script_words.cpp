#include "viewer/script/script_words.h"

namespace meshfront {
namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

// The word in quotes that begins at `at`, which is left behind it.
Result<std::string> quotedWord(std::string_view line, size_t& at) {
  std::string word;
  for (++at; at < line.size(); ++at) {
    if (line[at] == '"') {
      ++at;
      if (at < line.size() && !isBlank(line[at])) return fail("expected a blank behind the quotes");
      return word;
    }
    if (line[at] == '\\' && at + 1 < line.size()) {
      ++at;
      if (line[at] != '"' && line[at] != '\\')
        return fail("expected \\\" or \\\\ within quotes, not \\" + std::string(1, line[at]));
    }
    word += line[at];
  }
  return fail("expected closing quotes");
}

}  // namespace

Result<std::vector<std::string>> splitScriptLine(std::string_view line) {
  std::vector<std::string> words;
  size_t at = 0;
  while (true) {
    while (at < line.size() && isBlank(line[at])) ++at;
    if (at == line.size() || line[at] == '#') return words;
    if (line[at] == '"') {
      auto word = quotedWord(line, at);
      if (!word) return tl::unexpected(word.error());
      words.push_back(std::move(*word));
      continue;
    }
    const size_t begin = at;
    while (at < line.size() && !isBlank(line[at])) ++at;
    words.emplace_back(line.substr(begin, at - begin));
  }
}

}  // namespace meshfront
