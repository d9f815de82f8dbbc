#include "mesh_ops/features/atlas/near_duplicates.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "mesh_ops/base/hash.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

using Features = TexelColors::Features;

struct Patch {
  std::size_t set, patch;
  TexelRect rect;
  std::uint64_t mask = 0;  // hash of the opacity mask
  std::size_t opaque = 0;  // number of opaque texels
  // Mean weighted features of the rectangle's quarters, scaled by the root of each quarter's share of the opaque
  // texels. Their squared distance is a lower bound of the mean squared difference of features (Jensen's inequality).
  std::array<double, 32> quarters{};
};

struct SetTexels {
  std::unique_ptr<const TexelReader> reader;
  AlphaCode code;
};
using Texels = std::vector<SetTexels>;  // per set

template <class Visit>
void for_each_opaque(const Texels& texels, const Patch& patch, Visit visit) {
  const TexelReader& reader = *texels[patch.set].reader;
  for (int y = 0; y < patch.rect.height(); ++y)
    for (int x = 0; x < patch.rect.width(); ++x)
      if (const Texel& texel = reader.at(patch.rect.left + x, patch.rect.top + y); texel.opaque())
        visit(x, y, decode_features(texel, texels[patch.set].code));
}

// Sensitivity of colours to each feature: root mean square of central differences at a sample of texels.
Features weights_of(const Texels& texels, const std::vector<Patch>& patches, const TexelColors& looks) {
  constexpr std::size_t max_samples = 256;
  constexpr double step = 0.02;
  std::vector<Features> moved;  // per sample and feature: one step up, then one down
  const std::size_t every = std::max<std::size_t>(1, patches.size() / max_samples);
  for (std::size_t k = 0; k < patches.size(); k += every) {
    bool taken = false;
    for_each_opaque(texels, patches[k], [&](int, int, const Features& features) {
      if (taken) return;
      taken = true;
      for (std::size_t f = 0; f < 8; ++f)
        for (const double by : {step, -step}) {
          moved.push_back(features);
          moved.back()[f] += by;
        }
    });
  }
  std::vector<Color> colors(moved.size() * looks.directions());
  looks.decode_into(moved, colors);
  Features weights{};
  for (std::size_t k = 0; k < moved.size(); k += 2)
    for (std::size_t d = 0; d < looks.directions(); ++d)
      weights[k / 2 % 8] +=
          ((colors[k * looks.directions() + d] - colors[(k + 1) * looks.directions() + d]) / (2 * step)).squaredNorm();
  const double values = 3.0 * static_cast<double>(std::max<std::size_t>(16, colors.size())) / 16;
  for (double& weight : weights) weight = std::sqrt(weight / values);
  return weights;
}

void describe(const Texels& texels, const Features& weights, Patch& patch) {
  std::array<double, 4> count{};
  for_each_opaque(texels, patch, [&](int x, int y, const Features& features) {
    const std::size_t quarter =
        (2 * x >= patch.rect.width() ? 1U : 0U) + (2 * y >= patch.rect.height() ? std::size_t{2} : std::size_t{0});
    ++count[quarter];
    for (std::size_t f = 0; f < 8; ++f) patch.quarters[quarter * 8 + f] += weights[f] * features[f];
  });
  for (std::size_t q = 0; q < 4; ++q)
    for (std::size_t f = 0; f < 8 && count[q] > 0; ++f)
      patch.quarters[q * 8 + f] *= std::sqrt(count[q] / static_cast<double>(patch.opaque)) / count[q];
}

double squared_distance(const Patch& a, const Patch& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.quarters.size(); ++k)
    sum += (a.quarters[k] - b.quarters[k]) * (a.quarters[k] - b.quarters[k]);
  return sum;
}

// Mean squared difference of colours. Stops early above `most` with a partial sum above `most`; infinite if opacity
// differs.
double color_loss(const Texels& texels, const TexelColors& looks, const Patch& a, const Patch& b, double most) {
  const SetTexels &first = texels[a.set], &second = texels[b.set];
  const double values = 3.0 * static_cast<double>(a.opaque * looks.directions());
  constexpr std::size_t batch_size = 4 * network_lanes;
  std::vector<Features> features;  // alternating: of a, of b
  std::vector<Color> colors(2 * batch_size * looks.directions());
  double sum = 0;
  const auto add = [&] {
    looks.decode_into(features, colors);
    for (std::size_t k = 0; k < features.size(); k += 2)
      for (std::size_t d = 0; d < looks.directions(); ++d)
        sum += (colors[k * looks.directions() + d] - colors[(k + 1) * looks.directions() + d]).squaredNorm();
    features.clear();
  };
  for (int y = 0; y < a.rect.height(); ++y)
    for (int x = 0; x < a.rect.width(); ++x) {
      const Texel &p = first.reader->at(a.rect.left + x, a.rect.top + y),
                  &q = second.reader->at(b.rect.left + x, b.rect.top + y);
      if (p.opaque() != q.opaque()) return std::numeric_limits<double>::infinity();
      if (!p.opaque() || (p == q && first.code == second.code)) continue;
      features.push_back(decode_features(p, first.code));
      features.push_back(decode_features(q, second.code));
      if (features.size() < 2 * batch_size) continue;
      add();
      if (sum > most * values) return sum / values;
    }
  add();
  return values > 0 ? sum / values : 0;
}

std::vector<Patch> patches_of(const BakedObject& object, DuplicatePatches& result) {
  std::vector<Patch> patches;
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    const TexelPatches found = texel_patches(object.sets[s]);
    result.representative_of.emplace_back();
    for (std::size_t p = 0; p < found.rects.size(); ++p) {
      result.representative_of.back().push_back({s, p});
      patches.push_back({s, p, found.rects[p], 0, 0, {}});
    }
  }
  tbb::parallel_for(std::size_t{0}, patches.size(), [&](std::size_t k) {
    Patch& patch = patches[k];
    const FeatureTexture& texels = *object.sets[patch.set].texels;
    std::vector<std::uint8_t> mask;
    for (int y = patch.rect.top; y <= patch.rect.bottom; ++y)
      for (int x = patch.rect.left; x <= patch.rect.right; ++x) mask.push_back(texels.opaque(x, y) ? 1 : 0);
    patch.mask = content_hash({reinterpret_cast<const char*>(mask.data()), mask.size()});
    patch.opaque = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
  });
  return patches;
}

}  // namespace

DuplicatePatches near_duplicate_patches(const BakedObject& object, double squared_loss, const Progress& progress) {
  DuplicatePatches result;
  if (!std::all_of(object.sets.begin(), object.sets.end(), can_pack)) return result;
  std::vector<Patch> patches = patches_of(object, result);
  result.patches = patches.size();
  Texels texels;
  for (const TextureSet& set : object.sets)
    texels.push_back({std::make_unique<const TexelReader>(*set.texels), set.texels->alpha_code()});
  constexpr std::size_t directions = 6;
  const TexelColors looks(*object.decoder, even_directions(directions));
  const Features weights = weights_of(texels, patches, looks);
  tbb::parallel_for(std::size_t{0}, patches.size(), [&](std::size_t k) { describe(texels, weights, patches[k]); });

  // Representatives per size and opacity mask, sorted by the quarter's feature with the largest variance over all
  // patches.
  std::size_t key = 0;
  double widest = -1;
  for (std::size_t q = 0; q < 32; ++q) {
    double mean = 0, square = 0;
    for (const Patch& patch : patches) mean += patch.quarters[q], square += patch.quarters[q] * patch.quarters[q];
    if (const double spread = square - mean * mean / static_cast<double>(std::max<std::size_t>(1, patches.size()));
        spread > widest) {
      widest = spread;
      key = q;
    }
  }
  using Kind = std::tuple<int, int, std::uint64_t>;
  std::map<Kind, std::multimap<double, std::size_t>> representatives;
  // Weights are means over a sample, so the search radius is larger than the allowed loss: a patch's features may
  // matter less than the average.
  constexpr double reach = 4;
  constexpr std::size_t max_decoded = 8;
  double lost = 0, opaque = 0;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    if (k % 256 == 0)
      progress.at("finding near-duplicate patches", static_cast<double>(k) / static_cast<double>(patches.size()));
    const Patch& patch = patches[k];
    opaque += static_cast<double>(patch.opaque);
    auto& known = representatives[{patch.rect.width(), patch.rect.height(), patch.mask}];
    const double most = reach * squared_loss, radius = std::sqrt(most);
    std::vector<std::pair<double, std::size_t>> near;
    for (auto it = known.lower_bound(patch.quarters[key] - radius);
         it != known.end() && it->first <= patch.quarters[key] + radius; ++it)
      if (const double distance = squared_distance(patch, patches[it->second]); distance <= most)
        near.emplace_back(distance, it->second);
    std::sort(near.begin(), near.end());
    bool is_duplicate = false;
    for (std::size_t n = 0; n < near.size() && n < max_decoded && !is_duplicate; ++n) {
      const Patch& representative = patches[near[n].second];
      const double loss = color_loss(texels, looks, representative, patch, squared_loss);
      if (!(loss <= squared_loss)) continue;
      result.representative_of[patch.set][patch.patch] = {representative.set, representative.patch};
      ++result.merged;
      result.texels += patch.opaque;
      lost += loss * static_cast<double>(patch.opaque);
      is_duplicate = true;
    }
    if (!is_duplicate) known.emplace(patch.quarters[key], k);
  }
  result.squared_loss = opaque > 0 ? lost / opaque : 0;
  return result;
}

}  // namespace rebake
