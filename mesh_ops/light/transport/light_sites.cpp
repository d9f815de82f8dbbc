#include "mesh_ops/light/transport/light_sites.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

// An object's triangles as baked or as edited, with their normals and roughness.
struct Surface {
  std::vector<std::array<Vec3, 3>> corners;  // per face: positions
  std::vector<Vec3> normals;                 // per face; length: twice the area
  std::vector<std::array<Vec3, 3>> smooth;   // per corner: unit smooth normal
  // Per corner and side: deviation of the surrounding facets from the smooth surface, as the root mean square of sines.
  std::vector<std::array<std::array<double, 2>, 3>> roughness;
  std::vector<double> pitch;  // per face: size, the square root of twice the area
};

// Cosine (60°) between normals of adjacent faces above which they are one smooth surface. Below it there is an edge.
constexpr double smooth_cosine = 0.5;
// Height of a face beyond an edge, relative to its size, below which it occludes next to nothing.
constexpr double relevant_height = 0.1;

// The faces around each welded vertex, as compressed rows.
struct FacesAround {
  std::vector<std::uint32_t> first, faces;
  std::span<const std::uint32_t> of(std::uint32_t place) const {
    return {faces.data() + first[place], faces.data() + first[place + 1]};
  }
};
FacesAround faces_around(const WeldedCorners& welded) {
  FacesAround around{std::vector<std::uint32_t>(welded.place_count + 1, 0),
                     std::vector<std::uint32_t>(welded.places.size())};
  for (const std::uint32_t place : welded.places) ++around.first[place + 1];
  for (std::size_t k = 1; k < around.first.size(); ++k) around.first[k] += around.first[k - 1];
  std::vector<std::uint32_t> next(around.first.begin(), around.first.end() - 1);
  for (std::uint32_t c = 0; c < welded.places.size(); ++c) around.faces[next[welded.places[c]]++] = c / 3;
  return around;
}

void smooth_normals(const WeldedCorners& welded, const FacesAround& around, Surface& surface) {
  const std::size_t faces = surface.corners.size();
  surface.smooth.resize(faces);
  tbb::parallel_for(std::size_t{0}, faces, [&](std::size_t f) {
    const Vec3 own = surface.normals[f].stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 sum = Vec3::Zero();
      for (const std::uint32_t a : around.of(welded.places[f * 3 + k])) {
        // Triangles of soups may face either way.
        const Vec3& other = surface.normals[a];
        const double size = other.stableNorm();
        if (!(size > 0)) continue;
        const double cosine = own.dot(other) / size;
        if (std::abs(cosine) >= smooth_cosine) sum += cosine < 0 ? Vec3(-other) : other;
      }
      const Vec3 normal = sum.stableNormalized();
      surface.smooth[f][k] = normal.allFinite() && normal.squaredNorm() > 0.5 ? normal : own;
    }
  });
}

// A facet of a smooth surface is perpendicular to the mean normal of its corners, even if the surface is curved. A
// facet of a ragged surface is not. Faces that rise at an edge count as roughness 1, because they block all rays that
// start below their top.
void find_roughness(const WeldedCorners& welded, const FacesAround& around, Surface& surface) {
  const std::size_t faces = surface.corners.size();
  std::vector<double> ragged(faces, 0);  // per face: squared sine between its normal and the mean normal of its corners
  tbb::parallel_for(std::size_t{0}, faces, [&](std::size_t f) {
    const Vec3 own = surface.normals[f].stableNormalized(),
               mean = (surface.smooth[f][0] + surface.smooth[f][1] + surface.smooth[f][2]).stableNormalized();
    const double cosine = own.dot(mean);
    ragged[f] = 1 - std::min(1.0, cosine * cosine);
  });
  surface.roughness.resize(faces);
  tbb::parallel_for(std::size_t{0}, faces, [&](std::size_t f) {
    const Vec3 own = surface.normals[f].stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      double area = 0;
      std::array<double, 2> rough{};
      for (const std::uint32_t a : around.of(welded.places[f * 3 + k])) {
        const double size = surface.normals[a].stableNorm();
        if (!(size > 0)) continue;
        area += size;
        if (std::abs(own.dot(surface.normals[a])) >= smooth_cosine * size) {
          for (double& side : rough) side += size * ragged[a];
          continue;
        }
        double above = 0, below = 0;
        for (const Vec3& corner : surface.corners[a]) {
          const double height = (corner - surface.corners[f][k]).dot(own);
          above = std::max(above, height);
          below = std::max(below, -height);
        }
        if (above > relevant_height * surface.pitch[a]) rough[0] += size;
        if (below > relevant_height * surface.pitch[a]) rough[1] += size;
      }
      for (std::size_t side = 0; side < 2; ++side)
        surface.roughness[f][k][side] = area > 0 ? std::sqrt(rough[side] / area) : 0;
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
  const FacesAround around = faces_around(welded);
  smooth_normals(welded, around, surface);
  find_roughness(welded, around, surface);
  return surface;
}

// Offset of ray origins in facet sizes: small on smooth surfaces, up to half a facet on ragged ones, because a soup
// would occlude itself.
constexpr double min_offset = 0.02, offset_per_sine = 0.5;

// The site at barycentric weights `w` of a face. `rough`: the surface as baked; its roughness counts, because bending
// adds none.
LightSite site_at(const Surface& surface, const Surface& rough, std::size_t face, const Vec3& w) {
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
  for (std::size_t side = 0; side < 2; ++side) {
    double roughness = 0;
    for (std::size_t k = 0; k < 3; ++k) roughness += w[static_cast<Eigen::Index>(k)] * rough.roughness[face][k][side];
    site.offset[side] = surface.pitch[face] * std::clamp(offset_per_sine * roughness, min_offset, 1.0);
  }
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
      sites.now.push_back(site_at(surface_now, surface_baked, face, weights));
      LightSite before = site_at(surface_baked, surface_baked, face, weights);
      const Affine& change = to_body[body_of[face]];
      if (!change.matrix().isIdentity(0)) {
        before.position = change * before.position;
        before.normal = (change.linear().inverse().transpose() * before.normal).normalized();
        const Vec3 tangent = change.linear() * before.tangent;
        before.tangent = (tangent - tangent.dot(before.normal) * before.normal).normalized();
        for (double& offset : before.offset) offset *= std::cbrt(std::abs(change.linear().determinant()));
      }
      sites.baked.push_back(before);
    }
    first_face += static_cast<std::uint32_t>(object.sets[s].soup.triangle_count());
  }
  sites.first.push_back(sites.size());
  return sites;
}

}  // namespace rebake
