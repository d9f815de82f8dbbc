#pragma once

#include <optional>
#include <string>

#include "editor/gui/window/window.h"

namespace rebake {

/// A number that is typed while something is dragged; it counts in place of the pointer's way. Takes digits, a point,
/// signs, * and /, e.g. "1/4".
class TypedNumber {
 public:
  /// True when the key was for the number.
  bool key(const KeyPress& press);
  /// The last value that what was typed came to; nothing before there is one.
  std::optional<double> value() const { return value_; }
  const std::string& text() const { return text_; }
  void clear() { *this = {}; }

 private:
  std::string text_;
  std::optional<double> value_;
};

}  // namespace rebake
