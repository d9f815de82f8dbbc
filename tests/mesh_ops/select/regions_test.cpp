// Boxes relative to an object's bounds as boxes of object space: the same points are inside.
#include "mesh_ops/select/regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// A node whose object has these bounds.
PlacedNode placed_in(const Box& bounds) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 4, .rows = 2}));
  object->sets = {
      {Soup({bounds.min(), bounds.max(), bounds.center()}, std::vector<Vec2>(3, Vec2(0.5, 0.5)), {Face{0, 1, 2}}),
       object->sets[0].texels}};
  const Scene scene = scene_of(object);
  return placed_nodes(scene).front();
}

TEST(BoxRegions, RelativeToBoundsKeepTheSamePointsAsBoxesOfObjectSpace) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int run = 0; run < 200; ++run) {
    Vec3 corner, size;
    for (int axis = 0; axis < 3; ++axis) {
      corner[axis] = number(random) * std::pow(10, 8 * number(random));
      size[axis] = run % 7 == axis ? 0 : std::abs(number(random)) * std::pow(10, 4 * number(random));
    }
    const PlacedNode placed = placed_in(Box(corner, Vec3(corner + size)));
    const FrameTransform frame(CoordinateFrame::bounds, placed);
    BoxRegion region{Vec3::Constant(0), Vec3::Constant(1)};
    if (run % 3 == 1) region = {Vec3(0, 0.5, 0.25), Vec3(1, 1, 0.75)};
    if (run % 3 == 2) region = {Vec3(number(random), -2, 0), Vec3(1.5, number(random), 1)};
    const ObjectRegion expected = region_of(frame, region);
    const auto [to_box, box] = box_region_of(frame, region);
    const Box bounds = placed.node->object->bounds();
    for (int k = 0; k < 200; ++k) {
      Vec3 point;
      for (int axis = 0; axis < 3; ++axis) {
        // On the limits, one rounding beside them, and anywhere.
        const double share = k % 4 == 0 ? region.min[axis] : k % 4 == 1 ? region.max[axis] : number(random);
        point[axis] = bounds.min()[axis] + share * bounds.sizes()[axis];
        if (k % 8 > 3) point[axis] = std::nextafter(point[axis], k % 16 > 7 ? 1e300 : -1e300);
      }
      ASSERT_EQ(box.contains(Vec3(to_box * point)), expected.inside(point)) << run << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace rebake::test
