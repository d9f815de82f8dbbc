#include "render/gl/pixel_program.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <glm/gtc/type_ptr.hpp>

#include "mesh_ops/base/error.h"
#include "render/gl/shader_library.h"
#include "render/gl/to_glm.h"

namespace rebake::gl {

PixelProgram::PixelProgram(const std::string& shader, const std::string& preamble)
    : program_(make_program(shader_source("fullscreen.vert", ""), shader_source(shader, preamble))),
      triangle_(make_vertex_array()) {}

int PixelProgram::location(const char* name) const {
  glUseProgram(program_.name());
  return glGetUniformLocation(program_.name(), name);
}

void PixelProgram::set(const char* name, int value) { glUniform1i(location(name), value); }
void PixelProgram::set(const char* name, double value) { glUniform1f(location(name), static_cast<float>(value)); }
void PixelProgram::set(const char* name, double x, double y) {
  glUniform2f(location(name), static_cast<float>(x), static_cast<float>(y));
}
void PixelProgram::set(const char* name, const Vec3& value) {
  glUniform3fv(location(name), 1, glm::value_ptr(to_glm(value)));
}
void PixelProgram::set(const char* name, const Mat3& value) {
  glUniformMatrix3fv(location(name), 1, GL_FALSE, glm::value_ptr(to_glm(value)));
}

void PixelProgram::add(const char* sampler, Input input) {
  set(sampler, static_cast<int>(inputs_.size()));
  inputs_.push_back(std::move(input));
}

void PixelProgram::add_volume(const char* sampler, int channels, const std::array<int, 3>& size,
                              const std::uint8_t* texels, bool linear) {
  add(sampler, {GL_TEXTURE_3D, make_volume(channels, size, texels, linear), {}});
}

void PixelProgram::add_buffer(const char* sampler, unsigned format, const void* data, std::size_t count,
                              std::size_t size) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (count > static_cast<std::size_t>(most))
    throw DeviceError(fmt::format("the driver supports buffers of {} elements, {} are needed", most, count));
  Buffer buffer = make_buffer(GL_TEXTURE_BUFFER, data, count * size);
  Texture texture = make_buffer_texture(buffer, format);
  add(sampler, {GL_TEXTURE_BUFFER, std::move(texture), std::move(buffer)});
}

void PixelProgram::add_numbers(const char* sampler, std::span<const std::int32_t> values) {
  add_buffer(sampler, GL_R32I, values.data(), values.size(), sizeof(std::int32_t));
}

void PixelProgram::add_vectors(const char* sampler, std::span<const std::array<std::uint16_t, 4>> values) {
  add_buffer(sampler, GL_RGBA16F, values.data(), values.size(), 4 * sizeof(std::uint16_t));
}

std::uint64_t PixelProgram::bytes() const {
  std::uint64_t sum = 0;
  for (const Input& input : inputs_) sum += input.texture.bytes() + input.buffer.bytes();
  return sum;
}

void PixelProgram::draw(int width, int height) {
  if (width != width_ || height != height_) {
    target_ = make_texture(GL_RGBA8, width, height, 4);
    framebuffer_ = make_framebuffer({&target_}, nullptr);
    width_ = width, height_ = height;
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, width, height);
  for (const GLenum state : {GL_DEPTH_TEST, GL_BLEND, GL_SCISSOR_TEST, GL_CULL_FACE}) glDisable(state);
  glUseProgram(program_.name());
  for (std::size_t k = 0; k < inputs_.size(); ++k) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(k));
    glBindTexture(inputs_[k].target, inputs_[k].texture.name());
  }
  glActiveTexture(GL_TEXTURE0);
  glBindVertexArray(triangle_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glFinish();
}

std::vector<std::uint8_t> PixelProgram::picture() const {
  std::vector<std::uint8_t> rgb, rgba(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * 4);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  rgb.reserve(rgba.size() / 4 * 3);
  for (int y = height_ - 1; y >= 0; --y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t at =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x));
      rgb.insert(rgb.end(), {rgba[at], rgba[at + 1], rgba[at + 2]});
    }
  return rgb;
}

}  // namespace rebake::gl
