#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/learned/pose_space.h"
#include "mesh_ops/light/transport/spherical_harmonics.h"

namespace rebake {

/// Method of predicting transfer from a pose. All but `linear` predict transfer in frames that rotate with the surface,
/// so that rotation need not be learned.
enum class TransferMethod {
  linear,  ///< coefficients in the body's space are linear in the pose (as in precomputed transfer for morphable
           ///< models, MoMoPRT)
  rotated_linear,  ///< coefficients in rotated frames are linear in the pose
  rotated_kernel   ///< the same plus Gaussian kernels for the nonlinear remainder
};

/// Training set: traced poses of one body, with the same sites in the same order.
struct TransferTraining {
  std::vector<std::uint32_t> probes;            ///< sites whose positions identify a pose
  std::vector<Vec3> rest_probes;                ///< probe positions at rest
  std::vector<std::vector<Vec3>> posed_probes;  ///< probe positions per pose
  Eigen::MatrixXf local;                        ///< row per pose: 16 coefficients per site, in rotated frames
  Eigen::MatrixXf plain;                        ///< the same in the body's space; empty unless requested
  double seconds = 0;                           ///< tracing time

  /// Frames to store: TransferMethod::linear needs both.
  enum class Frames { turned, both };
  TransferTraining(const std::vector<Vec3>& rest, std::size_t poses, Frames frames, std::size_t probe_count = 48);
  /// Sets pose `k`: position, rotation since rest and transfer of each site.
  void set(std::size_t k, const std::vector<Vec3>& places, const std::vector<Mat3>& turns,
           const std::vector<sh::Coefficients>& transfer);
  std::vector<Vec3> probes_in(const std::vector<Vec3>& places) const;
};

/// A trained model of a body's transfer as a function of its pose.
class LearnedTransfer {
 public:
  struct Options {
    TransferMethod way = TransferMethod::rotated_kernel;
    int rank = 48;  ///< number of principal components of coefficients
  };
  /// Principal components over the poses, with weights by ridge regression; an eighth of the poses is held out to
  /// select the regularisation. Throws Error for fewer than 8 poses.
  static LearnedTransfer learned(const TransferTraining& training, const Options& options,
                                 const Progress& progress = {});

  /// 16 coefficients per site: in rotated frames, or with `linear` in the body's space.
  Eigen::VectorXf predict(const PoseSpace::Place& place) const;
  std::vector<Vec3> probes_in(const std::vector<Vec3>& places) const;
  std::size_t site_count() const { return static_cast<std::size_t>(mean.size()) / sh::count; }
  /// PoseSpace::Place::range up to which the model beats rotation alone (`rebake study transfer`).
  static constexpr double trusted_range = 2;
  /// Keeps only the pose space and the errors, for a network that predicts instead.
  void drop_weights();
  /// Memory of the model in bytes.
  std::uint64_t memory() const;

  // Stored in files:
  TransferMethod way = TransferMethod::rotated_kernel;
  std::vector<std::uint32_t> probes;
  PoseSpace space;
  Eigen::VectorXf mean;        ///< 16 per site
  Eigen::MatrixXf components;  ///< column per component
  Eigen::MatrixXd linear;      ///< weights, row per component: constant and the pose's coordinates
  Eigen::MatrixXd centers;     ///< column per kernel; empty without kernels
  Eigen::MatrixXd kernel;      ///< weights: row per component, column per kernel
  double width = 1;            ///< kernel width, in pose coordinates
  double held_back_error = 0;  ///< relative error on the held-out poses
  double seconds = 0;          ///< training time, without tracing
};

}  // namespace rebake
