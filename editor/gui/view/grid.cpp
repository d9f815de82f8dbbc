#include "editor/gui/view/grid.h"

#include <cmath>

namespace rebake {

void add_grid(const Desk& desk, std::vector<Guides::Line>& lines) {
  // On the ground; squares of the power of ten that fits the scene.
  const Box box = world_bounds(desk.scene());
  const double size = box.isEmpty() || !(box.diagonal().norm() > 0) ? 1 : box.diagonal().norm();
  const double step = std::pow(10, std::floor(std::log10(size)));
  const double floor = box.isEmpty() ? 0 : box.min().y();
  constexpr int half = 10;
  for (int k = -half; k <= half; ++k) {
    const double at = k * step, end = half * step;
    const Color grey(0.55, 0.56, 0.58);
    lines.push_back(
        {{at, floor, -end}, {at, floor, end}, k == 0 ? Color(0.3, 0.5, 0.95) : grey, k == 0 ? 0.7 : 0.28, 0});
    lines.push_back(
        {{-end, floor, at}, {end, floor, at}, k == 0 ? Color(0.9, 0.35, 0.35) : grey, k == 0 ? 0.7 : 0.28, 0});
  }
}

}  // namespace rebake
