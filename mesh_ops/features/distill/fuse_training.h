#pragma once

#include <chrono>
#include <optional>

#include "mesh_ops/features/distill/view_samples.h"

namespace rebake {

/// A sample of a composition's texels, even over its blocks, with directions from which they are visible.
struct TexelSample {
  /// One group of a part.
  struct Piece {
    TexelGroup group;
    std::uint32_t part;
    std::vector<Vec3> directions;  ///< visible directions for training
    std::vector<Vec3> held_out;    ///< other visible directions, for scoring
  };
  std::vector<Piece> pieces;
};
/// Samples about `texels` texels. Each part gets groups in proportion to its texels, but at least two, and at least an
/// equal share of an eighth of the sample.
TexelSample sampled(const Composition& composition, const VisibleDirections& sightlines, std::size_t texels,
                    std::uint64_t seed, const Progress& progress);

/// The one decoder of a fused object, with maps that guess its features from those of the original decoders (teachers).
struct Student {
  FeatureNetwork decoder;  ///< takes world directions
  /// Maps a texel's signature() to features; nothing for side-by-side students.
  std::optional<FeatureNetwork> encoder;
  /// A teacher that the decoder contains, or was initialised from.
  struct Branch {
    std::size_t teacher;
    Mat3 turn;  ///< fed direction = turn · world direction
    /// Student's features = encode · teacher's features + offset.
    Eigen::Matrix<double, 8, 8> encode = Eigen::Matrix<double, 8, 8>::Identity();
    Eigen::Matrix<double, 8, 1> offset = Eigen::Matrix<double, 8, 1>::Zero();
  };
  std::vector<Branch> branches;
  std::uint32_t selectors = 0;  ///< bit mask of the features that select a branch; 0 if there are none
  bool keeps = false;           ///< whether the decoder is that of its only branch, whose texels stay bit for bit
  bool exact = false;           ///< whether the decoder equals its branches' teachers up to the rounding of features
};

/// Whether a part's texels stay unchanged, bit for bit.
bool stays(const Student& student, const Composition::Part& part);
/// Whether a part's texels need no fit, only rounding.
bool needs_only_rounding(const Student& student, const Composition::Part& part);

struct TrainingOptions {
  int steps = 8000;    ///< Adam steps on decoder and encoder together; more steps gain little
  double rate = 0.02;  ///< initial rate of Adam for a new decoder
  std::uint64_t seed = 1;
  /// Deadline of training; if it is exceeded, the result so far is used.
  std::optional<std::chrono::steady_clock::time_point> until = std::nullopt;
};

/// The teachers as networks.
std::vector<FeatureNetwork> networks_of(const Composition& composition);

/// The decoder of teacher `base`, unchanged, with a trained encoder for the texels of other teachers.
Student keeping(const Composition& composition, const TexelSample& sample, std::size_t base,
                const TrainingOptions& options, const Progress& progress);
/// Puts the teachers side by side in one decoder: each keeps its own neurons, and the plane of the two least important
/// features is cut into a sector per branch, outside of which the branch is silenced. Averages of texels of a branch
/// stay in its sector, and so do partly covered pixels. Teachers of bent parts get up to `bent_turns` branches, one per
/// rotation.
Student side_by_side(const Composition& composition, const TexelSample& sample, std::size_t bent_turns);
/// Maximum number of sectors.
inline constexpr std::size_t max_branches = 4;

/// A student's decoder, widened and fine-tuned. Texels may be initialised by its branches.
Student fine_tuned(const Student& student, const Composition& composition, const TexelSample& sample, std::size_t width,
                   const TrainingOptions& options, const Progress& progress);
/// Trains decoder and encoder from random weights.
Student from_scratch(const Composition& composition, const TexelSample& sample, std::size_t width,
                     const TrainingOptions& options, const Progress& progress);

/// Quantisation of stored features with `bits` (1 … 8) per feature; features 3 and 7 have at most 7 with halved alpha.
std::array<FeatureLevels, texel_features> feature_levels(int bits, AlphaCode code);

/// Converts a teacher's features to those of a branch, in place.
void encode_for(const Student::Branch& branch, Lanes* features);

/// Initial guess of features: by the best branch of their teacher or by the encoder, whichever is better.
void initial_guess(const Student& student, const FeatureNetwork& teacher, const Composition::Part& part,
                   const TexelGroup& group, const std::vector<ViewSample>& view_samples, Lanes* features, Lanes* work);

/// Size of the workspace `work` of the functions above, in lanes.
std::size_t workspace_of(const Student& student, const std::vector<FeatureNetwork>& teachers);

}  // namespace rebake
