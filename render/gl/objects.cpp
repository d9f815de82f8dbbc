#include "render/gl/objects.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <atomic>

#include "mesh_ops/base/error.h"

namespace rebake::gl {

namespace {

// Atomic, because several threads may draw, each in its own context.
std::atomic<std::uint64_t> held = 0, most = 0;

void take(std::uint64_t bytes) {
  const std::uint64_t now = held += bytes;
  for (std::uint64_t peak = most; now > peak && !most.compare_exchange_weak(peak, now);) continue;
}

class Shader {
 public:
  Shader(GLenum stage, const std::string& source) : name_(glCreateShader(stage)) {
    const char* text = source.c_str();
    glShaderSource(name_, 1, &text, nullptr);
    glCompileShader(name_);
    GLint ok = 0;
    glGetShaderiv(name_, GL_COMPILE_STATUS, &ok);
    if (ok == GL_TRUE) return;
    std::string log(8192, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(name_, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    glDeleteShader(name_);
    throw DeviceError("a shader does not compile on this driver: " + log);
  }
  ~Shader() { glDeleteShader(name_); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  GLuint name() const { return name_; }

 private:
  GLuint name_;
};

void check_memory(const char* what) {
  if (glGetError() == GL_OUT_OF_MEMORY)
    throw DeviceError(fmt::format("GPU memory is too small for the {}; use fewer samples or a smaller picture", what));
}

}  // namespace

MemoryUse memory_use() { return {held, most}; }

void BufferTraits::release(unsigned name, std::uint64_t bytes) {
  glDeleteBuffers(1, &name);
  held -= bytes;
}
void TextureTraits::release(unsigned name, std::uint64_t bytes) {
  glDeleteTextures(1, &name);
  held -= bytes;
}
void FramebufferTraits::release(unsigned name, std::uint64_t) { glDeleteFramebuffers(1, &name); }
void VertexArrayTraits::release(unsigned name, std::uint64_t) { glDeleteVertexArrays(1, &name); }
void ProgramTraits::release(unsigned name, std::uint64_t) { glDeleteProgram(name); }

Buffer make_buffer(unsigned target, const void* data, std::size_t bytes) {
  unsigned name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(target, name);
  glBufferData(target, static_cast<GLsizeiptr>(bytes), data, GL_STATIC_DRAW);
  take(bytes);
  Buffer buffer(name, bytes);
  check_memory("geometry");
  return buffer;
}

Texture make_texture(unsigned internal_format, int width, int height, int bytes_per_texel) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (width > largest || height > largest)
    throw DeviceError(
        fmt::format("the driver supports textures up to {0}×{0} texels, {1}×{2} are needed (use a smaller picture, "
                    "fewer samples, or "
                    "export with --layout split)",
                    largest, width, height));
  unsigned name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  GLenum format = GL_RGBA, type = GL_UNSIGNED_BYTE;
  switch (internal_format) {
    case GL_RG32UI:
      format = GL_RG_INTEGER, type = GL_UNSIGNED_INT;
      break;
    case GL_R16UI:
      format = GL_RED_INTEGER, type = GL_UNSIGNED_SHORT;
      break;
    case GL_RGBA32F:
      format = GL_RGBA, type = GL_FLOAT;
      break;
    case GL_R8:
      format = GL_RED;
      break;
    case GL_DEPTH_COMPONENT32F:
      format = GL_DEPTH_COMPONENT, type = GL_FLOAT;
      break;
    default:
      break;
  }
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, format, type, nullptr);
  const GLint filter = internal_format == GL_RGBA8 ? GL_LINEAR : GL_NEAREST;
  for (const GLenum parameter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, parameter, filter);
  for (const GLenum parameter : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, parameter, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  const std::uint64_t bytes = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) *
                              static_cast<std::uint64_t>(bytes_per_texel);
  take(bytes);
  Texture texture(name, bytes);
  check_memory("picture or its textures");
  return texture;
}

Texture make_volume(int channels, const std::array<int, 3>& size, const std::uint8_t* texels, bool linear) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &largest);
  if (size[0] > largest || size[1] > largest || size[2] > largest)
    throw DeviceError(fmt::format("the driver supports 3-D textures up to {0}×{0}×{0} texels, {1}×{2}×{3} are needed",
                                  largest, size[0], size[1], size[2]));
  const GLenum format = channels == 1 ? GL_RED : channels == 3 ? GL_RGB : GL_RGBA;
  const GLint internal_format = channels == 1 ? GL_R8 : channels == 3 ? GL_RGB8 : GL_RGBA8;
  unsigned name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_3D, name);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, internal_format, size[0], size[1], size[2], 0, format, GL_UNSIGNED_BYTE, texels);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (const GLenum parameter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_3D, parameter, linear ? GL_LINEAR : GL_NEAREST);
  for (const GLenum parameter : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(GL_TEXTURE_3D, parameter, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
  const std::uint64_t bytes = static_cast<std::uint64_t>(channels) * static_cast<std::uint64_t>(size[0]) *
                              static_cast<std::uint64_t>(size[1]) * static_cast<std::uint64_t>(size[2]);
  take(bytes);
  Texture texture(name, bytes);
  check_memory("volume");
  return texture;
}

Texture make_buffer_texture(const Buffer& buffer, unsigned internal_format) {
  unsigned name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_BUFFER, name);
  glTexBuffer(GL_TEXTURE_BUFFER, internal_format, buffer.name());
  return Texture(name);
}

Framebuffer make_framebuffer(const std::vector<const Texture*>& colors, const Texture* depth) {
  unsigned name = 0;
  glGenFramebuffers(1, &name);
  Framebuffer framebuffer(name);
  glBindFramebuffer(GL_FRAMEBUFFER, name);
  std::vector<GLenum> targets;
  for (const Texture* color : colors) {
    targets.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(targets.size()));
    glFramebufferTexture2D(GL_FRAMEBUFFER, targets.back(), GL_TEXTURE_2D, color->name(), 0);
  }
  if (depth != nullptr) glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->name(), 0);
  glDrawBuffers(static_cast<GLsizei>(targets.size()), targets.data());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw DeviceError("the driver does not support the integer and float render targets that are needed");
  return framebuffer;
}

VertexArray make_vertex_array() {
  unsigned name = 0;
  glGenVertexArrays(1, &name);
  return VertexArray(name);
}

Program make_program(const std::string& vertex_source, const std::string& fragment_source) {
  const Shader vertex(GL_VERTEX_SHADER, vertex_source);
  const Shader fragment(GL_FRAGMENT_SHADER, fragment_source);
  Program program(glCreateProgram());
  glAttachShader(program.name(), vertex.name());
  glAttachShader(program.name(), fragment.name());
  glLinkProgram(program.name());
  GLint ok = 0;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) {
    std::string log(8192, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw DeviceError("shaders do not link on this driver: " + log);
  }
  return program;
}

}  // namespace rebake::gl
