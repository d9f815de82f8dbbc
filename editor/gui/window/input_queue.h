#pragma once

#include <cstddef>
#include <deque>

namespace rebake {

/// One thing that pointer or keyboard did, as GLFW tells it.
struct InputEvent {
  enum class Kind { move, wheel, button, key, repeat, text };
  Kind kind;
  int code = 0;       ///< button, key or character
  int scancode = 0;   ///< of keys
  bool down = false;  ///< pressed, not released
  int modifiers = 0;
  double x = 0, y = 0;  ///< where the pointer is, or how far the wheel turned
};

/// How many of the waiting events one frame may see. Whoever looks at the state of buttons and keys once a frame, as
/// Dear ImGui 1.86 does, misses a press and release that fall into one frame, puts a press where the pointer went
/// later, and mixes keys with text. So a frame ends before a second change of a button or key, and before the pointer
/// moves on from where the first happened or the wheel turned. What is held (repeats) never makes a frame wait.
inline std::size_t events_of_frame(const std::deque<InputEvent>& waiting) {
  using Kind = InputEvent::Kind;
  bool changed = false, turned = false;
  std::size_t count = 0;
  for (const InputEvent& event : waiting) {
    const bool change = event.kind == Kind::button || event.kind == Kind::key;
    if (changed && change) break;
    if ((changed || turned) && event.kind == Kind::move) break;
    changed = changed || change;
    turned = turned || event.kind == Kind::wheel;
    ++count;
  }
  return count;
}

}  // namespace rebake
