#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace rebake::gl {

/// Bytes held by the live Buffer and Texture objects of this process, and the most that were held at once.
struct MemoryUse {
  std::uint64_t now = 0;
  std::uint64_t peak = 0;
};
MemoryUse memory_use();

/// A move-only OpenGL name; `Traits` knows how it is deleted.
template <class Traits>
class Handle {
 public:
  Handle() = default;
  explicit Handle(unsigned name, std::uint64_t bytes = 0) : name_(name), bytes_(bytes) {}
  Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)), bytes_(std::exchange(other.bytes_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(name_, other.name_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~Handle() {
    if (name_ != 0) Traits::release(name_, bytes_);
  }

  unsigned name() const { return name_; }
  std::uint64_t bytes() const { return bytes_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  unsigned name_ = 0;
  std::uint64_t bytes_ = 0;
};

struct BufferTraits {
  static void release(unsigned name, std::uint64_t bytes);
};
struct TextureTraits {
  static void release(unsigned name, std::uint64_t bytes);
};
struct FramebufferTraits {
  static void release(unsigned name, std::uint64_t bytes);
};
struct VertexArrayTraits {
  static void release(unsigned name, std::uint64_t bytes);
};
struct ProgramTraits {
  static void release(unsigned name, std::uint64_t bytes);
};

using Buffer = Handle<BufferTraits>;
using Texture = Handle<TextureTraits>;
using Framebuffer = Handle<FramebufferTraits>;
using VertexArray = Handle<VertexArrayTraits>;
using Program = Handle<ProgramTraits>;

/// A buffer with these bytes, for use as `target` (GL_ARRAY_BUFFER, …). Throws DeviceError when memory is out.
Buffer make_buffer(unsigned target, const void* data, std::size_t bytes);
/// A 2-D texture without mipmaps, clamped; sampled linearly where it is a picture (GL_RGBA8), else the nearest texel.
/// Throws DeviceError when too large.
Texture make_texture(unsigned internal_format, int width, int height, int bytes_a_texel);
/// A texture that reads `buffer` in this format, such as GL_RGBA32F.
Texture make_buffer_texture(const Buffer& buffer, unsigned internal_format);
Framebuffer make_framebuffer(const std::vector<const Texture*>& colors, const Texture* depth);
VertexArray make_vertex_array();
/// Compiles and links. Throws DeviceError with the driver's log.
Program make_program(const std::string& vertex_source, const std::string& fragment_source);

}  // namespace rebake::gl
