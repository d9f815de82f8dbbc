#pragma once

#include <optional>
#include <string>

#include "editor/gui/platform/window.h"

namespace rebake {

/// A number typed during a drag, which overrides the pointer's motion. Accepts digits, '.', '-', '*' and '/', e.g.
/// "1/4".
class TypedNumber {
 public:
  /// Handles a key press; returns true if it edits the number.
  bool key(const KeyPress& press);
  /// Value of the text, or of its last complete expression; empty if there is none yet or the text is deleted.
  std::optional<double> value() const { return value_; }
  const std::string& text() const { return text_; }
  void clear() { *this = {}; }

 private:
  std::string text_;
  std::optional<double> value_;
};

}  // namespace rebake
