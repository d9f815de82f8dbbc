#pragma once

#include "mesh_ops/base/types.h"

namespace rebake {

/// The rotation that is nearest to a Jacobian.
struct LocalRotation {
  Mat3 rotation = Mat3::Identity();  ///< always a rotation: det 1, RᵀR = I to 1e-14
  /// False where two rotations are equally near: the Jacobian is flat to a line, or reflects as much as it keeps. A
  /// neighbour's rotation is the better answer there.
  bool defined = true;
};

/// By scaled Newton iteration (Higham 1986) where det J > 1e-6 ‖J‖³, else by singular values. Scale does not matter.
LocalRotation local_rotation(const Mat3& jacobian);

/// As local_rotation(), but the orthogonal polar factor, a reflection, if J mirrors: det J < 0 and the smallest
/// singular value is more than an eighth of the middle one. Nearer to collapse the rotation is taken, which has no jump
/// at det J = 0.
LocalRotation local_orthogonal(const Mat3& jacobian);

/// The orthogonal polar factor by scaled Newton iteration: a reflection where det J < 0, and useless where J is nearly
/// singular.
Mat3 newton_polar_factor(const Mat3& jacobian);

/// By singular values, the smallest one's sign turned where det J < 0.
LocalRotation svd_rotation(const Mat3& jacobian);

/// The orthogonal polar factor of `linear`: its rotation, or rotation and reflection. Throws std::invalid_argument when
/// `linear` is singular or not finite. Scale does not matter.
Mat3 orthogonal_factor(const Mat3& linear);

}  // namespace rebake
