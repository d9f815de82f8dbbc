// GPU pictures compared with an independent ray caster: at least 45 dB, and 99.5 % of pixels within 2/255.
#include "render/picture.h"
#include "mesh_ops/base/polar.h"
#include "render/graph/effects.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh_ops/formats/formats.h"
#include "mesh_ops/texture/decoder.h"
#include "render/compare.h"
#include "render/passes/decoder_glsl.h"
#include "render/thumbnail.h"
#include "tests/support/made_scenes.h"
#include "tests/support/nerf2mesh_example.h"
#include "tests/support/oracle.h"

namespace rebake::test {
namespace {

Soup moved_part(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first, const Affine& motion) {
  return move_faces(soup, flags, first, motion, orthogonal_factor(motion.linear()));
}

constexpr double min_psnr_db = 45;
constexpr double max_beyond = 0.005;

Renderer& renderer() {
  static Renderer one;
  return one;
}

View view_from(const Vec3& eye, int samples = 4) {
  View view;
  view.camera.eye = eye;
  view.camera.near_plane = 0.5;
  view.camera.far_plane = 20;
  // With one sample per pixel, rounding at an edge changes a whole pixel. An equal number of samples keeps the
  // thresholds comparable.
  view.width = samples == 1 ? 320 : 160;
  view.height = samples == 1 ? 240 : 120;
  view.samples = samples;
  return view;
}

void expect_as_cast(const Scene& scene, const View& view, const RenderOptions& options = {}) {
  const Image drawn = renderer().render(scene, view, options), cast = cast_picture(scene, view);
  const Difference d = compare(drawn, cast, 2);
  EXPECT_GE(d.psnr_db, min_psnr_db);
  EXPECT_LE(d.share_beyond, max_beyond);
  // An empty picture would agree with anything.
  EXPECT_NE(std::count(drawn.rgb.begin(), drawn.rgb.end(), drawn.rgb[0]), static_cast<long>(drawn.rgb.size()));
  if (d.psnr_db < min_psnr_db) {
    std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '-');
    write_picture(drawn, std::filesystem::temp_directory_path() / (name + "-drawn.png"), {});
    write_picture(cast, std::filesystem::temp_directory_path() / (name + "-cast.png"), {});
  }
}

Scene placed(const std::shared_ptr<const BakedObject>& object, const Affine& to_world) {
  Scene scene = scene_of(object);
  return with_changed(scene, scene.roots[0]->id, [&](Node& n) { n.to_parent = to_world; });
}

Scene together(const std::vector<Scene>& scenes) {
  Scene result;
  for (const Scene& scene : scenes) {
    Node node = *scene.roots[0];
    node.id = NodeId::none;
    result = with_added(result, node, NodeId::none, 99);
  }
  return result;
}

Affine moved(double x, double y, double z) { return Affine(Eigen::Translation3d(x, y, z)); }

class PictureBySamples : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Picture, PictureBySamples, ::testing::Values(1, 4, 16));

TEST_P(PictureBySamples, OneObject) { expect_as_cast(scene_of(made_object()), view_from({0.5, 1.5, 3}, GetParam())); }

TEST_P(PictureBySamples, OneRayForAllSamplesOfANarrowPixel) {
  const Scene scene = scene_of(made_object());
  View view = view_from({0.8, 2.4, 4.8}, GetParam());
  view.camera.fov_degrees = 25;  // pixels just below the angle at which each sample gets its own ray
  EXPECT_FALSE(plan(scene, view).runs(effects::ray_per_sample));
  expect_as_cast(scene, view);
}

View orthographic_view(int samples) {
  View view = view_from({0.5, 1.5, 3}, samples);
  view.camera.ortho_height = 2.2;
  return view;
}

TEST_P(PictureBySamples, Orthographic) {
  const Scene scene = scene_of(made_object());
  EXPECT_FALSE(plan(scene, orthographic_view(GetParam())).runs(effects::ray_per_sample));
  expect_as_cast(scene, orthographic_view(GetParam()));
}

TEST_P(PictureBySamples, TwoDecodersMixedAtPixels) {
  expect_as_cast(together({placed(made_object({.seed = 1}), moved(-0.4, 0, 0)),
                           placed(made_object({.seed = 2}), moved(0.5, 0.2, 0.3))}),
                 view_from({0.5, 1.5, 4}, GetParam()));
}

// nerf2mesh and plain colours beside MobileNeRF, with weights as constants and in a buffer.
TEST_P(PictureBySamples, OtherColorRules) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n");
  const Scene read = read_any(folder.path() / "n", Axes::y_up);
  auto plain = std::make_shared<BakedObject>(*read.roots[0]->object);
  plain->decoder = std::make_shared<const Decoder>(diffuse_decoder());
  const Affine turn = moved(-0.9, 0.3, 0) * Eigen::AngleAxisd(0.8, Vec3(1, 2, 0).normalized());
  const Scene all = together({placed(read.roots[0]->object, turn), placed(plain, moved(0.8, -0.7, 0.4)),
                              placed(made_object({.seed = 2}), moved(0.9, 0.9, -0.3))});
  for (const auto weights : {RenderOptions::Weights::constants, RenderOptions::Weights::buffer}) {
    RenderOptions options;
    options.weights = weights;
    expect_as_cast(read, view_from({0.5, 1.5, 3}, GetParam()), options);
    expect_as_cast(scene_of(plain), view_from({0.5, 1.5, 3}, GetParam()), options);
    expect_as_cast(all, view_from({0.5, 1.5, 4}, GetParam()), options);
  }
}

TEST_P(PictureBySamples, FolderThatNerf2MeshWrote) {
  const auto scene = read_any(REBAKE_SOURCE "/tests/mesh_ops/formats/nerf2mesh/written_by_nerf2mesh", Axes::y_up);
  expect_as_cast(scene, view_from({1.5, 1.5, 3}, GetParam()));
}

TEST_P(PictureBySamples, RotatedTriangles) {
  const auto object = made_object();
  TriangleSet flags(object->triangle_count());
  for (std::size_t f = 0; f < flags.size(); ++f) flags[f] = f % 32 < 16 ? 1 : 0;
  auto turned = std::make_shared<BakedObject>(*object);
  turned->sets[0].soup =
      moved_part(object->sets[0].soup, flags, 0,
                 Affine(Eigen::Translation3d(0.4, 0.1, 0) * Eigen::AngleAxisd(0.8, Vec3(1, 2, 0).normalized())));
  ASSERT_TRUE(turned->any_rotations());
  expect_as_cast(scene_of(turned), view_from({0.5, 1.5, 4}, GetParam()));
  expect_as_cast(scene_of(turned), orthographic_view(GetParam()));
}

TEST(Picture, ForwardFacingAxes) {
  expect_as_cast(scene_of(made_object({.axes = Axes::forward})), view_from({0, 0, 3}));
}
TEST(Picture, PlainAlphaOfUnsplitFolders) {
  expect_as_cast(scene_of(made_object({.code = AlphaCode::plain})), view_from({0, 1, 3}));
}
TEST(Picture, AxesAndAlphaCodesTogether) {
  auto second =
      std::make_shared<BakedObject>(*made_object({.seed = 1, .code = AlphaCode::plain, .axes = Axes::forward}));
  expect_as_cast(together({placed(made_object(), moved(-0.5, 0, 0)), placed(second, moved(0.5, 0, 0))}),
                 view_from({0, 1, 4}));
}

TEST(Picture, WideDecodersFromConstantsAndBuffer) {
  auto object = std::make_shared<BakedObject>(*made_object());
  object->decoder = std::make_shared<const Decoder>(made_decoder(5, 40, 24));
  for (const auto weights : {RenderOptions::Weights::constants, RenderOptions::Weights::buffer})
    expect_as_cast(scene_of(object), view_from({0, 1, 3}), {weights, {}, {}});
}

TEST(Picture, AnyArithmeticOfConstantsIsTheSamePicture) {
  // Widths that are no multiples of 4, and a layer whose weights are mostly 0.
  auto object = std::make_shared<BakedObject>(*made_object());
  auto decoder = std::make_shared<Decoder>(made_decoder(5, 13, 10));
  decoder->weights1.topRows(8).setZero();
  object->decoder = decoder;
  for (const auto arithmetic : {RenderOptions::Arithmetic::all_scalars, RenderOptions::Arithmetic::vectors})
    for (const auto shading : {RenderOptions::Shading::deferred, RenderOptions::Shading::forward}) {
      RenderOptions options;
      options.weights = RenderOptions::Weights::constants;
      options.shading = shading;
      options.arithmetic = arithmetic;
      expect_as_cast(scene_of(object), view_from({0, 1, 3}, 1), options);
    }
}

TEST(Picture, SixteenBitFloatsComeNearOrAreRefusedByName) {
  const Scene scene = scene_of(made_object());
  const View view = view_from({0, 1, 3}, 1);
  RenderOptions options;
  options.weights = RenderOptions::Weights::constants;
  const Image reference = renderer().render(scene, view, options);
  options.arithmetic = RenderOptions::Arithmetic::halves;
  // Whatever the driver: the text asks for the extension first, and has literals of 16 bits only.
  const std::string text = decoder_constants_glsl({placed_nodes(scene).front().node->object->decoder},
                                                  options.precision, options.arithmetic);
  EXPECT_TRUE(text.starts_with("#extension GL_AMD_gpu_shader_half_float : require\n"));
  for (std::size_t at = text.find("e-0"); at != std::string::npos; at = text.find("e-0", at + 1))
    EXPECT_EQ(text.substr(at + 4, 2), "hf") << text.substr(at, 12);
  try {
    EXPECT_GT(compare(renderer().render(scene, view, options), reference, 0).psnr_db, 40);
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("GL_AMD_gpu_shader_half_float"), std::string::npos);
  }
}

TEST(Picture, ForwardShadingIsTheSamePicture) {
  const Scene scene = together(
      {placed(made_object({.seed = 1}), moved(-0.4, 0, 0)), placed(made_object({.seed = 2}), moved(0.5, 0.2, 0.3))});
  const View view = view_from({0, 1, 4}, 1);
  const Image deferred = renderer().render(scene, view, {{}, RenderOptions::Shading::deferred, {}});
  for (const auto weights : {RenderOptions::Weights::constants, RenderOptions::Weights::buffer}) {
    const Image forward = renderer().render(scene, view, {weights, RenderOptions::Shading::forward, {}});
    EXPECT_LE(compare(deferred, forward, 0).largest, 1);
  }
}

TEST(Picture, NodeFarFromTheOrigin) {
  View view = view_from(Vec3(1e6, 2e6, -1e6) + Vec3(0, 1, 3));
  view.camera.target = Vec3(1e6, 2e6, -1e6);
  expect_as_cast(placed(made_object(), moved(1e6, 2e6, -1e6)), view);
}

TEST(Picture, TinyAndHugeScale) {
  for (const double scale : {1e-6, 1e6}) {
    View view = view_from(Vec3(0, 1, 3) * scale);
    view.camera.near_plane *= scale;
    view.camera.far_plane *= scale;
    expect_as_cast(placed(made_object(), Affine(Eigen::Scaling(scale))), view);
  }
}

TEST(Picture, MirroredAndStretched) {
  const Affine mirror(Eigen::AngleAxisd(0.5, Vec3(1, 1, 0).normalized()) * Eigen::Scaling(-1.0, 1.2, 0.7));
  expect_as_cast(placed(made_object(), mirror), view_from({0.5, 1, 3}));
}

TEST(Picture, GeometryCrossingTheNearPlane) {
  View view = view_from({0, 0, 1.1});
  view.camera.target = {0.3, 0.1, 0};
  view.camera.near_plane = 0.4;
  expect_as_cast(scene_of(made_object()), view);
}

TEST(Picture, EyeInside) {
  View view = view_from({0, 0, 0});
  view.camera.target = {1, 0.2, 0.3};
  view.camera.near_plane = 0.05;
  expect_as_cast(scene_of(made_object()), view);
}

TEST(Picture, CoplanarDuplicateDrawnLaterWins) {
  const auto first = made_object({.seed = 1, .holes = false});
  auto second = std::make_shared<BakedObject>(*first);
  second->decoder = std::make_shared<const Decoder>(made_decoder(9));
  const View view = view_from({0, 1, 3});
  const Scene both = together({scene_of(first), scene_of(second)});
  expect_as_cast(both, view);
  EXPECT_EQ(renderer().render(both, view), renderer().render(scene_of(second), view));
}

TEST(Picture, OverlappingInstancesOfOneObject) {
  const auto object = made_object();
  expect_as_cast(together({scene_of(object), placed(object, Affine(Eigen::Translation3d(0.5, 0.1, 0.2) *
                                                                   Eigen::AngleAxisd(0.7, Vec3::UnitY())))}),
                 view_from({0, 1, 4}));
}

TEST(Picture, SeparatedPartChangesNoPixel) {
  const auto object = made_object();
  TriangleSet flags(object->triangle_count());
  for (std::size_t f = 0; f < flags.size() / 2; ++f) flags[f] = 1;
  auto a = std::make_shared<BakedObject>(*object), b = std::make_shared<BakedObject>(*object);
  a->sets[0].soup = subset(object->sets[0].soup, flags, 0, true);
  b->sets[0].soup = subset(object->sets[0].soup, flags, 0, false);
  b->decoder = std::make_shared<const Decoder>(*object->decoder);
  const View view = view_from({0.3, 1, 3});
  // The halves are uploaded relative to other centres, so depth differs in its last bits: allow single pixels at edges.
  const Difference d = compare(renderer().render(scene_of(object), view),
                               renderer().render(together({scene_of(a), scene_of(b)}), view), 1);
  EXPECT_LE(d.share_beyond, 0.0002);
}

TEST(Picture, BackgroundShowsThrough) {
  Scene scene = scene_of(made_object());
  scene.background = {0.2, 0.5, 0.8};
  expect_as_cast(scene, view_from({0, 1, 3}));
}

TEST(Picture, EmptySceneIsBackground) {
  Scene scene;
  scene.background = {1, 0, 0};
  const Image image = renderer().render(scene, view_from({0, 1, 3}));
  EXPECT_EQ(image.rgb[0], 255);
  EXPECT_EQ(image.rgb[1], 0);
}

TEST(Picture, FoldedRotationIsTheSamePicture) {
  const auto object = made_object();
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(0.3, 1, -0.5).normalized()).toRotationMatrix();
  Affine rotation = Affine::Identity();
  rotation.linear() = turn;
  auto folded = std::make_shared<BakedObject>(*object);
  std::vector<Vec3> positions = object->sets[0].soup.positions();
  for (Vec3& p : positions) p = turn * p;
  folded->sets[0].soup = Soup(positions, object->sets[0].soup.uvs(), object->sets[0].soup.faces());
  folded->decoder = std::make_shared<const Decoder>(fold_rotation(*object->decoder, turn, Axes::y_up, Axes::y_up));
  const View view = view_from({0.3, 1, 3});
  const Difference d =
      compare(renderer().render(placed(object, rotation), view), renderer().render(scene_of(folded), view), 1);
  EXPECT_LE(d.share_beyond, 0.001);
  EXPECT_GE(d.psnr_db, 60);
}

TEST(Picture, RealMicGeometry) {
  const auto mic = mic_object();
  if (!mic) GTEST_SKIP() << "REBAKE_TEST_DATA has no mic";
  View view = view_from({0, 2, 3.464});
  view.camera.near_plane = 2;
  view.camera.far_plane = 6;
  expect_as_cast(scene_of(mic), view);
}

TEST(Thumbnail, AveragesTheMiddleAndNeverEnlarges) {
  Image image{8, 2, {}};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 8; ++x)
      for (int c = 0; c < 3; ++c) image.rgb.push_back(static_cast<std::uint8_t>(x < 2 || x > 5 ? 255 : 10 * x + y));
  const Image small = thumbnail_of(image, 2, 1);              // half the size, of the middle four columns
  EXPECT_EQ(small, (Image{2, 1, {26, 26, 26, 46, 46, 46}}));  // 25.5 and 45.5
  EXPECT_EQ(thumbnail_of(small, 100, 100).rgb, small.rgb);
}

// Consecutive nodes of one object share bound buffers; copies with their own arrays do not. The picture is the same.
TEST(Picture, SharedObjectsMatchCopies) {
  const auto object = made_object({.columns = 24, .rows = 12, .cell = 9, .radius = 0.3});
  Scene copies, apart;
  for (int k = 0; k < 4; ++k) {
    Node node;
    node.object = object;
    node.to_parent.translation() = Vec3(0.5 * k - 0.75, 0.1 * k, -0.2 * k);
    // The third one is rotated, so that its decoder gets other view directions.
    if (k == 2) node.to_parent.linear() = Eigen::AngleAxisd(0.5, Vec3::UnitY()).toRotationMatrix();
    copies = with_added(copies, node, NodeId::none, static_cast<std::size_t>(k));
    auto own = std::make_shared<BakedObject>(*object);
    for (TextureSet& set : own->sets)
      set.soup = Soup(std::vector<Vec3>(set.soup.positions()), std::vector<Vec2>(set.soup.uvs()),
                      std::vector<Face>(set.soup.faces()));
    node.object = own;
    apart = with_added(apart, node, NodeId::none, static_cast<std::size_t>(k));
  }
  for (const int samples : {1, 4}) {
    const View view = view_from({1, 0.5, 3}, samples);
    expect_as_cast(copies, view);
    EXPECT_EQ(renderer().render(copies, view), renderer().render(apart, view)) << samples;
  }
}

}  // namespace
}  // namespace rebake::test
