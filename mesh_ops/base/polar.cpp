#include "mesh_ops/base/polar.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

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

}  // namespace rebake
