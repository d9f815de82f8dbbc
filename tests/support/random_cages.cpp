#include "tests/support/random_cages.h"

#include <Eigen/Geometry>
#include <cmath>

namespace rebake::test {

namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
std::size_t index(Random& random, std::size_t count) {
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
}
Vec3 direction(Random& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}
void rotate(Cage& cage, Random& random) {
  const Mat3 rotation = Eigen::AngleAxisd(uniform(random, 0, 6), direction(random)).toRotationMatrix();
  for (Vec3& v : cage.vertices) v = rotation * v;
}
void append(Cage& cage, const Cage& other) {
  const auto first = static_cast<std::uint32_t>(cage.vertices.size());
  cage.vertices.insert(cage.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Face& face : other.faces) cage.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
}

}  // namespace

RandomCage random_wedge(Random& random) {
  const double slope = std::pow(10.0, uniform(random, -4, 0.3)), size = std::pow(10.0, uniform(random, -1, 0));
  Cage cage;
  cage.vertices = {Vec3(0, 0, 0), Vec3(1, uniform(random, -0.3, 0.3), -slope),
                   Vec3(1, uniform(random, -0.3, 0.3), slope), Vec3(uniform(random, -0.1, 0.1), 1, 0)};
  for (Vec3& v : cage.vertices) v *= size;
  cage.faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  const bool beside_cube = index(random, 2) == 0;
  if (beside_cube) {
    const Vec3 low(2 * size, 0, 0);
    append(cage, lattice_cage(Box(low, low + Vec3::Constant(10 * size)), 1, 1, 1));
  }
  if (index(random, 2) == 0) rotate(cage, random);
  return {"wedge of slope " + std::to_string(slope) + ", size " + std::to_string(size) +
              (beside_cube ? " beside a cube" : ""),
          checked_cage(std::move(cage))};
}

RandomCage random_lattice(Random& random) {
  const auto cells = [&] { return static_cast<int>(1 + index(random, 4)); };
  const int n = cells(), m = cells(), k = cells();
  const Vec3 half(uniform(random, 0.1, 0.5), uniform(random, 0.1, 0.5), uniform(random, 0.1, 0.5));
  Cage cage = lattice_cage(Box(-half, half), n, m, k);
  const bool rotated = index(random, 2) == 0;
  if (rotated) rotate(cage, random);
  return {
      "lattice " + std::to_string(n) + "x" + std::to_string(m) + "x" + std::to_string(k) + (rotated ? ", rotated" : ""),
      std::move(cage)};
}

RandomCage random_star(Random& random) {
  const int cells = static_cast<int>(1 + index(random, 3));
  Cage cage = lattice_cage(Box(Vec3::Constant(-1), Vec3::Constant(1)), cells, cells, cells);
  for (Vec3& v : cage.vertices) v = v.normalized() * uniform(random, 0.2, 0.5);
  return {"star of " + std::to_string(cage.vertices.size()) + " vertices", checked_cage(std::move(cage))};
}

Vec3 random_near_point(const Cage& cage, Random& random) {
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  const Face& face = cage.faces[index(random, cage.faces.size())];
  const std::size_t k = index(random, 3);
  const Vec3 &a = cage.vertices[face[k]], &b = cage.vertices[face[(k + 1) % 3]], &c = cage.vertices[face[(k + 2) % 3]];
  const Vec3 normal = (b - a).cross(c - a).normalized(), across = normal.cross(b - a).normalized();
  Vec3 at = a;
  switch (index(random, 3)) {
    case 0: {  // on the face
      const double u = uniform(random, 0, 1), v = uniform(random, 0, 1 - u);
      at += u * (b - a) + v * (c - a);
      break;
    }
    case 1:  // on an edge
      at += uniform(random, 0, 1) * (b - a);
      break;
    default:
      break;
  }
  if (index(random, 8) == 0) return at;
  const double distance = box.diagonal().norm() * std::pow(10.0, uniform(random, -16, -6));
  switch (index(random, 4)) {
    case 0:
      return at + distance * direction(random);
    case 1:
      return at + (index(random, 2) == 0 ? distance : -distance) * normal;
    case 2: {
      const double angle = uniform(random, 0, 6.3);
      return at + distance * (std::cos(angle) * (b - a).normalized() + std::sin(angle) * across);
    }
    default:
      return at + (index(random, 2) == 0 ? distance : -distance) * across;
  }
}

}  // namespace rebake::test
