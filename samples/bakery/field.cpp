#include "samples/bakery/field.h"

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rebake::bakery {

using std::numbers::pi;

namespace {

constexpr int finer = 4;  // tessellation cells per side of a quad
constexpr int sky_rays = 192;
constexpr int sun_rays = 48;
constexpr double sun_radius = 0.09;  // radians; soft shadows

Vec3 sky(const Vec3& d) {
  const double t = std::clamp(d.y() * 0.5 + 0.5, 0.0, 1.0);
  return Vec3(0.34, 0.30, 0.27) * (1 - t) + Vec3(0.75, 0.88, 1.1) * t;
}

double encode(double linear) {
  linear = std::clamp(linear, 0.0, 1.0);
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

struct Light {
  Vec3 irradiance = Vec3::Zero();  // divided by π
  double open = 0;                 // visible share of the sky
  double sun = 0;                  // visible share of the sun
};

Mat3 basis(const Vec3& n) {
  const Vec3 t = n.cross(std::abs(n.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
  Mat3 m;
  m.col(0) = t;
  m.col(1) = n.cross(t);
  m.col(2) = n;
  return m;
}

// The tessellation of a patch, with light at its vertices.
struct Grid {
  int columns, rows;  // numbers of cells
  std::vector<Light> light;
  const Patch* patch;

  Vec3 normal(double u, double v) const {
    const double h = 1e-4, u0 = std::max(0.0, u - h), u1 = std::min(1.0, u + h), v0 = std::max(0.0, v - h),
                 v1 = std::min(1.0, v + h);
    Vec3 n = (patch->point(u1, v) - patch->point(u0, v)).cross(patch->point(u, v1) - patch->point(u, v0));
    if (n.norm() < 1e-14) {
      // At a pole one derivative vanishes: evaluate slightly beside it.
      const double w = v < 0.5 ? v + 1e-2 : v - 1e-2;
      n = (patch->point(u1, w) - patch->point(u0, w))
              .cross(patch->point(u, std::min(1.0, w + h)) - patch->point(u, std::max(0.0, w - h)));
    }
    return n.stableNormalized();
  }
  Light at(double u, double v) const {
    const double x = u * columns, y = v * rows;
    const int i = std::clamp(static_cast<int>(x), 0, columns - 1), j = std::clamp(static_cast<int>(y), 0, rows - 1);
    const double fx = x - i, fy = y - j;
    Light sum;
    for (int k = 0; k < 4; ++k) {
      const Light& l = light[static_cast<std::size_t>((j + k / 2) * (columns + 1) + i + k % 2)];
      const double w = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy);
      sum.irradiance += w * l.irradiance;
      sum.open += w * l.open;
      sum.sun += w * l.sun;
    }
    return sum;
  }
};

struct PatchUv {
  double u, v;
};

PatchUv uv_of(const Grid& grid, unsigned prim, double a, double b) {
  // Two triangles per cell: (0, 1, 2) and (3, 2, 1).
  const int cell = static_cast<int>(prim / 2), i = cell % grid.columns, j = cell / grid.columns;
  const double x = prim % 2 == 0 ? a : 1 - a, y = prim % 2 == 0 ? b : 1 - b;
  return {(i + x) / grid.columns, (j + y) / grid.rows};
}

void alpha_filter(const RTCFilterFunctionNArguments* args) {
  const auto& grid = *static_cast<const Grid*>(args->geometryUserPtr);
  const auto* hit = reinterpret_cast<const RTCHit*>(args->hit);
  const PatchUv at = uv_of(grid, hit->primID, static_cast<double>(hit->u), static_cast<double>(hit->v));
  if (!grid.patch->opaque(std::clamp(at.u, 0.0, 1.0), std::clamp(at.v, 0.0, 1.0))) args->valid[0] = 0;
}

}  // namespace

class RadianceField::Impl {
 public:
  explicit Impl(const Model& model) : model_(model), device_(rtcNewDevice("threads=2")), scene_(rtcNewScene(device_)) {
    grids_.reserve(model.patches.size());
    Box box;
    for (const Patch& patch : model.patches) {
      Grid grid{patch.columns * finer, patch.rows * finer, {}, &patch};
      grid.light.resize(static_cast<std::size_t>((grid.columns + 1) * (grid.rows + 1)));
      grids_.push_back(std::move(grid));
    }
    for (const Grid& grid : grids_) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* vertices = static_cast<float*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, grid.light.size()));
      auto* indices =
          static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                                         static_cast<std::size_t>(grid.columns * grid.rows * 2)));
      for (int j = 0; j <= grid.rows; ++j)
        for (int i = 0; i <= grid.columns; ++i) {
          const Vec3 p = grid.patch->point(static_cast<double>(i) / grid.columns, static_cast<double>(j) / grid.rows);
          box.extend(p);
          for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(p[k]);
        }
      for (int j = 0; j < grid.rows; ++j)
        for (int i = 0; i < grid.columns; ++i) {
          const auto c = [&](int x, int y) { return static_cast<unsigned>((j + y) * (grid.columns + 1) + i + x); };
          for (const unsigned index : {c(0, 0), c(1, 0), c(0, 1), c(1, 1), c(0, 1), c(1, 0)}) *indices++ = index;
        }
      rtcSetGeometryUserData(geometry, const_cast<Grid*>(&grid));
      rtcSetGeometryIntersectFilterFunction(geometry, alpha_filter);
      rtcSetGeometryOccludedFilterFunction(geometry, alpha_filter);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene_, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_);
    offset_ = 2e-3 * std::min(box.diagonal().norm(), 3.0);
    for (Grid& grid : grids_)
      tbb::parallel_for(0, grid.rows + 1, [&](int j) {
        for (int i = 0; i <= grid.columns; ++i) {
          const double u = static_cast<double>(i) / grid.columns, v = static_cast<double>(j) / grid.rows;
          const Vec3 p = grid.patch->point(u, v), n = grid.normal(u, v);
          const double ray_offset = grid.patch->ray_offset > 0 ? grid.patch->ray_offset : offset_;
          Light light = gather(p, n, ray_offset);
          if (grid.patch->two_sided) {
            const Light other = gather(p, -n, ray_offset);
            light.irradiance = 0.6 * light.irradiance + 0.4 * other.irradiance;
            light.sun = std::max(light.sun, other.sun);
          }
          grid.light[static_cast<std::size_t>(j * (grid.columns + 1) + i)] = light;
        }
      });
  }
  ~Impl() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Color color(std::size_t k, double u, double v, const Vec3& direction) const {
    const Grid& grid = grids_[k];
    const Patch& patch = *grid.patch;
    const Vec3 p = patch.point(u, v);
    const Light light = grid.at(u, v);
    Vec3 out = patch.albedo(u, v, p).cwiseProduct(light.irradiance);
    if (patch.name == "backdrop") out = patch.albedo(u, v, p);
    if (patch.reflectance > 0) {
      Vec3 n = grid.normal(u, v);
      if (patch.two_sided && n.dot(direction) > 0) n = -n;
      const double facing = std::clamp(-n.dot(direction), 0.0, 1.0);
      const double fresnel = patch.reflectance + (0.6 - patch.reflectance) * std::pow(1 - facing, 5);
      const Vec3 mirrored = direction - 2 * n.dot(direction) * n;
      const double lobe = std::pow(std::max(0.0, mirrored.dot(model_.sun.normalized())), patch.sharpness);
      out += fresnel * (light.open * sky(mirrored) + light.sun * lobe * Vec3(4, 3.7, 3.2));
    }
    return {encode(out.x()), encode(out.y()), encode(out.z())};
  }

  const Grid& grid(std::size_t k) const { return grids_[k]; }
  double ray_offset() const { return offset_; }

  bool occluded(const Vec3& from, const Vec3& direction, double distance) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray{};
    ray.org_x = static_cast<float>(from.x()), ray.org_y = static_cast<float>(from.y()),
    ray.org_z = static_cast<float>(from.z());
    ray.dir_x = static_cast<float>(direction.x()), ray.dir_y = static_cast<float>(direction.y()),
    ray.dir_z = static_cast<float>(direction.z());
    ray.tfar = static_cast<float>(distance);
    ray.mask = ~0U;
    rtcOccluded1(scene_, &context, &ray);
    return ray.tfar < 0;
  }

  std::optional<Hit> hit(const Vec3& eye, const Vec3& direction) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(eye.x()), query.ray.org_y = static_cast<float>(eye.y()),
    query.ray.org_z = static_cast<float>(eye.z());
    query.ray.dir_x = static_cast<float>(direction.x()), query.ray.dir_y = static_cast<float>(direction.y()),
    query.ray.dir_z = static_cast<float>(direction.z());
    query.ray.tfar = std::numeric_limits<float>::infinity();
    query.ray.mask = ~0U;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const PatchUv at = uv_of(grids_[query.hit.geomID], query.hit.primID, static_cast<double>(query.hit.u),
                             static_cast<double>(query.hit.v));
    return Hit{query.hit.geomID, std::clamp(at.u, 0.0, 1.0), std::clamp(at.v, 0.0, 1.0),
               static_cast<double>(query.ray.tfar)};
  }

  bool visible(const Vec3& eye, std::size_t k, double u, double v) const {
    const Vec3 p = model_.patches[k].point(u, v), way = p - eye;
    const double distance = way.norm();
    return !occluded(eye, way / distance, distance - 3 * offset_);
  }

  Image trace(const Camera& camera, int width, int height, const Shade& shade) const {
    constexpr int side = 8;
    Image image{width, height,
                std::vector<std::uint8_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)};
    const Mat3 to_world = world_to_camera(camera).transpose();
    const double tan_half = std::tan(camera.fov_degrees / 2 * pi / 180);
    tbb::parallel_for(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        Vec3 sum = Vec3::Zero();
        for (int s = 0; s < side * side; ++s) {
          const double sx = (x + (s % side + 0.5) / side) / width * 2 - 1,
                       sy = 1 - (y + (s / side + 0.5) / side) / height * 2;
          const Vec3 d = (to_world * Vec3(sx * tan_half * width / height, sy * tan_half, -1)).normalized();
          const std::optional<Hit> found = hit(camera.eye, d);
          sum += found ? shade(found->patch, found->u, found->v, d) : Color(Color::Ones());
        }
        for (int c = 0; c < 3; ++c)
          image.rgb[static_cast<std::size_t>((y * width + x) * 3 + c)] =
              static_cast<std::uint8_t>(std::lround(sum[c] / (side * side) * 255));
      }
    });
    return image;
  }

 private:
  Light gather(const Vec3& p, const Vec3& n, double ray_offset) const {
    Light light;
    const Mat3 frame = basis(n);
    const Vec3 from = p + ray_offset * n;
    for (int k = 0; k < sky_rays; ++k) {
      // Cosine-weighted Fibonacci points of the hemisphere.
      const double r2 = (k + 0.5) / sky_rays, phi = 2 * pi * std::fmod(k * 0.6180339887498949, 1.0), r = std::sqrt(r2);
      const Vec3 d = frame * Vec3(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r2));
      const bool open = !occluded(from, d, 12);
      // Occluders send back a constant grey radiance, for one bounce.
      light.irradiance += (open ? sky(d) : Vec3(0.13, 0.12, 0.11)) / sky_rays;
      light.open += open ? 1.0 / sky_rays : 0;
    }
    const Vec3 sun = model_.sun.normalized();
    if (n.dot(sun) > 0) {
      const Mat3 sun_frame = basis(sun);
      for (int k = 0; k < sun_rays; ++k) {
        const double r = sun_radius * std::sqrt((k + 0.5) / sun_rays),
                     phi = 2 * pi * std::fmod(k * 0.6180339887498949, 1.0);
        if (!occluded(from, (sun_frame * Vec3(r * std::cos(phi), r * std::sin(phi), 1)).normalized(), 12))
          light.sun += 1.0 / sun_rays;
      }
      light.irradiance += light.sun * n.dot(sun) * Vec3(1.15, 1.05, 0.9);
    }
    return light;
  }

  const Model& model_;
  RTCDevice device_;
  RTCScene scene_;
  std::vector<Grid> grids_;
  double offset_ = 0;
};

RadianceField::RadianceField(const Model& model) : impl_(std::make_unique<Impl>(model)) {}
RadianceField::~RadianceField() = default;
Color RadianceField::color(std::size_t patch, double u, double v, const Vec3& direction) const {
  return impl_->color(patch, u, v, direction);
}
Vec3 RadianceField::normal(std::size_t patch, double u, double v) const { return impl_->grid(patch).normal(u, v); }
std::array<double, 2> RadianceField::openness(std::size_t patch, double u, double v) const {
  const Light light = impl_->grid(patch).at(u, v);
  return {light.open, light.sun};
}
Vec3 RadianceField::irradiance(std::size_t patch, double u, double v) const {
  return impl_->grid(patch).at(u, v).irradiance;
}
bool RadianceField::visible(const Vec3& eye, std::size_t patch, double u, double v) const {
  return impl_->visible(eye, patch, u, v);
}
std::optional<RadianceField::Hit> RadianceField::hit(const Vec3& eye, const Vec3& direction) const {
  return impl_->hit(eye, direction);
}
double RadianceField::ray_offset() const { return impl_->ray_offset(); }
Image RadianceField::trace(const Camera& camera, int width, int height) const {
  return impl_->trace(camera, width, height, [this](std::size_t patch, double u, double v, const Vec3& direction) {
    return color(patch, u, v, direction);
  });
}
Image RadianceField::trace(const Camera& camera, int width, int height, const Shade& color) const {
  return impl_->trace(camera, width, height, color);
}

}  // namespace rebake::bakery
