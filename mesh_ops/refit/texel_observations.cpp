#include "mesh_ops/refit/texel_observations.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/index/footprint.h"

namespace rebake {

namespace {

// Views flatter than this, as a cosine, show texels only as slivers.
constexpr double least_cosine = 0.1;

double focal_of(const FitPhotograph& photograph) {
  return photograph.height / (2 * std::tan(photograph.camera.fov_degrees * std::numbers::pi / 360));
}

}  // namespace

std::vector<ObservedTexel> observed_texels(const BakedObject& object, const TriangleSet& chosen) {
  std::vector<ObservedTexel> texels;
  const Mat3 axes = axes_matrix(object.axes);
  std::size_t first_flag = 0;
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    const TextureSet& set = object.sets[s];
    const int width = set.texels->width();
    // The largest piece of a texel decides its place.
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> known(static_cast<std::size_t>(width) * static_cast<std::size_t>(set.texels->height()),
                                     none);
    std::vector<float> areas;
    const std::size_t base = texels.size();
    for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
      const Face& face = set.soup.faces()[f];
      const std::array<Vec2, 3> corners = texel_corners(set, f);
      const auto& positions = set.soup.positions();
      const Vec3 &a = positions[face[0]], &b = positions[face[1]], &c = positions[face[2]];
      const Vec3 normal = (b - a).cross(c - a);
      if (!(normal.squaredNorm() > 0)) continue;
      Mat3 to_fed = axes;
      if (const auto* turns = set.soup.rotations()) to_fed = axes * (*turns)[face[0]].matrix().transpose();
      for_each_texel_piece(corners, width, set.texels->height(), [&](int x, int y, double area, const Vec2& centroid) {
        if (!set.texels->opaque(x, y)) return;
        const Vec3 shares = barycentric(corners, centroid);
        auto& number =
            known[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
        const bool fresh = number == none;
        if (fresh) {
          number = static_cast<std::uint32_t>(texels.size());
          texels.emplace_back();
          areas.push_back(0);
        }
        ObservedTexel& texel = texels[number];
        texel.chosen = texel.chosen || chosen[first_flag + f] != 0;
        float& largest = areas[number - base];
        if (!fresh && !(area > static_cast<double>(largest))) return;
        largest = static_cast<float>(area);
        texel.set = static_cast<std::uint32_t>(s);
        texel.x = static_cast<std::uint32_t>(x);
        texel.y = static_cast<std::uint32_t>(y);
        texel.position = shares[0] * a + shares[1] * b + shares[2] * c;
        texel.normal = normal;
        texel.to_fed = to_fed;
      });
    }
    first_flag += set.soup.triangle_count();
  }
  return texels;
}

ObservingPhotograph::ObservingPhotograph(const FitPhotograph& photograph, const SceneRays& occluders, double scene_size,
                                         double largest_pixel)
    : photograph_(photograph),
      occluders_(occluders),
      to_camera_(world_to_camera(photograph.camera)),
      largest_pixel_(largest_pixel),
      focal_(focal_of(photograph)),
      depths_(static_cast<std::size_t>(photograph.width) * static_cast<std::size_t>(photograph.height),
              std::numeric_limits<float>::infinity()) {
  const Mat3 to_world = to_camera_.transpose();
  const double far = scene_size + 2 * photograph.camera.eye.norm();
  tbb::parallel_for(0, photograph.height, [&](int y) {
    for (int first = 0; first < photograph.width; first += 8) {
      SceneRays::Bundle rays;
      for (int k = 0; k < 8; ++k) {
        const int x = std::min(first + k, photograph.width - 1);
        const auto lane = static_cast<std::size_t>(k);
        rays.origins[lane] = photograph.camera.eye;
        rays.directions[lane] = to_world * Vec3((x + 0.5 - photograph.width / 2.0) / focal_,
                                                -(y + 0.5 - photograph.height / 2.0) / focal_, -1);
        rays.far[lane] = far;
      }
      occluders.nearest(rays, 0);
      for (int k = 0; k < 8 && first + k < photograph.width; ++k)
        if (const auto& hit = rays.hits[static_cast<std::size_t>(k)])
          depths_[static_cast<std::size_t>(y) * static_cast<std::size_t>(photograph.width) +
                  static_cast<std::size_t>(first + k)] = static_cast<float>(hit->t);
    }
  });
}

Observation ObservingPhotograph::observe(const ObservedTexel& texel, const Affine& to_world,
                                         const Mat3& world_to_object_turn) const {
  const Vec3 world = to_world * texel.position, way = world - photograph_.camera.eye, seen = to_camera_ * way;
  if (!(seen.z() < 0)) return {};
  const double depth = -seen.z(), x = photograph_.width / 2.0 + focal_ * seen.x() / depth - 0.5,
               y = photograph_.height / 2.0 - focal_ * seen.y() / depth - 0.5;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  if (!(left >= 0 && top >= 0 && left + 1 < photograph_.width && top + 1 < photograph_.height)) return {};
  // Normals transform by the inverse transpose.
  const Vec3 normal = (to_world.linear().inverse().transpose() * texel.normal).stableNormalized();
  const double cosine = std::abs(normal.dot(way.stableNormalized()));
  if (!(cosine >= least_cosine) || !(depth / focal_ <= largest_pixel_)) return {};
  if (occluders_.blocked(photograph_.camera.eye, world)) return {};
  Observation made;
  const Vec3 in_camera = to_camera_ * normal;
  // Along the surface, one pixel changes the depth by its width over the cosine; curved surfaces by some more.
  const double tolerance = 3 * depth / focal_ / cosine;
  std::array<double, 3> color{};
  for (int corner = 0; corner < 4; ++corner) {
    const int px = left + corner % 2, py = top + corner / 2;
    const auto p =
        static_cast<std::size_t>(py) * static_cast<std::size_t>(photograph_.width) + static_cast<std::size_t>(px);
    if (photograph_.valid[p] == 0) return {};
    const double share = (corner % 2 == 1 ? x - left : left + 1 - x) * (corner / 2 == 1 ? y - top : top + 1 - y);
    for (std::size_t c = 0; c < 3; ++c) color[c] += share * photograph_.rgb[3 * p + c] / 255;
    // Depth of the texel's plane at the pixel.
    const Vec3 ray((px + 0.5 - photograph_.width / 2.0) / focal_, -(py + 0.5 - photograph_.height / 2.0) / focal_, -1);
    const double plane = in_camera.dot(seen) / in_camera.dot(ray);
    made.mixed = made.mixed || !(std::abs(static_cast<double>(depths_[p]) - plane) <= tolerance);
  }
  const Vec3 fed = texel.to_fed * (world_to_object_turn * way.stableNormalized());
  for (std::size_t c = 0; c < 3; ++c) {
    made.color[c] = static_cast<float>(color[c]);
    made.fed_direction[c] = static_cast<float>(fed[static_cast<Eigen::Index>(c)]);
  }
  // Pixels of nearer cameras are smaller on the surface.
  made.weight = static_cast<float>(cosine * focal_ / depth);
  return made;
}

}  // namespace rebake
