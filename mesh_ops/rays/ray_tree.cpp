#include "mesh_ops/rays/ray_tree.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cstring>

namespace rebake {

namespace {

// What the filter needs to look a hit's texel up.
struct Surface {
  TextureSet set;
  std::uint32_t first_triangle;
};

void let_through_transparent(const RTCFilterFunctionNArguments* args) {
  const auto& surface = *static_cast<const Surface*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const unsigned primitive = RTCHitN_primID(args->hit, args->N, i);
    const double u = RTCHitN_u(args->hit, args->N, i), v = RTCHitN_v(args->hit, args->N, i);
    const Face& face = surface.set.soup.faces()[primitive];
    const std::vector<Vec2>& uvs = surface.set.soup.uvs();
    const Vec2 uv = uvs[face[0]] * (1 - u - v) + uvs[face[1]] * u + uvs[face[2]] * v;
    if (!surface.set.texels->sample(uv.x(), uv.y()).opaque()) args->valid[i] = 0;
  }
}

}  // namespace

class RayTree::Impl {
 public:
  explicit Impl(const BakedObject& object)
      : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)), center_(object.bounds().center()) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    std::uint32_t first = 0;
    surfaces_.reserve(object.sets.size());
    for (const TextureSet& set : object.sets) {
      surfaces_.push_back({set, first});
      const Soup& soup = set.soup;
      first += static_cast<std::uint32_t>(soup.triangle_count());
      if (soup.triangle_count() == 0) {
        // Keeps the geometry numbers those of the sets.
        RTCGeometry empty = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcCommitGeometry(empty);
        rtcAttachGeometry(scene_, empty);
        rtcReleaseGeometry(empty);
        continue;
      }
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), soup.positions().size()));
      for (const Vec3& p : soup.positions()) {
        const Vec3 relative = p - center_;
        for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(relative[k]);
      }
      void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Face),
                                              soup.faces().size());
      std::memcpy(indices, soup.faces().data(), soup.faces().size() * sizeof(Face));
      rtcSetGeometryUserData(geometry, &surfaces_.back());
      rtcSetGeometryIntersectFilterFunction(geometry, let_through_transparent);
      rtcSetGeometryOccludedFilterFunction(geometry, let_through_transparent);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene_, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_);
  }
  ~Impl() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  std::optional<Hit> nearest(const Vec3& origin, const Vec3& direction, double near, double far) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray = ray(origin, direction, near, far);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{query.ray.tfar, surfaces_[query.hit.geomID].first_triangle + query.hit.primID};
  }
  void nearest(Bundle& rays, double near) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit8 query{};
    alignas(32) std::array<int, 8> valid{};
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec3 start = rays.origins[i] - center_;
      valid[i] = rays.far[i] >= near ? -1 : 0;
      query.ray.org_x[i] = static_cast<float>(start.x());
      query.ray.org_y[i] = static_cast<float>(start.y());
      query.ray.org_z[i] = static_cast<float>(start.z());
      query.ray.dir_x[i] = static_cast<float>(rays.directions[i].x());
      query.ray.dir_y[i] = static_cast<float>(rays.directions[i].y());
      query.ray.dir_z[i] = static_cast<float>(rays.directions[i].z());
      query.ray.tnear[i] = static_cast<float>(near);
      query.ray.tfar[i] = static_cast<float>(rays.far[i]);
      query.ray.mask[i] = ~0U;
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid.data(), scene_, &context, &query);
    for (std::size_t i = 0; i < 8; ++i) {
      rays.hit[i] = valid[i] != 0 && query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      if (!rays.hit[i]) continue;
      rays.far[i] = static_cast<double>(query.ray.tfar[i]);
      rays.triangle[i] = surfaces_[query.hit.geomID[i]].first_triangle + query.hit.primID[i];
    }
  }
  bool blocked(const Vec3& origin, const Vec3& direction, double near, double far) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay query = ray(origin, direction, near, far);
    rtcOccluded1(scene_, &context, &query);
    return query.tfar < 0;
  }

 private:
  RTCRay ray(const Vec3& origin, const Vec3& direction, double near, double far) const {
    const Vec3 start = origin - center_;
    RTCRay ray{};
    ray.org_x = static_cast<float>(start.x());
    ray.org_y = static_cast<float>(start.y());
    ray.org_z = static_cast<float>(start.z());
    ray.dir_x = static_cast<float>(direction.x());
    ray.dir_y = static_cast<float>(direction.y());
    ray.dir_z = static_cast<float>(direction.z());
    ray.tnear = static_cast<float>(near);
    ray.tfar = static_cast<float>(far);
    ray.mask = ~0U;
    return ray;
  }

  RTCDevice device_;
  RTCScene scene_;
  Vec3 center_;
  std::vector<Surface> surfaces_;
};

RayTree::RayTree(const BakedObject& object) : impl_(std::make_unique<Impl>(object)) {}
RayTree::~RayTree() = default;
std::optional<RayTree::Hit> RayTree::nearest(const Vec3& origin, const Vec3& direction, double near, double far) const {
  return impl_->nearest(origin, direction, near, far);
}
void RayTree::nearest(Bundle& rays, double near) const { impl_->nearest(rays, near); }
bool RayTree::blocked(const Vec3& origin, const Vec3& direction, double near, double far) const {
  return impl_->blocked(origin, direction, near, far);
}

}  // namespace rebake
