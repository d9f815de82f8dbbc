#include "mesh_ops/features/distill/fuse_training.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rebake {

namespace {

constexpr std::size_t encoder_hidden0 = 64, encoder_hidden1 = 32;
constexpr std::size_t trained_directions = 48, held_out_directions = 16;
// Number of partial sums of gradients. They are added in order, so that results do not depend on the number of threads.
constexpr std::size_t gradient_parts = 8;

struct Gradients {
  std::vector<std::vector<Lanes>> parts;
  explicit Gradients(std::size_t values) : parts(gradient_parts, std::vector<Lanes>(values)) {}
  void clear() {
    for (auto& part : parts) std::fill(part.begin(), part.end(), Lanes{});
  }
  void mean_into(std::vector<float>& result, double count) const {
    result.resize(parts[0].size());
    for (std::size_t i = 0; i < result.size(); ++i) {
      Lanes sum{};
      for (const auto& part : parts)
        for (std::size_t l = 0; l < network_lanes; ++l) sum.at[l] += part[i].at[l];
      float total = 0;
      for (const float value : sum.at) total += value;
      result[i] = static_cast<float>(static_cast<double>(total) / count);
    }
  }
};

// Transpose of mixed(): distributes the gradient of the means over the lanes.
void unmix(const Lanes& slopes, std::uint32_t way, Lanes& to) {
  for (std::size_t l = 0; l < network_lanes; ++l) {
    const auto other = [&](std::size_t k) { return slopes.at[(l + network_lanes * way - k * way) % network_lanes]; };
    to.at[l] = 0.25F * ((other(0) + other(1)) + (other(2) + other(3)));
  }
}

void set_direction(const Vec3& direction, float coverage, Lanes* input) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    std::fill_n(input[axis].at, network_lanes,
                coverage * static_cast<float>(direction[static_cast<Eigen::Index>(axis)]));
}

// Training data: a sample with its teachers and signatures.
struct TrainingData {
  const Composition& composition;
  const TexelSample& sample;
  std::vector<FeatureNetwork> teachers = networks_of(composition);
  std::vector<std::vector<Lanes>> signatures;  // per piece

  TrainingData(const Composition& c, const TexelSample& s) : composition(c), sample(s), signatures(s.pieces.size()) {
    tbb::parallel_for(std::size_t{0}, signatures.size(), [&](std::size_t k) {
      std::vector<Lanes> work(workspace());
      signatures[k].resize(signature_size);
      signature(teacher_of(k), sample.pieces[k].group, signatures[k].data(), work.data());
    });
  }
  const FeatureNetwork& teacher_of(std::size_t piece) const {
    return teachers[composition.parts[sample.pieces[piece].part].teacher];
  }
  std::size_t workspace() const {
    std::size_t most = 0;
    for (const FeatureNetwork& teacher : teachers) most = std::max(most, network_kernels().workspace(teacher.view()));
    return most;
  }
};

// Trains the encoder, and the decoder if `decoder_moves`, end to end on the error of colours.
void train_together(Student& student, const TrainingData& lesson, int steps, bool decoder_moves, double rate,
                    const TrainingOptions& options, const Progress& progress) {
  const NetworkKernels& kernels = network_kernels();
  constexpr std::size_t groups_per_step = 64, view_samples_per_group = 2;
  std::vector<std::size_t> pieces;
  for (std::size_t k = 0; k < lesson.sample.pieces.size(); ++k)
    if (!stays(student, lesson.composition.parts[lesson.sample.pieces[k].part])) pieces.push_back(k);
  if (pieces.empty()) return;
  FeatureNetwork& encoder = *student.encoder;
  Adam decoder_adam(student.decoder.values.size()), encoder_adam(encoder.values.size());
  Gradients decoder_gradients(decoder_moves ? student.decoder.values.size() : 0),
      encoder_gradients(encoder.values.size());
  std::vector<float> gradient;
  const std::size_t decoder_work = kernels.workspace(student.decoder.view()),
                    encoder_work = kernels.workspace(encoder.view()), teacher_work = lesson.workspace();
  for (int step = 0; step < steps; ++step) {
    if (step % 50 == 0) progress.at("training", static_cast<double>(step) / steps);
    if (step % 50 == 0 && options.until && std::chrono::steady_clock::now() > *options.until) break;
    decoder_gradients.clear();
    encoder_gradients.clear();
    tbb::parallel_for(std::size_t{0}, gradient_parts, [&](std::size_t part) {
      SplitMix64 dice(options.seed + static_cast<std::uint64_t>(step) * gradient_parts + part);
      std::vector<Lanes> work(decoder_work + encoder_work + teacher_work);
      Lanes* const at_decoder = work.data();
      Lanes* const at_encoder = at_decoder + decoder_work;
      Lanes* const at_teacher = at_encoder + encoder_work;
      for (std::size_t g = 0; g < groups_per_step / gradient_parts; ++g) {
        const std::size_t number = pieces[dice.below(pieces.size())];
        const TexelSample::Piece& piece = lesson.sample.pieces[number];
        Lanes features[texel_features], feature_slopes[texel_features] = {};
        kernels.forward(encoder.view(), lesson.signatures[number].data(), features, at_encoder);
        for (std::size_t k = 0; k < view_samples_per_group; ++k) {
          const Vec3& direction = piece.directions[dice.below(piece.directions.size())];
          const ViewSampleKind kind = view_sample_kind(dice.next() >> 32);
          Lanes target[3], input[decoder_inputs], output[3], slopes[3], input_slopes[decoder_inputs];
          teacher_colors(lesson.teacher_of(number), piece.group, direction, kind.coverage, kind.mix, target,
                         at_teacher);
          for (std::size_t c = 0; c < texel_features; ++c) {
            input[c] = mixed(features[c], kind.mix);
            for (float& value : input[c].at) value *= kind.coverage;
          }
          set_direction(direction, kind.coverage, input + texel_features);
          kernels.forward(student.decoder.view(), input, output, at_decoder);
          const float weight = kind.coverage * kind.coverage;
          for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t l = 0; l < network_lanes; ++l)
              slopes[c].at[l] = weight * (output[c].at[l] - target[c].at[l]);
          kernels.backward(student.decoder.view(), input, output, slopes,
                           decoder_moves ? decoder_gradients.parts[part].data() : nullptr, input_slopes, at_decoder);
          for (std::size_t c = 0; c < texel_features; ++c) {
            Lanes own = input_slopes[c];
            if (kind.mix != 0) unmix(input_slopes[c], kind.mix, own);
            for (std::size_t l = 0; l < network_lanes; ++l) feature_slopes[c].at[l] += kind.coverage * own.at[l];
          }
        }
        kernels.backward(encoder.view(), lesson.signatures[number].data(), features, feature_slopes,
                         encoder_gradients.parts[part].data(), nullptr, at_encoder);
      }
    });
    const float step_rate = static_cast<float>(rate) * cosine_rate(static_cast<double>(step) / steps);
    constexpr double observations = groups_per_step * view_samples_per_group * network_lanes;
    encoder_gradients.mean_into(gradient, observations);
    encoder_adam.step(encoder.values, gradient, step_rate);
    if (!decoder_moves) continue;
    decoder_gradients.mean_into(gradient, observations);
    decoder_adam.step(student.decoder.values, gradient, step_rate);
  }
}

FeatureNetwork new_encoder(std::uint64_t seed) {
  FeatureNetwork encoder(signature_size, encoder_hidden0, encoder_hidden1, texel_features);
  randomise(encoder, seed + 17);
  return encoder;
}

}  // namespace

TexelSample sampled(const Composition& composition, const VisibleDirections& sightlines, std::size_t texels,
                    std::uint64_t seed, const Progress& progress) {
  const std::size_t wanted = (texels + network_lanes - 1) / network_lanes;
  std::vector<std::vector<std::uint32_t>> blocks_of_part(composition.parts.size());
  std::vector<std::uint64_t> texels_of_part(composition.parts.size());
  for (std::uint32_t b = 0; b < composition.blocks.size(); ++b) {
    blocks_of_part[composition.blocks[b].part].push_back(b);
    texels_of_part[composition.blocks[b].part] += composition.blocks[b].opaque;
  }
  TexelSample sample;
  SplitMix64 dice(seed);
  for (std::uint32_t part = 0; part < composition.parts.size(); ++part) {
    if (texels_of_part[part] == 0) continue;
    const auto share = static_cast<double>(texels_of_part[part]) / static_cast<double>(composition.opaque_texels);
    // A small part may fill a picture, so an eighth of the sample is divided equally among the parts.
    const std::size_t least = std::min<std::size_t>(wanted / (8 * composition.parts.size()),
                                                    static_cast<std::size_t>(texels_of_part[part]) / network_lanes);
    const std::size_t groups =
        std::max({std::size_t{2}, least, static_cast<std::size_t>(std::lround(share * static_cast<double>(wanted)))});
    // Stratified along the part's texels, so that no region is missed.
    std::uint64_t passed = 0;
    std::size_t at = 0;
    const double offset = dice.share();
    for (std::size_t g = 0; g < groups; ++g) {
      const auto place = static_cast<std::uint64_t>((static_cast<double>(g) + offset) / static_cast<double>(groups) *
                                                    static_cast<double>(texels_of_part[part]));
      while (passed + composition.blocks[blocks_of_part[part][at]].opaque <= place)
        passed += composition.blocks[blocks_of_part[part][at++]].opaque;
      TexelSample::Piece piece;
      piece.part = part;
      const Composition::Block& block = composition.blocks[blocks_of_part[part][at]];
      const std::vector<TexelSite> sites = sites_of(composition, block);
      if (sites.empty()) continue;
      std::vector<TexelGroup> groups_here = groups_of(composition, block, sites);
      piece.group = groups_here[dice.below(groups_here.size())];
      piece.directions = sightlines.directions(sites, trained_directions, dice.next());
      piece.held_out = sightlines.directions(sites, held_out_directions, dice.next());
      sample.pieces.push_back(std::move(piece));
      if (g % 32 == 0)
        progress.at("sampling texels",
                    static_cast<double>(sample.pieces.size()) / static_cast<double>(wanted + composition.parts.size()));
    }
  }
  return sample;
}

bool stays(const Student& student, const Composition::Part& part) {
  return student.keeps && student.branches.front().teacher == part.teacher && !part.bent && !part.light;
}

bool needs_only_rounding(const Student& student, const Composition::Part& part) {
  return student.exact && !part.bent && !part.light &&
         std::any_of(student.branches.begin(), student.branches.end(),
                     [&](const Student::Branch& branch) { return branch.teacher == part.teacher; });
}

std::vector<FeatureNetwork> networks_of(const Composition& composition) {
  std::vector<FeatureNetwork> networks;
  for (const auto& teacher : composition.teachers) networks.emplace_back(*teacher);
  return networks;
}

Student keeping(const Composition& composition, const TexelSample& sample, std::size_t base,
                const TrainingOptions& options, const Progress& progress) {
  const Decoder decoder =
      fold_rotation(*composition.teachers[base], composition.frames[base], Axes::forward, Axes::forward);
  Student student{FeatureNetwork(decoder),
                  new_encoder(options.seed),
                  {{base, composition.frames[base].transpose()}},
                  0,
                  true,
                  true};
  train_together(student, TrainingData(composition, sample), options.steps / 2, false, options.rate / 4, options,
                 progress);
  return student;
}

Student fine_tuned(const Student& student, const Composition& composition, const TexelSample& sample, std::size_t width,
                   const TrainingOptions& options, const Progress& progress) {
  Student result = student;
  result.keeps = result.exact = false;
  result.decoder = widened(student.decoder, width, options.seed + 5);
  // Half the learning rate, so that the decoder does not forget its teacher.
  train_together(result, TrainingData(composition, sample), options.steps, true, options.rate / 2, options, progress);
  return result;
}

Student from_scratch(const Composition& composition, const TexelSample& sample, std::size_t width,
                     const TrainingOptions& options, const Progress& progress) {
  Student student{FeatureNetwork(decoder_inputs, width, width, 3), new_encoder(options.seed), {}, 0, false, false};
  randomise(student.decoder, options.seed + 3);
  train_together(student, TrainingData(composition, sample), options.steps, true, options.rate, options, progress);
  return student;
}

std::array<FeatureLevels, texel_features> feature_levels(int bits, AlphaCode code) {
  std::array<FeatureLevels, texel_features> levels;
  for (std::size_t c = 0; c < texel_features; ++c) {
    const bool alpha = c % 4 == 3;
    const int dropped = std::max(8 - bits, alpha && code == AlphaCode::halved ? 1 : 0), step = 1 << dropped,
              highest = 256 / step - 1;
    levels[c] = {static_cast<float>(step - 1) / 255, static_cast<float>(step) / 255, 0, static_cast<float>(highest)};
    // Byte 0 of feature 0 means transparent.
    if (c == 0 && dropped == 0) levels[c].lowest = 1;
  }
  return levels;
}

void encode_for(const Student::Branch& branch, Lanes* features) {
  for (std::size_t l = 0; l < network_lanes; ++l) {
    Eigen::Matrix<double, 8, 1> own;
    for (std::size_t c = 0; c < texel_features; ++c)
      own[static_cast<Eigen::Index>(c)] = static_cast<double>(features[c].at[l]);
    const Eigen::Matrix<double, 8, 1> stored = branch.encode * own + branch.offset;
    for (std::size_t c = 0; c < texel_features; ++c)
      features[c].at[l] = static_cast<float>(std::clamp(stored[static_cast<Eigen::Index>(c)], 0.0, 1.0));
  }
}

void initial_guess(const Student& student, const FeatureNetwork& teacher, const Composition::Part& part,
                   const TexelGroup& group, const std::vector<ViewSample>& view_samples, Lanes* features, Lanes* work) {
  const NetworkKernels& kernels = network_kernels();
  // All texels of a group get the same kind of guess, so that their features can be averaged.
  float least = std::numeric_limits<float>::infinity();
  const auto consider = [&](const Lanes* guess) {
    Lanes tried[texel_features], error;
    std::copy_n(guess, texel_features, tried);
    kernels.fit_texels(student.decoder.view(), view_samples.data(), view_samples.size(), {}, tried, &error, work);
    const float sum = std::accumulate(std::begin(error.at), std::end(error.at), 0.0F);
    if (!(sum < least)) return;
    least = sum;
    std::copy_n(guess, texel_features, features);
  };
  Lanes guess[texel_features];
  if (student.encoder) {
    Lanes signs[signature_size];
    signature(teacher, group, signs, work);
    kernels.forward(student.encoder->view(), signs, guess, work);
    consider(guess);
  }
  for (const Student::Branch& branch : student.branches) {
    if (student.encoder && branch.teacher != part.teacher) continue;
    std::copy_n(group.features, texel_features, guess);
    encode_for(branch, guess);
    consider(guess);
  }
}

std::size_t workspace_of(const Student& student, const std::vector<FeatureNetwork>& teachers) {
  std::size_t most = network_kernels().workspace(student.decoder.view());
  if (student.encoder) most = std::max(most, network_kernels().workspace(student.encoder->view()));
  for (const FeatureNetwork& teacher : teachers) most = std::max(most, network_kernels().workspace(teacher.view()));
  return most;
}

}  // namespace rebake
