#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "render/gl/objects.h"
#include "render/graph/effects.h"

namespace rebake {

/// The targets that a frame's effects write: made when one does, kept from frame to frame while sizes stay, freed when
/// none does.
class TargetPool {
 public:
  /// Throws DeviceError.
  void fit(const FramePlan& plan);

  const gl::Texture& texture(Target target) const { return textures_[static_cast<std::size_t>(target)]; }
  /// What draws into these, in this order, and with `depth` into depth too. All are there.
  const gl::Framebuffer& framebuffer(const std::vector<Target>& colors, bool depth);

 private:
  int width_ = 0, height_ = 0, side_ = 1;
  std::array<gl::Texture, target_count> textures_;
  std::map<std::pair<std::vector<Target>, bool>, gl::Framebuffer> framebuffers_;
};

}  // namespace rebake
