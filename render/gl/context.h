#pragma once

#include <memory>
#include <string>

namespace rebake::gl {

/// An OpenGL core context, version 3.3 or newer, with or without a window.
class Context {
 public:
  virtual ~Context() = default;
  virtual bool is_current() const = 0;
  /// Makes it current on the calling thread. Throws DeviceError, for example if it is current on another thread.
  virtual void make_current() = 0;
  /// Leaves the calling thread without a context, so that another thread can make this one current.
  virtual void release() = 0;
};

/// Scope guard: makes a context current on this thread, and releases it at the end unless it was current before. Lets
/// several threads draw one after the other.
class CurrentContextScope {
 public:
  explicit CurrentContextScope(Context& context) : context_(context), was_(context.is_current()) {
    if (!was_) context_.make_current();
  }
  ~CurrentContextScope() {
    if (!was_) context_.release();
  }
  CurrentContextScope(const CurrentContextScope&) = delete;
  CurrentContextScope& operator=(const CurrentContextScope&) = delete;

 private:
  Context& context_;
  bool was_;
};

/// Detects the loss of the current context and all its objects (glGetGraphicsResetStatus). Construct it while the
/// context works: a lost one cannot list its extensions.
class LossCheck {
 public:
  LossCheck();
  /// Returns false if the driver cannot detect losses.
  bool lost() const;

 private:
  enum class Ask { core, extension, nobody };
  Ask ask_;
};

/// Clears the window of the current context, `width` × `height` pixels.
void clear_window(int width, int height);

/// Creates a context without a display or window system, through EGL: on the first hardware device, otherwise on Mesa's
/// surfaceless platform. Throws DeviceError if neither works or OpenGL is older than 3.3.
std::unique_ptr<Context> make_headless_context();

/// Renderer and version of the current context, such as "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
std::string device_name();

}  // namespace rebake::gl
