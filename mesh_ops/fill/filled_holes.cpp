#include "mesh_ops/fill/filled_holes.h"

#include <algorithm>
#include <cmath>

#include "mesh_ops/base/error.h"
#include "mesh_ops/fill/patch_texture.h"
#include "mesh_ops/index/footprint.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

using Bytes = std::array<double, 8>;

// The object's triangles by their numbers through all sets.
class Triangles {
 public:
  explicit Triangles(const BakedObject& object) : object_(object) {
    for (const TextureSet& set : object.sets) {
      first_.push_back(count_);
      count_ += static_cast<std::uint32_t>(set.soup.triangle_count());
      readers_.push_back(std::make_unique<const TexelReader>(*set.texels));
    }
  }
  std::size_t set_of(std::uint32_t triangle) const {
    return static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), triangle) - first_.begin()) - 1;
  }
  const TextureSet& set(std::uint32_t triangle) const { return object_.sets[set_of(triangle)]; }
  std::size_t face(std::uint32_t triangle) const { return triangle - first_[set_of(triangle)]; }
  const TexelReader& reader(std::uint32_t triangle) const { return *readers_[set_of(triangle)]; }

 private:
  const BakedObject& object_;
  std::vector<std::uint32_t> first_;
  std::uint32_t count_ = 0;
  std::vector<std::unique_ptr<const TexelReader>> readers_;
};

// An opaque texel at a border point, and its weight.
struct BorderTexel {
  Bytes bytes;
  double weight;
};

// The opaque texels at a corner; those near it weigh most.
std::vector<BorderTexel> texels_at(const Triangles& triangles, const std::vector<HoleLoop::Corner>& corners) {
  std::vector<BorderTexel> found;
  for (const HoleLoop::Corner& at : corners) {
    const TextureSet& set = triangles.set(at.triangle);
    const std::array<Vec2, 3> uv = texel_corners(set, triangles.face(at.triangle));
    for_each_texel_piece(uv, set.texels->width(), set.texels->height(),
                         [&](int x, int y, double area, const Vec2& centroid) {
                           if (!set.texels->opaque(x, y)) return;
                           const double near = std::max(0.0, barycentric(uv, centroid)[at.corner]);
                           const Texel& texel = triangles.reader(at.triangle).at(x, y);
                           BorderTexel one{{}, area * std::pow(near, 8)};
                           for (std::size_t c = 0; c < 8; ++c)
                             one.bytes[c] = c < 4 ? texel.feat0[c] : texel.feat1[c - 4];
                           found.push_back(one);
                         });
  }
  return found;
}

std::optional<Bytes> mean_of(const std::vector<BorderTexel>& texels) {
  Bytes sum{};
  double weight = 0;
  for (const BorderTexel& one : texels) {
    weight += one.weight;
    for (std::size_t c = 0; c < 8; ++c) sum[c] += one.weight * one.bytes[c];
  }
  if (!(weight > 0)) return std::nullopt;
  for (double& value : sum) value /= weight;
  return sum;
}

std::array<double, 8> decoded(const Bytes& bytes, AlphaCode code) {
  std::array<double, 8> features{};
  for (std::size_t c = 0; c < 8; ++c)
    features[c] = c % 4 == 3 && code == AlphaCode::halved ? 2 * bytes[c] / 255 - 1 : bytes[c] / 255;
  return features;
}

// Median side of the texels at the border, in object units.
double texel_size(const Triangles& triangles, const std::vector<HoleLoop>& loops) {
  std::vector<double> sizes;
  for (const HoleLoop& loop : loops)
    for (const auto& corners : loop.corners)
      for (const HoleLoop::Corner& at : corners) {
        const TextureSet& set = triangles.set(at.triangle);
        const Face& face = set.soup.faces()[triangles.face(at.triangle)];
        const std::array<Vec2, 3> uv = texel_corners(set, triangles.face(at.triangle));
        const auto& p = set.soup.positions();
        const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
        const double texels = std::abs(a.x() * b.y() - a.y() * b.x()),
                     area = (p[face[1]] - p[face[0]]).cross(p[face[2]] - p[face[0]]).norm();
        if (texels > 0 && area > 0) sizes.push_back(std::sqrt(area / texels));
      }
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

// Weighted squared differences of colours at a border point.
struct ColorSteps {
  double squares = 0, weight = 0;
};
void add_steps(ColorSteps& steps, const BakedObject& object, AlphaCode code, const Bytes& mean,
               const std::vector<BorderTexel>& texels, const Vec3& view) {
  std::vector<std::array<double, 8>> features{decoded(mean, code)};
  for (const BorderTexel& one : texels) features.push_back(decoded(one.bytes, code));
  std::vector<Color> colors(features.size());
  TexelColors(*object.decoder, {axes_matrix(object.axes) * view}).decode_into(features, colors);
  for (std::size_t k = 0; k < texels.size(); ++k) {
    steps.squares += texels[k].weight * (colors[k + 1] - colors[0]).squaredNorm() / 3;
    steps.weight += texels[k].weight;
  }
}

// Mean normal of a patch.
Vec3 normal_of(const HolePatch& patch) {
  Vec3 sum = Vec3::Zero();
  for (const Face& face : patch.faces)
    sum += (patch.vertices[face[1]] - patch.vertices[face[0]]).cross(patch.vertices[face[2]] - patch.vertices[face[0]]);
  return sum.stableNormalized();
}

// The object's sets without the flagged triangles.
std::vector<TextureSet> sets_without(const BakedObject& object, const TriangleSet& removed) {
  std::vector<TextureSet> sets;
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    TriangleSet kept;
    for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) kept.push_back(removed[first + f] == 0 ? 1 : 0);
    first += kept.size();
    const std::size_t left = count(kept);
    if (left == kept.size())
      sets.push_back(set);
    else if (left > 0)
      sets.push_back({subset(set.soup, kept, 0, true), set.texels});
  }
  return sets;
}

// The kept triangles around a loop, numbered without the removed ones. `number`: the new number of each triangle.
std::vector<std::uint32_t> triangles_around(const HoleLoop& loop, const std::vector<std::uint32_t>& number) {
  std::vector<std::uint32_t> around;
  for (const auto& corners : loop.corners)
    for (const HoleLoop::Corner& corner : corners) around.push_back(number[corner.triangle]);
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

std::vector<std::uint32_t> numbers_without(const TriangleSet& removed) {
  std::vector<std::uint32_t> number(removed.size());
  std::uint32_t next = 0;
  for (std::size_t f = 0; f < removed.size(); ++f) number[f] = removed[f] == 0 ? next++ : next;
  return number;
}

// Removes the flagged triangles, and closes the loops of at most `longest` edges.
FilledHoles filled(const BakedObject& object, const TriangleSet& removed, const HoleLoops& borders, std::size_t longest,
                   const Progress& progress) {
  FilledHoles result;
  result.removed = count(removed);
  const AlphaCode code = object.sets.front().texels->alpha_code();
  for (const TextureSet& set : object.sets)
    if (set.texels->alpha_code() != code) throw EditError("the object's textures store alpha in different ways");
  result.open_edges = borders.open_edges;
  const Triangles triangles(object);
  const double texel = texel_size(triangles, borders.loops);  // 0 if UVs have no area
  std::vector<HolePatch> patches;
  std::vector<PatchFeatures> features;
  ColorSteps steps;
  const std::vector<std::uint32_t> number = numbers_without(removed);
  for (const HoleLoop& loop : borders.loops) {
    progress.at("filling",
                static_cast<double>(result.holes + result.unfilled()) / static_cast<double>(borders.loops.size()));
    if (loop.points.size() > longest || !(texel > 0)) {
      ++(loop.points.size() > longest ? result.longer : result.untextured);
      continue;
    }
    HolePatch patch = hole_patch(loop, progress);
    std::vector<std::optional<Bytes>> border;
    const Vec3 view = patch.faces.empty() ? Vec3::Zero() : normal_of(patch);
    for (const auto& corners : loop.corners) {
      const std::vector<BorderTexel> texels = texels_at(triangles, corners);
      border.push_back(mean_of(texels));
      if (border.back() && !patch.faces.empty()) add_steps(steps, object, code, *border.back(), texels, view);
    }
    PatchFeatures own = patch.faces.empty() ? PatchFeatures() : harmonic_features(patch, border);
    if (own.empty()) {
      ++(patch.faces.empty() ? result.crossing : result.untextured);
      continue;
    }
    ++result.holes;
    result.triangles += patch.faces.size();
    result.around.push_back(triangles_around(loop, number));
    patches.push_back(std::move(patch));
    features.push_back(std::move(own));
  }
  result.color_step = steps.weight > 0 ? std::sqrt(steps.squares / steps.weight) : 0;
  auto made = std::make_shared<BakedObject>(object);
  made->sets = sets_without(object, removed);
  if (!patches.empty()) {
    made->sets.push_back(textured_patches(patches, features, texel, code, result.hole_of));
    result.texels = made->sets.back().texels->opaque_count();
  }
  if (made->sets.empty()) return result;
  record_bodies(*made, object);
  result.object = std::move(made);
  return result;
}

double weld_tolerance(const BakedObject& object) {
  if (object.any_rotations())
    throw EditError("bends have rotated some of the object's triangles: fill its holes before bending it");
  return 1e-6 * object.bounds().diagonal().norm();
}

}  // namespace

double patch_area(const FilledHoles& filled, const Affine& to_world) {
  if (filled.holes == 0) return 0;
  const Soup& soup = filled.object->sets.back().soup;
  double area = 0;
  for (const Face& face : soup.faces()) {
    const Vec3 at = to_world * soup.positions()[face[0]], right = to_world * soup.positions()[face[1]],
               up = to_world * soup.positions()[face[2]];
    area += (right - at).cross(up - at).norm() / 2;
  }
  return area;
}

FilledHoles filled_holes(const BakedObject& object, const TriangleSet& removed, const Progress& progress) {
  return filled(object, removed, hole_loops(object, removed, weld_tolerance(object)), longest_loop, progress);
}

FilledHoles filled_open_holes(const BakedObject& object, const TriangleSet& flagged, std::size_t longest,
                              const Progress& progress) {
  return filled(object, TriangleSet(flagged.size(), 0), open_loops(object, flagged, weld_tolerance(object)),
                std::min(longest, longest_loop), progress);
}

}  // namespace rebake
