#include "mesh_ops/simulation/cloth.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace rebake {

Cloth::Cloth(std::vector<Vec3> places, std::vector<double> kilograms, std::vector<Spring> its_springs)
    : positions(std::move(places)),
      velocities(positions.size(), Vec3::Zero()),
      masses(std::move(kilograms)),
      springs(std::move(its_springs)) {
  if (masses.size() != positions.size()) throw std::invalid_argument("a cloth needs one mass per point");
  for (const Spring& spring : springs)
    for (const std::uint32_t point : spring.points)
      if (point >= positions.size()) throw std::invalid_argument("a spring names a point that does not exist");
}

void Cloth::advance(double seconds, int substeps, const std::vector<Vec3>* held) {
  if (substeps < 1) throw std::invalid_argument("a cloth advances in at least one step");
  const double h = seconds / substeps;
  std::vector<std::uint32_t> fixed;
  std::vector<Vec3> from;
  if (held != nullptr)
    for (std::uint32_t p = 0; p < positions.size(); ++p)
      if (masses[p] == 0) {
        fixed.push_back(p);
        from.push_back(positions[p]);
      }
  if (held != nullptr && held->size() != fixed.size()) throw std::invalid_argument("each held point needs a place");
  for (int k = 0; k < substeps; ++k) {
    const double share = static_cast<double>(k + 1) / substeps;
    for (std::size_t i = 0; i < fixed.size(); ++i) positions[fixed[i]] = from[i] + share * ((*held)[i] - from[i]);
    step(h);
  }
}

void Cloth::step(double h) {
  const std::vector<Vec3> before = positions;
  for (std::size_t p = 0; p < positions.size(); ++p) {
    if (masses[p] == 0) continue;
    Vec3& v = velocities[p];
    v += h * gravity;
    // Implicit: decays at any step.
    const Vec3 air = wind ? wind(positions[p], time_) : Vec3(0, 0, 0);
    v = (v + h * drag * air) / (1 + h * drag);
    positions[p] += h * v;
  }
  for (const Spring& spring : springs) {
    const auto [a, b] = spring.points;
    const double wa = masses[a] > 0 ? 1 / masses[a] : 0, wb = masses[b] > 0 ? 1 / masses[b] : 0;
    const Vec3 along = positions[a] - positions[b];
    const double length = along.norm(), weight = wa + wb + spring.compliance / (h * h);
    if (!(length > 0) || !(wa + wb > 0)) continue;
    const Vec3 push = (length - spring.rest) / (weight * length) * along;
    positions[a] -= wa * push;
    positions[b] += wb * push;
  }
  for (std::size_t p = 0; p < positions.size(); ++p)
    velocities[p] = masses[p] > 0 ? Vec3((positions[p] - before[p]) / h) : Vec3(0, 0, 0);
  time_ += h;
}

double Cloth::energy() const {
  double sum = 0;
  for (std::size_t p = 0; p < positions.size(); ++p)
    sum += masses[p] * (velocities[p].squaredNorm() / 2 - gravity.dot(positions[p]));
  for (const Spring& spring : springs)
    if (spring.compliance > 0) {
      const double off = (positions[spring.points[0]] - positions[spring.points[1]]).norm() - spring.rest;
      sum += off * off / (2 * spring.compliance);
    }
  return sum;
}

Vec3 Cloth::momentum() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t p = 0; p < positions.size(); ++p) sum += masses[p] * velocities[p];
  return sum;
}

Vec3 Cloth::angular_momentum() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t p = 0; p < positions.size(); ++p) sum += masses[p] * positions[p].cross(velocities[p]);
  return sum;
}

double Cloth::largest_stretch() const {
  double largest = 0;
  for (const Spring& spring : springs) {
    const double length = (positions[spring.points[0]] - positions[spring.points[1]]).norm();
    if (spring.rest > 0) largest = std::max(largest, std::abs(length - spring.rest) / spring.rest);
  }
  return largest;
}

Cloth hanging_sheet(const SheetOptions& options) {
  const int side = options.side;
  const double cell = options.width / (side - 1);
  std::vector<Vec3> positions;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      positions.emplace_back(column * cell - options.width / 2, options.width / 2 - row * cell, 0);
  std::vector<Cloth::Spring> springs;
  const auto connect = [&](int row, int column, int down, int right, double compliance) {
    if (row + down >= side || column + right >= side || column + right < 0) return;
    springs.push_back({{static_cast<std::uint32_t>(row * side + column),
                        static_cast<std::uint32_t>((row + down) * side + column + right)},
                       cell * std::hypot(down, right),
                       compliance});
  };
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      connect(row, column, 0, 1, options.stretching);
      connect(row, column, 1, 0, options.stretching);
      connect(row, column, 1, 1, options.shearing);
      connect(row, column, 1, -1, options.shearing);
      connect(row, column, 0, 2, options.bending);
      connect(row, column, 2, 0, options.bending);
    }
  return {std::move(positions),
          std::vector<double>(static_cast<std::size_t>(side * side), options.mass / (side * side)), std::move(springs)};
}

}  // namespace rebake
