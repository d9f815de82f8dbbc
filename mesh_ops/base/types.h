#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace rebake {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Affine = Eigen::Affine3d;
using Box = Eigen::AlignedBox3d;

/// Three vertex indices into the positions (and UVs) of one texture set.
using Face = std::array<std::uint32_t, 3>;

/// Display (sRGB-encoded) colour, 0 … 1 per channel.
using Color = Eigen::Vector3d;

}  // namespace rebake
