// Passes for compositing, transparent pictures, panoramas and contact sheets.
#include "render/image_passes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "editor/actions/views.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/scene/scene_light.h"
#include "render/compare.h"
#include "render/contact_sheet.h"
#include "render/panorama.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// Two balls, the smaller one in front of the larger one.
Scene two_balls() {
  Scene scene = scene_of(made_object({.seed = 1}), "large");
  Node small;
  small.name = "small";
  small.object = made_object({.seed = 2});
  small.to_parent = Eigen::Translation3d(0.7, 0.2, 2) * Eigen::Scaling(0.5);
  return with_added(scene, small, NodeId::none, 1);
}

View view_of(const Scene& scene, int width = 90, int height = 70) {
  return resolve_view(scene, std::nullopt, "", width, height, 4);
}

// Distance along the view axis to the nearest triangle by testing all of them, whatever their texels show; infinity if
// there is none.
double nearest_triangle_depth(const Scene& scene, const Vec3& origin, const Vec3& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const PlacedNode& placed : placed_nodes(scene))
    for (const TextureSet& set : placed.node->object->sets)
      for (const Face& face : set.soup.faces()) {
        Mat3 m;
        const Vec3 a = placed.to_world * set.soup.positions()[face[0]];
        m.col(0) = placed.to_world * set.soup.positions()[face[1]] - a;
        m.col(1) = placed.to_world * set.soup.positions()[face[2]] - a;
        m.col(2) = -ray;
        const Vec3 solution = m.fullPivLu().solve(origin - a);
        if (solution.x() >= 0 && solution.y() >= 0 && solution.x() + solution.y() <= 1 && solution.z() > 0)
          nearest = std::min(nearest, solution.z());
      }
  return nearest;
}

TEST(ImagePasses, DepthPositionAndNodeAreThoseOfTheTriangles) {
  const Scene scene = two_balls();
  View view = view_of(scene);
  view.samples = 1;
  Renderer renderer;
  const ImagePasses passes = render_passes(renderer, scene, view, {}, nullptr, {"depth", "node", "position", "normal"});
  const nlohmann::json names = nlohmann::json::parse(passes.attributes.at(0).second);
  const Mat3 rows = world_to_camera(view.camera);
  const double half = half_height(view.camera, 1);
  int compared = 0;
  for (int y = 0; y < view.height; y += 3)
    for (int x = 0; x < view.width; x += 3) {
      const auto pixel = static_cast<std::size_t>(y * view.width + x);
      const float depth = passes.find("depth.Z")->values[pixel];
      if (depth == 1e10F) {
        EXPECT_EQ(passes.find("node.ID")->values[pixel], 0);
        continue;
      }
      const Vec3 ray = rows.transpose() * Vec3(((x + 0.5) / view.width * 2 - 1) * half * view.width / view.height,
                                               (1 - (y + 0.5) / view.height * 2) * half, -1);
      EXPECT_GE(depth, nearest_triangle_depth(scene, view.camera.eye, ray) * (1 - 1e-6));
      const std::string name = names.at(std::to_string(static_cast<int>(passes.find("node.ID")->values[pixel])));
      Vec3 position, normal;
      for (int axis = 0; axis < 3; ++axis) {
        position[axis] = passes.find(std::string("position.") + "XYZ"[axis])->values[pixel];
        normal[axis] = passes.find(std::string("normal.") + "XYZ"[axis])->values[pixel];
      }
      const PlacedNode placed = *find_placed(scene, find(scene, name)->id);
      EXPECT_LT((placed.to_world * position - (view.camera.eye + depth * ray)).norm(), 1e-5);
      EXPECT_NEAR(normal.norm(), 1, 1e-6);
      EXPECT_LE(normal.dot(ray), 0);
      ++compared;
    }
  EXPECT_GT(compared, 50);
}

TEST(ImagePasses, DataCoverTheSamePixelsAsTheRenderer) {
  const Scene scene = two_balls();
  const View view = view_of(scene, 200, 150);
  Renderer renderer;
  const ImagePasses passes = render_passes(renderer, scene, view, {}, nullptr, {"alpha", "depth"});
  std::size_t covered = 0, differ = 0;
  for (std::size_t p = 0; p < passes.find("A")->values.size(); ++p) {
    const bool drawn = passes.find("A")->values[p] > 0, hit = passes.find("depth.Z")->values[p] < 1e10F;
    covered += drawn ? 1 : 0;
    differ += drawn != hit ? 1 : 0;
  }
  EXPECT_GT(covered, 1000U);
  EXPECT_LE(differ, covered / 500);  // samples on edges, within float rounding
}

TEST(ImagePasses, NodesAreTheOnesThatTheRendererDraws) {
  const Scene scene = two_balls();
  const View view = view_of(scene, 200, 150);
  Renderer renderer;
  const ImagePasses passes = render_passes(renderer, scene, view, {}, nullptr, {"node"});
  const Image both = renderer.render(scene, view);
  RenderOptions options;
  options.transparent = true;
  const Image only = renderer.render(without(scene, find(scene, "large")->id), view, options);
  std::size_t inside = 0;
  const auto& ids = passes.find("node.ID")->values;
  for (std::size_t p = 0; p < ids.size(); ++p) {
    // The small ball, which is in front, covers the whole pixel.
    if (only.alpha[p] != 255) continue;
    ++inside;
    EXPECT_EQ(ids[p], 2);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(both.rgb[3 * p + c], only.rgb[3 * p + c], 1);
  }
  EXPECT_GT(inside, 200U);
}

TEST(ImagePasses, WritesOneFileOrAFileEach) {
  const TemporaryFolder folder;
  const Scene scene = two_balls();
  Renderer renderer;
  const ImagePasses passes =
      render_passes(renderer, scene, view_of(scene, 20, 16), {}, nullptr, {"color", "alpha", "depth", "light"});
  write_passes(passes, folder.path() / "a.exr", false, {});
  const PictureLayout layout = open_picture(folder.path() / "a.exr")->layout();
  EXPECT_EQ(layout.channels, 8);
  EXPECT_TRUE(layout.floating);
  write_passes(passes, folder.path() / "b.exr", true, {});
  for (const char* name : {"b.color.exr", "b.depth.exr", "b.light.exr"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
  EXPECT_THROW(check_pass_names({"colour"}), FieldError);
}

TEST(ImagePasses, TransparentPicturesShowTheSameOverAnyBackground) {
  Scene scene = two_balls();
  const View view = view_of(scene, 120, 90);
  Renderer renderer;
  RenderOptions options;
  options.transparent = true;
  const Image cut = renderer.render(scene, view, options);
  ASSERT_EQ(cut.alpha.size(), 120U * 90U);
  scene.background = {0.2, 0.9, 0.4};
  const Image over = renderer.render(scene, view);
  int largest = 0;
  std::size_t partial = 0;
  for (std::size_t p = 0; p < cut.alpha.size(); ++p) {
    const double alpha = cut.alpha[p] / 255.0;
    partial += alpha > 0 && alpha < 1 ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double blended =
          alpha * cut.rgb[3 * p + c] + (1 - alpha) * 255 * scene.background[static_cast<Eigen::Index>(c)];
      largest = std::max(largest, static_cast<int>(std::lround(std::abs(blended - over.rgb[3 * p + c]))));
    }
  }
  EXPECT_GT(partial, 50U);
  EXPECT_LE(largest, 1);
  EXPECT_TRUE(over.alpha.empty());
}

TEST(Panorama, ShowsWhatACameraSeesInEveryDirection) {
  const Scene scene = two_balls();
  View around;
  around.camera.eye = {0.3, 0.1, 4};
  around.camera.target = {0, 0, 0};
  around.camera.near_plane = 0.1;
  around.camera.far_plane = 20;
  around.width = 800;
  around.height = 400;
  Renderer renderer;
  const Image panorama = render_panorama(renderer, scene, around, {}, nullptr);
  View front = around;
  front.width = front.height = 120;
  front.camera.fov_degrees = 40;
  const Image picture = renderer.render(scene, front);
  const Mat3 rows = world_to_camera(front.camera);
  const Vec3 up(0, 1, 0), ahead = (Vec3(-0.3, 0, -4)).normalized();
  Image resampled = picture;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 120; ++x) {
      const double half = half_height(front.camera, 1);
      const Vec3 d =
          (rows.transpose() * Vec3(((x + 0.5) / 60 - 1) * half, (1 - (y + 0.5) / 60) * half, -1)).normalized();
      const double about = std::atan2(d.dot(ahead.cross(up)), d.dot(ahead)), above = std::asin(d.dot(up));
      const int column = static_cast<int>((about / std::numbers::pi + 1) * 400),
                row = static_cast<int>((0.5 - above / std::numbers::pi) * 400);
      for (std::size_t c = 0; c < 3; ++c)
        resampled.rgb[3 * static_cast<std::size_t>(y * 120 + x) + c] =
            panorama.rgb[3 * static_cast<std::size_t>(row * 800 + column) + c];
    }
  // Nearest pixels of a raster of similar density.
  EXPECT_GT(compare(picture, resampled, 0).psnr_db, 20);
  around.width = 700;
  EXPECT_THROW(render_panorama(renderer, scene, around, {}, nullptr), FieldError);
}

TEST(ContactSheet, PlacesPicturesInRows) {
  const Image red{2, 1, {255, 0, 0, 255, 0, 0}}, blue{2, 1, {0, 0, 255, 0, 0, 255}};
  const Image sheet = contact_sheet({red, blue, red}, 2, 1, {9, 9, 9});
  ASSERT_EQ(sheet.width, 7);
  ASSERT_EQ(sheet.height, 5);
  const auto pixel = [&](int x, int y) { return sheet.rgb[static_cast<std::size_t>(3 * (7 * y + x))]; };
  EXPECT_EQ(pixel(0, 0), 9);
  EXPECT_EQ(pixel(1, 1), 255);
  EXPECT_EQ(pixel(4, 1), 0);
  EXPECT_EQ(pixel(1, 3), 255);
  EXPECT_EQ(pixel(4, 3), 9);
}

}  // namespace
}  // namespace rebake::test
