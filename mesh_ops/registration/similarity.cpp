#include "mesh_ops/registration/similarity.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

using Points = Eigen::Matrix3Xd;

constexpr double least_spread = 1e-6;

Vec3 mean_of(const std::vector<Vec3>& points) {
  // Relative to the first point, so that places far from the origin lose no digits.
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p - points.front();
  return points.front() + sum / static_cast<double>(points.size());
}

Points centred(const std::vector<Vec3>& points, const Vec3& center) {
  Points matrix(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) matrix.col(static_cast<Eigen::Index>(k)) = points[k] - center;
  return matrix;
}

// Ratio of the second to the first singular value. Throws FieldError if the points do not span a plane.
double spread_of(const Points& points, const char* field) {
  const Vec3 values = Eigen::JacobiSVD<Points>(points).singularValues();
  if (!std::isfinite(values[0])) throw FieldError(field, "must be finite");
  if (values[0] == 0) throw FieldError(field, "coincide: pick at least three different points");
  const double spread = values[1] / values[0];
  if (spread < least_spread) {
    const bool two_places = [&] {
      for (Eigen::Index k = 1; k < points.cols(); ++k)
        if ((points.col(k) - points.col(0)).norm() > 0) return false;
      return true;
    }();
    throw FieldError(field, two_places ? "coincide: pick at least three different points"
                                       : "lie on a line, or two of three coincide: pick points that span a plane");
  }
  return spread;
}

double squared_error(const Points& from, const Points& onto, const Eigen::Matrix4d& motion) {
  return ((motion.topLeftCorner<3, 3>() * from).colwise() + Vec3(motion.topRightCorner<3, 1>()) - onto).squaredNorm();
}

// Throws FieldError if exchanging two of the points makes a bad fit good.
void refuse_swapped(const Points& a, const Points& b, bool with_scale, double rms, double extent) {
  constexpr double bad = 0.02, good = 0.2;  // of the extent; of the residuals before
  if (rms < bad * extent || a.cols() < 4) return;
  for (Eigen::Index i = 0; i < a.cols(); ++i)
    for (Eigen::Index j = i + 1; j < a.cols(); ++j) {
      Points swapped = a;
      swapped.col(i).swap(swapped.col(j));
      const double error = squared_error(swapped, b, Eigen::umeyama(swapped, b, with_scale));
      if (std::sqrt(error / static_cast<double>(a.cols())) < good * rms)
        throw FieldError("onto", fmt::format("fit much better if pairs {} and {} are swapped", i + 1, j + 1));
    }
}

}  // namespace

Affine Similarity::affine() const {
  Affine result = Affine::Identity();
  result.linear() = scale * rotation;
  result.translation() = center + shift - result.linear() * center;
  return result;
}

double Similarity::degrees() const { return Eigen::AngleAxisd(rotation).angle() * 180 / std::numbers::pi; }

PairFit fit_pairs(const std::vector<Vec3>& from, const std::vector<Vec3>& onto, bool with_scale) {
  if (from.size() < 3)
    throw FieldError("points", fmt::format("must be at least three points, but has {}", from.size()));
  if (onto.size() != from.size())
    throw FieldError("onto",
                     fmt::format("must have as many points as points ({}), but has {}", from.size(), onto.size()));
  const Vec3 center = mean_of(from), target = mean_of(onto);
  const Points a = centred(from, center), b = centred(onto, target);
  PairFit fit;
  fit.spread = std::min(spread_of(a, "points"), spread_of(b, "onto"));
  const Eigen::Matrix4d motion = Eigen::umeyama(a, b, with_scale);
  // Points of a plane fit a mirrored copy equally well; solid ones show the mirror.
  const Eigen::DiagonalMatrix<double, 3> mirror(-1, 1, 1);
  const Points mirrored = mirror * a;
  const double error = squared_error(a, b, motion),
               mirrored_error = squared_error(mirrored, b, Eigen::umeyama(mirrored, b, with_scale));
  if (error > 1e-6 * b.squaredNorm() && mirrored_error < 0.01 * error)
    throw FieldError("onto", "fit a mirrored copy of the points: two pairs are probably swapped");
  fit.motion.center = center;
  fit.motion.scale = std::cbrt(motion.topLeftCorner<3, 3>().determinant());
  fit.motion.rotation = motion.topLeftCorner<3, 3>() / fit.motion.scale;
  fit.motion.shift = (target - center) + Vec3(motion.topRightCorner<3, 1>());
  for (std::size_t k = 0; k < from.size(); ++k) {
    fit.residuals.push_back((fit.motion(from[k]) - onto[k]).norm());
    fit.rms += fit.residuals.back() * fit.residuals.back();
  }
  fit.rms = std::sqrt(fit.rms / static_cast<double>(from.size()));
  fit.extent = b.norm() / std::sqrt(static_cast<double>(from.size()));
  refuse_swapped(a, b, with_scale, fit.rms, fit.extent);
  return fit;
}

}  // namespace rebake
