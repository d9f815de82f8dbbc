#include "tests/support/oracle.h"

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <numbers>

namespace rebake::test {

namespace {

struct Surface {
  const TextureSet* set;
  const BakedObject* object;
  Mat3 world_to_object;       // for directions
  std::vector<Vec3> corners;  // world positions relative to the eye
  int decoder;
  std::unique_ptr<const TexelReader> texels;
};

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  unsigned surface = 0;
  unsigned face = 0;
  Texel texel;
  Vec3 fed;
  bool found = false;
};

struct CastContext {
  RTCIntersectContext base;
  const std::vector<Surface>* surfaces;
  Vec3 start, ray;  // relative to the eye; the ray's length along the view axis is 1
  double nearest, farthest;
  bool parallel;  // orthographic camera
  Hit hit;
};

// Möller–Trumbore in double; false if the ray misses by more than rounding.
bool intersect(const Vec3& start, const Vec3& ray, const Vec3& a, const Vec3& b, const Vec3& c, double& t, double& u,
               double& v) {
  const Vec3 e1 = b - a, e2 = c - a, p = ray.cross(e2);
  const double det = e1.dot(p);
  if (det == 0) return false;
  const Vec3 s = start - a, q = s.cross(e1);
  u = s.dot(p) / det;
  v = ray.dot(q) / det;
  t = e2.dot(q) / det;
  return u >= -1e-7 && v >= -1e-7 && u + v <= 1 + 1e-7;
}

void filter(const RTCFilterFunctionNArguments* args) {
  args->valid[0] = 0;  // rejects every hit, so that Embree reports all of them; they are compared here in double
  auto& context = *reinterpret_cast<CastContext*>(args->context);
  const auto* hit = reinterpret_cast<const RTCHit*>(args->hit);
  const Surface& surface = (*context.surfaces)[hit->geomID];
  const Soup& soup = surface.set->soup;
  const Face& face = soup.faces()[hit->primID];
  double t = 0, u = 0, v = 0;
  if (!intersect(context.start, context.ray, surface.corners[face[0]], surface.corners[face[1]],
                 surface.corners[face[2]], t, u, v))
    return;
  if (t < context.nearest || t > context.farthest) return;
  // At equal depth, the triangle that is drawn later is visible (depth test less-or-equal).
  if (t > context.hit.t) return;
  if (t == context.hit.t && std::pair(hit->geomID, hit->primID) < std::pair(context.hit.surface, context.hit.face))
    return;
  const Vec2 uv = soup.uvs()[face[0]] * (1 - u - v) + soup.uvs()[face[1]] * u + soup.uvs()[face[2]] * v;
  const FeatureTexture& texels = *surface.set->texels;
  const int x = std::clamp(static_cast<int>(std::floor(uv.x() * texels.width())), 0, texels.width() - 1);
  const int y = std::clamp(static_cast<int>(std::floor((1 - uv.y()) * texels.height())), 0, texels.height() - 1);
  const Texel& texel = surface.texels->at(x, y);
  if (texel.feat0[0] == 0) return;
  Vec3 direction = surface.world_to_object * context.ray;
  if (soup.rotations() != nullptr) {
    // The corners' view rays are rotated back to the baked pose and interpolated without normalisation.
    Vec3 sum = Vec3::Zero();
    const double weight[3] = {1 - u - v, u, v};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 corner_ray = surface.world_to_object * (context.parallel ? context.ray : surface.corners[face[k]]);
      sum += weight[k] * ((*soup.rotations())[face[k]].matrix().transpose() * corner_ray);
    }
    direction = sum;
  }
  direction.normalize();
  context.hit = {t,
                 hit->geomID,
                 hit->primID,
                 texel,
                 surface.object->axes == Axes::forward ? direction : Vec3(direction.x(), -direction.z(), direction.y()),
                 true};
}

Mat3 inverse_rotation(const Mat3& linear) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(linear / linear.norm(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  return (svd.matrixU() * svd.matrixV().transpose()).transpose();
}

// The colour of one decoder's samples. `input`: sums over samples, divided by the number of all samples, of which
// `coverage` show the object.
Vec3 decoded(const Decoder& d, std::array<double, 11> input, double coverage) {
  if (d.rule != ColorRule::network)
    for (double& value : input) value /= coverage;
  const Vec3 diffuse(input[1], input[2], input[3]);
  if (d.rule == ColorRule::diffuse) return diffuse;
  std::vector<double> values(input.begin(), input.end());
  const auto layer = [&values](const Eigen::MatrixXd& w, const Eigen::VectorXd& b, bool relu) {
    std::vector<double> out(static_cast<std::size_t>(b.size()));
    for (Eigen::Index j = 0; j < b.size(); ++j) {
      double sum = b[j];
      for (std::size_t i = 0; i < values.size(); ++i) sum += values[i] * w(static_cast<Eigen::Index>(i), j);
      out[static_cast<std::size_t>(j)] = relu && sum < 0 ? 0 : sum;
    }
    values = out;
  };
  layer(d.weights0, d.bias0, true);
  layer(d.weights1, d.bias1, true);
  layer(d.weights2, d.bias2, false);
  const Vec3 out(1 / (1 + std::exp(-values[0])), 1 / (1 + std::exp(-values[1])), 1 / (1 + std::exp(-values[2])));
  return d.rule == ColorRule::network ? out : Vec3(diffuse + out);
}

}  // namespace

Image cast_picture(const Scene& scene, const View& view) {
  const Vec3 back = (view.camera.eye - view.camera.target).normalized();
  const Vec3 right = view.camera.up.cross(back).normalized();
  const Vec3 up = back.cross(right);
  std::vector<Surface> surfaces;
  std::vector<const Decoder*> decoders;
  const auto placed_list = placed_nodes(scene);
  for (const PlacedNode& placed : placed_list) {
    if (!placed.visible || !placed.node->object) continue;
    int decoder = 0;
    while (decoder < static_cast<int>(decoders.size()) &&
           !(*decoders[static_cast<std::size_t>(decoder)] == *placed.node->object->decoder))
      ++decoder;
    if (decoder == static_cast<int>(decoders.size())) decoders.push_back(placed.node->object->decoder.get());
    for (const TextureSet& set : placed.node->object->sets) {
      Surface surface{&set, placed.node->object.get(), inverse_rotation(placed.to_world.linear()), {}, decoder, {}};
      for (const Vec3& p : set.soup.positions())
        surface.corners.push_back(placed.to_world.linear() * p + (placed.to_world.translation() - view.camera.eye));
      surface.texels = std::make_unique<const TexelReader>(*set.texels);
      surfaces.push_back(std::move(surface));
    }
  }
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene rays = rtcNewScene(device);
  rtcSetSceneFlags(rays, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  for (const Surface& surface : surfaces) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, surface.corners.size()));
    for (std::size_t v = 0; v < surface.corners.size(); ++v)
      for (int k = 0; k < 3; ++k)
        vertices[v * 3 + static_cast<std::size_t>(k)] = static_cast<float>(surface.corners[v][k]);
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   12, surface.set->soup.faces().size()));
    for (std::size_t f = 0; f < surface.set->soup.faces().size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) indices[f * 3 + k] = surface.set->soup.faces()[f][k];
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(rays, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(rays);

  const int side = view.samples == 1 ? 1 : view.samples == 4 ? 2 : 4;
  const bool parallel = view.camera.ortho_height > 0;
  const double half =
      parallel ? view.camera.ortho_height / 2 : std::tan(view.camera.fov_degrees / 2 * std::numbers::pi / 180);
  const double aspect = static_cast<double>(view.width) / view.height;
  Image image{view.width, view.height,
              std::vector<std::uint8_t>(static_cast<std::size_t>(view.width * view.height) * 3)};
  tbb::parallel_for(0, view.height, [&](int y) {
    for (int x = 0; x < view.width; ++x) {
      struct Sum {
        std::array<double, 11> input{};
        double coverage = 0;
      };
      std::vector<Sum> sums(decoders.size());
      for (int k = 0; k < side * side; ++k) {
        const double sx = (x + (k % side + 0.5) / side) / view.width * 2 - 1,
                     sy = 1 - (y + (k / side + 0.5) / side) / view.height * 2;
        const Vec3 aside = sx * half * aspect * right + sy * half * up;
        CastContext context{{},
                            &surfaces,
                            parallel ? aside : Vec3(0, 0, 0),
                            parallel ? Vec3(-back) : Vec3(aside - back),
                            view.camera.near_plane,
                            view.camera.far_plane,
                            parallel,
                            {}};
        rtcInitIntersectContext(&context.base);
        context.base.filter = filter;
        RTCRayHit query{};
        query.ray.org_x = static_cast<float>(context.start.x());
        query.ray.org_y = static_cast<float>(context.start.y());
        query.ray.org_z = static_cast<float>(context.start.z());
        query.ray.dir_x = static_cast<float>(context.ray.x());
        query.ray.dir_y = static_cast<float>(context.ray.y());
        query.ray.dir_z = static_cast<float>(context.ray.z());
        query.ray.tfar = std::numeric_limits<float>::infinity();
        query.ray.mask = ~0U;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(rays, &context.base, &query);
        if (!context.hit.found) continue;
        const Surface& surface = surfaces[context.hit.surface];
        Sum& sum = sums[static_cast<std::size_t>(surface.decoder)];
        const bool halved = surface.set->texels->alpha_code() == AlphaCode::halved;
        for (std::size_t c = 0; c < 8; ++c) {
          const double byte = c < 4 ? context.hit.texel.feat0[c] : context.hit.texel.feat1[c - 4];
          sum.input[c] += (c % 4 == 3 && halved ? 2 * byte / 255 - 1 : byte / 255) / (side * side);
        }
        for (std::size_t c = 0; c < 3; ++c)
          sum.input[8 + c] += context.hit.fed[static_cast<Eigen::Index>(c)] / (side * side);
        sum.coverage += 1.0 / (side * side);
      }
      Vec3 color = Vec3::Zero();
      double coverage = 0;
      for (std::size_t k = 0; k < sums.size(); ++k) {
        if (sums[k].coverage == 0) continue;
        color += sums[k].coverage * decoded(*decoders[k], sums[k].input, sums[k].coverage).cwiseMin(1.0);
        coverage += sums[k].coverage;
      }
      color += (1 - coverage) * scene.background;
      for (int c = 0; c < 3; ++c)
        image.rgb[static_cast<std::size_t>((y * view.width + x) * 3 + c)] =
            static_cast<std::uint8_t>(std::lround(std::clamp(color[c], 0.0, 1.0) * 255));
    }
  });
  rtcReleaseScene(rays);
  rtcReleaseDevice(device);
  return image;
}

}  // namespace rebake::test
