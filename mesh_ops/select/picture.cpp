#include "mesh_ops/select/picture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/index/footprint.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/select/mask_culler.h"

namespace rebake {

PixelMask full_mask(int width, int height) {
  return {width, height,
          std::vector<std::uint8_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 1)};
}

PixelMask polygon_mask(const std::vector<Vec2>& corners, int width, int height) {
  PixelMask mask = full_mask(width, height);
  std::fill(mask.flags.begin(), mask.flags.end(), std::uint8_t{0});
  std::vector<double> crossings;
  for (int y = 0; y < height; ++y) {
    const double row = y + 0.5;
    crossings.clear();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec2 &a = corners[k], &b = corners[(k + 1) % corners.size()];
      if ((a.y() <= row) == (b.y() <= row)) continue;
      crossings.push_back(a.x() + (b.x() - a.x()) * ((row - a.y()) / (b.y() - a.y())));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
      const int begin = static_cast<int>(std::ceil(std::clamp(crossings[k] - 0.5, 0.0, static_cast<double>(width))));
      const int end = static_cast<int>(std::ceil(std::clamp(crossings[k + 1] - 0.5, 0.0, static_cast<double>(width))));
      const auto line = mask.flags.begin() + static_cast<std::ptrdiff_t>(y) * width;
      std::fill(line + begin, line + std::max(begin, end), std::uint8_t{1});
    }
  }
  return mask;
}

PixelMask brush_mask(const std::vector<Vec2>& points, double radius, int width, int height) {
  PixelMask mask = full_mask(width, height);
  std::fill(mask.flags.begin(), mask.flags.end(), std::uint8_t{0});
  tbb::parallel_for(0, height, [&](int y) {
    const double row = y + 0.5;
    // Each segment of the stroke is a capsule, which is convex, so it covers one interval of this row.
    std::vector<int> starts(static_cast<std::size_t>(width) + 1,
                            0);  // per pixel: intervals starting minus ending
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec2 &a = points[k], &b = points[std::min(k + 1, points.size() - 1)];
      if (std::min(a.y(), b.y()) - radius > row || std::max(a.y(), b.y()) + radius < row) continue;
      double low = std::numeric_limits<double>::infinity(), high = -low;
      const auto extend = [&](double x) {
        low = std::min(low, x);
        high = std::max(high, x);
      };
      for (const Vec2& end : {a, b}) {
        const double half = radius * radius - (row - end.y()) * (row - end.y());
        if (half < 0) continue;
        extend(end.x() - std::sqrt(half));
        extend(end.x() + std::sqrt(half));
      }
      const Vec2 along = b - a;
      if (const double length = along.norm(); length > 0 && along.y() != 0) {
        const Vec2 side = Vec2(-along.y(), along.x()) * (radius / length);
        for (const Vec2& start : {Vec2(a + side), Vec2(a - side)})
          if (const double t = (row - start.y()) / along.y(); t >= 0 && t <= 1) extend(start.x() + t * along.x());
      }
      const auto column = [&](double x) {
        return static_cast<std::size_t>(std::ceil(std::clamp(x - 0.5, 0.0, static_cast<double>(width))));
      };
      if (low > high) continue;
      // Includes a pixel whose centre lies exactly on the boundary.
      const std::size_t end =
          static_cast<std::size_t>(std::floor(std::clamp(high + 0.5, 0.0, static_cast<double>(width))));
      if (column(low) >= end) continue;
      ++starts[column(low)];
      --starts[end];
    }
    int open = 0;
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      open += starts[x];
      mask.flags[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x] = open > 0 ? 1 : 0;
    }
  });
  return mask;
}

Projector::Projector(const Picture& picture) : picture_(picture), eye_(picture.camera.eye) {
  check(picture.camera);
  rows_ = world_to_camera(picture.camera);
  half_height_ = half_height(picture.camera, 1);
}

bool Projector::operator()(const Vec3& world, At& at) const {
  const Vec3 p = rows_ * (world - eye_);
  at.depth = -p.z();
  if (!(at.depth >= picture_.camera.near_plane && at.depth <= picture_.camera.far_plane)) return false;
  const auto pixel = [](double v) { return static_cast<int>(std::floor(std::clamp(v, -1e9, 1e9))); };
  const double top = picture_.camera.orthographic() ? half_height_ : at.depth * half_height_,
               right = top * picture_.width / picture_.height;
  at.x = pixel((p.x() / right + 1) / 2 * picture_.width);
  at.y = pixel((1 - p.y() / top) / 2 * picture_.height);
  return true;
}

ViewRay Projector::ray(int x, int y) const {
  const double right = half_height_ * picture_.width / picture_.height;
  const Vec3 aside = rows_.transpose() * Vec3((2 * (x + 0.5) / picture_.width - 1) * right,
                                              (1 - 2 * (y + 0.5) / picture_.height) * half_height_, 0);
  const Vec3 forward = -rows_.row(2).transpose();
  if (picture_.camera.orthographic()) return {eye_ + aside, forward};
  return {eye_, aside + forward};
}

Vec3 Projector::start_for(const Vec3& world) const {
  const Vec3 back = rows_.row(2).transpose();
  const double depth = -back.dot(world - eye_), near = std::min(picture_.camera.near_plane, depth);
  if (picture_.camera.orthographic()) return world + (depth - near) * back;
  return near > 0 ? Vec3(eye_ + near / depth * (world - eye_)) : eye_;
}

TriangleSet projected_triangles(const BakedObject& object, const Affine& to_world, const Projector& project,
                                const PixelMask& mask, double nearest, double farthest) {
  TriangleSet flags(object.triangle_count(), 0);
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    const std::vector<Vec3>& p = set.soup.positions();
    tbb::parallel_for(std::size_t{0}, set.soup.triangle_count(), [&](std::size_t f) {
      const Face& face = set.soup.faces()[f];
      Projector::At at;
      if (!project(to_world * Vec3((p[face[0]] + p[face[1]] + p[face[2]]) / 3), at)) return;
      if (at.depth >= nearest && at.depth <= farthest && mask.at(at.x, at.y)) flags[first + f] = 1;
    });
    first += set.soup.triangle_count();
  }
  return flags;
}

std::vector<TriangleSet> visible_triangles(const std::vector<PlacedNode>& objects, const Projector& project,
                                           const PixelMask& mask, double nearest, double farthest) {
  std::vector<SceneRays::Instance> instances;
  MaskCuller through(project, mask);
  for (const PlacedNode& placed : objects) {
    const BakedObject& object = *placed.node->object;
    through.look_at(object, placed.to_world);
    instances.push_back({rays_for_mask(through, object), placed.to_world, object.bounds().diagonal().norm()});
  }
  const SceneRays scene(std::move(instances));
  std::vector<TriangleSet> flags;
  for (const PlacedNode& placed : objects) flags.emplace_back(placed.node->object->triangle_count(), 0);
  struct Pick {
    std::size_t object;
    std::uint32_t triangle;
  };
  std::vector<std::vector<Pick>> picks(static_cast<std::size_t>(mask.height));
  tbb::parallel_for(0, mask.height, [&](int y) {
    for (int first = 0; first < mask.width; first += 8) {
      const auto* const flags_here =
          mask.flags.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width);
      if (std::none_of(flags_here + first, flags_here + std::min(first + 8, mask.width),
                       [](std::uint8_t f) { return f != 0; }))
        continue;
      SceneRays::Bundle rays;
      for (int i = 0; i < 8; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const ViewRay ray = project.ray(first + i, y);
        rays.origins[k] = ray.origin;
        rays.directions[k] = ray.direction;
        rays.far[k] = mask.at(first + i, y) ? project.camera().far_plane : -1;
      }
      scene.nearest(rays, project.camera().near_plane);
      for (const auto& hit : rays.hits)
        if (hit && hit->t >= nearest && hit->t <= farthest)
          picks[static_cast<std::size_t>(y)].push_back({hit->instance, hit->triangle});
    }
  });
  for (const auto& row : picks)
    for (const Pick& pick : row) flags[pick.object][pick.triangle] = 1;
  return flags;
}

Viewpoint viewpoint_of(const Camera& camera, const Affine& to_object) {
  const Vec3 back = to_object.linear() * world_to_camera(camera).row(2).transpose();
  return {to_object * camera.eye, camera.orthographic() ? Vec3(back.normalized()) : Vec3::Zero()};
}

namespace {

// Barycentric coordinates of the centroid, and of points near each corner and edge.
const std::array<Vec3, 7> inner_points = {
    Vec3(1.0 / 3, 1.0 / 3, 1.0 / 3), Vec3(0.8, 0.1, 0.1),   Vec3(0.1, 0.8, 0.1),  Vec3(0.1, 0.1, 0.8),
    Vec3(0.45, 0.45, 0.1),           Vec3(0.1, 0.45, 0.45), Vec3(0.45, 0.1, 0.45)};

// Rays per triangle, if 16 points do not need more.
constexpr std::size_t max_rays = 4096;

}  // namespace

TriangleSet triangles_unseen(const BakedObject& object, const std::vector<Viewpoint>& viewpoints) {
  const auto rays = rays_of(object);
  const double size = object.bounds().diagonal().norm();
  TriangleSet flags(object.triangle_count(), 0);
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    tbb::parallel_for(std::size_t{0}, set.soup.triangle_count(), [&](std::size_t f) {
      const std::array<Vec2, 3> uv = texel_corners(set, f);
      const Face& face = set.soup.faces()[f];
      const std::vector<Vec3>& p = set.soup.positions();
      if ((p[face[1]] - p[face[0]]).cross(p[face[2]] - p[face[0]]).isZero(0)) {
        flags[first + f] = 1;  // a triangle without area is never drawn
        return;
      }
      std::vector<Vec3> opaque;
      // One point in each opaque texel that shows.
      for_each_texel_piece(uv, set.texels->width(), set.texels->height(),
                           [&](int x, int y, double /*area*/, const Vec2& at) {
                             if (!set.texels->opaque(x, y)) return;
                             const Vec3 w = barycentric(uv, at);
                             opaque.push_back(p[face[0]] * w[0] + p[face[1]] * w[1] + p[face[2]] * w[2]);
                           });
      // UVs without area, or that are not finite.
      if (opaque.empty())
        for (const Vec3& w : inner_points) {
          const Vec2 at = uv[0] * w[0] + uv[1] * w[1] + uv[2] * w[2];
          if (!at.allFinite()) continue;
          if (set.texels->opaque(texel_within(at.x(), set.texels->width()), texel_within(at.y(), set.texels->height())))
            opaque.push_back(p[face[0]] * w[0] + p[face[1]] * w[1] + p[face[2]] * w[2]);
        }
      // A number of points that depends on the number of eyes, spread evenly over all of them.
      const std::size_t most = std::max<std::size_t>(16, max_rays / std::max<std::size_t>(1, viewpoints.size()));
      const std::size_t tried = std::min(most, opaque.size());
      bool seen = false;
      for (std::size_t k = 0; k < tried && !seen; ++k) {
        const Vec3& point = opaque[k * opaque.size() / tried];
        for (const Viewpoint& from : viewpoints) {
          // Parallel rays start outside the object.
          const Vec3 eye = from.back.isZero(0) ? from.eye : Vec3(point + 1.5 * size * from.back);
          // The ray ends before the point by more than the tree's error.
          const Vec3 way = point - eye;
          const double distance = way.norm();
          if (distance > 0 && rays->blocked(eye, way, 0, 1 - 1e-5 * size / distance)) continue;
          seen = true;
          break;
        }
      }
      flags[first + f] = seen ? 0 : 1;
    });
    first += set.soup.triangle_count();
  }
  return flags;
}

std::vector<Viewpoint> viewpoints_around(const Box& box, int count, double distance) {
  // Fibonacci lattice.
  std::vector<Viewpoint> eyes;
  const double radius = distance * box.diagonal().norm() / 2;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
    const auto angle = elementary::sine_cosine(i * std::numbers::pi * (3 - std::sqrt(5.0)));
    eyes.push_back({box.center() + radius * Vec3(r * angle.cosine, z, r * angle.sine), Vec3::Zero()});
  }
  return eyes;
}

}  // namespace rebake
