#include "mesh_ops/base/polar.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <stdexcept>

namespace rebake {

Mat3 newton_polar_factor(const Mat3& jacobian) {
  Mat3 x = jacobian;
  for (int i = 0; i < 20; ++i) {
    // The inverse's transpose is the cofactors over the determinant.
    Mat3 cofactors;
    cofactors.col(0) = x.col(1).cross(x.col(2));
    cofactors.col(1) = x.col(2).cross(x.col(0));
    cofactors.col(2) = x.col(0).cross(x.col(1));
    const double determinant = x.col(0).dot(cofactors.col(0));
    const Mat3 inverse = cofactors / determinant;
    const double scale = std::sqrt(inverse.norm() / x.norm());
    const Mat3 next = 0.5 * (scale * x + inverse / scale);
    const double change = (next - x).norm();
    x = next;
    if (change < 1e-8) {
      // Converges quadratically: one unscaled step from here is rounding.
      cofactors.col(0) = x.col(1).cross(x.col(2));
      cofactors.col(1) = x.col(2).cross(x.col(0));
      cofactors.col(2) = x.col(0).cross(x.col(1));
      return 0.5 * (x + cofactors / x.col(0).dot(cofactors.col(0)));
    }
  }
  return x;
}

LocalRotation svd_rotation(const Mat3& jacobian) {
  const double size = jacobian.cwiseAbs().maxCoeff();
  if (!(size > 0) || !std::isfinite(size)) return {Mat3::Identity(), false};
  const Eigen::JacobiSVD<Mat3> svd(jacobian / size, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3& sigma = svd.singularValues();
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  LocalRotation result;
  result.rotation = svd.matrixU() * Vec3(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  result.defined = sigma[1] + sign * sigma[2] > 1e-12 * sigma[0];
  return result;
}

LocalRotation local_rotation(const Mat3& jacobian) {
  const double size = jacobian.cwiseAbs().maxCoeff();
  if (!(size > 0) || !std::isfinite(size)) return {Mat3::Identity(), false};
  const Mat3 scaled = jacobian / size;
  const double norm = scaled.norm();
  if (scaled.determinant() > 1e-6 * norm * norm * norm) return {newton_polar_factor(scaled), true};
  return svd_rotation(jacobian);
}

LocalRotation local_orthogonal(const Mat3& jacobian) {
  const double size = jacobian.cwiseAbs().maxCoeff();
  if (!(size > 0) || !std::isfinite(size)) return {Mat3::Identity(), false};
  const Mat3 scaled = jacobian / size;
  if (scaled.determinant() < 0) {
    const Eigen::JacobiSVD<Mat3> svd(scaled, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (svd.singularValues()[2] > svd.singularValues()[1] / 8) return {svd.matrixU() * svd.matrixV().transpose(), true};
  }
  return local_rotation(jacobian);
}

Mat3 orthogonal_factor(const Mat3& linear) {
  const double scale = linear.cwiseAbs().maxCoeff();
  if (!linear.allFinite() || scale == 0) throw std::invalid_argument("the transform is singular or not finite");
  // Matrices that are already orthogonal come back bit for bit, so exact quarter turns and identities stay exact.
  if (linear.isUnitary(1e-15)) return linear;
  const Mat3 scaled = linear / scale;
  const Eigen::JacobiSVD<Mat3> svd(scaled, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.singularValues()[2] < 1e-14 * svd.singularValues()[0])
    throw std::invalid_argument("the transform is singular: it flattens the object");
  Mat3 factor = svd.matrixU() * svd.matrixV().transpose();
  // A pure axis-aligned scale has an exact factor; rounding noise in it would needlessly rotate every direction.
  const Mat3 rounded = factor.array().round();
  if ((factor - rounded).cwiseAbs().maxCoeff() < 1e-15) factor = rounded;
  return factor;
}

}  // namespace rebake
