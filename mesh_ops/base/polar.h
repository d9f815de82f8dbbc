#pragma once

#include "mesh_ops/base/types.h"

namespace rebake {

/// The rotation nearest to a Jacobian (in the Frobenius norm).
struct LocalRotation {
  Mat3 rotation = Mat3::Identity();  ///< always a rotation: det 1, RᵀR = I to 1e-14
  /// False if the nearest rotation is not unique, or J is zero or not finite. It is not unique if J has rank 1, or if
  /// det J < 0 and the two smallest singular values are equal. Use a neighbour's rotation then.
  bool defined = true;
};

/// Scaled Newton iteration (Higham 1986) if det J > 1e-6 ‖J‖³, otherwise SVD. Invariant to the scale of J.
LocalRotation local_rotation(const Mat3& jacobian);

/// As local_rotation(), but returns the orthogonal polar factor, a reflection, if det J < 0 and the smallest singular
/// value exceeds an eighth of the middle one. For flatter J the rotation is continuous at det J = 0.
LocalRotation local_orthogonal(const Mat3& jacobian);

/// Orthogonal polar factor by scaled Newton iteration: a reflection if det J < 0, and inaccurate if J is nearly
/// singular.
Mat3 newton_polar_factor(const Mat3& jacobian);

/// Nearest rotation by SVD; if det J < 0, the sign of the smallest singular value is flipped.
LocalRotation svd_rotation(const Mat3& jacobian);

/// Orthogonal polar factor of `linear`: a rotation, or a rotation with a reflection. Throws std::invalid_argument if
/// `linear` is singular or not finite. Invariant to scale.
Mat3 orthogonal_factor(const Mat3& linear);

}  // namespace rebake
