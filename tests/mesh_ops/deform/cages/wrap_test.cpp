// Wraps: closed cages around all triangles.
#include "mesh_ops/deform/cages/wrap.h"

#include <gtest/gtest.h>

#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Wrap, EnclosesEveryTriangleAndIsClosed) {
  const auto object = made_object();
  const Soup& soup = object->sets[0].soup;
  for (const double coarseness : {0.3, 0.1, 0.05}) {
    const Cage cage = wrap({soup.positions(), soup.faces()}, coarseness);
    EXPECT_GT(volume(cage), 0);
    EXPECT_EQ(self_intersections(cage), 0U);
    EXPECT_EQ(deform_points(*green_coordinates(cage), cage, cage.vertices, soup.positions(), false).outside,
              std::vector<std::uint8_t>(soup.positions().size(), 0))
        << "all points must be inside by Green's coordinates";
  }
  EXPECT_THROW(wrap({soup.positions(), soup.faces()}, 0.9), FieldError);
  EXPECT_THROW(wrap({}, 0.1), Error);
}

}  // namespace
}  // namespace rebake::test
