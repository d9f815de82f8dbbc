// Overlays of the editor: selected triangles, outlines, lines and inspection, in front of and behind surfaces.
#include "render/graph/guides.h"

#include <gtest/gtest.h>

#include "render/compare.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

View view_of(int samples) {
  View view;
  view.width = view.height = 120;
  view.samples = samples;
  view.camera.eye = {0, 0, 4};
  view.camera.near_plane = 0.1;
  return view;
}

Scene selected_scene(bool front) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16}));
  const BakedObject& object = *scene.roots[0]->object;
  TriangleSet flags;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces()) {
      Vec3 centre(0, 0, 0);
      for (const std::uint32_t v : face) centre += set.soup.positions()[v] / 3;
      flags.push_back((centre.z() > 0.3) == front && std::abs(centre.z()) > 0.3 ? 1 : 0);
    }
  return with_changed(scene, scene.roots[0]->id,
                      [&](Node& node) { node.selection = std::make_shared<const TriangleSet>(flags); });
}

// Number of pixels in which a channel differs by more than `by`.
std::size_t changed(const Image& a, const Image& b, int by) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.rgb.size(); k += 3)
    for (std::size_t c = 0; c < 3; ++c)
      if (std::abs(a.rgb[k + c] - b.rgb[k + c]) > by) {
        ++count;
        break;
      }
  return count;
}

class GuidesTest : public ::testing::TestWithParam<int> {
 protected:
  Image shown(const Scene& scene, const Guides& guides) {
    renderer.show(scene, view_of(GetParam()), {}, guides, false);
    return renderer.shown_image();
  }
  Renderer renderer;
};

TEST_P(GuidesTest, WithoutOverlaysThePictureIsUnchanged) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16}));
  EXPECT_EQ(shown(scene, {}).rgb, renderer.render(scene, view_of(GetParam())).rgb);
  const auto planned = renderer.show(scene, view_of(GetParam()), {}, {}, false).passes;
  for (const PlannedPass& pass : planned)
    EXPECT_FALSE(pass.runs && (pass.name == "selection" || pass.name == "guides")) << pass.why;
}

TEST_P(GuidesTest, TrianglesAreVisibleOnTheirSurfaceOnly) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16, .holes = false}));
  const auto triangles = [&](double side, double scale) {
    auto list = std::make_shared<std::vector<Guides::Triangle>>();
    for (const TextureSet& set : scene.roots[0]->object->sets)
      for (const Face& face : set.soup.faces()) {
        Guides::Triangle triangle;
        for (std::size_t k = 0; k < 3; ++k) triangle.corners[k] = scale * set.soup.positions()[face[k]];
        if (side * triangle.corners[0].z() > 0.3) list->push_back(triangle);
      }
    return list;
  };
  for (const bool orthographic : {false, true}) {
    View view = view_of(GetParam());
    if (orthographic) view.camera.ortho_height = 3;
    const auto seen = [&](const Guides& guides) {
      renderer.show(scene, view, {}, guides, false);
      return renderer.shown_image();
    };
    const Image plain = seen({});
    Guides guides;
    guides.triangles = triangles(1, 1);
    EXPECT_GT(changed(plain, seen(guides), 40), 1000U) << "they lie on the visible surface";
    guides.triangles = triangles(-1, 1);
    EXPECT_EQ(seen(guides), plain) << "they lie behind the surface";
    guides.triangles = triangles(1, 1.1);
    EXPECT_EQ(seen(guides), plain) << "they lie on no surface";
  }
}

TEST_P(GuidesTest, SelectedTrianglesInFrontAreTintedMoreThanThoseBehind) {
  const Image plain = renderer.render(selected_scene(true), view_of(GetParam()));
  const Image front = shown(selected_scene(true), {}), back = shown(selected_scene(false), {});
  EXPECT_GT(changed(plain, front, 25), 800U);
  EXPECT_GT(changed(plain, back, 8), 800U) << "hidden triangles must be tinted faintly";
  EXPECT_LT(changed(plain, back, 60), changed(plain, front, 60) / 2);
  Guides off;
  off.selection = false;
  EXPECT_EQ(shown(selected_scene(true), off).rgb, plain.rgb);
}

TEST_P(GuidesTest, OutlinesPickedNodesFaintlyIfOccluded) {
  Scene scene = scene_of(made_object({.columns = 32, .rows = 16}), "front");
  Node behind = *scene.roots[0];
  behind.id = NodeId::none;
  behind.name = "behind";
  behind.to_parent.translation() = Vec3(0.5, 0, -3);
  NodeId back = NodeId::none;
  scene = with_added(scene, behind, NodeId::none, 1, &back);
  const Image plain = renderer.render(scene, view_of(GetParam()));
  Guides guides;
  guides.outlined = {scene.roots[0]->id};
  const std::size_t front = changed(plain, shown(scene, guides), 60);
  EXPECT_GT(front, 100U);
  EXPECT_LT(front, 1500U) << "an outline, not the whole node";
  guides.outlined = {back};
  const Image line = shown(scene, guides);
  EXPECT_GT(changed(plain, line, 15), 50U) << "hidden outlines must be visible";
  for (const PlannedPass& pass : renderer.show(scene, view_of(GetParam()), {}, {}, false).passes)
    EXPECT_FALSE(pass.runs && pass.name == "outline") << "without picked nodes the pass must not run";
}

TEST_P(GuidesTest, SurfacesOccludeLines) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16}));
  const Image plain = renderer.render(scene, view_of(GetParam()));
  const auto line_at = [&](double z, double hidden) {
    Guides guides;
    guides.lines.push_back({{-0.2, 0.01, z}, {0.2, 0.01, z}, Color(1, 0, 1), 1, hidden});
    return changed(plain, shown(scene, guides), 40);
  };
  EXPECT_GE(line_at(2, 0), 10U);
  EXPECT_EQ(line_at(-2, 0), 0U);
  EXPECT_GE(line_at(-2, 1), 5U);
  // A line in an empty scene.
  Guides guides;
  guides.lines.push_back({{-1, 0, 0}, {1, 0, 0}, Color(0, 0, 0), 1, 0});
  EXPECT_GT(changed(shown({}, {}), shown({}, guides), 40), 30U);
}

// Depths of the previous picture must not hide lines if nothing is drawn now.
TEST_P(GuidesTest, PreviousDepthDoesNotOccludeLines) {
  const Scene scene = scene_of(made_object({.columns = 32, .rows = 16}));
  Guides guides;
  guides.lines.push_back({{-0.3, 0.01, -2}, {0.3, 0.01, -2}, Color(1, 0, 1), 1, 0});
  View beside = view_of(GetParam());
  beside.camera.target = {9, 0, 3};
  Renderer fresh;
  for (const View& view : {view_of(GetParam()), beside}) {
    renderer.show(scene, view, {}, guides, false);
    fresh.show(scene, view, {}, guides, false);
  }
  EXPECT_EQ(renderer.shown_image().rgb, fresh.shown_image().rgb);
}

TEST_P(GuidesTest, InspectModesDifferAndCanBeLeft) {
  const Scene scene = selected_scene(true);
  Guides guides;
  guides.lines.push_back({{-1, 0, 0}, {1, 0, 0}, Color(0, 0, 0), 1, 0.3});
  const Image colours = shown(scene, guides);
  std::vector<Image> looks;
  for (const Guides::Inspect inspect :
       {Guides::Inspect::wireframe, Guides::Inspect::opacity, Guides::Inspect::texture_sets, Guides::Inspect::channel,
        Guides::Inspect::overdraw}) {
    guides.inspect = inspect;
    looks.push_back(shown(scene, guides));
    for (const PlannedPass& pass : renderer.show(scene, view_of(GetParam()), {}, guides, false).passes)
      EXPECT_FALSE(pass.runs && (pass.name == "geometry" || pass.name == "resolve" || pass.name == "forward"));
    EXPECT_GT(changed(looks.back(), colours, 20), 500U);
    for (std::size_t k = 0; k + 1 < looks.size(); ++k) EXPECT_GT(changed(looks.back(), looks[k], 20), 500U);
    guides.inspect = Guides::Inspect::none;
    EXPECT_EQ(shown(scene, guides).rgb, colours.rgb);
  }
}

INSTANTIATE_TEST_SUITE_P(Samples, GuidesTest, ::testing::Values(1, 4));

}  // namespace
}  // namespace rebake::test
