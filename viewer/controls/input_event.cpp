#include "viewer/controls/input_event.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace meshfront {
namespace {

struct NamedKey {
  std::string_view name;
  Key key;
};
constexpr std::array<NamedKey, 16> kNamedKeys = {{{"left", Key::left},
                                                  {"right", Key::right},
                                                  {"up", Key::up},
                                                  {"down", Key::down},
                                                  {"home", Key::home},
                                                  {"escape", Key::escape},
                                                  {"tab", Key::tab},
                                                  {"delete", Key::deleteKey},
                                                  {"F1", Key::f1},
                                                  {"F12", Key::f12},
                                                  {"+", Key::plus},
                                                  {"-", Key::minus},
                                                  {"?", Key::question},
                                                  {"[", Key::leftBracket},
                                                  {"]", Key::rightBracket},
                                                  {"esc", Key::escape}}};

char lowered(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

bool sameName(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lowered(x) == lowered(y); });
}

}  // namespace

const std::string_view kKeyNames =
    "A to Z, left, right, up, down, home, escape, tab, delete, F1, F12, + - ? [ ]";

std::optional<Key> keyNamed(std::string_view name) {
  if (name.size() == 1 && std::isalpha(static_cast<unsigned char>(name.front())) != 0) {
    return letterKey(static_cast<char>(lowered(name.front()) - 'a' + 'A'));
  }
  const auto* found = std::find_if(kNamedKeys.begin(), kNamedKeys.end(),
                                   [name](const NamedKey& k) { return sameName(k.name, name); });
  if (found == kNamedKeys.end()) return std::nullopt;
  return found->key;
}

std::string keyName(Key key) {
  for (const NamedKey& named : kNamedKeys) {
    if (named.key == key) return std::string(named.name);
  }
  const auto code = static_cast<unsigned char>(key);
  return std::isupper(code) != 0 ? std::string(1, static_cast<char>(code)) : "none";
}

}  // namespace meshfront
