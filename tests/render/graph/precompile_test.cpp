// Shader programs for other views of a scene are compiled in advance; pictures do not change.
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "render/graph/variants.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// Three objects, 100 units apart: the second has another decoder and is rotated, the third is bent.
Scene far_apart() {
  Scene scene = scene_of(made_object({.seed = 1}));
  Node turned;
  turned.object = made_object({.seed = 2});
  turned.to_parent = Affine(Eigen::AngleAxisd(1, Vec3::UnitX()));
  turned.to_parent.pretranslate(Vec3(100, 0, 0));
  scene = with_added(scene, turned, NodeId::none, 9);
  auto object = std::make_shared<BakedObject>(*made_object({.seed = 1}));
  Soup& soup = object->sets[0].soup;
  soup = change_vertices(soup, std::vector<std::uint8_t>(soup.triangle_count(), 1), 0,
                         [](std::uint32_t vertex, Vec3& position, Mat3& turn) {
                           turn = Eigen::AngleAxisd(0.001 * vertex, Vec3::UnitY()).toRotationMatrix();
                           position.y() *= 1.1;
                         });
  Node bent;
  bent.object = object;
  bent.to_parent.translation() = Vec3(200, 0, 0);
  return with_added(scene, bent, NodeId::none, 9);
}

View look_at(double x, int samples, double back = 4) {
  View view;
  view.camera.eye = Vec3(x, 1, back);
  view.camera.target = Vec3(x, 0, 0);
  view.camera.near_plane = 0.1;
  view.camera.far_plane = 1000;
  view.width = view.height = 48;
  view.samples = samples;
  return view;
}

TEST(MakeAhead, CompilesAllProgramsInAdvance) {
  const Scene scene = far_apart();
  Renderer renderer, fresh;
  const Image first = renderer.render(scene, look_at(0, 4));
  const std::size_t compiled = renderer.compile_stall_count();
  EXPECT_EQ(compiled, 1U);
  int made = 0;
  while (renderer.compile_next_program(scene, look_at(0, 4), {}, nullptr)) {
    ++made;
    ASSERT_LT(made, 100);
  }
  EXPECT_GT(made, 3);
  EXPECT_EQ(renderer.shown_image(), first) << "the shown picture must stay";
  for (const int samples : {4, 1})
    for (const double x : {0.0, 100.0, 200.0, 50.0, 150.0, -500.0})
      for (const double back : {4.0, 120.0, 300.0}) {
        const View view = look_at(x, samples, back);
        EXPECT_EQ(renderer.render(scene, view), fresh.render(scene, view)) << samples << " " << x << " " << back;
      }
  EXPECT_EQ(renderer.compile_stall_count(), compiled);
  EXPECT_GT(fresh.compile_stall_count(), 5U) << "without make_ahead() frames must compile";
  EXPECT_FALSE(renderer.compile_next_program(scene, look_at(100, 4), {}, nullptr));
}

TEST(MakeAhead, OneObjectNeedsOnlyFewerSamples) {
  const Scene scene = scene_of(made_object());
  Renderer renderer;
  renderer.render(scene, look_at(0, 4));
  EXPECT_TRUE(renderer.compile_next_program(scene, look_at(0, 4), {}, nullptr))
      << "programs for fewer samples while the camera moves";
  EXPECT_FALSE(renderer.compile_next_program(scene, look_at(0, 4), {}, nullptr));
  renderer.render(scene, look_at(0, 1));
  EXPECT_EQ(renderer.compile_stall_count(), 1U);
  EXPECT_FALSE(renderer.compile_next_program(Scene(), look_at(0, 4), {}, nullptr));
}

TEST(MakeAhead, InstancesShareFrameVariants) {
  Scene scene = scene_of(made_object());
  const auto turned_by = [&](double angle) {
    Node node = *scene.roots[0];
    node.id = NodeId::none;
    node.to_parent = Affine(Eigen::AngleAxisd(angle, Vec3::UnitY()));
    scene = with_added(scene, node, NodeId::none, 1000);
  };
  turned_by(0.5);
  const std::size_t of_two = precompile_frames(scene, look_at(0, 4), {}, nullptr).size();
  for (int k = 0; k < 100; ++k) turned_by(0.01 * k);
  EXPECT_EQ(precompile_frames(scene, look_at(0, 4), {}, nullptr).size(), of_two);
  EXPECT_LE(of_two, 4U);
}

}  // namespace
}  // namespace rebake::test
