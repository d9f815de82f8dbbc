#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "render/gl/objects.h"
#include "render/graph/effects.h"

namespace rebake {

/// Owner of the render targets. Targets are allocated when an effect of a frame writes them, reused while the size
/// stays the same, and freed when no effect writes them.
class TargetPool {
 public:
  /// Allocates and frees targets for a frame. Throws DeviceError if memory is out.
  void fit(const FramePlan& plan);

  const gl::Texture& texture(Target target) const { return textures_[static_cast<std::size_t>(target)]; }
  /// Cached framebuffer with these colour attachments in this order, and the depth target if `depth`. All must be
  /// allocated.
  const gl::Framebuffer& framebuffer(const std::vector<Target>& colors, bool depth);

 private:
  int width_ = 0, height_ = 0, side_ = 1;
  std::array<gl::Texture, target_count> textures_;
  std::map<std::pair<std::vector<Target>, bool>, gl::Framebuffer> framebuffers_;
};

}  // namespace rebake
