#include "render/graph/targets.h"

#include <epoxy/gl.h>

#include <bitset>

namespace rebake {

namespace {

struct Format {
  GLenum internal;
  int bytes;
  bool per_sample;
};
// In the order of Target.
constexpr std::array<Format, target_count> formats{{{GL_RGBA8, 4, false},
                                                    {GL_RG32UI, 8, true},
                                                    {GL_R16UI, 2, true},
                                                    {GL_RGBA32F, 16, true},
                                                    {GL_DEPTH_COMPONENT32F, 4, true},
                                                    {GL_RGBA16F, 8, true},
                                                    {GL_RGBA16F, 8, true},
                                                    {GL_R8, 1, false}}};

std::bitset<target_count> written_by(const FramePlan& plan) {
  std::bitset<target_count> written;
  written.set(static_cast<std::size_t>(Target::picture));  // always cleared to the background
  for (const Effect* effect : effect_table()) {
    if (effect->execute == nullptr || !plan.runs(*effect)) continue;
    for (const Use& use : effect->writes)
      if (use.where == nullptr || plan.runs(*use.where)) written.set(static_cast<std::size_t>(use.target));
  }
  return written;
}

}  // namespace

void TargetPool::fit(const FramePlan& plan) {
  const std::bitset<target_count> wanted = written_by(plan);
  const bool resized = width_ != plan.view.width || height_ != plan.view.height || side_ != plan.view.side();
  bool changes = resized;
  for (std::size_t k = 0; k < target_count; ++k) changes = changes || wanted[k] != static_cast<bool>(textures_[k]);
  if (!changes) return;
  // Frees old targets first, to limit the peak of memory. Sizes are set last, so that all targets are reallocated after
  // a failure.
  framebuffers_.clear();
  width_ = 0;
  for (std::size_t k = 0; k < target_count; ++k)
    if (resized || !wanted[k]) textures_[k] = {};
  for (std::size_t k = 0; k < target_count; ++k) {
    if (!wanted[k] || textures_[k]) continue;
    const int side = formats[k].per_sample ? plan.view.side() : 1;
    textures_[k] =
        gl::make_texture(formats[k].internal, plan.view.width * side, plan.view.height * side, formats[k].bytes);
  }
  width_ = plan.view.width;
  height_ = plan.view.height;
  side_ = plan.view.side();
}

const gl::Framebuffer& TargetPool::framebuffer(const std::vector<Target>& colors, bool depth) {
  gl::Framebuffer& framebuffer = framebuffers_[{colors, depth}];
  if (!framebuffer) {
    std::vector<const gl::Texture*> textures;
    for (const Target target : colors) textures.push_back(&texture(target));
    framebuffer = gl::make_framebuffer(textures, depth ? &texture(Target::depth) : nullptr);
  }
  return framebuffer;
}

}  // namespace rebake
