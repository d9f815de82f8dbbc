// What is kept on the GPU between scenes: never a picture of what was.
#include "render/gpu_scene/gpu_scene.h"

#include <gtest/gtest.h>

#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// The object with its corners moved, and all else shared: as while something is dragged.
Scene bent(const Scene& scene, double amount) {
  return with_changed(scene, scene.roots[0]->id, [&](Node& node) {
    auto object = std::make_shared<BakedObject>(*node.object);
    std::size_t first = 0;
    const TriangleSet all(object->triangle_count(), 1);
    for (TextureSet& set : object->sets) {
      const std::size_t count = set.soup.triangle_count();
      set.soup = change_vertices(set.soup, all, first, [&](std::uint32_t, Vec3& position, Mat3&) {
        position.x() += amount * position.y() * position.y();
      });
      first += count;
    }
    node.object = object;
  });
}

TEST(GpuScene, WhatOnlyMovedIsDrawnAsIfItWereNew) {
  const Scene scene = scene_of(made_object({.columns = 64, .rows = 40}));
  View view;
  view.width = view.height = 150;
  view.camera.eye = {0.5, 1, 4};
  view.camera.near_plane = 0.1;
  Renderer kept;
  const Image first = kept.render(scene, view);
  EXPECT_EQ(bent(scene, 0.3).roots[0]->object->sets[0].soup.uvs(), scene.roots[0]->object->sets[0].soup.uvs());
  for (const double amount : {0.2, 0.5, -4.0}) {
    const Scene moved = bent(scene, amount);
    Renderer fresh;
    EXPECT_EQ(kept.render(moved, view).rgb, fresh.render(moved, view).rgb) << amount;
  }
  EXPECT_EQ(kept.render(scene, view).rgb, first.rgb);
  // Beside a copy of itself that stays.
  Scene two = scene;
  two = with_added(two, Node(*bent(scene, 0.4).roots[0]), NodeId::none, 1);
  Renderer fresh;
  EXPECT_EQ(kept.render(two, view).rgb, fresh.render(two, view).rgb);
}

}  // namespace
}  // namespace rebake::test
