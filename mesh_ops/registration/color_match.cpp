#include "mesh_ops/registration/color_match.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/registration/nearest_samples.h"
#include "mesh_ops/registration/surface_samples.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

double logit(double color) {
  const double inside = std::clamp(color, 1 / 510.0, 509 / 510.0);
  return std::log(inside / (1 - inside));
}
double logistic(double x) { return 1 / (1 + std::exp(-x)); }

// One point along one direction, as both captures show it.
struct Observation {
  Color from, onto;
};

// A sample with a view direction in world space, from the eye to the sample.
struct Look {
  std::size_t sample;
  Vec3 direction;
};

// Colours of samples along directions.
std::vector<Color> colors_of(const std::vector<PlacedNode>& nodes, const SurfaceSamples& samples,
                             const std::vector<Look>& looks) {
  std::vector<Color> colors(looks.size());
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    const auto& object = nodes[n].node->object;
    if (!object) continue;
    const Mat3 axes = axes_matrix(object->axes), to_object = orthogonal_factor(nodes[n].to_world.linear()).transpose();
    std::vector<std::unique_ptr<const TexelReader>> readers;
    for (const TextureSet& set : object->sets) readers.push_back(std::make_unique<const TexelReader>(*set.texels));
    std::vector<std::size_t> own;
    std::vector<std::array<double, 8>> features;
    std::vector<Vec3> directions;
    for (std::size_t k = 0; k < looks.size(); ++k) {
      const SurfacePlace& place = samples.places[looks[k].sample];
      if (place.node != n) continue;
      const TextureSet& set = object->sets[place.set];
      Mat3 turn_back = Mat3::Identity();  // of bends
      if (const auto* rotations = set.soup.rotations())
        turn_back = (*rotations)[set.soup.faces()[place.face][0]].matrix().transpose();
      own.push_back(k);
      features.push_back(decode_features(readers[place.set]->at(place.x, place.y), set.texels->alpha_code()));
      directions.push_back(axes * turn_back * to_object * looks[k].direction);
    }
    std::vector<Color> made(own.size());
    if (!own.empty()) TexelColors(*object->decoder, {}).decode_each(features, directions, made);
    for (std::size_t k = 0; k < own.size(); ++k) colors[own[k]] = made[k];
  }
  return colors;
}

// Pairs of samples of the same surface, each seen along up to `most_looks` free directions.
struct Pairs {
  std::vector<Look> from, onto;
  std::size_t points = 0;
};
Pairs pairs_of(const SurfaceSamples& from, const SurfaceSamples& onto, const SceneRays& rays, double reach, double far,
               const Progress& progress) {
  constexpr std::size_t most_looks = 4;
  constexpr double least_cosine = 0.3, alike = 0.8;
  const NearestSamples nearest(onto.points);
  const std::vector<Vec3> views = even_directions(32);
  Pairs pairs;
  for (std::size_t k = 0; k < from.points.size(); ++k) {
    if (k % 1000 == 0)
      progress.at("comparing colours", static_cast<double>(k) / static_cast<double>(from.points.size()));
    const std::size_t other = nearest.nearest(from.points[k]);
    if ((onto.points[other] - from.points[k]).norm() > reach) continue;
    if (std::abs(onto.normals[other].dot(from.normals[k])) < alike) continue;
    std::size_t looks = 0;
    for (std::size_t v = 0; v < views.size() && looks < most_looks; ++v) {
      const Vec3& view = views[(v + 7 * k) % views.size()];
      if (std::abs(view.dot(from.normals[k])) < least_cosine) continue;
      // Starts beyond the other capture's surface, which is never exactly here.
      if (rays.blocked(from.points[k] - far * view, from.points[k] - 4 * reach * view)) continue;
      pairs.from.push_back({k, view});
      pairs.onto.push_back({other, view});
      ++looks;
    }
    if (looks > 0) ++pairs.points;
  }
  return pairs;
}

// Weight of an observation's logits, so that their errors count as errors of display colours: the squared derivative of
// the logistic function, between both.
double logit_weight(double from, double onto) {
  const double middle = (from + onto) / 2, slope = middle * (1 - middle);
  return slope * slope;
}

// Weighted mean and variance of logits, and their covariance.
struct Moments {
  double weight = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
};
Moments moments_of(const std::vector<Observation>& all, const std::vector<double>& weights, Eigen::Index channel) {
  Moments m;
  std::vector<double> own = weights;
  for (std::size_t k = 0; k < all.size(); ++k) {
    own[k] *= logit_weight(all[k].from[channel], all[k].onto[channel]);
    m.weight += own[k];
    m.x += own[k] * logit(all[k].from[channel]);
    m.y += own[k] * logit(all[k].onto[channel]);
  }
  if (!(m.weight > 0)) return m;
  m.x /= m.weight;
  m.y /= m.weight;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double dx = logit(all[k].from[channel]) - m.x, dy = logit(all[k].onto[channel]) - m.y;
    m.xx += own[k] * dx * dx / m.weight;
    m.yy += own[k] * dy * dy / m.weight;
    m.xy += own[k] * dx * dy / m.weight;
  }
  return m;
}

ColorChange weighted_fit(const std::vector<Observation>& all, const std::vector<double>& weights, bool with_gain) {
  // Below this correlation, the spread is mostly noise, and its ratio tells nothing about contrast.
  constexpr double least_correlation = 0.5;
  ColorChange change;
  for (std::size_t c = 0; c < 3; ++c) {
    const Moments m = moments_of(all, weights, static_cast<Eigen::Index>(c));
    const double scale = std::sqrt(m.xx * m.yy);
    if (with_gain && scale > 0 && m.xy > least_correlation * scale) change.gain[c] = std::sqrt(m.yy / m.xx);
    change.offset[c] = m.y - change.gain[c] * m.x;
  }
  return change;
}

std::vector<double> residuals_of(const std::vector<Observation>& all, const ColorChange& change) {
  std::vector<double> residuals;
  for (const Observation& one : all) residuals.push_back((change(one.from) - one.onto).norm() / std::sqrt(3.0));
  return residuals;
}

}  // namespace

Color ColorChange::operator()(const Color& color) const {
  Color result;
  for (Eigen::Index c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    result[c] = logistic(gain[k] * logit(color[c]) + offset[k]);
  }
  return result;
}

ColorMatch matched_colors(const std::vector<PlacedNode>& changed, const std::vector<PlacedNode>& fixed,
                          const ColorMatchOptions& options, const Progress& progress) {
  const SurfaceSamples from = sampled_surfaces(changed, options.samples, 1),
                       onto = sampled_surfaces(fixed, 5 * options.samples, 2);
  const auto box_of = [](const SurfaceSamples& samples) {
    Box box;
    for (const Vec3& point : samples.points) box.extend(point);
    return box;
  };
  constexpr std::size_t fewest_points = 100;
  if (from.points.size() < fewest_points || onto.points.size() < fewest_points)
    throw Error("a capture has no opaque surface to compare");
  const double diagonal = std::min(box_of(from).diagonal().norm(), box_of(onto).diagonal().norm());
  std::vector<PlacedNode> both = changed;
  both.insert(both.end(), fixed.begin(), fixed.end());
  const Pairs pairs = pairs_of(from, onto, rays_through(both), options.distance * diagonal,
                               std::max(0.2, 8 * options.distance) * diagonal, progress);
  ColorMatch match;
  match.pairs = pairs.points;
  if (match.pairs < fewest_points)
    throw Error("only " + std::to_string(match.pairs) +
                " points of the captures lie on each other: register them first, or allow a larger distance");
  const std::vector<Color> a = colors_of(changed, from, pairs.from), b = colors_of(fixed, onto, pairs.onto);
  std::vector<Observation> all;
  for (std::size_t k = 0; k < a.size(); ++k) all.push_back({a[k], b[k]});
  std::vector<double> weights(all.size(), 1);
  constexpr int iterations = 20;
  constexpr double cut = 4.685 * 1.4826;  // Tukey's constant, and the median of normal deviations
  for (int round = 0; round < iterations; ++round) {
    match.change = weighted_fit(all, weights, options.gain);
    const std::vector<double> residuals = residuals_of(all, match.change);
    std::vector<double> sorted = residuals;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double limit = std::max(cut * *middle, 1 / 255.0);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double share = std::min(1.0, residuals[k] / limit);
      weights[k] = (1 - share * share) * (1 - share * share);
    }
  }
  const std::vector<double> before = residuals_of(all, {}), after = residuals_of(all, match.change);
  std::size_t used = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (weights[k] == 0) continue;
    ++used;
    match.before += before[k] * before[k];
    match.after += after[k] * after[k];
  }
  match.before = std::sqrt(match.before / static_cast<double>(used));
  match.after = std::sqrt(match.after / static_cast<double>(used));
  match.used = static_cast<double>(used) / static_cast<double>(all.size());
  return match;
}

std::shared_ptr<const BakedObject> recolored(const BakedObject& object, const ColorChange& change) {
  auto made = std::make_shared<BakedObject>(object);
  if (object.decoder->rule == ColorRule::diffuse_and_network)
    throw EditError(
        "colours of nerf2mesh are sums that cannot be matched exactly: export the object with plain first, and import "
        "the result");
  if (object.decoder->rule == ColorRule::network) {
    Decoder decoder = *object.decoder;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto k = static_cast<std::size_t>(c);
      decoder.weights2.col(c) *= change.gain[k];
      decoder.bias2[c] = change.gain[k] * decoder.bias2[c] + change.offset[k];
    }
    made->decoder = std::make_shared<const Decoder>(std::move(decoder));
    return made;
  }
  std::array<std::array<std::uint8_t, 256>, 3> table{};
  for (std::size_t v = 0; v < 256; ++v) {
    const Color color = change(Color::Constant(static_cast<double>(v) / 255));
    for (std::size_t c = 0; c < 3; ++c)
      table[c][v] = static_cast<std::uint8_t>(std::lround(255 * color[static_cast<Eigen::Index>(c)]));
  }
  for (TextureSet& set : made->sets) {
    const FeatureTexture& old = *set.texels;
    const TexelReader texels(old);
    set.texels = std::make_shared<const FeatureTexture>(
        FeatureTexture::from_rows(old.width(), old.height(), old.alpha_code(), [&](int y, Texel* row) {
          for (int x = 0; x < old.width(); ++x) {
            row[x] = texels.at(x, y);
            if (row[x].opaque())
              for (std::size_t c = 0; c < 3; ++c) row[x].feat0[1 + c] = table[c][row[x].feat0[1 + c]];
          }
        }));
  }
  return made;
}

}  // namespace rebake
