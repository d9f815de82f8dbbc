#include <fmt/format.h>

#include <cmath>

#include "editor/studies/study.h"
#include "mesh_ops/fill/filled_holes.h"
#include "mesh_ops/index/footprint.h"
#include "mesh_ops/registration/nearest_samples.h"
#include "mesh_ops/registration/surface_samples.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

constexpr std::size_t holes_per_size = 40;

// Opaque texels of some triangles of an object: where they are, their features, and normals away from its centre.
struct SurfaceTexels {
  std::vector<Vec3> points, normals;
  std::vector<std::array<double, 8>> features;
};

SurfaceTexels texels_of(const BakedObject& object, const TextureSet& set, const TriangleSet& wanted,
                        std::size_t first) {
  SurfaceTexels result;
  const TexelReader reader(*set.texels);
  for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
    if (!wanted.empty() && wanted[first + f] == 0) continue;
    const Face& face = set.soup.faces()[f];
    const auto& p = set.soup.positions();
    const std::array<Vec2, 3> uv = texel_corners(set, f);
    Vec3 normal = (p[face[1]] - p[face[0]]).cross(p[face[2]] - p[face[0]]).stableNormalized();
    if (normal.dot(p[face[0]] - object.bounds().center()) < 0) normal = -normal;
    for_each_texel_piece(uv, set.texels->width(), set.texels->height(),
                         [&](int x, int y, double /*area*/, const Vec2& centroid) {
                           if (!set.texels->opaque(x, y)) return;
                           const Vec3 w = barycentric(uv, centroid);
                           result.points.push_back(w[0] * p[face[0]] + w[1] * p[face[1]] + w[2] * p[face[2]]);
                           result.normals.push_back(normal);
                           result.features.push_back(decode_features(reader.at(x, y), set.texels->alpha_code()));
                         });
  }
  return result;
}

// Sums over the filled holes of one size.
struct Totals {
  std::size_t tried = 0, closed = 0, texels = 0;
  double places = 0, colors = 0, milliseconds = 0;
};

void fill_one(const BakedObject& object, const Vec3& center, double radius, int frames, Totals& totals) {
  TriangleSet removed(object.triangle_count(), 0);
  SurfaceTexels truth;
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
      Vec3 centre = Vec3::Zero();
      for (const std::uint32_t v : set.soup.faces()[f]) centre += set.soup.positions()[v] / 3;
      removed[first + f] = (centre - center).norm() <= radius ? 1 : 0;
    }
    const SurfaceTexels own = texels_of(object, set, removed, first);
    truth.points.insert(truth.points.end(), own.points.begin(), own.points.end());
    truth.normals.insert(truth.normals.end(), own.normals.begin(), own.normals.end());
    truth.features.insert(truth.features.end(), own.features.begin(), own.features.end());
    first += set.soup.triangle_count();
  }
  if (truth.points.empty()) return;
  ++totals.tried;
  FilledHoles filled;
  const double time = median_milliseconds(std::min(frames, 3), [&] { filled = filled_holes(object, removed); });
  if (filled.holes == 0 || filled.open_edges > 0 || filled.unfilled() > 0) return;
  ++totals.closed;
  totals.milliseconds += time;
  const SurfaceTexels made = texels_of(object, filled.object->sets.back(), {}, 0);
  const NearestSamples nearest(truth.points);
  std::vector<std::array<double, 8>> removed_features;
  std::vector<Vec3> views;
  for (const Vec3& point : made.points) {
    const std::size_t at = nearest.nearest(point);
    totals.places += (point - truth.points[at]).squaredNorm();
    removed_features.push_back(truth.features[at]);
    views.push_back(axes_matrix(object.axes) * -truth.normals[at]);  // from outside
  }
  std::vector<Color> now(views.size()), before(views.size());
  const TexelColors decoder(*object.decoder, {});
  decoder.decode_each(made.features, views, now);
  decoder.decode_each(removed_features, views, before);
  for (std::size_t k = 0; k < views.size(); ++k) totals.colors += (now[k] - before[k]).squaredNorm() / 3;
  totals.texels += made.points.size();
}

}  // namespace

// Spheres around evenly spread points of the surface are removed and filled. Each new texel is compared with the
// nearest removed one.
StudyTable study_fill(const StudyInput& input) {
  StudyTable table{
      {"ms", "place error % of the diagonal", "PSNR dB of colours", "radius % of the diagonal", "closed %"},
      {},
      0,
      1,
      true,
      true};
  for (const double share : {0.01, 0.02, 0.04, 0.06, 0.08}) {
    Totals totals;
    double diagonal = 1;
    for (const PlacedNode& placed : placed_nodes(input.scene)) {
      if (!placed.visible || !placed.node->object || placed.node->object->any_rotations()) continue;
      const BakedObject& object = *placed.node->object;
      diagonal = object.bounds().diagonal().norm();
      PlacedNode own = placed;
      own.to_world = Affine::Identity();
      const SurfaceSamples centers = sampled_surfaces({own}, holes_per_size, 7);
      for (const Vec3& center : centers.points) {
        input.progress.at(
            "filling", (static_cast<double>(table.rows.size()) * holes_per_size + static_cast<double>(totals.tried)) /
                           (5.0 * holes_per_size));
        fill_one(object, center, share * diagonal, input.frames, totals);
      }
    }
    const auto texels = static_cast<double>(totals.texels), closed = static_cast<double>(totals.closed);
    table.rows.push_back(
        {fmt::format("radius {:g} %", share * 100),
         {totals.milliseconds / closed, 100 * std::sqrt(totals.places / texels) / diagonal,
          -10 * std::log10(totals.colors / texels), share * 100, 100 * closed / static_cast<double>(totals.tried)}});
  }
  return table;
}

}  // namespace rebake
