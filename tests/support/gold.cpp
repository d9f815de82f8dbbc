#include "tests/support/gold.h"

namespace rebake::test {

namespace {

Gold3 operator-(const Gold3& a, const Gold3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Gold3 operator*(const Gold3& a, const Gold& s) { return {a[0] * s, a[1] * s, a[2] * s}; }
Gold dot(const Gold3& a, const Gold3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Gold3 cross(const Gold3& a, const Gold3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Gold length(const Gold3& a) { return sqrt(dot(a, a)); }

}  // namespace

Gold3 gold(const Vec3& v) { return {Gold(v.x()), Gold(v.y()), Gold(v.z())}; }

std::vector<Gold> gold_mean_value(const Cage& cage, const Gold3& point) {
  std::vector<Gold> weights(cage.vertices.size(), Gold(0));
  Gold total = 0;
  for (const Face& face : cage.faces) {
    std::array<Gold3, 3> e;
    for (std::size_t k = 0; k < 3; ++k) e[k] = gold(cage.vertices[face[k]]) - point;
    const Gold3 normal = cross(e[1] - e[0], e[2] - e[0]);
    if (dot(normal, normal) == 0) continue;
    if (dot(normal, e[0]) == 0) {
      std::array<Gold, 3> lambda;
      for (std::size_t k = 0; k < 3; ++k)
        lambda[k] = dot(cross(e[(k + 1) % 3], e[(k + 2) % 3]), normal) / dot(normal, normal);
      if (lambda[0] < 0 || lambda[1] < 0 || lambda[2] < 0) continue;
      weights.assign(cage.vertices.size(), Gold(0));
      for (std::size_t k = 0; k < 3; ++k) weights[face[k]] = lambda[k];
      return weights;
    }
    Gold3 mean{Gold(0), Gold(0), Gold(0)};
    std::array<Gold3, 3> side;
    for (std::size_t k = 0; k < 3; ++k) {
      const Gold3 &a = e[(k + 1) % 3], &b = e[(k + 2) % 3];
      side[k] = cross(a, b);
      const Gold sine = length(side[k]);
      const Gold3 share = side[k] * (atan2(sine, dot(a, b)) / sine / 2);
      for (std::size_t axis = 0; axis < 3; ++axis) mean[axis] += share[axis];
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Gold weight = dot(side[k], mean) / dot(side[k], e[k]);
      weights[face[k]] += weight;
      total += weight;
    }
  }
  for (Gold& weight : weights) weight /= total;
  return weights;
}

std::vector<Gold> gold_green(const Cage& cage, const Gold3& point) {
  const Gold full = 4 * acos(Gold(-1));
  std::vector<Gold> weights(cage.vertices.size() + cage.faces.size(), Gold(0));
  for (std::size_t f = 0; f < cage.faces.size(); ++f) {
    const Face& face = cage.faces[f];
    std::array<Gold3, 3> e;
    std::array<Gold, 3> r;
    for (std::size_t k = 0; k < 3; ++k) {
      e[k] = gold(cage.vertices[face[k]]) - point;
      r[k] = length(e[k]);
    }
    Gold3 normal = cross(e[1] - e[0], e[2] - e[0]);
    const Gold area = length(normal);  // twice the area
    if (area == 0) continue;
    normal = normal * (1 / area);
    const Gold h = dot(e[0], normal);
    const Gold angle = 2 * atan2(dot(e[0], cross(e[1], e[2])), r[0] * r[1] * r[2] + dot(e[0], e[1]) * r[2] +
                                                                   dot(e[1], e[2]) * r[0] + dot(e[2], e[0]) * r[1]);
    Gold sum = 0;
    Gold3 logs{Gold(0), Gold(0), Gold(0)};
    std::array<Gold, 3> lambda;
    std::array<Gold3, 3> slope;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      const Gold3 along = e[j] - e[i];
      const Gold size = length(along);
      const Gold3 outward = cross(along * (1 / size), normal);
      const Gold a = dot(e[i], outward);
      const Gold log_k = log((r[i] + r[j] + size) / (r[i] + r[j] - size));
      sum += a * log_k;
      for (std::size_t axis = 0; axis < 3; ++axis) logs[axis] += outward[axis] * log_k;
      lambda[k] = a * size / area;
      slope[k] = outward * (-size / area);
    }
    for (std::size_t k = 0; k < 3; ++k) weights[face[k]] += (lambda[k] * angle - h * dot(slope[k], logs)) / full;
    weights[cage.vertices.size() + f] = (sum - h * angle) / full;
  }
  return weights;
}

std::vector<Vec3> gold_gradients(std::vector<Gold> (*weights)(const Cage&, const Gold3&), const Cage& cage,
                                 const Vec3& point) {
  const Gold step("1e-40");
  std::vector<Vec3> result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Gold3 low = gold(point), high = low;
    low[axis] -= step;
    high[axis] += step;
    const std::vector<Gold> below = weights(cage, low), above = weights(cage, high);
    result.resize(below.size());
    for (std::size_t i = 0; i < below.size(); ++i)
      result[i][static_cast<int>(axis)] = static_cast<double>((above[i] - below[i]) / (2 * step));
  }
  return result;
}

}  // namespace rebake::test
