#pragma once

#include <memory>
#include <string>

namespace rebake::gl {

/// An OpenGL 3.3 core context (or newer). Not tied to a window: passes work the same on any kind.
class Context {
 public:
  virtual ~Context() = default;
  virtual bool is_current() const = 0;
  /// On the calling thread. Throws DeviceError, e.g. while another thread has it.
  virtual void make_current() = 0;
  /// The calling thread has none then, and others can take it.
  virtual void release() = 0;
};

/// A context is current on this thread while this lives, and afterwards where it was before: so any thread can draw in
/// its turn.
class Current {
 public:
  explicit Current(Context& context) : context_(context), was_(context.is_current()) {
    if (!was_) context_.make_current();
  }
  ~Current() {
    if (!was_) context_.release();
  }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  Context& context_;
  bool was_;
};

/// Tells whether the current context was lost, and with it all that was made in it. To be made while the context is
/// sound: a lost one does not tell what it can do.
class LossCheck {
 public:
  LossCheck();
  /// False where the driver cannot say.
  bool lost() const;

 private:
  enum class Ask { core, extension, nobody };
  Ask ask_;
};

/// Clears the window of the current context, `width` × `height` pixels.
void clear_window(int width, int height);

/// A context without any display or window system, through EGL: Mesa's surfaceless platform first, then the first EGL
/// device. Throws DeviceError that says what is missing.
std::unique_ptr<Context> make_headless_context();

/// What the current context runs on, e.g. "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
std::string device_name();

}  // namespace rebake::gl
