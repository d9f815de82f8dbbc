#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mesh_ops/base/types.h"
#include "render/gl/objects.h"

namespace rebake::gl {

/// A fragment shader that runs for each pixel of a picture, without geometry. All members, and the destructor, need the
/// context in which it was made to be current.
class PixelProgram {
 public:
  /// Compiles `shader`, a file of the folder of shaders, see shader_source(). Throws DeviceError.
  PixelProgram(const std::string& shader, const std::string& preamble);

  /// Sets uniforms. Names that the shader does not use are ignored.
  void set(const char* name, int value);
  void set(const char* name, double value);
  void set(const char* name, double x, double y);
  void set(const char* name, const Vec3& value);
  void set(const char* name, const Mat3& value);

  /// Uploads what a sampler reads. Each sampler once. Throws DeviceError if the device cannot hold it.
  /// A 3-D texture, see make_volume().
  void add_volume(const char* sampler, int channels, const std::array<int, 3>& size, const std::uint8_t* texels,
                  bool linear);
  /// Whole numbers of an isamplerBuffer.
  void add_numbers(const char* sampler, std::span<const std::int32_t> values);
  /// Vectors of four half floats of a samplerBuffer.
  void add_vectors(const char* sampler, std::span<const std::array<std::uint16_t, 4>> values);
  /// Memory of all that was uploaded.
  std::uint64_t bytes() const;

  /// Draws a picture of this size and waits until it is done. The shader writes RGBA into its only output.
  void draw(int width, int height);
  /// Reads back the picture that was drawn last: RGB of each pixel, row by row from the top.
  std::vector<std::uint8_t> picture() const;

 private:
  struct Input {
    unsigned target;
    Texture texture;
    Buffer buffer;  // of a buffer texture
  };
  int location(const char* name) const;
  void add(const char* sampler, Input input);
  void add_buffer(const char* sampler, unsigned format, const void* data, std::size_t count, std::size_t size);
  Program program_;
  VertexArray triangle_;
  std::vector<Input> inputs_;
  Texture target_;
  Framebuffer framebuffer_;
  int width_ = 0, height_ = 0;
};

}  // namespace rebake::gl
