#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>

#include "mesh_ops/base/error.h"
#include "render/gl/context.h"

namespace rebake::gl {

namespace {

bool has_extension(const char* list, const char* name) {
  return list != nullptr && std::string(list).find(name) != std::string::npos;
}

EGLDisplay initialised(EGLDisplay display) {
  return display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE ? display : EGL_NO_DISPLAY;
}

EGLDisplay open_display() {
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  // Prefers a hardware device: Mesa's surfaceless platform would fall back to software even if there is one.
  if (has_extension(client, "EGL_EXT_device_enumeration") && has_extension(client, "EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint i = 0; i < count; ++i) {
      const char* extensions = eglQueryDeviceStringEXT(devices[static_cast<std::size_t>(i)], EGL_EXTENSIONS);
      if (has_extension(extensions, "EGL_MESA_device_software")) continue;
      const EGLDisplay display =
          initialised(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
      if (display != EGL_NO_DISPLAY) return display;
    }
  }
  if (has_extension(client, "EGL_MESA_platform_surfaceless")) {
    const EGLDisplay display =
        initialised(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    if (display != EGL_NO_DISPLAY) return display;
  }
  return EGL_NO_DISPLAY;
}

class HeadlessContext final : public Context {
 public:
  HeadlessContext() : display_(open_display()) {
    if (display_ == EGL_NO_DISPLAY)
      throw DeviceError(
          "OpenGL without a display is not available: EGL offers neither a device nor Mesa's surfaceless platform "
          "(install "
          "libgl1-mesa-dri and libegl-mesa0)");
    eglBindAPI(EGL_OPENGL_API);
    for (const auto& [major, minor] : {std::pair{4, 5}, std::pair{3, 3}}) {
      const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                   major,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   minor,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_NONE};
      context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
      if (context_ != EGL_NO_CONTEXT) break;
    }
    if (context_ == EGL_NO_CONTEXT) throw DeviceError("the OpenGL driver is too old: 3.3 core or newer is needed");
  }
  ~HeadlessContext() override {
    if (is_current()) release();
    eglDestroyContext(display_, context_);
  }
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

  bool is_current() const override {
    eglBindAPI(EGL_OPENGL_API);  // the bound API is per thread
    return eglGetCurrentContext() == context_;
  }
  void release() override {
    eglBindAPI(EGL_OPENGL_API);
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  void make_current() override {
    eglBindAPI(EGL_OPENGL_API);
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
      throw DeviceError(fmt::format("the OpenGL context cannot be made current (EGL error {:#x})", eglGetError()));
  }

 private:
  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<Context> make_headless_context() { return std::make_unique<HeadlessContext>(); }

}  // namespace rebake::gl
