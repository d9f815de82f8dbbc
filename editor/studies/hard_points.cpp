#include "editor/studies/hard_points.h"

#include <algorithm>
#include <limits>

namespace rebake {

namespace {

// Points on and beside each edge and near each corner. Both cages have a size of about 1.
std::vector<Vec3> points_beside_edges(const Cage& cage) {
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  Vec3 center(0, 0, 0);
  for (const Vec3& v : cage.vertices) center += v / static_cast<double>(cage.vertices.size());
  std::vector<Vec3> points;
  for (const Face& face : cage.faces) {
    const Vec3 normal = (cage.vertices[face[1]] - cage.vertices[face[0]])
                            .cross(cage.vertices[face[2]] - cage.vertices[face[0]])
                            .normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = cage.vertices[face[k]], &b = cage.vertices[face[(k + 1) % 3]];
      for (const double share : {0.1, 0.5, 0.7}) {
        const Vec3 on = a + share * (b - a);
        for (const double beside : {0.0, rounding, -rounding}) points.push_back(on + beside * normal);
      }
      points.push_back(a + 1e-8 * (center - a).normalized());
    }
  }
  return points;
}

}  // namespace

std::vector<HardPoints> hard_points() {
  Cage wedge;
  wedge.vertices = {{0, 0, 0}, {1, 0, -0.01}, {1, 0, 0.01}, {0, 1, 0}};
  wedge.faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  std::vector<HardPoints> all;
  for (const Cage& cage : {checked_cage(wedge), lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 3, 3, 3)}) {
    HardPoints hard{cage, cage.vertices, points_beside_edges(cage), Mat3::Zero()};
    hard.turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    for (Vec3& v : hard.moved) v = hard.turn * v;
    all.push_back(std::move(hard));
  }
  return all;
}

double largest_error(const HardPoints& hard, const std::vector<Vec3>& moved, const std::vector<std::uint8_t>* outside) {
  double worst = 0;
  for (std::size_t k = 0; k < moved.size(); ++k)
    if (outside == nullptr || (*outside)[k] == 0)
      worst = std::max(worst, (moved[k] - hard.turn * hard.points[k]).norm());
  return worst;
}

}  // namespace rebake
