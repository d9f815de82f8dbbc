#include "mesh_ops/rays/ray_tree.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// Data of one texture set that the hit filter needs to look up a texel.
struct Surface {
  const std::vector<Face>* faces;
  const std::vector<Vec2>* uvs;
  const FeatureTexture* texels;
  std::uint32_t first_triangle;
  const std::uint32_t* numbers;  // face numbers of a subset; null: all faces

  std::uint32_t face(std::uint32_t primitive) const { return numbers != nullptr ? numbers[primitive] : primitive; }
  std::uint32_t triangle(std::uint32_t primitive) const { return first_triangle + face(primitive); }
  bool opaque(std::uint32_t primitive, double u, double v) const {
    const Face& corners = (*faces)[face(primitive)];
    const Vec2 uv = (*uvs)[corners[0]] * (1 - u - v) + (*uvs)[corners[1]] * u + (*uvs)[corners[2]] * v;
    return texels->opaque_at(uv.x(), uv.y());
  }
};

// Passed with each ray, so that trees with different textures can share triangles.
struct Context {
  RTCIntersectContext embree;
  const Surface* surfaces;  // one per texture set

  explicit Context(const std::vector<Surface>& of) : embree{}, surfaces(of.data()) { rtcInitIntersectContext(&embree); }
};

bool count_bytes(void* sum, ssize_t bytes, bool /*after*/) {
  *static_cast<std::atomic<std::int64_t>*>(sum) += bytes;
  return true;
}

void reject_transparent(const RTCFilterFunctionNArguments* args) {
  const auto* const surfaces = reinterpret_cast<const Context*>(args->context)->surfaces;
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const Surface& surface = surfaces[RTCHitN_geomID(args->hit, args->N, i)];
    const double u = RTCHitN_u(args->hit, args->N, i), v = RTCHitN_v(args->hit, args->N, i);
    if (!surface.opaque(RTCHitN_primID(args->hit, args->N, i), u, v)) args->valid[i] = 0;
  }
}

}  // namespace

// A ray in the tree's frame, where the longest side of the object's box is ½ … 1. The origin is moved along the ray to
// the box, and the direction is a unit vector, so that floats suffice for distant eyes and for tiny or huge objects.
struct LocalRay {
  std::array<float, 3> origin{}, direction{};
  float near = 0, far = -1;
  double shift = 0;    // distance that the origin was moved, in the caller's t
  double length = 1;   // length of the caller's direction in this frame
  bool meets = false;  // whether the ray meets the box

  double t(float local) const { return shift + static_cast<double>(local) / length; }
};

class RayTriangles::Impl {
 public:
  Impl(const BakedObject& object, const std::vector<std::uint32_t>* only)
      : device_(rtcNewDevice(instructions())), scene_(nullptr), some_(only != nullptr) {
    if (device_ == nullptr) throw DeviceError("Embree cannot be started; reinstall its library");
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
    scene_ = rtcNewScene(device_);
    const Box box = object.bounds();
    if (!box.isEmpty() && box.sizes().allFinite()) {
      center_ = box.center();
      int exponent = 0;
      std::frexp(box.sizes().maxCoeff(), &exponent);
      scale_ = box.sizes().maxCoeff() > 0 ? std::ldexp(1.0, -exponent) : 1.0;
      const Vec3 half = box.sizes() / 2 * scale_;
      half_ = half + Vec3::Constant(1e-6 + 1e-6 * half.maxCoeff());
    }
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    std::size_t first = 0, next = 0;
    for (const TextureSet& set : object.sets) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      // A set without triangles gets a geometry too, so that geometry numbers equal set numbers.
      const std::size_t end = first + set.soup.triangle_count();
      std::vector<std::uint32_t>& numbers = numbers_.emplace_back();
      counts_.push_back(set.soup.triangle_count());
      if (only != nullptr) {
        for (; next < only->size() && (*only)[next] < end; ++next)
          numbers.push_back((*only)[next] - static_cast<std::uint32_t>(first));
        counts_.back() = numbers.size();
        if (!numbers.empty()) add_triangles(geometry, set.soup, numbers);
      } else if (set.soup.triangle_count() > 0) {
        add_triangles(geometry, set.soup);
      }
      first = end;
      triangle_count_ += counts_.back();
      rtcSetGeometryIntersectFilterFunction(geometry, reject_transparent);
      rtcSetGeometryOccludedFilterFunction(geometry, reject_transparent);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene_, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
      release();
      throw DeviceError(error == RTC_ERROR_OUT_OF_MEMORY
                            ? "there is not enough memory for the ray tracing hierarchy (Embree BVH)"
                            : "Embree reports error " + std::to_string(error));
    }
  }
  ~Impl() { release(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  std::uint64_t memory() const { return static_cast<std::uint64_t>(std::max<std::int64_t>(0, bytes_)); }
  RTCScene scene() const { return scene_; }
  const std::uint32_t* numbers(std::size_t set) const { return some_ ? numbers_[set].data() : nullptr; }
  Box bounds() const { return Box(Vec3(center_ - half_ / scale_), Vec3(center_ + half_ / scale_)); }
  Affine to_frame() const { return Eigen::Scaling(scale_) * Eigen::Translation3d(-center_); }
  std::size_t triangle_count() const { return triangle_count_; }
  std::vector<std::array<std::vector<float>, 9>> corners(std::size_t room) const {
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    std::vector<std::array<std::vector<float>, 9>> sets;
    for (unsigned set = 0; set < numbers_.size(); ++set) {
      std::array<std::vector<float>, 9>& columns = sets.emplace_back();
      RTCGeometry geometry = rtcGetGeometry(scene_, set);
      const auto* vertices = static_cast<const float*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
      const auto* faces =
          static_cast<const std::uint32_t*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_INDEX, 0));
      const std::size_t count = counts_[set];
      for (std::size_t column = 0; column < 9; ++column) {
        columns[column].assign(count + room, none);
        for (std::size_t f = 0; f < count; ++f) {
          const float value = vertices[3 * std::size_t{faces[3 * f + column / 3]} + column % 3];
          columns[column][f] = std::isfinite(value) ? value : none;
        }
      }
    }
    return sets;
  }
  LocalRay local_ray(const Vec3& origin, const Vec3& direction, double near, double far) const {
    LocalRay ray;
    const Vec3 d = direction * scale_, o = (origin - center_) * scale_;
    const double squared = d.squaredNorm();
    ray.length = squared > 1e-200 && squared < 1e200 ? std::sqrt(squared) : d.stableNorm();
    if (!(far >= near) || !(ray.length > 0) || !std::isfinite(ray.length) || !o.allFinite()) return ray;
    // Ray parameters of entering and leaving the box. Most rays start inside.
    double enters = near, leaves = far;
    const bool within = near >= 0 && (o.cwiseAbs().array() <= half_.array()).all();
    for (int axis = 0; axis < 3; ++axis) {
      if (d[axis] == 0) {
        if (std::abs(o[axis]) > half_[axis]) return ray;
        continue;
      }
      const double side = std::copysign(half_[axis], d[axis]);
      if (!within) enters = std::max(enters, (-side - o[axis]) / d[axis]);
      leaves = std::min(leaves, (side - o[axis]) / d[axis]);
    }
    if (!(enters <= leaves)) return ray;
    ray.meets = true;
    ray.shift = enters;
    const Vec3 start = o + d * enters, along = d / ray.length;
    for (int axis = 0; axis < 3; ++axis) {
      ray.origin[static_cast<std::size_t>(axis)] = static_cast<float>(start[axis]);
      ray.direction[static_cast<std::size_t>(axis)] = static_cast<float>(along[axis]);
    }
    ray.far = static_cast<float>((leaves - enters) * ray.length);
    return ray;
  }

 private:
  // Limits Embree to instructions that find the same triangles at silhouettes and shared corners on every processor.
  // SSE 4.2 gives the same bits as SSE 2 and is faster. AVX may find another one of several triangles at the same
  // distance, and AVX 2 other distances too.
  static const char* instructions() {
#ifdef __x86_64__
    if (__builtin_cpu_supports("sse4.2")) return "isa=sse4.2";
#endif
    return "isa=sse2";
  }

  void add_triangles(RTCGeometry geometry, const Soup& soup) {
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), soup.positions().size()));
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Face),
                                            soup.faces().size());
    if (vertices == nullptr || indices == nullptr) return;  // the constructor reports the device's error
    for (const Vec3& p : soup.positions()) vertices = put(p, vertices);
    std::memcpy(indices, soup.faces().data(), soup.faces().size() * sizeof(Face));
  }
  // Subsets are small, so each of their triangles gets its own vertices.
  void add_triangles(RTCGeometry geometry, const Soup& soup, const std::vector<std::uint32_t>& numbers) {
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), 3 * numbers.size()));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), numbers.size()));
    if (vertices == nullptr || indices == nullptr) return;
    std::iota(indices, indices + 3 * numbers.size(), 0U);
    for (const std::uint32_t number : numbers)
      for (const std::uint32_t corner : soup.faces()[number]) vertices = put(soup.positions()[corner], vertices);
  }
  float* put(const Vec3& position, float* to) const {
    const Vec3 local = (position - center_) * scale_;
    for (int k = 0; k < 3; ++k) *to++ = static_cast<float>(local[k]);
    return to;
  }

  void release() {
    if (scene_ != nullptr) rtcReleaseScene(scene_);
    if (device_ != nullptr) rtcReleaseDevice(device_);
  }

  std::atomic<std::int64_t> bytes_ = 0;  ///< memory held by Embree, in bytes
  RTCDevice device_;
  RTCScene scene_;
  bool some_;                                        ///< only a subset of the triangles is included
  std::vector<std::vector<std::uint32_t>> numbers_;  ///< per set: faces of the subset; empty if all are included
  std::vector<std::size_t> counts_;                  ///< per set: number of included triangles
  std::size_t triangle_count_ = 0;
  Vec3 center_{0, 0, 0};
  double scale_ = 1;             ///< a power of two
  Vec3 half_{1e-6, 1e-6, 1e-6};  ///< half size of the box in the tree's frame, slightly enlarged
};

class RayTree::Impl {
 public:
  Impl(std::shared_ptr<const RayTriangles> triangles, const BakedObject& object) : triangles_(std::move(triangles)) {
    std::uint32_t first = 0;
    for (const TextureSet& set : object.sets) {
      surfaces_.push_back(
          {&set.soup.faces(), &set.soup.uvs(), set.texels.get(), first, triangles_->impl_->numbers(surfaces_.size())});
      first += static_cast<std::uint32_t>(set.soup.triangle_count());
    }
  }

  std::uint64_t memory() const { return surfaces_.size() * sizeof(Surface); }
  std::optional<Hit> nearest(const Vec3& origin, const Vec3& direction, double near, double far) const {
    const LocalRay local = triangles_->impl_->local_ray(origin, direction, near, far);
    if (!local.meets) return std::nullopt;
    Context context(surfaces_);
    RTCRayHit query{};
    query.ray = embree_ray(local);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(triangles_->impl_->scene(), &context.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{local.t(query.ray.tfar), surfaces_[query.hit.geomID].triangle(query.hit.primID)};
  }
  void nearest(Bundle& rays, double near) const {
    Context context(surfaces_);
    context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit8 query{};
    alignas(32) std::array<int, 8> valid{};
    std::array<LocalRay, 8> local;
    for (std::size_t i = 0; i < 8; ++i) {
      local[i] = triangles_->impl_->local_ray(rays.origins[i], rays.directions[i], near, rays.far[i]);
      valid[i] = local[i].meets ? -1 : 0;
      query.ray.org_x[i] = local[i].origin[0];
      query.ray.org_y[i] = local[i].origin[1];
      query.ray.org_z[i] = local[i].origin[2];
      query.ray.dir_x[i] = local[i].direction[0];
      query.ray.dir_y[i] = local[i].direction[1];
      query.ray.dir_z[i] = local[i].direction[2];
      query.ray.tnear[i] = local[i].near;
      query.ray.tfar[i] = local[i].far;
      query.ray.mask[i] = ~0U;
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid.data(), triangles_->impl_->scene(), &context.embree, &query);
    for (std::size_t i = 0; i < 8; ++i) {
      rays.hit[i] = valid[i] != 0 && query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      if (!rays.hit[i]) continue;
      rays.far[i] = local[i].t(query.ray.tfar[i]);
      rays.triangle[i] = surfaces_[query.hit.geomID[i]].triangle(query.hit.primID[i]);
    }
  }
  const RayTriangles::Impl& triangles() const { return *triangles_->impl_; }
  bool solid(std::size_t set) const {
    const FeatureTexture& texels = *surfaces_[set].texels;
    std::uint64_t opaque = 0;
    for (int row = 0; row < texels.tile_rows(); ++row)
      for (int column = 0; column < texels.tile_columns(); ++column) opaque += texels.tile(column, row)->opaque_count();
    return opaque == static_cast<std::uint64_t>(texels.width()) * static_cast<std::uint64_t>(texels.height());
  }
  bool opaque(std::size_t set, std::uint32_t primitive, double b1, double b2) const {
    return surfaces_[set].opaque(primitive, b1, b2);
  }
  bool blocked(const Vec3& origin, const Vec3& direction, double near, double far) const {
    const LocalRay local = triangles_->impl_->local_ray(origin, direction, near, far);
    if (!local.meets) return false;
    Context context(surfaces_);
    RTCRay query = embree_ray(local);
    rtcOccluded1(triangles_->impl_->scene(), &context.embree, &query);
    return query.tfar < 0;
  }

 private:
  static RTCRay embree_ray(const LocalRay& local) {
    RTCRay ray{};
    ray.org_x = local.origin[0];
    ray.org_y = local.origin[1];
    ray.org_z = local.origin[2];
    ray.dir_x = local.direction[0];
    ray.dir_y = local.direction[1];
    ray.dir_z = local.direction[2];
    ray.tnear = local.near;
    ray.tfar = local.far;
    ray.mask = ~0U;
    return ray;
  }

  std::shared_ptr<const RayTriangles> triangles_;
  std::vector<Surface> surfaces_;
};

RayTriangles::RayTriangles(const BakedObject& object) : impl_(std::make_unique<Impl>(object, nullptr)) {}
RayTriangles::RayTriangles(const BakedObject& object, const std::vector<std::uint32_t>& only)
    : impl_(std::make_unique<Impl>(object, &only)) {}
RayTriangles::RayTriangles(RayTriangles&&) noexcept = default;
RayTriangles::~RayTriangles() = default;
std::uint64_t RayTriangles::memory() const { return impl_->memory(); }

RayTree::RayTree(const BakedObject& object) : RayTree(std::make_shared<const RayTriangles>(object), object) {}
RayTree::RayTree(std::shared_ptr<const RayTriangles> triangles, const BakedObject& object)
    : impl_(std::make_unique<Impl>(std::move(triangles), object)) {}
RayTree::RayTree(RayTree&&) noexcept = default;
RayTree::~RayTree() = default;
std::uint64_t RayTree::memory() const { return impl_->memory(); }
std::optional<RayTree::Hit> RayTree::nearest(const Vec3& origin, const Vec3& direction, double near, double far) const {
  return impl_->nearest(origin, direction, near, far);
}
void RayTree::nearest(Bundle& rays, double near) const { impl_->nearest(rays, near); }
Box RayTree::bounds() const { return impl_->triangles().bounds(); }
Affine RayTree::to_frame() const { return impl_->triangles().to_frame(); }
std::size_t RayTree::triangle_count() const { return impl_->triangles().triangle_count(); }
std::vector<std::array<std::vector<float>, 9>> RayTree::corners(std::size_t room) const {
  return impl_->triangles().corners(room);
}
bool RayTree::solid(std::size_t set) const { return impl_->solid(set); }
bool RayTree::opaque(std::size_t set, std::uint32_t triangle, double b1, double b2) const {
  return impl_->opaque(set, triangle, b1, b2);
}
bool RayTree::blocked(const Vec3& origin, const Vec3& direction, double near, double far) const {
  return impl_->blocked(origin, direction, near, far);
}

}  // namespace rebake
