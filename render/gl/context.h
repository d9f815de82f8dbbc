#pragma once

#include <memory>
#include <string>

namespace rebake::gl {

/// An OpenGL 3.3 core context (or newer). Not tied to a window: passes work the same on any kind.
class Context {
 public:
  virtual ~Context() = default;
  virtual void make_current() = 0;
};

/// Whether the current context was lost, and with it all that was made in it; false where the driver cannot say. To be
/// called once while the context is sound: a lost one does not tell what it can do.
bool context_lost();

/// Clears the window of the current context, `width` × `height` pixels.
void clear_window(int width, int height);

/// A context without any display or window system, through EGL: Mesa's surfaceless platform first, then the first EGL
/// device. Throws DeviceError that says what is missing.
std::unique_ptr<Context> make_headless_context();

/// What the current context runs on, e.g. "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
std::string device_name();

}  // namespace rebake::gl
