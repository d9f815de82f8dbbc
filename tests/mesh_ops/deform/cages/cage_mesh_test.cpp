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

// Cavities face the other way.
TEST(CageMesh, CountsPartsInsideOthersThatFaceTheSameWay) {
  Box box;
  for (const Vec3& v : cube().vertices) box.extend(v);
  const auto with_second = [&](bool turned, const Vec3& offset) {
    Cage cage = cube();
    const auto base = static_cast<std::uint32_t>(cage.vertices.size());
    for (const Vec3& v : cube().vertices) cage.vertices.push_back(box.center() + (v - box.center()) / 2 + offset);
    for (const Face& f : cube().faces)
      cage.faces.push_back({f[turned ? 1 : 0] + base, f[turned ? 0 : 1] + base, f[2] + base});
    return cage;
  };
  EXPECT_EQ(nested_components(cube()), 0U);
  EXPECT_EQ(nested_components(with_second(false, Vec3(0, 0, 0))), 1U);
  EXPECT_EQ(nested_components(with_second(true, Vec3(0, 0, 0))), 0U) << "a cavity";
  EXPECT_EQ(nested_components(with_second(false, 2 * box.sizes())), 0U) << "beside the other";
}

}  // namespace
}  // namespace rebake::test
