#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/gui/window/input_queue.h"
#include "render/gl/context.h"

struct GLFWwindow;

namespace rebake {

/// A key press: GLFW's number of the key, and which modifiers are held.
struct KeyPress {
  int key = 0;
  bool shift = false, control = false, alt = false;
  bool repeated = false;  ///< by being held
  bool operator==(const KeyPress& other) const {
    return key == other.key && shift == other.shift && control == other.control && alt == other.alt;
  }
};

/// The connection to the display. Windows must not outlive it.
class WindowSystem {
 public:
  /// Throws DeviceError where there is no display; the message names what works without.
  WindowSystem();
  ~WindowSystem();
  WindowSystem(const WindowSystem&) = delete;
  WindowSystem& operator=(const WindowSystem&) = delete;
  /// Wakes Window::wait() up, from any thread.
  static void wake();
};

/// A desktop window with an OpenGL context and Dear ImGui in it.
class Window {
 public:
  /// Throws DeviceError where the driver is too old; the message names what works without.
  Window(const WindowSystem& system, const std::string& title, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// The window's context, for a renderer. The window must outlive it.
  std::unique_ptr<gl::Context> context();

  bool wants_to_close() const;
  void stay_open();
  void close();
  void set_title(const std::string& title);
  int width() const;   ///< pixels
  int height() const;  ///< pixels
  /// How much larger than on a plain screen text and buttons are to be.
  double scale() const;

  /// Sleeps until something happens, at most so many seconds (for ever when negative). True when something came, or
  /// input waits for a frame.
  bool wait(double seconds);
  /// Whether the driver has lost what was on the GPU (it was reset): the window must be made anew.
  bool lost() const;

  /// After the fonts were changed.
  void renew_fonts();
  /// What was seen of people so far: presses and releases, characters, turns of the wheel, where the pointer is.
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
  /// Where the pointer went within this frame, in its order.
  const std::vector<std::array<double, 2>>& moves() const { return moves_; }
  bool input_waits() const { return !waiting_.empty(); }

  void begin_frame();
  void end_frame();

  std::function<void(const KeyPress&)> on_key;
  std::function<void(const std::vector<std::string>&)> on_drop;

 private:
  std::optional<gl::LossCheck> loss_;
  class Callbacks;
  GLFWwindow* window_ = nullptr;
  int events_ = 0;  ///< since the last wait()
  std::deque<InputEvent> waiting_;
  Seen seen_;
  std::vector<std::array<double, 2>> moves_;
  std::array<bool, 5> buttons_{};
  double pointer_x_ = 0, pointer_y_ = 0;  ///< where it was last, as seen by the frame
};

}  // namespace rebake
