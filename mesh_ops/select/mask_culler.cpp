#include "mesh_ops/select/mask_culler.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "mesh_ops/index/index.h"

namespace rebake {

MaskCuller::MaskCuller(const Projector& project, const PixelMask& mask)
    : project_(project), width_(mask.width), height_(mask.height) {
  sums_.resize(static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1));
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const bool flagged = mask.at(x, y);
      sums_[corner(x + 1, y + 1)] =
          flagged_before(x, y + 1) + flagged_before(x + 1, y) - flagged_before(x, y) + (flagged ? 1 : 0);
      if (!flagged) continue;
      left_ = std::min(left_, x);
      right_ = std::max(right_, x);
      top_ = std::min(top_, y);
      bottom_ = std::max(bottom_, y);
    }
}

void MaskCuller::look_at(const BakedObject& object, const Affine& to_world) {
  // Exceeds the tree's error.
  room_ = 1e-5 * object.bounds().diagonal().norm();
  const Camera& camera = project_.camera();
  const Mat3 turn = world_to_camera(camera) * to_world.linear();
  const double pixels = height_ / (2 * half_height(camera, 1));
  eye_ = to_world.inverse() * camera.eye;
  across_ = pixels * turn.row(0).transpose();
  down_ = -pixels * turn.row(1).transpose();
  depth_ = -turn.row(2).transpose();
  pixels_a_unit_ = pixels * to_world.linear().norm();
  const Affine to_object = to_world.inverse();
  std::array<ViewRay, 4> corners{project_.ray(left_ - 1, top_ - 1), project_.ray(right_ + 1, top_ - 1),
                                 project_.ray(right_ + 1, bottom_ + 1), project_.ray(left_ - 1, bottom_ + 1)};
  for (ViewRay& corner : corners)
    corner = {to_object * corner.origin, (to_object.linear() * corner.direction).normalized()};
  for (std::size_t k = 0; k < 4; ++k) {
    const ViewRay &a = corners[k], &b = corners[(k + 1) % 4], &across = corners[(k + 2) % 4];
    Vec3 normal = a.direction.cross(b.origin - a.origin + b.direction);
    // The rays are too close: rounding would rotate the plane by more than a pixel.
    constexpr double min_sine = 1e-6;
    if (!(normal.norm() > min_sine)) {
      sides_[k] = {};
      continue;
    }
    normal.normalize();
    if (normal.dot(across.origin - a.origin + across.direction) < 0) normal = -normal;
    sides_[k] = {normal, normal.dot(a.origin)};
  }
}

bool MaskCuller::beside(const Box& box) const {
  return right_ < left_ || std::any_of(sides_.begin(), sides_.end(), [&](const Side& side) {
           const Vec3 farthest = (side.normal.array() > 0).select(box.max(), box.min());
           return side.normal.dot(farthest) < side.at - room_;
         });
}

bool MaskCuller::may_hit(const Vec3& a, const Vec3& b, const Vec3& c) const {
  for (const Side& side : sides_) {
    // With NaN the comparisons are false, so nothing is culled.
    const double nearest = side.at - room_;
    if (side.normal.dot(a) < nearest && side.normal.dot(b) < nearest && side.normal.dot(c) < nearest) return false;
  }
  double x0 = std::numeric_limits<double>::infinity(), x1 = -x0, y0 = x0, y1 = -x0, nearest_depth = x0;
  const Camera& camera = project_.camera();
  for (const Vec3* corner : {&a, &b, &c}) {
    const Vec3 from_eye = *corner - eye_;
    const double depth = depth_.dot(from_eye);
    if (!(depth > 0 && depth >= camera.near_plane && depth <= camera.far_plane)) return true;
    const double shrinks = camera.orthographic() ? 1 : 1 / depth, x = across_.dot(from_eye) * shrinks,
                 y = down_.dot(from_eye) * shrinks;
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
    nearest_depth = std::min(nearest_depth, depth);
  }
  const double room = 2 + room_ * pixels_a_unit_ / (camera.orthographic() ? 1 : nearest_depth);
  const auto pixel = [&](double centred, int most) {
    return static_cast<int>(std::clamp(centred + most / 2.0, 0.0, static_cast<double>(most)));
  };
  const int left = pixel(x0 - room, width_), right = pixel(x1 + room + 1, width_), top = pixel(y0 - room, height_),
            bottom = pixel(y1 + room + 1, height_);
  return flagged_before(right, bottom) - flagged_before(left, bottom) - flagged_before(right, top) +
             flagged_before(left, top) >
         0;
}

std::shared_ptr<const RayTree> rays_for_mask(const MaskCuller& mask, const BakedObject& object) {
  std::vector<std::uint32_t> shown;
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    const std::vector<Vec3>& p = set.soup.positions();
    const std::size_t count = mask.beside(set.soup.bounds()) ? 0 : set.soup.triangle_count();
    constexpr std::size_t batch = 4096;
    std::vector<std::vector<std::uint32_t>> batches((count + batch - 1) / batch);
    tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) {
      for (std::size_t f = b * batch; f < std::min(count, (b + 1) * batch); ++f) {
        const Face& face = set.soup.faces()[f];
        if (mask.may_hit(p[face[0]], p[face[1]], p[face[2]]))
          batches[b].push_back(static_cast<std::uint32_t>(first + f));
      }
    });
    for (const auto& some : batches) shown.insert(shown.end(), some.begin(), some.end());
    first += set.soup.triangle_count();
  }
  constexpr std::size_t many = 8;
  if (many * shown.size() > first) return rays_of(object);
  return std::make_shared<const RayTree>(std::make_shared<const RayTriangles>(object, shown), object);
}

}  // namespace rebake
