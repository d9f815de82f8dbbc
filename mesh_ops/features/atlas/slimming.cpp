#include "mesh_ops/features/atlas/slimming.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/index/footprint.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/training/feature_network.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

// Number of unoccluded rays after which a triangle counts as visible. More than one ray tells openings of different
// size apart.
constexpr int enough = 4;

Vec3 random_direction(SplitMix64& dice) {
  const double z = 2 * dice.share() - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
  const auto angle = elementary::sine_cosine(2 * std::numbers::pi * dice.share());
  return {r * angle.cosine, r * angle.sine, z};
}

// Random opaque points of a triangle.
class OpaquePoints {
 public:
  OpaquePoints(const TextureSet& set, std::size_t f) : texels_(*set.texels), uv_(texel_corners(set, f)) {
    for (std::size_t k = 0; k < 3; ++k) corners_[k] = set.soup.positions()[set.soup.faces()[f][k]];
    // Opaque texels that overlap the triangle, each represented by the triangle's point nearest to its centre.
    const Vec2 low = uv_[0].cwiseMin(uv_[1]).cwiseMin(uv_[2]), high = uv_[0].cwiseMax(uv_[1]).cwiseMax(uv_[2]);
    if (!(low.allFinite() && high.allFinite())) return;
    SplitMix64 dice(f);
    std::size_t number = 0;
    for (int y = texel_within(low.y(), texels_.height()); y <= texel_within(high.y(), texels_.height()); ++y)
      for (int x = texel_within(low.x(), texels_.width()); x <= texel_within(high.x(), texels_.width()); ++x) {
        if (!texels_.opaque(x, y)) continue;
        const Vec2 nearest = nearest_inside({x + 0.5, y + 0.5});
        // Half a texel's diagonal, squared.
        if ((nearest - Vec2(x + 0.5, y + 0.5)).squaredNorm() > 0.5) continue;
        // Reservoir sampling: a uniform choice of all (Vitter 1985).
        const Vec3 place = at(barycentric(uv_, nearest));
        if (places_.size() < max_places)
          places_.push_back(place);
        else if (const std::size_t k = dice.below(number + 1); k < max_places)
          places_[k] = place;
        ++number;
      }
  }

  bool none() const { return places_.empty(); }
  /// A random opaque point: with probability ½ uniform over the triangle, else the point of a random texel.
  Vec3 random(SplitMix64& dice) const {
    if (dice.below(2) == 0) {
      double a = dice.share(), b = dice.share();
      if (a + b > 1) a = 1 - a, b = 1 - b;
      const Vec3 weights(1 - a - b, a, b);
      const Vec2 uv = uv_[0] * weights[0] + uv_[1] * weights[1] + uv_[2] * weights[2];
      if (texels_.opaque(texel_within(uv.x(), texels_.width()), texel_within(uv.y(), texels_.height())))
        return at(weights);
    }
    return places_[dice.below(places_.size())];
  }

 private:
  Vec3 at(const Vec3& weights) const {
    return corners_[0] * weights[0] + corners_[1] * weights[1] + corners_[2] * weights[2];
  }
  Vec2 nearest_inside(const Vec2& p) const {
    const Vec3 weights = barycentric(uv_, p);
    if (weights.minCoeff() >= 0) return p;
    Vec2 nearest = uv_[0];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 along = uv_[(k + 1) % 3] - uv_[k];
      const double length = along.squaredNorm();
      const double share = length > 0 ? std::clamp((p - uv_[k]).dot(along) / length, 0.0, 1.0) : 0;
      const Vec2 on_edge = uv_[k] + share * along;
      if ((on_edge - p).squaredNorm() < (nearest - p).squaredNorm()) nearest = on_edge;
    }
    return nearest;
  }

  static constexpr std::size_t max_places = 1024;
  const FeatureTexture& texels_;
  std::array<Vec2, 3> uv_;
  std::array<Vec3, 3> corners_;
  std::vector<Vec3> places_;
};

std::uint8_t rounded(std::uint8_t value, int bits) {
  if (bits >= 8) return value;
  const double steps = (1 << bits) - 1;
  return static_cast<std::uint8_t>(std::lround(std::round(value * steps / 255) * 255 / steps));
}

Texel rounded(Texel texel, const FeatureBits& bits) {
  for (std::size_t k = 0; k < 4; ++k) {
    texel.feat0[k] = rounded(texel.feat0[k], bits[k]);
    texel.feat1[k] = rounded(texel.feat1[k], bits[k + 4]);
  }
  // Byte 0 of feature 0 would be transparent: the lowest step above it.
  if (texel.feat0[0] == 0) texel.feat0[0] = bits[0] >= 8 ? 1 : rounded(255, bits[0]) / ((1 << bits[0]) - 1);
  return texel;
}

// The texture with each texel replaced by change(x, y, texel); the same pointer if no texel differs.
template <class Change>
std::shared_ptr<const FeatureTexture> changed(const std::shared_ptr<const FeatureTexture>& texels, Change change) {
  std::atomic<bool> any = false;
  const TexelReader reader(*texels);
  auto made = std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(texels->width(), texels->height(), texels->alpha_code(), [&](int y, Texel* row) {
        bool differs = false;
        for (int x = 0; x < texels->width(); ++x) {
          const Texel& was = reader.at(x, y);
          row[x] = change(x, y, was);
          differs = differs || !(row[x] == was);
        }
        if (differs) any = true;
      }));
  if (any) return made;
  return texels;
}

// A sample of an object's texels, with their colours along a few directions.
struct ColorSample {
  struct One {
    Texel texel;
    AlphaCode code;
  };
  std::vector<One> texels;
  std::vector<Vec3> directions;
  std::vector<Color> colors;  ///< [texel][direction]
};

ColorSample sampled_colors(const BakedObject& object) {
  constexpr std::size_t wanted = 2048, directions = 6;
  ColorSample sample;
  SplitMix64 dice(1);
  for (std::size_t k = 0; k < directions; ++k) sample.directions.push_back(random_direction(dice));
  std::uint64_t opaque = 0;
  for (const TextureSet& set : object.sets) opaque += set.texels->opaque_count();
  const std::uint64_t step = std::max<std::uint64_t>(1, opaque / wanted);
  std::uint64_t number = 0;
  for (const TextureSet& set : object.sets) {
    const TexelReader texels(*set.texels);
    for (int y = 0; y < set.texels->height(); ++y)
      for (int x = 0; x < set.texels->width();) {
        const int end = std::min(set.texels->width(), (x / TexelTile::size + 1) * TexelTile::size);
        const Texel* part = texels.row_part(x, y);
        for (const Texel* t = part; t < part + (end - x); ++t)
          if (t->opaque() && number++ % step == 0) sample.texels.push_back({*t, set.texels->alpha_code()});
        x = end;
      }
  }
  return sample;
}

std::vector<Color> colors_of(const ColorSample& sample, const TexelColors& looks, const FeatureBits& bits) {
  std::vector<Color> colors(sample.texels.size() * looks.directions());
  constexpr std::size_t block = 256;
  tbb::parallel_for(std::size_t{0}, (sample.texels.size() + block - 1) / block, [&](std::size_t b) {
    const std::size_t first = b * block, count = std::min(block, sample.texels.size() - first);
    std::vector<TexelColors::Features> features;
    for (std::size_t k = first; k < first + count; ++k)
      features.push_back(decode_features(rounded(sample.texels[k].texel, bits), sample.texels[k].code));
    looks.decode_into(features, std::span(colors).subspan(first * looks.directions(), count * looks.directions()));
  });
  return colors;
}

// Mean squared error of colours at these numbers of bits.
double squared_loss(const ColorSample& sample, const TexelColors& looks, const FeatureBits& bits) {
  const std::vector<Color> colors = colors_of(sample, looks, bits);
  double sum = 0;
  for (std::size_t k = 0; k < colors.size(); ++k) sum += (colors[k] - sample.colors[k]).squaredNorm();
  return sum / (3 * static_cast<double>(sample.colors.size()));
}

}  // namespace

double missed_share_bound(std::size_t triangles, int rays) {
  return 1 - std::pow(0.05 / static_cast<double>(std::max<std::size_t>(1, triangles)), 1.0 / std::max(1, rays));
}

VisibilityReport traced_visibility(const BakedObject& object, const EyeRegion& eyes, int max_rays,
                                   const Progress& progress) {
  const auto tree = rays_of(object);
  const double size = object.bounds().diagonal().norm();
  struct Sent {
    std::size_t set, face;  ///< index of the set; of the face within it
    int rays = 0, through = 0;
    bool shows = true;
  };
  std::vector<Sent> all;
  for (std::size_t s = 0; s < object.sets.size(); ++s)
    for (std::size_t f = 0; f < object.sets[s].soup.triangle_count(); ++f) all.push_back({s, f});
  const auto send = [&](std::size_t triangle, int until) {
    Sent& sent = all[triangle];
    const OpaquePoints points(object.sets[sent.set], sent.face);
    sent.shows = !points.none();
    // A different random sequence for each call.
    SplitMix64 dice(triangle * 64 + static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(sent.rays))));
    while (sent.shows && sent.rays < until && sent.through < enough) {
      const Vec3 point = points.random(dice);
      Vec3 eye;
      if (!eyes.viewpoints.empty()) {
        const Viewpoint& from = eyes.viewpoints[dice.below(eyes.viewpoints.size())];
        eye = from.back.isZero(0) ? from.eye : Vec3(point + 1.5 * size * from.back);
      } else if (eyes.box) {
        const Vec3 share(dice.share(), dice.share(), dice.share());
        eye = eyes.world_to_object * Vec3(eyes.box->min() + share.cwiseProduct(eyes.box->sizes()));
      } else {
        eye = point + 1.5 * size * random_direction(dice);
      }
      ++sent.rays;
      // The ray ends before the point by more than the tree's rounding error.
      const Vec3 way = point - eye;
      const double distance = way.norm();
      if (distance > 0 && tree->blocked(eye, way, 0, 1 - 1e-5 * size / distance)) continue;
      ++sent.through;
    }
  };
  std::vector<std::size_t> open(all.size());  // triangles that no ray has reached yet
  std::iota(open.begin(), open.end(), std::size_t{0});
  constexpr int first_rays = 1024;
  int until = std::min(first_rays, max_rays);
  for (bool more = true; more;) {
    std::atomic<std::size_t> done = 0, found = 0;
    tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t k) {
      send(open[k], until);
      if (all[open[k]].through > 0) ++found;
      const std::size_t now = ++done;
      if (now % 256 == 0)
        progress.at("tracing visibility", static_cast<double>(now) / static_cast<double>(open.size()));
    });
    std::erase_if(open, [&](std::size_t k) { return all[k].through > 0 || !all[k].shows; });
    // The first round finds the clearly visible triangles. The rest counts as unseen after a further round that finds
    // nothing.
    more = !open.empty() && until < max_rays && (found > 0 || until == first_rays);
    if (more) until = std::min(2 * until, max_rays);
  }
  VisibilityReport seen;
  seen.rays_each = until;
  for (const Sent& sent : all) {
    seen.rays += static_cast<std::uint64_t>(sent.rays);
    seen.unseen.push_back(sent.through == 0 ? 1 : 0);
    seen.seen_once.push_back(sent.through == 1 ? 1 : 0);
    seen.opaque.push_back(sent.shows ? 1 : 0);
    if (sent.through == 0) continue;
    seen.smallest_opening = std::min(seen.smallest_opening, static_cast<double>(sent.through) / sent.rays);
  }
  return seen;
}

BitsFound fewest_bits(const BakedObject& object, double psnr_db, const Progress& progress) {
  BitsFound found;
  found.psnr_db = std::numeric_limits<double>::infinity();
  ColorSample sample = sampled_colors(object);
  if (sample.texels.empty()) return found;
  const TexelColors looks(*object.decoder, sample.directions);
  sample.colors = colors_of(sample, looks, found.bits);
  const double most = std::pow(10.0, -psnr_db / 10);
  for (int taken = 0;; ++taken) {
    progress.at("reducing bits", taken / 56.0);
    double least = std::numeric_limits<double>::infinity();
    FeatureBits best = found.bits;
    for (std::size_t k = 0; k < 8; ++k) {
      if (found.bits[k] == 1) continue;
      FeatureBits fewer = found.bits;
      --fewer[k];
      const double loss = squared_loss(sample, looks, fewer);
      if (loss >= least) continue;
      least = loss;
      best = fewer;
    }
    if (!(least <= most)) return found;
    found.bits = best;
    found.psnr_db = -10 * std::log10(least);
  }
}

std::shared_ptr<const FeatureTexture> with_bits(const std::shared_ptr<const FeatureTexture>& texels,
                                                const FeatureBits& bits) {
  return changed(texels, [&](int, int, const Texel& texel) { return texel.opaque() ? rounded(texel, bits) : texel; });
}

std::shared_ptr<const FeatureTexture> without_unused_texels(const TextureSet& set) {
  const int width = set.texels->width(), height = set.texels->height();
  std::vector<std::uint8_t> shown(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
    const std::array<Vec2, 3> uv = texel_corners(set, f);
    const Vec2 low = uv[0].cwiseMin(uv[1]).cwiseMin(uv[2]), high = uv[0].cwiseMax(uv[1]).cwiseMax(uv[2]);
    if (!(low.allFinite() && high.allFinite())) return set.texels;
    // With a margin of one texel for rounding.
    const int left = texel_within(low.x() - 1, width), right = texel_within(high.x() + 1, width);
    for (int y = texel_within(low.y() - 1, height); y <= texel_within(high.y() + 1, height); ++y)
      std::fill_n(shown.begin() + static_cast<std::ptrdiff_t>(y) * width + left, right - left + 1, 1);
  }
  return changed(set.texels, [&, empty = empty_texel(set.texels->alpha_code())](int x, int y, const Texel& texel) {
    return texel.opaque() &&
                   shown[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] !=
                       0
               ? texel
               : empty;
  });
}

}  // namespace rebake
