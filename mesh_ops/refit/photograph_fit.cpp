#include "mesh_ops/refit/photograph_fit.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/features/distill/fuse_training.h"
#include "mesh_ops/refit/texel_observations.h"
#include "mesh_ops/training/fit.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

using Features = std::array<std::uint8_t, 8>;

// The observations of an object's texels: those of texel t are all[first[t]] … all[first[t + 1] − 1].
struct Observations {
  std::vector<ObservedTexel> texels;
  std::vector<std::vector<Observation>> of_texel;
};

// A number 0 … 1 from a texel and a photograph, the same in every run.
double dice(std::size_t texel, std::size_t photograph) {
  return SplitMix64(texel * 0x9e3779b97f4a7c15U + photograph).share();
}

// Of the observations, at most `most`: random ones, with a probability that grows with the weight (Efraimidis,
// Spirakis 2006).
void keep_some(std::vector<Observation>& all, std::size_t texel, std::size_t most) {
  const auto is_mixed = [](const Observation& one) { return one.mixed; };
  if (!std::all_of(all.begin(), all.end(), is_mixed)) std::erase_if(all, is_mixed);
  if (all.size() <= most) return;
  std::vector<std::pair<double, std::size_t>> keys;
  for (std::size_t k = 0; k < all.size(); ++k)
    keys.emplace_back(std::log(std::max(dice(texel, k), 1e-300)) / static_cast<double>(all[k].weight), k);
  std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(most), keys.end(), std::greater<>());
  std::vector<Observation> kept;
  for (std::size_t k = 0; k < most; ++k) kept.push_back(all[keys[k].second]);
  all = std::move(kept);
}

// What all photographs show of the texels of an object, which all `nodes` have with the same triangles chosen.
Observations observed(const BakedObject& object, const std::vector<const FitTarget*>& nodes,
                      const std::vector<ObservingPhotograph>& photographs, std::size_t most) {
  Observations result{observed_texels(object, nodes.front()->triangles), {}};
  result.of_texel.resize(result.texels.size());
  std::vector<Mat3> turns;
  for (const FitTarget* node : nodes) turns.push_back(orthogonal_factor(node->placed.to_world.linear()).transpose());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, result.texels.size(), 256), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      if (!result.texels[t].chosen) continue;
      std::vector<Observation>& all = result.of_texel[t];
      for (std::size_t n = 0; n < nodes.size(); ++n)
        for (const ObservingPhotograph& photograph : photographs)
          if (const Observation one = photograph.observe(result.texels[t], nodes[n]->placed.to_world, turns[n]);
              one.weight > 0)
            all.push_back(one);
      keep_some(all, t, most);
    }
  });
  return result;
}

void set_bytes(Texel& texel, const Features& bytes) {
  for (std::size_t c = 0; c < 4; ++c) {
    texel.feat0[c] = bytes[c];
    texel.feat1[c] = bytes[c + 4];
  }
}

// Sum of squared errors of the observations under an object's own features and decoder, and their number.
struct ErrorSum {
  double squares = 0;
  std::size_t count = 0;
};
ErrorSum error_of(const BakedObject& object, const Observations& observations) {
  std::deque<TexelReader> readers;
  for (const TextureSet& set : object.sets) readers.emplace_back(*set.texels);
  ErrorSum sum;
  for (std::size_t t = 0; t < observations.texels.size(); ++t) {
    const ObservedTexel& texel = observations.texels[t];
    const auto features = decode_features(readers[texel.set].at(static_cast<int>(texel.x), static_cast<int>(texel.y)),
                                          object.sets[texel.set].texels->alpha_code());
    for (const Observation& one : observations.of_texel[t]) {
      const Vec3 fed(one.fed_direction[0], one.fed_direction[1], one.fed_direction[2]);
      const Color color = decode(*object.decoder, features, fed);
      for (std::size_t c = 0; c < 3; ++c) {
        const double d = color[static_cast<Eigen::Index>(c)] - static_cast<double>(one.color[c]);
        sum.squares += d * d / 3;
      }
      ++sum.count;
    }
  }
  return sum;
}

// Fits the features of up to 16 texels with a fixed decoder. Returns the bytes of each.
class FixedFitter {
 public:
  FixedFitter(const BakedObject& object, const Observations& observations)
      : object_(object), observations_(observations), network_(*object.decoder) {
    for (const TextureSet& set : object.sets) readers_.emplace_back(*set.texels);
  }

  std::array<Features, network_lanes> fit(const std::array<std::size_t, network_lanes>& texels) const {
    const NetworkKernels& kernels = network_kernels();
    std::vector<Lanes> work(kernels.workspace(network_.view()));
    const AlphaCode code = object_.sets[observations_.texels[texels[0]].set].texels->alpha_code();
    std::vector<ViewSample> samples = samples_of(texels);
    const std::size_t observed_count = samples.size();
    add_prior(texels, code, samples, work.data());
    const auto levels = feature_levels(8, code);
    Lanes best[texel_features], least;
    std::fill_n(least.at, network_lanes, std::numeric_limits<float>::infinity());
    // Pixels average the features of neighbours, so these should be alike: other starts count only where the present
    // features lead to a poor fit, as where all neurons are silent.
    constexpr float poor = 15.0F / 255;
    const auto count = static_cast<float>(3 * observed_count);
    for (std::size_t start = 0; start < starts; ++start) {
      if (start > 0 && *std::max_element(least.at, least.at + network_lanes) <= poor * poor * count) break;
      Lanes tried[texel_features], error;
      begin(texels, start, code, tried);
      kernels.fit_texels(network_.view(), samples.data(), samples.size(), {iterations, levels.data(), true, 0}, tried,
                         &error, work.data());
      for (std::size_t l = 0; l < network_lanes; ++l) {
        if (!(error.at[l] < least.at[l]) || (start > 0 && least.at[l] <= poor * poor * count)) continue;
        least.at[l] = error.at[l];
        for (std::size_t c = 0; c < texel_features; ++c) best[c].at[l] = tried[c].at[l];
      }
    }
    std::array<Features, network_lanes> result{};
    for (std::size_t l = 0; l < network_lanes; ++l)
      for (std::size_t c = 0; c < texel_features; ++c) {
        const long byte = std::lround(best[c].at[l] * 255);
        const bool halved = c % 4 == 3 && code == AlphaCode::halved;
        result[l][c] = static_cast<std::uint8_t>(halved ? 128 + (byte - 1) / 2 : byte);
      }
    return result;
  }

 private:
  static constexpr std::size_t starts = 4, iterations = 12, prior_count = 12;
  static constexpr float prior_weight = 0.05F;  // of one observation

  std::vector<ViewSample> samples_of(const std::array<std::size_t, network_lanes>& texels) const {
    std::size_t count = 0;
    for (const std::size_t t : texels) count = std::max(count, observations_.of_texel[t].size());
    std::vector<ViewSample> samples(count);
    for (std::size_t k = 0; k < count; ++k) {
      samples[k].coverage = samples[k].weight = 1;
      samples[k].mix = 0;
      for (std::size_t l = 0; l < network_lanes; ++l) {
        const std::vector<Observation>& all = observations_.of_texel[texels[l]];
        const Observation& one = all[k % all.size()];
        for (std::size_t c = 0; c < 3; ++c) {
          samples[k].direction[c].at[l] = one.fed_direction[c];
          samples[k].target[c].at[l] = one.color[c];
        }
      }
    }
    return samples;
  }

  // Few photographs leave features undetermined, so that texels would look like grain from elsewhere: along even
  // directions, they are drawn weakly to their present view dependence about their observed mean colour.
  void add_prior(const std::array<std::size_t, network_lanes>& texels, AlphaCode code, std::vector<ViewSample>& samples,
                 Lanes* work) const {
    const NetworkKernels& kernels = network_kernels();
    Lanes input[decoder_inputs], shown[3], change[3]{};
    begin(texels, 0, code, input);
    const auto observed_count = static_cast<float>(samples.size());
    const auto show = [&](const ViewSample& sample) {
      std::copy_n(sample.direction, 3, input + texel_features);
      kernels.forward(network_.view(), input, shown, work);
    };
    for (const ViewSample& sample : samples) {
      show(sample);
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t l = 0; l < network_lanes; ++l)
          change[c].at[l] += (sample.target[c].at[l] - shown[c].at[l]) / observed_count;
    }
    for (const Vec3& direction : prior_directions_) {
      ViewSample& sample = samples.emplace_back();
      for (std::size_t c = 0; c < 3; ++c)
        std::fill_n(sample.direction[c].at, network_lanes, static_cast<float>(direction[static_cast<Eigen::Index>(c)]));
      show(sample);
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t l = 0; l < network_lanes; ++l)
          sample.target[c].at[l] = std::clamp(shown[c].at[l] + change[c].at[l], 0.0F, 1.0F);
      sample.coverage = 1;
      sample.mix = 0;
      sample.weight = prior_weight;
    }
  }

  // The present features, or others spread evenly.
  void begin(const std::array<std::size_t, network_lanes>& texels, std::size_t start, AlphaCode code,
             Lanes* features) const {
    for (std::size_t l = 0; l < network_lanes; ++l) {
      const ObservedTexel& texel = observations_.texels[texels[l]];
      const auto present =
          decode_features(readers_[texel.set].at(static_cast<int>(texel.x), static_cast<int>(texel.y)), code);
      for (std::size_t c = 0; c < texel_features; ++c)
        features[c].at[l] =
            static_cast<float>(start == 0 ? present[c] : 0.1 + 0.8 * dice(texel_features * start + c, 1));
    }
  }

  const BakedObject& object_;
  const Observations& observations_;
  FeatureNetwork network_;
  std::deque<TexelReader> readers_;
  std::vector<Vec3> prior_directions_ = even_directions(prior_count);
};

std::vector<std::size_t> seen_texels(const Observations& observations) {
  std::vector<std::size_t> seen;
  for (std::size_t t = 0; t < observations.texels.size(); ++t)
    if (!observations.of_texel[t].empty()) seen.push_back(t);
  // Groups of one set, whose code is the same, and of texels with about as many observations.
  std::stable_sort(seen.begin(), seen.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(observations.texels[a].set, observations.of_texel[a].size()) <
           std::pair(observations.texels[b].set, observations.of_texel[b].size());
  });
  return seen;
}

// The object with other features of some texels.
std::shared_ptr<const BakedObject> with_features(const BakedObject& object, const Observations& observations,
                                                 const std::vector<std::size_t>& texels,
                                                 const std::vector<Features>& features) {
  auto made = std::make_shared<BakedObject>(object);
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    FeatureTexture::Change change(*object.sets[s].texels);
    for (std::size_t k = 0; k < texels.size(); ++k) {
      const ObservedTexel& texel = observations.texels[texels[k]];
      if (texel.set == s) set_bytes(change.at(static_cast<int>(texel.x), static_cast<int>(texel.y)), features[k]);
    }
    if (change.touched()) made->sets[s].texels = change.finish();
  }
  return made;
}

std::shared_ptr<const BakedObject> fitted_features(const BakedObject& object, const Observations& observations,
                                                   const Progress& progress) {
  const std::vector<std::size_t> seen = seen_texels(observations);
  const FixedFitter fitter(object, observations);
  std::vector<std::array<std::size_t, network_lanes>> groups;
  for (std::size_t k = 0; k < seen.size();) {
    std::array<std::size_t, network_lanes> group{};
    group.fill(seen[k]);
    const std::uint32_t set = observations.texels[seen[k]].set;
    for (std::size_t l = 0; l < network_lanes && k < seen.size() && observations.texels[seen[k]].set == set; ++l, ++k)
      group[l] = seen[k];
    groups.push_back(group);
  }
  std::vector<std::array<Features, network_lanes>> fitted(groups.size());
  constexpr std::size_t parts = 50;
  for (std::size_t part = 0; part < parts; ++part) {
    progress.at("fitting texels", static_cast<double>(part) / parts);
    tbb::parallel_for(groups.size() * part / parts, groups.size() * (part + 1) / parts,
                      [&](std::size_t g) { fitted[g] = fitter.fit(groups[g]); });
  }
  std::vector<std::size_t> texels;
  std::vector<Features> features;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t l = 0; l < network_lanes; ++l) {
      texels.push_back(groups[g][l]);
      features.push_back(fitted[g][l]);
    }
  return with_features(object, observations, texels, features);
}

// Features and decoder together; texels that nothing observes are fitted to their present colours.
std::shared_ptr<const BakedObject> fitted_with_decoder(const BakedObject& object, const Observations& observations,
                                                       const FitOfPhotographsOptions& options,
                                                       const Progress& progress) {
  const std::size_t count = options.observations;
  FitProblem problem{observations.texels.size(), count, {}, {}, {}};
  const std::vector<Vec3> even = even_directions(count);
  const TexelColors colors(*object.decoder, even);
  std::deque<TexelReader> readers;
  for (const TextureSet& set : object.sets) readers.emplace_back(*set.texels);
  std::vector<Color> present(count);
  for (std::size_t t = 0; t < observations.texels.size(); ++t) {
    const ObservedTexel& texel = observations.texels[t];
    const std::vector<Observation>& all = observations.of_texel[t];
    if (all.empty()) {
      const std::array<TexelColors::Features, 1> features{
          decode_features(readers[texel.set].at(static_cast<int>(texel.x), static_cast<int>(texel.y)),
                          object.sets[texel.set].texels->alpha_code())};
      colors.decode_into(features, present);
    }
    for (std::size_t k = 0; k < count; ++k) {
      std::array<float, 3> direction{}, color{};
      for (std::size_t c = 0; c < 3; ++c) {
        const auto axis = static_cast<Eigen::Index>(c);
        direction[c] = all.empty() ? static_cast<float>(even[k][axis]) : all[k % all.size()].fed_direction[c];
        color[c] = all.empty() ? static_cast<float>(present[k][axis]) : all[k % all.size()].color[c];
      }
      problem.fed_directions.push_back(direction);
      problem.colors.push_back(color);
    }
  }
  FitOptions fit_options;
  fit_options.epochs = options.epochs;
  if (object.decoder->rule == ColorRule::network)
    fit_options.hidden = std::max(object.decoder->hidden0(), object.decoder->hidden1());
  const FitResult fitted = fit(problem, fit_options, progress);
  auto made = std::make_shared<BakedObject>(object);
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    const FeatureTexture& before = *object.sets[s].texels;
    const std::size_t width = static_cast<std::size_t>(before.width());
    std::vector<Texel> texels(width * static_cast<std::size_t>(before.height()), empty_texel(AlphaCode::halved));
    for (std::size_t t = 0; t < observations.texels.size(); ++t)
      if (const ObservedTexel& texel = observations.texels[t]; texel.set == s)
        set_bytes(texels[texel.y * width + texel.x], fitted.features[t]);
    made->sets[s].texels = std::make_shared<const FeatureTexture>(
        FeatureTexture::from_rows(before.width(), before.height(), AlphaCode::halved, [&](int y, Texel* row) {
          std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * width), width, row);
        }));
  }
  made->decoder = std::make_shared<const Decoder>(fitted.decoder);
  made->dialect.alpha.reset();
  made->dialect.linear = 0;
  made->dialect.no_holes = false;
  if (object.decoder->rule != ColorRule::network) made->other_members = {};  // those of another format
  return made;
}

}  // namespace

FitOfPhotographs fit_to_photographs(const std::vector<FitTarget>& targets, const SceneRays& occluders,
                                    const std::vector<FitPhotograph>& photographs,
                                    const FitOfPhotographsOptions& options, const Progress& progress) {
  Box box;
  for (const FitTarget& target : targets)
    box.extend(transformed(target.placed.node->object->bounds(), target.placed.to_world));
  // Coarser photographs mix all of an object.
  constexpr double largest_pixel = 1.0 / 16;
  std::vector<ObservingPhotograph> observing;
  for (std::size_t k = 0; k < photographs.size(); ++k) {
    progress.at("looking at photographs", static_cast<double>(k) / static_cast<double>(photographs.size()));
    observing.emplace_back(photographs[k], occluders, box.diagonal().norm() + box.center().norm(),
                           largest_pixel * box.diagonal().norm());
  }
  // Targets that share an object and its chosen triangles share the result.
  std::vector<std::vector<const FitTarget*>> groups;
  for (const FitTarget& target : targets) {
    const auto same = [&](const std::vector<const FitTarget*>& group) {
      return group.front()->placed.node->object == target.placed.node->object &&
             group.front()->triangles == target.triangles;
    };
    const auto found = std::find_if(groups.begin(), groups.end(), same);
    if (found == groups.end())
      groups.push_back({&target});
    else
      found->push_back(&target);
  }
  FitOfPhotographs result;
  ErrorSum before, after;
  for (const std::vector<const FitTarget*>& group : groups) {
    progress.at("finding texels in the photographs", 0);
    // Objects without view dependence get the axes of most MobileNeRF folders.
    BakedObject with_axes = *group.front()->placed.node->object;
    if (with_axes.decoder->rule == ColorRule::diffuse) with_axes.axes = Axes::y_up;
    const BakedObject* const object = &with_axes;
    const Observations observations = observed(*object, group, observing, options.observations);
    std::size_t seen = 0;
    for (std::size_t t = 0; t < observations.texels.size(); ++t)
      if (observations.texels[t].chosen) ++(observations.of_texel[t].empty() ? result.unseen : seen);
    result.seen += seen;
    if (seen == 0) continue;
    const bool with_decoder = options.decoder || object->decoder->rule != ColorRule::network;
    const ErrorSum own = error_of(*object, observations);
    const auto fitted = with_decoder ? fitted_with_decoder(*object, observations, options, progress)
                                     : fitted_features(*object, observations, progress);
    const ErrorSum fitted_error = error_of(*fitted, observations);
    before.squares += own.squares;
    after.squares += fitted_error.squares;
    before.count += own.count;
    for (const FitTarget* target : group) result.objects[target->placed.node->id] = fitted;
  }
  if (before.count > 0) {
    result.before = std::sqrt(before.squares / static_cast<double>(before.count));
    result.after = std::sqrt(after.squares / static_cast<double>(before.count));
  }
  return result;
}

}  // namespace rebake
