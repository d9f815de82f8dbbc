#pragma once

#include "mesh_ops/base/types.h"

namespace rebake {

// A rotation as people type it: degrees about X, then Y, then Z of the world, which is Blender's order XYZ.

Mat3 rotation_of(const Vec3& degrees);
/// Angles in (−180, 180], that about Y in [−90, 90]. Where Y is ±90, X and Z turn about the same axis: all is in X.
Vec3 euler_degrees(const Mat3& rotation);

}  // namespace rebake
