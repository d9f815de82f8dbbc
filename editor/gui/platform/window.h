#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/gui/platform/input_queue.h"
#include "render/gl/context.h"

struct GLFWwindow;

namespace rebake {

/// A key press with modifiers.
struct KeyPress {
  int key = 0;  ///< GLFW's key code
  bool shift = false, control = false, alt = false;
  bool repeated = false;  ///< by auto-repeat; not compared
  bool operator==(const KeyPress& other) const {
    return key == other.key && shift == other.shift && control == other.control && alt == other.alt;
  }
};

/// RAII owner of GLFW's connection to the display. Windows must not outlive it.
class WindowSystem {
 public:
  /// Throws DeviceError if there is no display; the message lists commands that need none.
  WindowSystem();
  ~WindowSystem();
  WindowSystem(const WindowSystem&) = delete;
  WindowSystem& operator=(const WindowSystem&) = delete;
  /// Wakes Window::wait(); callable from any thread.
  static void wake();
};

/// A desktop window with an OpenGL context and Dear ImGui in it.
class Window {
 public:
  /// `width`, `height`: logical pixels. Throws DeviceError if OpenGL 3.3 is not available; the message lists commands
  /// that need no window.
  Window(const WindowSystem& system, const std::string& title, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// The window's OpenGL context, for a renderer. The window must outlive it.
  std::unique_ptr<gl::Context> context();

  /// Whether the user asked to close the window.
  bool wants_to_close() const;
  /// Withdraws the request to close.
  void stay_open();
  void close();
  void set_title(const std::string& title);
  int width() const;   ///< width of the framebuffer in pixels
  int height() const;  ///< height of the framebuffer in pixels
  /// The monitor's content scale: framebuffer pixels per logical pixel.
  double scale() const;

  /// Sleeps until an event arrives, at most `seconds` (negative: without limit; 0: polls). True if an event arrived or
  /// queued input waits for a frame.
  bool wait(double seconds);
  /// Whether the OpenGL context was lost by a reset of the driver; the window must then be recreated.
  bool lost() const;

  /// Uploads the font texture again; to be called after the fonts were changed.
  void renew_fonts();
  /// Numbers of processed input events: presses and releases of keys and buttons, characters, wheel events. Also the
  /// pointer position in window pixels. Tests use it to wait for their input.
  struct Seen {
    std::size_t keys = 0, buttons = 0, text = 0, wheel = 0;
    double x = 0, y = 0;
  };
  Seen seen() const {
    Seen now = seen_;
    now.x = pointer_x_;
    now.y = pointer_y_;
    return now;
  }
  /// Pointer positions of this frame in order, in window pixels.
  const std::vector<std::array<double, 2>>& moves() const { return moves_; }
  /// Whether input is queued for a later frame.
  bool input_waits() const { return !waiting_.empty(); }

  /// Processes input events (events_of_frame()) and begins a Dear ImGui frame.
  void begin_frame();
  /// Draws the Dear ImGui frame and swaps buffers.
  void end_frame();

  std::function<void(const KeyPress&)> on_key;  ///< called for each key press, before Dear ImGui gets it
  std::function<void(const std::vector<std::string>&)> on_drop;  ///< called with paths that are dropped on the window

 private:
  std::optional<gl::LossCheck> loss_;
  class Callbacks;
  GLFWwindow* window_ = nullptr;
  int events_ = 0;  ///< number of events since the last wait()
  std::deque<InputEvent> waiting_;
  Seen seen_;
  std::vector<std::array<double, 2>> moves_;
  std::array<bool, 5> buttons_{};
  double pointer_x_ = 0, pointer_y_ = 0;  ///< pointer position in the current frame, in window pixels
};

}  // namespace rebake
