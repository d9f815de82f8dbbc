#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A coordinate system of poses: displacements of a few well-spread points (probes), projected onto their principal
/// components over the training poses, in standard deviations. It covers any deformation (cages, bends), so a model can
/// tell whether a pose lies within its training range.
class PoseSpace {
 public:
  /// Indices of at most `probes` points of `rest`, by farthest-point sampling.
  static std::vector<std::uint32_t> probes_of(const std::vector<Vec3>& rest, std::size_t probes);

  PoseSpace() = default;
  /// Probe positions at rest and in each training pose.
  PoseSpace(std::vector<Vec3> rest, const std::vector<std::vector<Vec3>>& poses);

  /// A pose in this space.
  struct Place {
    Eigen::VectorXd coordinates;  ///< one per axis, in standard deviations
    /// At most 1 within the training range, by the distance from the mean pose and by the residual of the projection,
    /// which may be up to a twentieth of the largest displacement.
    double range;
  };
  /// The place of a pose, given its probe positions.
  Place place(const std::vector<Vec3>& probes) const;
  Eigen::Index dimensions() const { return axes.rows(); }

  // Stored in files:
  std::vector<Vec3> rest;      ///< probe positions at rest
  double size = 1;             ///< size of the body, the unit of displacements
  Eigen::VectorXd mean;        ///< mean displacements, three per probe
  Eigen::MatrixXd axes;        ///< rows: unit principal components divided by their standard deviation
  Eigen::VectorXd deviations;  ///< standard deviation per component
  double farthest = 1;         ///< largest distance of a training pose, in coordinates
  double largest = 1;          ///< largest displacement from the mean, in units of `size`

 private:
  Eigen::VectorXd displacement(const std::vector<Vec3>& probes) const;
};

}  // namespace rebake
