#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/features/fuse_training.h"
#include "mesh_ops/features/fuse_way.h"

namespace rebake {

struct FuseOptions {
  /// Of the hidden layers at most, 4 … 256; nothing: the narrowest that reaches `psnr_db`, else the best.
  /// Trained are 16, 24 and 32, as long as there is hope; others are as wide as what they are made of.
  std::optional<int> width;
  enum class Keep { automatic, none, node };
  /// Whose texels and decoder stay bit for bit. `automatic`: those of most texels, where that is better on the whole.
  Keep keep = Keep::automatic;
  NodeId keep_node = NodeId::none;
  std::optional<FuseWay> way;  ///< nothing: whichever is best
  double psnr_db = 40;
  bool until_psnr = false;  ///< texels are fitted, worst first, only while they are below `psnr_db`
  /// Above 0: as much as can be done in this time, but at least a guess of all texels; the bytes then depend on it.
  double seconds = 0;
  int iterations = 5;          ///< of Gauss–Newton for each texel; 0: features as the fitted map gives them
  bool search = true;          ///< looks among neighbouring bytes for better ones
  int bits = 8;                ///< a feature, 4 … 8
  std::size_t sample = 16384;  ///< texels that decoders are trained on and judged by
  TrainingOptions training{};
  Layout layout = Layout::split;
};

/// Result of a way to fuse on a sample of the texels: PSNR of the node that suffers most, over held-out directions, of
/// texels alone or as pixels mix them, whichever is worse.
struct FuseTrial {
  int width = 0;  ///< of the wider hidden layer
  FuseWay way = FuseWay::keep;
  double psnr_db = 0;
  std::string worst_node{};  ///< whose PSNR it is; empty when every node is shown exactly
  double seconds = 0;        ///< of training and judging
  double fit_seconds = 0;    ///< that fitting all texels takes, about
};

/// Errors of texels over held-out directions, as PSNR of display colours.
struct TexelErrors {
  std::uint64_t texels = 0;
  double psnr_db = 100;        ///< of the mean squared error; 100 at most
  double worst_psnr_db = 100;  ///< what 99 % of texels reach
};

struct FuseReport {
  struct Part {
    std::string node;
    bool kept = false;  ///< bit for bit
    TexelErrors errors;
    std::string shares{};  ///< node that counts the texels, when this one is a copy and has none of its own
  };
  std::vector<Part> parts;  ///< nodes in drawing order, those with kept and fitted texels twice
  TexelErrors whole;
  std::vector<FuseTrial> trials;  ///< in the plan's order
  std::size_t chosen = 0;         ///< among trials
  std::uint64_t fitted_texels = 0;
  double seconds = 0;
  bool in_time = true;  ///< false where `seconds` ended it
};

/// A decoder for a whole composition, with what it promises.
struct FuseCandidate {
  Student student;
  FuseTrial trial;
};
struct FusePlan {
  std::vector<FuseCandidate> candidates;
  std::size_t chosen = 0;
  /// When fitting ends at the latest, where the options say so.
  std::optional<std::chrono::steady_clock::time_point> until;
};

/// Trains decoders on a sample of the texels and takes what suits best. Deterministic, but for `seconds`. Throws
/// FieldError for options out of range or at odds with each other.
FusePlan plan_fuse(const Composition& composition, const Sightlines& sightlines, const FuseOptions& options,
                   const Progress& progress = {});

struct Fused {
  std::shared_ptr<const BakedObject> object;  ///< in world space
  FuseReport report;
};

/// One object that shows what a composition shows, as far as one decoder and 8 bytes a texel can: each texel's features
/// fitted to its colours along the directions from which it is seen. The same bytes at any number of threads.
Fused fuse(const Composition& composition, const Sightlines& sightlines, const FusePlan& plan,
           const FuseOptions& options, const Progress& progress = {});

/// Throws FieldError.
void check(const FuseOptions& options);

}  // namespace rebake
