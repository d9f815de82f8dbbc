#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// The poses that a body takes, as coordinates: displacements of a few of its points that lie far apart, along their
/// principal axes over the poses that were seen, in standard deviations. Whatever moves the body (a cage, a bend, both)
/// has a place in it, so that a model learnt in it can tell whether it was made for that.
class PoseSpace {
 public:
  /// The points' numbers among `rest`, at most `probes` of them, by farthest-point sampling.
  static std::vector<std::uint32_t> probes_of(const std::vector<Vec3>& rest, std::size_t probes);

  PoseSpace() = default;
  /// `rest` and each of `poses`: where the probes are.
  PoseSpace(std::vector<Vec3> rest, const std::vector<std::vector<Vec3>>& poses);

  struct Place {
    Eigen::VectorXd coordinates;
    /// How far out: up to 1 within what was seen, by the distance from the mean pose and by what the axes leave over
    /// (a twentieth of the largest displacement is allowed).
    double range;
  };
  Place place(const std::vector<Vec3>& probes) const;
  Eigen::Index dimensions() const { return axes.rows(); }

  // As files hold it:
  std::vector<Vec3> rest;
  double size = 1;             ///< of the body, that displacements are measured in
  Eigen::VectorXd mean;        ///< of displacements, three a probe
  Eigen::MatrixXd axes;        ///< rows of length 1 over standard deviation
  Eigen::VectorXd deviations;  ///< along each axis
  double farthest = 1;         ///< largest distance of a pose that was seen, in coordinates
  double largest = 1;          ///< largest displacement from the mean, in sizes

 private:
  Eigen::VectorXd displacement(const std::vector<Vec3>& probes) const;
};

}  // namespace rebake
