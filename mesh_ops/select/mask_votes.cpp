#include "mesh_ops/select/mask_votes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>

#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

constexpr std::size_t points_per_triangle = 4;

// Weights of 16 points spread over a triangle: an additive sequence (Roberts 2018), folded at the diagonal.
std::array<Vec3, 16> spread_points() {
  std::array<Vec3, 16> points;
  constexpr double plastic = 1.32471795724474602596;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto part = [&](double step) {
      const double value = 0.5 + static_cast<double>(k + 1) * step;
      return value - std::floor(value);
    };
    double a = part(1 / plastic), b = part(1 / (plastic * plastic));
    if (a + b > 1) a = 1 - a, b = 1 - b;
    points[k] = {1 - a - b, a, b};
  }
  return points;
}

// Opaque points of a triangle in world space.
std::vector<Vec3> opaque_points(const TextureSet& set, const Face& face, const Affine& to_world) {
  static const std::array<Vec3, 16> spread = spread_points();
  const auto& positions = set.soup.positions();
  const auto& uvs = set.soup.uvs();
  std::vector<Vec3> points;
  for (const Vec3& weights : spread) {
    Vec3 point = Vec3::Zero();
    Vec2 uv = Vec2::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double weight = weights[static_cast<Eigen::Index>(k)];
      point += weight * positions[face[k]];
      uv += weight * uvs[face[k]];
    }
    if (!set.texels->opaque_at(uv.x(), uv.y())) continue;
    points.push_back(to_world * point);
    if (points.size() == points_per_triangle) break;
  }
  return points;
}

// The label where a world point appears; −1 if it is outside the picture.
int label_at(const MaskedPhoto& photo, const Vec3& world) {
  const std::optional<Vec2> pixel = pixel_of(photo.camera, world);
  if (!pixel) return -1;
  const double x = std::floor(pixel->x() * photo.mask.width / photo.camera.width),
               y = std::floor(pixel->y() * photo.mask.height / photo.camera.height);
  if (!(x >= 0 && y >= 0 && x < photo.mask.width && y < photo.mask.height)) return -1;
  return photo.mask
      .labels[static_cast<std::size_t>(y) * static_cast<std::size_t>(photo.mask.width) + static_cast<std::size_t>(x)];
}

}  // namespace

std::vector<MaskVotes> mask_votes(const std::vector<PlacedNode>& objects, const std::vector<PlacedNode>& occluders,
                                  const std::vector<MaskedPhoto>& photos, const std::vector<std::uint8_t>& labels,
                                  const Progress& progress) {
  const SceneRays rays = rays_through(occluders);
  std::size_t all = 0;
  for (const PlacedNode& placed : objects) all += placed.node->object->triangle_count();
  std::atomic<std::size_t> done = 0;
  std::vector<MaskVotes> result;
  for (const PlacedNode& placed : objects) {
    const BakedObject& object = *placed.node->object;
    MaskVotes& votes = result.emplace_back();
    votes.seen.resize(object.triangle_count());
    votes.votes.assign(labels.size(), std::vector<std::uint32_t>(object.triangle_count()));
    std::size_t first = 0;
    for (const TextureSet& set : object.sets) {
      constexpr std::size_t grain = 256;
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, set.soup.triangle_count(), grain),
                        [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t f = range.begin(); f != range.end(); ++f)
                            for (const Vec3& point : opaque_points(set, set.soup.faces()[f], placed.to_world))
                              for (const MaskedPhoto& photo : photos) {
                                const int label = label_at(photo, point);
                                if (label < 0 || rays.blocked(photo.camera.eye, point)) continue;
                                ++votes.seen[first + f];
                                const auto found = std::find(labels.begin(), labels.end(), label);
                                if (found != labels.end())
                                  ++votes.votes[static_cast<std::size_t>(found - labels.begin())][first + f];
                              }
                          progress.at("voting", static_cast<double>(done += range.size()) / static_cast<double>(all));
                        });
      first += set.soup.triangle_count();
    }
  }
  return result;
}

void add_votes(std::vector<MaskVotes>& votes, const std::vector<MaskVotes>& more) {
  const auto add = [](std::vector<std::uint32_t>& to, const std::vector<std::uint32_t>& from) {
    std::transform(to.begin(), to.end(), from.begin(), to.begin(), std::plus());
  };
  for (std::size_t k = 0; k < votes.size(); ++k) {
    add(votes[k].seen, more[k].seen);
    for (std::size_t l = 0; l < votes[k].votes.size(); ++l) add(votes[k].votes[l], more[k].votes[l]);
  }
}

MaskDecision decide(const MaskVotes& votes, double threshold) {
  MaskDecision decision;
  const std::size_t triangles = votes.seen.size();
  decision.chosen.assign(votes.votes.size(), TriangleSet(triangles, 0));
  decision.any.assign(triangles, 0);
  double agreeing = 0, total = 0;
  for (std::size_t f = 0; f < triangles; ++f) {
    if (votes.seen[f] == 0) continue;
    ++decision.seen;
    std::uint32_t none = votes.seen[f], most = 0;
    std::size_t best = 0;
    for (std::size_t k = 0; k < votes.votes.size(); ++k) {
      none -= votes.votes[k][f];
      if (votes.votes[k][f] > most) most = votes.votes[k][f], best = k;
    }
    if (most > 0 && static_cast<double>(most) / votes.seen[f] >= threshold) decision.chosen[best][f] = 1;
    const std::uint32_t inside = votes.seen[f] - none;
    if (inside > 0 && static_cast<double>(inside) / votes.seen[f] >= threshold) decision.any[f] = 1;
    agreeing += std::max(most, none);
    total += votes.seen[f];
  }
  if (total > 0) decision.consistency = agreeing / total;
  return decision;
}

}  // namespace rebake
