#pragma once

#include "mesh_ops/base/types.h"

namespace rebake {

// Euler angles in degrees about the world's X, then Y, then Z axis (Blender's order XYZ).

Mat3 rotation_of(const Vec3& degrees);
/// Angles in (−180, 180]; Y in [−90, 90]. In gimbal lock (Y = ±90) Z is 0, and X has the rest of the rotation.
Vec3 euler_degrees(const Mat3& rotation);

}  // namespace rebake
