// Pointer, wheel and keys as a view takes them, apart from any window system: a window makes them
// from its own events, a script and tests directly.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace meshfront {

enum class PointerButton : uint8_t { left, middle, right };

struct Modifiers {
  bool shift = false;
  bool control = false;
  bool alt = false;
  bool operator==(const Modifiers&) const = default;
};

// Keys by what is printed on them, so that they lie where a person looks for them on any keyboard.
// Letters are their upper-case ASCII.
enum class Key : uint8_t {
  none = 0,
  plus = '+',
  minus = '-',
  question = '?',
  leftBracket = '[',
  rightBracket = ']',
  // 'A' .. 'Z'
  left = 128,
  right,
  up,
  down,
  home,
  escape,
  tab,
  deleteKey,
  f1,
  f12,
};
// 'A' to 'Z' only.
[[nodiscard]] constexpr Key letterKey(char upperCase) {
  return static_cast<Key>(upperCase);
}

// "left", "F12", "A", "+" ..., upper or lower case; none for what is no key of a view.
[[nodiscard]] std::optional<Key> keyNamed(std::string_view name);
[[nodiscard]] std::string keyName(Key key);
// For messages: every name that keyNamed() knows.
extern const std::string_view kKeyNames;

// Places are pixels of the picture, x to the right and y downward from its upper left.
struct PointerMoved {
  glm::dvec2 place{0};
};
struct PointerPressed {
  PointerButton button = PointerButton::left;
  Modifiers modifiers;
};
struct PointerReleased {
  PointerButton button = PointerButton::left;
  Modifiers modifiers;
};
// Steps of a wheel, fractions from a touchpad; y positive away from the person.
struct Scrolled {
  glm::dvec2 steps{0};
};
struct KeyPressed {
  Key key = Key::none;
  Modifiers modifiers;
};
using InputEvent =
    std::variant<PointerMoved, PointerPressed, PointerReleased, Scrolled, KeyPressed>;

}  // namespace meshfront
