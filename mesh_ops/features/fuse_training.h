#pragma once

#include <chrono>
#include <optional>

#include "mesh_ops/features/sightings.h"

namespace rebake {

/// A share of a composition's texels, drawn evenly over its blocks, with directions from which they are seen.
struct TexelSample {
  struct Piece {
    TexelGroup group;
    std::uint32_t part;
    std::vector<Vec3> directions;  ///< to train on
    std::vector<Vec3> held_out;    ///< to judge by
  };
  std::vector<Piece> pieces;
};
/// About `texels` of them: as many from each part as it has, but at least two groups, and a share of an eighth.
TexelSample sampled(const Composition& composition, const Sightlines& sightlines, std::size_t texels,
                    std::uint64_t seed, const Progress& progress);

/// What a fused folder is made by: one decoder, and first guesses of texels' features.
struct Student {
  FeatureNetwork decoder;  ///< fed directions of the world
  /// Signature → features, where it was trained.
  std::optional<FeatureNetwork> encoder;
  /// A teacher that the decoder contains, or began as.
  struct Branch {
    std::size_t teacher;
    Mat3 turn;  ///< fed direction = turn · world direction
    /// Features as the student stores them from those of the teacher: encode · features + offset.
    Eigen::Matrix<double, 8, 8> encode = Eigen::Matrix<double, 8, 8>::Identity();
    Eigen::Matrix<double, 8, 1> offset = Eigen::Matrix<double, 8, 1>::Zero();
  };
  std::vector<Branch> branches;
  std::uint32_t selectors = 0;  ///< a bit for each feature that tells branches apart
  bool keeps = false;           ///< the decoder is its one branch's own, and the texels of that stay bit for bit
  bool exact = false;  ///< the decoder shows what its branches' teachers show, but for the rounding of features
};

/// Texels that need no fit.
bool stays(const Student& student, const Composition::Part& part);
/// Texels that only have to be rounded.
bool shown_exactly(const Student& student, const Composition::Part& part);

struct TrainingOptions {
  int steps = 8000;    ///< of Adam on decoder and encoder together; more gains little
  double rate = 0.02;  ///< of Adam at the start, for a new decoder
  std::uint64_t seed = 1;
  /// When training ends at the latest, with what has been learnt.
  std::optional<std::chrono::steady_clock::time_point> until = std::nullopt;
};

/// The teachers as networks.
std::vector<FeatureNetwork> networks_of(const Composition& composition);

/// A base's decoder as it is; the encoder learns to use it.
Student keeping(const Composition& composition, const TexelSample& sample, std::size_t base,
                const TrainingOptions& options, const Progress& progress);
/// Teachers side by side in one decoder: each keeps its own neurons, and the plane of the two features that matter
/// least is cut into sectors, one for each, by which all others are switched off. Averages of texels stay right, and
/// partly covered pixels nearly: both keep to the sector. Bent parts get branches for `bent_turns` turns each.
Student side_by_side(const Composition& composition, const TexelSample& sample, std::size_t bent_turns);
/// Most branches that find room in the plane.
inline constexpr std::size_t most_branches = 4;

/// A student's decoder, widened and trained further. Texels may start as its branches say.
Student adapted(const Student& student, const Composition& composition, const TexelSample& sample, std::size_t width,
                const TrainingOptions& options, const Progress& progress);
/// Decoder and encoder from random weights.
Student from_scratch(const Composition& composition, const TexelSample& sample, std::size_t width,
                     const TrainingOptions& options, const Progress& progress);

/// The rounding of stored features. `bits` (1 … 8) a feature; features 3 and 7 have 7 at most in halved alpha.
std::array<FeatureLevels, texel_features> feature_levels(int bits, AlphaCode code);

/// A teacher's features as a branch stores them, in place.
void store_in(const Student::Branch& branch, Lanes* features);

/// Where features start: as the branch of their teacher says that fits best, else, or where that is better, as encoded.
void first_guess(const Student& student, const FeatureNetwork& teacher, const Composition::Part& part,
                 const TexelGroup& group, const std::vector<Sighting>& sightings, Lanes* features, Lanes* work);

/// Lanes of workspace that all of the above want.
std::size_t workspace_of(const Student& student, const std::vector<FeatureNetwork>& teachers);

}  // namespace rebake
