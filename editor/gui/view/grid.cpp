#include "editor/gui/view/grid.h"

#include <cmath>

namespace rebake {

void add_grid(const Scene& scene, const Ground& ground, std::vector<Guides::Line>& lines) {
  const Box box = world_bounds(scene);
  const double size = box.isEmpty() || !(box.diagonal().norm() > 0) ? 1 : box.diagonal().norm();
  const double step = std::pow(10, std::floor(std::log10(size)));
  const Mat3 frame = ground_frame(ground);
  // Grid corners lie on multiples of the step; the centre of the grid is the one nearest to the scene's centre.
  const Vec3 middle = box.isEmpty() ? Vec3::Zero() : Vec3(frame.transpose() * box.center() / step);
  const auto at = [&](double x, double z) -> Vec3 {
    return frame * Vec3(std::round(middle.x()) * step + x, ground.height, std::round(middle.z()) * step + z);
  };
  constexpr int half = 10;
  for (int k = -half; k <= half; ++k) {
    const double along = k * step, end = half * step;
    const Color grey(0.55, 0.56, 0.58);
    const bool axis_z = k + std::lround(middle.x()) == 0, axis_x = k + std::lround(middle.z()) == 0;
    lines.push_back({at(along, -end), at(along, end), axis_z ? Color(0.3, 0.5, 0.95) : grey, axis_z ? 0.7 : 0.28, 0});
    lines.push_back({at(-end, along), at(end, along), axis_x ? Color(0.9, 0.35, 0.35) : grey, axis_x ? 0.7 : 0.28, 0});
  }
}

}  // namespace rebake
