// Viewport navigation: orbit, pan, zoom to cursor, frame, axis views, projections and camera paths.
#include "editor/gui/state/navigation.h"

#include <gtest/gtest.h>

#include "editor/actions/views.h"
#include "editor/gui/view/viewport_projection.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

constexpr int width = 640, height = 480;

Camera camera() {
  Camera camera;
  camera.eye = {1, 2, 5};
  camera.target = {0.5, 0.25, -1};
  return camera;
}

TEST(Navigation, OrbitingKeepsTheDistanceAndStopsAtThePoles) {
  const double distance = (camera().eye - camera().target).norm();
  Camera moved = camera();
  for (int k = 0; k < 50; ++k) moved = orbited(moved, 13, 40, height);
  EXPECT_NEAR((moved.eye - moved.target).norm(), distance, 1e-12);
  EXPECT_EQ(moved.target, camera().target);
  // Far beyond the pole the camera looks straight down, without flipping over.
  const Vec3 direction = (moved.eye - moved.target).normalized();
  EXPECT_GT(direction.y(), 0.9999);
  EXPECT_LT(direction.y(), 1);
}

TEST(Navigation, FramesTheDenseCentreOfAScene) {
  Scene scene = scene_of(made_object({.columns = 64, .rows = 32}), "thing");
  const Camera alone = framing_camera(scene, 1);
  Node backdrop;
  backdrop.name = "backdrop";
  backdrop.object = made_object({.columns = 8, .rows = 4, .radius = 50});
  scene = with_added(scene, std::move(backdrop), NodeId::none, 1);
  const Camera inside = framing_camera(scene, 1);
  EXPECT_LT((inside.eye - inside.target).norm(), 1.1 * (alone.eye - alone.target).norm());
  EXPECT_GT(inside.far_plane, 50) << "the backdrop is drawn";
  // A scene of few triangles has no dense centre.
  const auto two = made_object({.columns = 3, .rows = 1, .radius = 2});
  EXPECT_GT((framing_camera(scene_of(two), 1).eye - framing_camera(scene_of(two), 1).target).norm(), 2);
  // Two dense objects side by side are both framed.
  const Scene pair = with_changed(scene, placed_nodes(scene)[1].node->id, [](Node& node) {
    node.object = made_object({.columns = 64, .rows = 32});
    node.to_parent.translation() = Vec3(6, 0, 0);
  });
  const Camera both = framing_camera(pair, 1);
  EXPECT_NEAR(both.target.x(), 3, 1e-6);
}

TEST(Navigation, FullOrbitReturns) {
  Camera moved = camera();
  for (int k = 0; k < 8; ++k) moved = orbited(moved, 2.0 * height / 8, 0, height);
  EXPECT_LT((moved.eye - camera().eye).norm(), 1e-12);
}

TEST(Navigation, PanMovesTheTargetWithThePointer) {
  for (const Camera& from : {camera(), toggled_projection(camera())}) {
    const Vec2 before = *ViewportProjection(from, width, height).pixel(from.target);
    const Camera moved = panned(from, 30, -20, height);
    const Vec2 after = *ViewportProjection(moved, width, height).pixel(from.target);
    EXPECT_LT((after - before - Vec2(30, -20)).norm(), 1e-9);
  }
}

TEST(Navigation, ZoomingKeepsThePointUnderThePointer) {
  const Vec3 point(0.8, 0.4, -0.5);
  for (const Camera& from : {camera(), toggled_projection(camera())}) {
    const Vec2 before = *ViewportProjection(from, width, height).pixel(point);
    Camera moved = from;
    for (int k = 0; k < 10; ++k) moved = zoomed(moved, point, 0.8);
    EXPECT_LT((*ViewportProjection(moved, width, height).pixel(point) - before).norm(), 1e-7);
    EXPECT_NEAR(ViewportProjection(moved, width, height).unit(point),
                ViewportProjection(from, width, height).unit(point) * std::pow(0.8, 10), 1e-15);
    // Endless zooming ends before numbers underflow.
    for (int k = 0; k < 1000; ++k) moved = zoomed(moved, point, 0.5);
    EXPECT_NO_THROW(check(moved));
  }
}

TEST(Navigation, FramingShowsAllOfABoxAtAnyAspect) {
  const Box box(Vec3(-3, -1, -2), Vec3(1, 0.5, 0));
  for (const Camera& from : {camera(), toggled_projection(camera())})
    for (const double aspect : {0.3, 1.0, 3.0}) {
      const ViewportProjection lens(framed(from, box, aspect), static_cast<int>(600 * aspect), 600);
      for (int corner = 0; corner < 8; ++corner) {
        const auto pixel = lens.pixel(box.corner(static_cast<Box::CornerType>(corner)));
        ASSERT_TRUE(pixel);
        EXPECT_GE(pixel->minCoeff(), 0);
        EXPECT_LE(pixel->x(), 600 * aspect);
        EXPECT_LE(pixel->y(), 600);
      }
    }
}

TEST(Navigation, AxisViewsLookAlongTheAxis) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const Camera moved = along_axis(camera(), sign * Vec3::Unit(axis));
      const Vec3 direction = (moved.eye - moved.target).normalized();
      EXPECT_EQ(direction, sign * Vec3::Unit(axis)) << "exactly";
      EXPECT_NO_THROW(check(moved));
      // Orbiting continues from there, with the world's up axis.
      const Camera on = orbited(moved, 10, 10, height);
      EXPECT_EQ(on.up, Vec3(0, 1, 0));
      EXPECT_LT((on.eye - moved.eye).norm(), 0.1 * (moved.eye - moved.target).norm());
      EXPECT_EQ(along_axis(moved, sign * Vec3::Unit(axis)).eye, moved.eye);
      // The right side of the picture stays on the right.
      EXPECT_GT(world_to_camera(on).row(0).dot(world_to_camera(moved).row(0)), 0.9);
    }
}

TEST(Navigation, ProjectionSwitchKeepsSizeAndReturns) {
  const Camera flat = toggled_projection(camera());
  ASSERT_TRUE(flat.orthographic());
  EXPECT_NO_THROW(check(flat));
  EXPECT_NEAR(ViewportProjection(camera(), width, height).unit(camera().target),
              ViewportProjection(flat, width, height).unit(camera().target), 1e-15);
  const Camera back = toggled_projection(flat);
  EXPECT_FALSE(back.orthographic());
  EXPECT_LT((back.eye - camera().eye).norm(), 1e-12);
  // Zooming in and out again restores the camera, including its depth range.
  const Box around(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  const Camera begun = with_clip_planes_for(flat, around);
  Camera there = begun;
  for (int k = 0; k < 40; ++k) there = with_clip_planes_for(zoomed(there, {0.1, 0.2, 0.3}, 0.8), around);
  for (int k = 0; k < 40; ++k) there = with_clip_planes_for(zoomed(there, {0.1, 0.2, 0.3}, 1.25), around);
  EXPECT_LT((there.eye - begun.eye).norm(), 1e-9);
  EXPECT_NEAR(there.far_plane, begun.far_plane, 1e-9);
  // However far one zooms in, nothing is clipped in front of the eye, and the picture stays the same.
  const Box box(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  const Camera close = zoomed(flat, flat.target, 1e-3), cleared = with_clip_planes_for(close, box);
  EXPECT_EQ(cleared.ortho_height, close.ortho_height);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 point = box.corner(static_cast<Box::CornerType>(corner));
    EXPECT_GT(ViewportProjection(cleared, width, height).depth(point), cleared.near_plane);
    EXPECT_LT((*ViewportProjection(cleared, width, height).pixel(point) -
               *ViewportProjection(close, width, height).pixel(point))
                  .norm(),
              1e-6);
  }
}

TEST(Navigation, DepthRangeContainsTheScene) {
  const Box box(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  for (const double away : {0.01, 1.0, 100.0, 1e5}) {
    Camera moved = camera();
    moved.eye = moved.target + Vec3(0, 0, away);
    moved = with_clip_planes_for(moved, box);
    EXPECT_NO_THROW(check(moved));
    EXPECT_GT(moved.far_plane, (box.center() - moved.eye).norm() + 1);
  }
}

TEST(ViewportProjection, PixelAndRayAreInverse) {
  for (const Camera& from : {camera(), toggled_projection(camera())}) {
    const ViewportProjection lens(from, width, height);
    for (const Vec2& pixel : {Vec2(0, 0), Vec2(320, 240), Vec2(637.5, 12.25)}) {
      const ViewRay ray = lens.ray(pixel);
      const Vec3 point = ray.origin + 3 * ray.direction;
      EXPECT_LT((*lens.pixel(point) - pixel).norm(), 1e-9);
      EXPECT_NEAR(lens.depth(point), 3, 1e-12);
      EXPECT_LT((*lens.pixel(point + lens.motion(point, {7, -5})) - pixel - Vec2(7, -5)).norm(), 1e-9);
      EXPECT_LT(ray.direction.normalized().dot(lens.direction_to_eye(point)), -1 + 1e-12);
    }
    const ViewRay middle = lens.ray({320, 240});
    EXPECT_EQ(lens.pixel(middle.origin - middle.direction).has_value(), from.orthographic());
  }
}

}  // namespace
}  // namespace rebake::test
