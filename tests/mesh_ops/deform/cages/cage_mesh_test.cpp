// Validation and orientation of cages.
#include "mesh_ops/deform/cages/cage_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "mesh_ops/base/error.h"
#include "tests/support/hard_cages.h"

namespace rebake::test {
namespace {

TEST(CageMesh, OrientsFlippedCagesAndRejectsOpenOnes) {
  Cage cage = cube();
  for (Face& face : cage.faces) std::swap(face[0], face[1]);
  EXPECT_EQ(volume(checked_cage(cage)), volume(cube()));
  cage = cube();
  cage.faces.pop_back();
  EXPECT_THROW(checked_cage(cage), Error);
  cage = cube();
  std::swap(cage.faces[0][0], cage.faces[0][1]);
  EXPECT_THROW(checked_cage(cage), Error);
  cage = cube();
  cage.vertices[0].x() = std::nan("");
  EXPECT_THROW(checked_cage(cage), Error);
}

}  // namespace
}  // namespace rebake::test
