#pragma once

#include <cstddef>
#include <deque>

namespace rebake {

/// A pointer or keyboard event of GLFW.
struct InputEvent {
  enum class Kind { move, wheel, button, key, repeat, text };
  Kind kind;
  int code = 0;         ///< GLFW's button or key code, or a Unicode character
  int scancode = 0;     ///< scancode of a key
  bool down = false;    ///< true: pressed or repeated; false: released
  int modifiers = 0;    ///< GLFW's modifier bits
  double x = 0, y = 0;  ///< pointer position in window pixels, or offset of the wheel
};

/// Number of queued events that one frame may process. Dear ImGui 1.86 samples buttons and keys once per frame: it
/// misses a press and release within one frame, places a press at the pointer's last position, and mixes the order of
/// keys and text. So a frame ends before a second press or release, and before a move that follows a press, release or
/// wheel event. Key repeats never end a frame.
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
