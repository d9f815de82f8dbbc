#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "mesh_ops/base/types.h"

namespace rebake {

// Eigen's doubles as GLM's floats, the types of uniforms and vertices. Both store matrices by columns.

inline glm::vec3 to_glm(const Vec3& vector) { return {vector.x(), vector.y(), vector.z()}; }

inline glm::mat3 to_glm(const Mat3& matrix) {
  return {to_glm(Vec3(matrix.col(0))), to_glm(Vec3(matrix.col(1))), to_glm(Vec3(matrix.col(2)))};
}

inline glm::mat4 to_glm(const Eigen::Matrix4d& matrix) {
  glm::mat4 result;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) result[column][row] = static_cast<float>(matrix(row, column));
  return result;
}

}  // namespace rebake
