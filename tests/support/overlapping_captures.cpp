#include "tests/support/overlapping_captures.h"

#include <cmath>
#include <numbers>
#include <random>

#include "mesh_ops/base/polar.h"

namespace rebake::test {

namespace {

double height(double x, double y) {
  double h = 0.06 * std::sin(5 * x + 1) + 0.05 * std::sin(7 * y + 2 * x) + 0.02 * std::cos(23 * x - 9 * y);
  // Pillars with steep sides.
  for (const auto& [px, py] : {std::pair(0.9, 0.2), {0.95, 0.75}, {0.3, 0.5}, {1.5, 0.4}, {1.05, 0.45}})
    h += 0.2 / (1 + std::exp(80 * (std::hypot(x - px, y - py) - 0.06)));
  return h;
}

std::shared_ptr<const BakedObject> capture(double from, double to, int steps, double outliers, std::mt19937& random,
                                           const Similarity& place) {
  std::vector<Vec3> positions;
  std::vector<Face> faces;
  const int columns = static_cast<int>(std::lround(steps * (to - from)));
  for (int j = 0; j <= steps; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double x = from + (to - from) * i / columns, y = static_cast<double>(j) / steps;
      positions.emplace_back(x, y, height(x, y));
    }
  for (int j = 0; j < steps; ++j)
    for (int i = 0; i < columns; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i), b = a + static_cast<std::uint32_t>(columns) + 1;
      faces.push_back({a, a + 1, b});
      faces.push_back({a + 1, b + 1, b});
    }
  std::uniform_real_distribution<double> unit(0, 1);
  const double width = 1.0 / steps;
  const auto count = static_cast<std::size_t>(outliers * static_cast<double>(faces.size()));
  for (std::size_t k = 0; k < count; ++k) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    const Vec3 at(from + (to - from) * unit(random), unit(random), unit(random) - 0.3);
    positions.push_back(at);
    positions.push_back(at + width * Vec3(unit(random), unit(random), unit(random)));
    positions.push_back(at + width * Vec3(unit(random), -unit(random), unit(random)));
    faces.push_back({first, first + 1, first + 2});
  }
  for (Vec3& p : positions) p = place(p);
  BakedObject object;
  object.decoder = std::make_shared<const Decoder>(diffuse_decoder());
  object.axes = Axes::forward;
  object.dialect.alpha = AlphaCode::plain;
  const auto texels = FeatureTexture::from_rows(4, 4, AlphaCode::plain, [](int, Texel* row) {
    for (int x = 0; x < 4; ++x) row[x] = {{255, 200, 150, 100}, {0, 0, 0, 255}};
  });
  std::vector<Vec2> uvs(positions.size(), Vec2(0.5, 0.5));
  object.sets.push_back(
      {Soup(std::move(positions), std::move(uvs), std::move(faces)), std::make_shared<const FeatureTexture>(texels)});
  return std::make_shared<const BakedObject>(std::move(object));
}

Similarity inverse(const Similarity& motion) {
  return {motion.rotation.transpose(), 1 / motion.scale, motion.center + motion.shift, -motion.shift};
}

}  // namespace

OverlappingCaptures overlapping_captures(double overlap, double outliers, const Similarity& truth, unsigned seed) {
  std::mt19937 random(seed);
  OverlappingCaptures captures;
  captures.truth = truth;
  const double first = 1 - overlap;
  Node fixed, moved;
  fixed.name = "fixed";
  fixed.object = capture(0, 1, 90, outliers, random, {});
  moved.name = "moved";
  moved.object = capture(first, first + 1, 83, outliers, random, inverse(truth));
  captures.scene = with_added(captures.scene, fixed, NodeId::none, 0);
  captures.scene = with_added(captures.scene, moved, NodeId::none, 1);
  captures.diagonal = fixed.object->bounds().diagonal().norm();
  for (const auto& [x, y] : {std::pair(0.1, 0.1), {0.9, 0.2}, {0.2, 0.9}, {0.8, 0.7}}) {
    const Vec3 place(first + overlap * x, y, height(first + overlap * x, y));
    captures.onto.push_back(place);
    captures.points.push_back(inverse(truth)(place));
  }
  return captures;
}

double place_error(const OverlappingCaptures& captures, const Affine& motion) {
  double largest = 0;
  for (const Vec3& p : captures.scene.roots[1]->object->sets[0].soup.positions())
    largest = std::max(largest, (motion * p - captures.truth(p)).norm());
  return largest / captures.diagonal;
}

double rotation_error(const OverlappingCaptures& captures, const Affine& motion) {
  const Mat3 turn = orthogonal_factor(motion.linear()) * captures.truth.rotation.transpose();
  return Eigen::AngleAxisd(turn).angle() * 180 / std::numbers::pi;
}

}  // namespace rebake::test
