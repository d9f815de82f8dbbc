#include "render/gl/context.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace rebake::gl {

void clear_window(int width, int height) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

LossCheck::LossCheck()
    : ask_(epoxy_gl_version() >= 45                      ? Ask::core
           : epoxy_has_gl_extension("GL_ARB_robustness") ? Ask::extension
                                                         : Ask::nobody) {}

bool LossCheck::lost() const {
  if (ask_ == Ask::nobody) return false;
  return (ask_ == Ask::core ? glGetGraphicsResetStatus() : glGetGraphicsResetStatusARB()) != GL_NO_ERROR;
}

std::string device_name() {
  const auto text = [](GLenum name) { return reinterpret_cast<const char*>(glGetString(name)); };
  return fmt::format("{}, OpenGL {}.{}", text(GL_RENDERER), epoxy_gl_version() / 10, epoxy_gl_version() % 10);
}

}  // namespace rebake::gl
