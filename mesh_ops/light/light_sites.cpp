#include "mesh_ops/light/light_sites.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

// Corners of an object's triangles at one of their two places, and what surfaces are like there.
struct Surface {
  std::vector<std::array<Vec3, 3>> corners;
  std::vector<Vec3> normals;  // twice the area long
  std::vector<std::array<Vec3, 3>> smooth;
  std::vector<std::array<double, 3>> roughness;  // sine of the angle by which facets around a corner differ
  std::vector<double> pitch;                     // size of the facets
};

// Faces whose normals differ by less than this are one surface: beyond it there is an edge.
constexpr double smooth_cosine = 0.5;

void smooth_normals(const WeldedCorners& welded, Surface& surface) {
  const std::size_t faces = surface.corners.size();
  std::vector<std::uint32_t> first(welded.place_count + 1, 0), around(faces * 3);
  for (const std::uint32_t place : welded.places) ++first[place + 1];
  for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::uint32_t c = 0; c < welded.places.size(); ++c) around[next[welded.places[c]]++] = c / 3;
  surface.smooth.resize(faces);
  surface.roughness.resize(faces);
  tbb::parallel_for(std::size_t{0}, faces, [&](std::size_t f) {
    const Vec3 own = surface.normals[f].stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t place = welded.places[f * 3 + k];
      Vec3 sum = Vec3::Zero();
      double differing = 0, area = 0;
      for (std::uint32_t a = first[place]; a < first[place + 1]; ++a) {
        // Triangles of soups may face either way.
        const Vec3& other = surface.normals[around[a]];
        const double size = other.stableNorm();
        if (!(size > 0)) continue;
        const double cosine = own.dot(other) / size;
        if (std::abs(cosine) >= smooth_cosine) sum += cosine < 0 ? Vec3(-other) : other;
        differing += size * (1 - std::min(1.0, cosine * cosine));
        area += size;
      }
      const Vec3 normal = sum.stableNormalized();
      surface.smooth[f][k] = normal.allFinite() && normal.squaredNorm() > 0.5 ? normal : own;
      surface.roughness[f][k] = area > 0 ? std::sqrt(differing / area) : 0;
    }
  });
}

Surface surface_of(const WeldedCorners& welded, std::vector<std::array<Vec3, 3>> corners) {
  Surface surface;
  surface.corners = std::move(corners);
  surface.normals.resize(surface.corners.size());
  surface.pitch.resize(surface.corners.size());
  for (std::size_t f = 0; f < surface.corners.size(); ++f) {
    const auto& [a, b, c] = surface.corners[f];
    surface.normals[f] = (b - a).cross(c - a);
    surface.pitch[f] = std::sqrt(surface.normals[f].stableNorm());
  }
  smooth_normals(welded, surface);
  return surface;
}

// Rays start above what a facet departs from the smooth surface: hardly where facets agree, a whole facet where they
// do not (a soup would shade itself).
constexpr double least_offset = 0.04, offset_a_sine = 1.0;

LightSite site_at(const Surface& surface, std::size_t face, const Vec3& w) {
  const auto& corners = surface.corners[face];
  LightSite site{};
  site.position = w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2];
  const auto& smooth = surface.smooth[face];
  const Vec3& own = surface.normals[face];
  Vec3 normal = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vec3& n = smooth[static_cast<std::size_t>(k)];
    normal += w[k] * (n.dot(own) < 0 ? Vec3(-n) : n);
  }
  site.normal = normal.stableNormalized();
  const Vec3 along = corners[1] - corners[0];
  Vec3 tangent = along - along.dot(site.normal) * site.normal;
  if (!(tangent.squaredNorm() > 1e-12 * along.squaredNorm())) tangent = site.normal.unitOrthogonal();
  site.tangent = tangent.stableNormalized();
  double roughness = 0;
  for (int k = 0; k < 3; ++k) roughness += w[k] * surface.roughness[face][static_cast<std::size_t>(k)];
  site.offset = surface.pitch[face] * std::clamp(offset_a_sine * roughness, least_offset, 1.0);
  return site;
}

}  // namespace

LightSites light_sites(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts) {
  LightSites sites;
  const auto welded = corners_of(object);
  const auto components = components_of(object);
  const std::vector<BakedBody> bodies = bodies_of(object);
  std::vector<Affine> to_body;
  for (const BakedBody& body : bodies) to_body.push_back(body.to_object.inverse());
  std::vector<std::array<Vec3, 3>> now, baked;
  std::vector<std::uint32_t> body_of;
  bool any_moved = false;
  for (const TextureSet& set : object.sets) {
    const auto* displaced = set.soup.vertex_attributes().find<Eigen::Vector3f>(Soup::displacement);
    const auto* body = set.soup.face_attributes().find<std::uint16_t>(BakedObject::body);
    any_moved = any_moved || displaced != nullptr;
    for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
      const Face& face = set.soup.faces()[f];
      body_of.push_back(body != nullptr ? (*body)[f] : 0);
      std::array<Vec3, 3> at, before;
      for (std::size_t k = 0; k < 3; ++k) {
        at[k] = set.soup.positions()[face[k]];
        before[k] = displaced != nullptr ? Vec3(at[k] - (*displaced)[face[k]].cast<double>()) : at[k];
      }
      now.push_back(at);
      baked.push_back(before);
    }
  }
  const Surface surface_now = surface_of(*welded, now);
  const Surface surface_baked = any_moved ? surface_of(*welded, baked) : surface_now;
  std::uint32_t first_face = 0;
  for (std::size_t s = 0; s < charts.size(); ++s) {
    sites.first.push_back(sites.size());
    for (const LightChart::Node& node : charts[s]->nodes) {
      const std::uint32_t face = first_face + node.face;
      const Vec3 weights = node.weights.cast<double>();
      sites.body.push_back(body_of[face]);
      sites.part.push_back(components->part_of[face]);
      sites.now.push_back(site_at(surface_now, face, weights));
      LightSite before = site_at(surface_baked, face, weights);
      const Affine& change = to_body[body_of[face]];
      if (!change.matrix().isIdentity(0)) {
        before.position = change * before.position;
        before.normal = (change.linear().inverse().transpose() * before.normal).normalized();
        const Vec3 tangent = change.linear() * before.tangent;
        before.tangent = (tangent - tangent.dot(before.normal) * before.normal).normalized();
        before.offset *= std::cbrt(std::abs(change.linear().determinant()));
      }
      sites.baked.push_back(before);
    }
    first_face += static_cast<std::uint32_t>(object.sets[s].soup.triangle_count());
  }
  sites.first.push_back(sites.size());
  return sites;
}

}  // namespace rebake
