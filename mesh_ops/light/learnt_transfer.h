#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/pose_space.h"
#include "mesh_ops/light/spherical_harmonics.h"

namespace rebake {

/// How transfer is predicted from a pose. All but `linear` predict what transfer is in frames that turn with the
/// surface, so that they need not learn to turn.
enum class TransferWay {
  linear,         ///< coefficients in the body's space are linear in the pose (as in precomputed transfer for morphable
                  ///< models, MoMoPRT)
  turned_linear,  ///< what turning leaves over is linear in the pose
  turned_kernel   ///< that, and a Gaussian kernel for what is not linear
};

/// Traced poses of one body, as models are learnt from. All hold the same sites in the same order.
struct TransferTraining {
  std::vector<std::uint32_t> probes;            ///< sites by whose places poses are told apart
  std::vector<Vec3> rest_probes;                ///< their places at rest
  std::vector<std::vector<Vec3>> posed_probes;  ///< their places in each pose
  Eigen::MatrixXf local;                        ///< a pose a row: 16 coefficients a site, in frames that turn along
  Eigen::MatrixXf plain;                        ///< the same in the body's space; empty where nobody wants it
  double seconds = 0;                           ///< that tracing took

  /// Which frames are kept: TransferWay::linear needs both.
  enum class Frames { turned, both };
  TransferTraining(const std::vector<Vec3>& rest, std::size_t poses, Frames frames, std::size_t probe_count = 48);
  /// Fills in the pose `k`: places, turns since rest and transfer of each site.
  void set(std::size_t k, const std::vector<Vec3>& places, const std::vector<Mat3>& turns,
           const std::vector<sh::Coefficients>& transfer);
  std::vector<Vec3> probes_in(const std::vector<Vec3>& places) const;
};

/// Transfer of a body as a function of its pose.
class LearntTransfer {
 public:
  struct Options {
    TransferWay way = TransferWay::turned_kernel;
    int rank = 48;  ///< principal components that are kept of coefficients
  };
  /// Principal components over the poses; their weights by ridge regression, what is chosen by an eighth of the poses
  /// that is held back. Throws Error for fewer than 8 poses.
  static LearntTransfer learnt(const TransferTraining& training, const Options& options, const Progress& progress = {});

  /// Coefficients of each site, 16 after each other: in turned frames, or with `linear` in the body's space.
  Eigen::VectorXf predict(const PoseSpace::Place& place) const;
  std::vector<Vec3> probes_in(const std::vector<Vec3>& places) const;
  std::size_t site_count() const { return static_cast<std::size_t>(mean.size()) / sh::count; }
  /// PoseSpace::Place::range up to which it is better than turning alone, by `rebake study transfer`.
  static constexpr double trusted_range = 2;
  /// Bytes of what prediction needs.
  std::uint64_t memory() const;

  // As files hold it:
  TransferWay way = TransferWay::turned_kernel;
  std::vector<std::uint32_t> probes;
  PoseSpace space;
  Eigen::VectorXf mean;        ///< 16 a site
  Eigen::MatrixXf components;  ///< a component a column
  Eigen::MatrixXd linear;      ///< weights: a component a row; 1 and the pose's coordinates
  Eigen::MatrixXd centers;     ///< a kernel a column; empty without
  Eigen::MatrixXd kernel;      ///< weights: a component a row, a kernel a column
  double width = 1;            ///< of the kernels, in coordinates
  double held_back_error = 0;  ///< relative, of the poses held back
  double seconds = 0;          ///< of learning, without tracing
};

}  // namespace rebake
