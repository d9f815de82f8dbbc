#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/features/distill/fuse_method.h"
#include "mesh_ops/features/distill/fuse_training.h"

namespace rebake {

/// Options of plan_fuse() and fuse().
struct FuseOptions {
  /// Maximum width of the hidden layers, 4 … 256. Nothing: the narrowest that reaches `psnr_db`, else the best. Trained
  /// decoders have widths 16, 24 and 32, as long as improvement is possible; other methods are as wide as their
  /// sources.
  std::optional<int> width;
  enum class Keep { automatic, none, node };
  /// Which texels and decoder stay bit for bit: those of `keep_node`, none, or with `automatic` the decoder with most
  /// texels, if that is better overall.
  Keep keep = Keep::automatic;
  NodeId keep_node = NodeId::none;
  std::optional<FuseMethod> way;  ///< the method; nothing: the best
  double psnr_db = 40;            ///< target PSNR of texels, above 0 and at most 100
  bool until_psnr = false;        ///< fit texels, worst first, only until `psnr_db` is reached
  /// Time limit in seconds; 0: none. All texels get at least an initial guess. With a limit, the resulting bytes depend
  /// on timing.
  double seconds = 0;
  int iterations = 5;          ///< Gauss–Newton iterations per texel; 0: features are only guessed and rounded
  bool search = true;          ///< search neighbouring bytes for better ones
  int bits = 8;                ///< bits per feature, 4 … 8
  std::size_t sample = 16384;  ///< number of texels for training and scoring decoders
  TrainingOptions training{};
  Layout layout = Layout::split;
};

/// Score of a method on a sample of the texels: PSNR of the worst node over held-out directions. The lower value of
/// single texels and of texels mixed as in pixels.
struct FuseTrial {
  int width = 0;  ///< width of the wider hidden layer
  FuseMethod way = FuseMethod::keep;
  double psnr_db = 0;
  std::string worst_node{};  ///< name of the node with the lowest PSNR; empty if all nodes are exact
  double seconds = 0;        ///< training and scoring time
  double fit_seconds = 0;    ///< estimated time of fitting all texels
};

/// Errors of texels over held-out directions, as PSNR of display colours.
struct TexelErrors {
  std::uint64_t texels = 0;
  double psnr_db = 100;        ///< PSNR of the mean squared error, at most 100
  double worst_psnr_db = 100;  ///< PSNR that 99 % of the texels reach, at most 100
};

/// Result of a fit, per node and overall.
struct FuseReport {
  struct Part {
    std::string node;
    bool kept = false;  ///< texels stay bit for bit
    TexelErrors errors;
    std::string shares{};  ///< for a copy without texels of its own: the node that its texels are counted for
  };
  std::vector<Part> parts;  ///< nodes in drawing order; those with both kept and fitted texels appear twice
  TexelErrors whole;
  std::vector<FuseTrial> trials;  ///< in the order of the plan
  std::size_t chosen = 0;         ///< index into trials
  std::uint64_t fitted_texels = 0;
  double seconds = 0;
  bool in_time = true;  ///< false if the time limit ended the fit
};

/// A decoder for a whole composition, with its score.
struct FuseCandidate {
  Student student;
  FuseTrial trial;
};
/// All candidates and the chosen one.
struct FusePlan {
  std::vector<FuseCandidate> candidates;
  std::size_t chosen = 0;
  /// Deadline of the fit, if the options set a time limit.
  std::optional<std::chrono::steady_clock::time_point> until;
};

/// Trains decoders on a sample of the texels and chooses one. Deterministic, except with a time limit. Throws
/// FieldError for options that are out of range or contradictory.
FusePlan plan_fuse(const Composition& composition, const VisibleDirections& sightlines, const FuseOptions& options,
                   const Progress& progress = {});

/// Result of fuse().
struct Fused {
  std::shared_ptr<const BakedObject> object;  ///< the fused object, in world space
  FuseReport report;
};

/// Approximates a composition by one object with one decoder and 8 bytes per texel: each texel's features are fitted to
/// its colours along its visible directions. The same bytes at any number of threads.
Fused fuse(const Composition& composition, const VisibleDirections& sightlines, const FusePlan& plan,
           const FuseOptions& options, const Progress& progress = {});

/// Validates the options. Throws FieldError that names the invalid one.
void check(const FuseOptions& options);

}  // namespace rebake
