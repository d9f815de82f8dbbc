#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace rebake::gl {

/// Memory of all Buffer and Texture objects of this process in bytes: current and peak.
struct MemoryUse {
  std::uint64_t now = 0;
  std::uint64_t peak = 0;
};
MemoryUse memory_use();

/// Move-only owner of an OpenGL object, which `Traits::release` deletes.
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

/// Creates a buffer bound to `target` (GL_ARRAY_BUFFER, …); null `data` leaves it uninitialised. Throws DeviceError if
/// out of memory.
Buffer make_buffer(unsigned target, const void* data, std::size_t bytes);
/// Creates a 2-D texture without mipmaps, clamped to its edges, with linear filtering for GL_RGBA8 and nearest sampling
/// for other formats. Throws DeviceError if it is too large or memory is out.
Texture make_texture(unsigned internal_format, int width, int height, int bytes_per_texel);
/// Creates a 3-D texture with 1, 3 or 4 channels of bytes, clamped to its edges; `texels` with x fastest, then y.
/// `linear`: filtered trilinearly, otherwise nearest. Throws DeviceError if it is too large or memory is out.
Texture make_volume(int channels, const std::array<int, 3>& size, const std::uint8_t* texels, bool linear);
/// Creates a buffer texture that reads `buffer` in a format such as GL_RGBA32F.
Texture make_buffer_texture(const Buffer& buffer, unsigned internal_format);
/// Creates a framebuffer; `depth` may be null. Throws DeviceError if the driver does not support these attachments.
Framebuffer make_framebuffer(const std::vector<const Texture*>& colors, const Texture* depth);
VertexArray make_vertex_array();
/// Compiles and links a program. Throws DeviceError with the driver's log.
Program make_program(const std::string& vertex_source, const std::string& fragment_source);

}  // namespace rebake::gl
