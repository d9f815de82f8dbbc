#include "editor/studies/representations/snerg_scene.h"

#include <cmath>
#include <numbers>

namespace rebake {

std::array<double, SnergDecoder::encoding> encoded_direction(const Vec3& direction) {
  std::array<double, SnergDecoder::encoding> out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double x = direction[static_cast<Eigen::Index>(c)];
    out[c] = x;
    for (std::size_t k = 0; k < 4; ++k) {
      const double scaled = std::ldexp(x, static_cast<int>(k));
      out[3 + 3 * k + c] = std::sin(scaled);
      out[15 + 3 * k + c] = std::sin(scaled + std::numbers::pi / 2);
    }
  }
  return out;
}

SnergScene::Size SnergScene::blocks() const {
  Size result{};
  for (std::size_t a = 0; a < 3; ++a) result[a] = (grid[a] + block_size - 1) / block_size;
  return result;
}

SnergScene::Size SnergScene::atlas_needed() const {
  Size result{};
  for (std::size_t a = 0; a < 3; ++a) result[a] = atlas_blocks[a] * (block_size + 2);
  return result;
}

}  // namespace rebake
