// Folders of every layout round-trip; unedited folders are copied byte for byte.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/features/atlas/atlas.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "tests/support/made_scenes.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

Soup moved_part(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first, const Affine& motion) {
  return move_faces(soup, flags, first, motion, orthogonal_factor(motion.linear()));
}

namespace fs = std::filesystem;

class ByLayout : public ::testing::TestWithParam<Layout> {
 protected:
  std::shared_ptr<const BakedObject> object() const {
    return made_object(
        {.code = GetParam() == Layout::unsplit ? AlphaCode::plain : AlphaCode::halved, .layout = GetParam()});
  }
};
std::string layout_name(const ::testing::TestParamInfo<Layout>& instance) {
  return instance.param == Layout::split ? "split" : instance.param == Layout::chunked ? "chunked" : "unsplit";
}
INSTANTIATE_TEST_SUITE_P(Folder, ByLayout, ::testing::Values(Layout::split, Layout::chunked, Layout::unsplit),
                         layout_name);

TEST_P(ByLayout, UneditedFolderExportsByteForByte) {
  const TemporaryFolder temporary;
  export_scene(scene_of(object()), temporary.path() / "a", {});
  const Scene read = read_any(temporary.path() / "a", Axes::y_up);
  EXPECT_EQ(read.roots[0]->object->layout, GetParam());
  EXPECT_EQ(read.roots[0]->name, "a");
  // Trailing white space that Rebake never writes shows that files are copied, not rewritten.
  const std::string mlp = read_file(temporary.path() / "a/mlp.json") + "\n  ";
  write_text(temporary.path() / "a/mlp.json", mlp);
  const Scene again = read_any(temporary.path() / "a", Axes::y_up);
  const ExportReport report = export_scene(again, temporary.path() / "b", {});
  EXPECT_TRUE(report.one_folder);
  EXPECT_EQ(folder_bytes(temporary.path() / "a"), folder_bytes(temporary.path() / "b"));
}

TEST_P(ByLayout, FileThatChangedOnDiskIsNotCopied) {
  const TemporaryFolder temporary;
  export_scene(scene_of(object()), temporary.path() / "a", {});
  const Scene read = read_any(temporary.path() / "a", Axes::y_up);
  const auto before = folder_bytes(temporary.path() / "a");
  write_text(temporary.path() / "a" / feature_name(GetParam(), 0, 0), "something else");
  fs::remove(temporary.path() / "a" / geometry_name(GetParam(), 0, 0));
  export_scene(read, temporary.path() / "b", {});
  EXPECT_EQ(folder_bytes(temporary.path() / "b"), before);
}

TEST_P(ByLayout, DeletionKeepsTexelsAndDropsUnusedSpace) {
  const TemporaryFolder temporary;
  export_scene(scene_of(object()), temporary.path() / "a", {});
  Scene scene = read_any(temporary.path() / "a", Axes::y_up);
  const auto read = scene.roots[0]->object;
  const BakedObject& whole = *read;
  TriangleSet keep(whole.triangle_count(), 0);
  for (std::size_t f = 0; f < keep.size(); ++f) keep[f] = f % 10 < 2 ? 1 : 0;
  auto cut = std::make_shared<BakedObject>(whole);
  cut->sets[0].soup = subset(whole.sets[0].soup, keep, 0, true);
  scene = with_changed(scene, scene.roots[0]->id, [&](Node& n) { n.object = cut; });
  export_scene(scene, temporary.path() / "b", {});
  const auto back = read_any(temporary.path() / "b", Axes::y_up).roots[0]->object;
  ASSERT_EQ(back->triangle_count(), cut->triangle_count());
  EXPECT_LT(back->sets[0].texels->width() * back->sets[0].texels->height(),
            whole.sets[0].texels->width() * whole.sets[0].texels->height() / 3);
  const TexelReader texels_back(*back->sets[0].texels), texels_cut(*cut->sets[0].texels);
  for (std::size_t f = 0; f < back->triangle_count(); ++f) {
    const auto corner = [f](const BakedObject& o, std::size_t k) { return o.sets[0].soup.faces()[f][k]; };
    for (int a = 0; a <= 8; ++a)
      for (int b = 0; a + b <= 8; ++b) {
        const auto at = [&](const BakedObject& o, const TexelReader& texels) {
          const auto& uv = o.sets[0].soup.uvs();
          const Vec2 p = (uv[corner(o, 0)] * a + uv[corner(o, 1)] * b + uv[corner(o, 2)] * (8 - a - b)) / 8;
          return texels.sample(p.x(), p.y());
        };
        EXPECT_EQ(at(*back, texels_back), at(*cut, texels_cut)) << "face " << f;
      }
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(back->sets[0].soup.positions()[corner(*back, k)], cut->sets[0].soup.positions()[corner(*cut, k)]);
  }
}

TEST(Folder, ChunkedExportHasEightNonEmptyChunks) {
  const TemporaryFolder temporary;
  export_scene(scene_of(made_object({.columns = 3, .rows = 1, .layout = Layout::chunked})), temporary.path() / "a", {});
  for (std::size_t j = 0; j < 8; ++j)
    EXPECT_NE(read_file(temporary.path() / "a" / geometry_name(Layout::chunked, 0, j)).find("\nf "), std::string::npos);
  EXPECT_FALSE(fs::exists(temporary.path() / "a" / geometry_name(Layout::chunked, 0, 8)));
}

TEST(Folder, LayoutsConvert) {
  const TemporaryFolder temporary;
  export_scene(scene_of(made_object()), temporary.path() / "split", {});
  const Scene split = read_any(temporary.path() / "split", Axes::y_up);
  export_scene(split, temporary.path() / "unsplit", {.layout = Layout::unsplit, .sources = {}});
  const auto unsplit = read_any(temporary.path() / "unsplit", Axes::y_up).roots[0]->object;
  EXPECT_EQ(unsplit->layout, Layout::unsplit);
  const FeatureTexture& split_texels = *split.roots[0]->object->sets[0].texels;
  const TexelReader a(split_texels), b(*unsplit->sets[0].texels);
  for (int y = 0; y < split_texels.height(); ++y)
    for (int x = 0; x < split_texels.width(); ++x) {
      ASSERT_EQ(a.at(x, y).opaque(), b.at(x, y).opaque());
      // Converting halved to plain alpha codes does not change decoded features.
      if (a.at(x, y).opaque()) {
        const auto one = decode_features(a.at(x, y), AlphaCode::halved),
                   other = decode_features(b.at(x, y), AlphaCode::plain);
        for (std::size_t c = 0; c < 8; ++c) ASSERT_NEAR(one[c], other[c], 1e-15);
      } else {
        ASSERT_EQ(b.at(x, y), empty_texel(AlphaCode::plain));
      }
    }
  export_scene(read_any(temporary.path() / "unsplit", Axes::y_up), temporary.path() / "chunked",
               {.layout = Layout::chunked, .sources = {}});
  EXPECT_EQ(read_any(temporary.path() / "chunked", Axes::y_up).roots[0]->object->layout, Layout::chunked);
  EXPECT_EQ(folder_bytes(temporary.path() / "chunked")["shape0.pngfeat0.png"],
            folder_bytes(temporary.path() / "split")["shape0.pngfeat0.png"]);
}

TEST(Folder, ObjectsWithEqualDecodersShareAFolder) {
  const TemporaryFolder temporary;
  Scene scene = scene_of(made_object({.seed = 1}), "a");
  Node node;
  node.object = made_object({.seed = 1});
  node.to_parent.translation() = Vec3(3, 0, 0);
  scene = with_added(scene, node, NodeId::none, 9);
  EXPECT_TRUE(export_scene(scene, temporary.path() / "one", {}).one_folder);
  EXPECT_EQ(read_any(temporary.path() / "one", Axes::y_up).roots[0]->object->triangle_count(), 512U);
  // Nodes with equal rotations still share a folder.
  const Affine turn(Eigen::AngleAxisd(0.3, Vec3::UnitY()));
  const auto turned = [&](Node& n) { n.to_parent = turn * n.to_parent; };
  const Scene both = with_changed(with_changed(scene, scene.roots[0]->id, turned), scene.roots[1]->id, turned);
  EXPECT_TRUE(export_scene(both, temporary.path() / "one", {}).one_folder);
  const ExportReport report =
      export_scene(with_changed(scene, scene.roots[0]->id, turned), temporary.path() / "two", {});
  EXPECT_FALSE(report.one_folder);
  EXPECT_EQ(report.folders, 2U);
  EXPECT_TRUE(fs::exists(temporary.path() / "two/scene.json"));
}

TEST(Folder, SavedSceneKeepsEveryNode) {
  const TemporaryFolder temporary;
  Scene scene = scene_of(made_object(), "a b/c");
  scene.background = {0.25, 0.5, 1};
  scene.views["front"] = {};
  Node group;
  group.name = "group";
  group.locked = true;
  Node child;
  child.name = "shape0.obj";  // a node name that must not become a file name
  child.visible = false;
  child.object = scene.roots[0]->object;
  child.to_parent = Affine(Eigen::Translation3d(1.0 / 3, 2, 3) * Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()) *
                           Eigen::Scaling(2.0, -1.0, 0.5));
  group.children.push_back(std::make_shared<const Node>(child));
  scene = with_added(scene, group, NodeId::none, 9);
  auto turned = std::make_shared<BakedObject>(*made_object({.seed = 4}));
  TriangleSet flags(turned->triangle_count(), 0);
  for (std::size_t f = 20; f < 50; ++f) flags[f] = 1;
  turned->sets[0].soup = moved_part(turned->sets[0].soup, flags, 0, Affine(Eigen::AngleAxisd(0.4, Vec3::UnitX())));
  child.object = turned;
  child.name = "turned";
  scene = with_added(scene, child, NodeId::none, 9);
  format_named("rebake").write(scene, temporary.path() / "s", {}, {});
  const Scene back = read_any(temporary.path() / "s", Axes::y_up);
  const auto before = placed_nodes(scene), after = placed_nodes(back);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_EQ(before[k].node->name, after[k].node->name);
    EXPECT_EQ(before[k].node->visible, after[k].node->visible);
    EXPECT_EQ(before[k].node->locked, after[k].node->locked);
    EXPECT_EQ(before[k].node->to_parent.matrix(), after[k].node->to_parent.matrix());
  }
  EXPECT_EQ(back.background, scene.background);
  EXPECT_EQ(back.views, scene.views);
  EXPECT_EQ(after[0].node->object, after[2].node->object);  // an object shared by two nodes is stored once
  const Soup &a = turned->sets[0].soup, &b = after[3].node->object->sets[0].soup;
  ASSERT_NE(b.rotations(), nullptr);
  for (std::size_t f = 0; f < a.faces().size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ((*a.rotations())[a.faces()[f][k]], (*b.rotations())[b.faces()[f][k]]);
}

// Other programs may write objects with children, which no edit expects.
TEST(Folder, ObjectsWithChildrenAreReadAsGroupsInTheSamePlaces) {
  const TemporaryFolder temporary;
  Scene scene = scene_of(made_object(), "upper");
  Node lower;
  lower.name = "lower";
  lower.object = scene.roots[0]->object;
  lower.to_parent = Affine(Eigen::Translation3d(0, -2, 0));
  scene = with_added(scene, lower, NodeId::none, 9);
  const Affine place(Eigen::Translation3d(5, 0, 0) * Eigen::AngleAxisd(0.5, Vec3::UnitY()));
  scene = with_changed(scene, scene.roots[0]->id, [&](Node& node) {
    node.to_parent = place;
    node.locked = true;
    NodeMotion motion;
    motion.place.push_back({0, place});
    motion.bends["sway"].degrees.push_back({0, 10});
    node.motion = std::make_shared<const NodeMotion>(motion);
  });
  format_named("rebake").write(scene, temporary.path() / "s", {}, {});
  const fs::path file = temporary.path() / "s/scene.json";
  nlohmann::json root = nlohmann::json::parse(read_file(file));
  root["nodes"][0]["children"] = nlohmann::json::array({root["nodes"][1]});
  root["nodes"].erase(1);
  std::ofstream(file) << root;

  const auto nodes = placed_nodes(read_any(temporary.path() / "s", Axes::y_up));
  ASSERT_EQ(nodes.size(), 3U);
  const Node &group = *nodes[0].node, &upper = *nodes[1].node;
  EXPECT_FALSE(group.object);
  EXPECT_EQ(group.name, "upper and children");
  EXPECT_EQ(upper.name, "upper");
  EXPECT_EQ(nodes[2].node->name, "lower");
  EXPECT_EQ(upper.object, nodes[2].node->object);
  EXPECT_EQ(nodes[1].to_world.matrix(), place.matrix());
  EXPECT_EQ(nodes[2].to_world.matrix(), (place * lower.to_parent).matrix());
  EXPECT_TRUE(nodes[1].locked && nodes[2].locked);
  ASSERT_TRUE(group.motion && upper.motion);
  EXPECT_EQ(group.motion->place.size(), 1U);
  EXPECT_TRUE(group.motion->bends.empty() && upper.motion->place.empty());
  EXPECT_EQ(upper.motion->bends.size(), 1U);
}

TEST(Folder, NamesThatDifferInCapitalsGetDifferentFolders) {
  EXPECT_EQ(folder_name("ball", {"Ball"}), "ball_2");
  EXPECT_EQ(folder_name("other", {"Ball"}), "other");
}

TEST(Folder, AForeignFileInAnObjectFolderIsKept) {
  const TemporaryFolder temporary;
  const Scene scene = scene_of(made_object(), "ball");
  format_named("rebake").write(scene, temporary.path() / "s", {}, {});
  format_named("rebake").write(scene, temporary.path() / "s", {}, {});
  write_text(temporary.path() / "s/ball/scene.json", "mine");
  EXPECT_THROW(format_named("rebake").write(scene, temporary.path() / "s", {}, {}), FileError);
  EXPECT_EQ(read_file(temporary.path() / "s/ball/scene.json"), "mine");
}

TEST(Folder, ExportsSayWhatTheyLeaveOut) {
  const TemporaryFolder temporary;
  Scene scene = scene_of(made_object(), "ball");
  scene = with_changed(scene, scene.roots[0]->id, [](Node& node) {
    node.locked = true;
    node.saved_selections["all"] = std::make_shared<const TriangleSet>(node.object->triangle_count(), 1);
    auto object = std::make_shared<BakedObject>(*node.object);
    object->other_members = {{"author", "\"a\""}};
    node.object = object;
  });
  Node other = *scene.roots[0];
  other.id = NodeId::none;
  auto object = std::make_shared<BakedObject>(*other.object);
  object->other_members = {{"author", "\"b\""}};
  other.object = object;
  scene = with_added(scene, other, NodeId::none, 9);
  std::string said;
  for (const std::string& note : export_scene(scene, temporary.path() / "out", {}).notes) said += note + "\n";
  for (const char* part : {"locks of nodes", "stored selections", "\"author\" of \"ball.2\""})
    EXPECT_NE(said.find(part), std::string::npos) << part << " in " << said;
}

TEST(Folder, FeaturePngsPreserveBytesWithoutColourChunks) {
  const auto texture = made_object()->sets[0].texels;
  const std::string png = write_feature_png(*texture, 0);
  for (const char* chunk : {"gAMA", "cHRM", "iCCP", "sRGB"}) EXPECT_EQ(png.find(chunk), std::string::npos) << chunk;
  const FeatureTexture back =
      read_feature_images(png, "a", write_feature_png(*texture, 1), "b", AlphaCode::halved).texels;
  const TexelReader were(*texture), are(back);
  for (int y = 0; y < back.height(); ++y)
    for (int x = 0; x < back.width(); ++x) ASSERT_EQ(are.at(x, y), were.at(x, y));
}

// Reading a folder cancels its task group if one file is bad. A texture under construction must still get all tiles.
TEST(Folder, TexturesAreCompleteIfTheirTaskGroupIsCancelled) {
  const auto texture = made_object()->sets[0].texels;
  const std::string feat0 = write_feature_png(*texture, 0), feat1 = write_feature_png(*texture, 1);
  const TexelReader texels(*texture);
  std::optional<FeatureTexture> read, made;
  tbb::task_group_context around;
  tbb::parallel_for(
      0, 1,
      [&](int) {
        around.cancel_group_execution();
        read = read_feature_images(feat0, "a", feat1, "b", texture->alpha_code()).texels;
        made = FeatureTexture::from_rows(texture->width(), texture->height(), texture->alpha_code(),
                                         [&](int y, Texel* row) {
                                           for (int x = 0; x < texture->width(); ++x) row[x] = texels.at(x, y);
                                         });
      },
      around);
  ASSERT_TRUE(read && made);
  const TexelReader texels_read(*read), texels_made(*made);
  for (int y = 0; y < texture->height(); ++y)
    for (int x = 0; x < texture->width(); ++x) {
      ASSERT_EQ(texels_read.at(x, y), texels.at(x, y));
      ASSERT_EQ(texels_made.at(x, y), texels.at(x, y));
    }
}

// An object with one patch over most of a texture of `side`² texels, and one small patch.
std::shared_ptr<const BakedObject> wide_object(int side) {
  const auto uv = [&](double x, double y) { return Vec2((x + 0.5) / side, 1 - (y + 0.5) / side); };
  const double far = side - 40;
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {3, 0, 0}, {2, 1, 0}};
  const std::vector<Vec2> uvs{
      uv(0, 0), uv(far, 0), uv(0, far), uv(far + 5, far + 5), uv(far + 20, far + 5), uv(far + 5, far + 20)};
  auto object = std::make_shared<BakedObject>();
  object->decoder = std::make_shared<const Decoder>(made_decoder(1));
  object->sets.push_back({Soup(positions, uvs, {Face{0, 1, 2}, Face{3, 4, 5}}),
                          std::make_shared<const FeatureTexture>(
                              FeatureTexture::from_rows(side, side, AlphaCode::halved, [&](int y, Texel* row) {
                                for (int x = 0; x < side; ++x) {
                                  const auto value = static_cast<std::uint8_t>(1 + (x * 7 + y * 3) % 250);
                                  row[x] = {{value, 2, 3, 200}, {4, value, 5, 150}};
                                }
                              }))});
  return object;
}

// Sizes around 4096, the usual maximum; powers of two and others.
TEST(Folder, UneditedTexturesOfAnySizeAreCopiedAndEditedOnesKeepTexels) {
  for (const int side :
       is_deep ? std::vector{64, 1000, 4095, 4096, 4097, 4200, 5000, 8192} : std::vector{64, 999, 4200}) {
    const TemporaryFolder temporary;
    BakedObject made = *wide_object(side);
    export_scene(scene_of(std::make_shared<const BakedObject>(made)), temporary.path() / "made", {});
    // The exporter may have packed its own texture again, so the folder on disk is the reference.
    const Scene read = read_any(temporary.path() / "made", Axes::y_up);
    export_scene(read, temporary.path() / "copy", {});
    EXPECT_EQ(folder_bytes(temporary.path() / "copy"), folder_bytes(temporary.path() / "made")) << side;
    // Without the small patch, texels of the large one must not change.
    Scene edited = read;
    edited = with_changed(edited, edited.roots[0]->id, [](Node& node) {
      auto object = std::make_shared<BakedObject>(*node.object);
      TriangleSet flags(object->sets[0].soup.triangle_count(), 0);
      flags[0] = 1;
      object->sets[0].soup = subset(object->sets[0].soup, flags, 0, true);
      node.object = object;
    });
    export_scene(edited, temporary.path() / "edited", {});
    const auto object = read_any(temporary.path() / "edited", Axes::y_up).roots[0]->object;
    ASSERT_EQ(object->sets.size(), 1U) << side;
    const FeatureTexture& texture = *object->sets[0].texels;
    const TexelReader texels(texture);
    EXPECT_LE(texture.width(), side);
    const Vec2 corner = object->sets[0].soup.uvs()[0];
    EXPECT_EQ(texels.at(static_cast<int>(corner.x() * texture.width()),
                        static_cast<int>((1 - corner.y()) * texture.height())),
              (Texel{{1, 2, 3, 200}, {4, 1, 5, 150}}));
  }
}

TEST(Folder, PageSizeRepacksLargerTextures) {
  const TemporaryFolder temporary;
  export_scene(scene_of(made_object()), temporary.path() / "made", {});
  const Scene read = read_any(temporary.path() / "made", Axes::y_up);
  const ExportReport report =
      export_scene(read, temporary.path() / "small", {.layout = {}, .sources = {}, .page_side = 128});
  const Scene small = read_any(temporary.path() / "small", Axes::y_up);
  for (const TextureSet& set : small.roots[0]->object->sets) {
    EXPECT_LE(set.texels->width(), 128);
    EXPECT_LE(set.texels->height(), 128);
  }
  ASSERT_FALSE(report.notes.empty());
  EXPECT_NE(report.notes.front().find("edited texture sets were repacked without"), std::string::npos)
      << report.notes.front();
}

TEST(Folder, EmptyChunksContainADroppedPlaceholder) {
  for (int columns = 1; columns <= 3; ++columns) {
    const TemporaryFolder temporary;
    const auto object = made_object({.columns = columns, .rows = 1, .layout = Layout::chunked});
    export_scene(scene_of(object), temporary.path() / "a", {});
    const auto back = read_any(temporary.path() / "a", Axes::y_up).roots[0]->object;
    EXPECT_EQ(back->triangle_count(), object->triangle_count());
    for (std::size_t j = 0; j < chunks_per_set; ++j)
      EXPECT_NE(read_file(temporary.path() / "a" / geometry_name(Layout::chunked, 0, j)).find("\nf "),
                std::string::npos);
    export_scene(read_any(temporary.path() / "a", Axes::y_up), temporary.path() / "b", {});
    EXPECT_EQ(folder_bytes(temporary.path() / "b"), folder_bytes(temporary.path() / "a"));
  }
}

TEST(Folder, RotationsOfFewChunkedTrianglesRoundTrip) {
  const TemporaryFolder temporary;
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 3, .rows = 1, .layout = Layout::chunked}));
  object->sets[0].soup =
      moved_part(object->sets[0].soup, {0, 0, 1, 1, 0, 0}, 0, Affine(Eigen::AngleAxisd(0.4, Vec3::UnitX())));
  format_named("rebake").write(scene_of(object), temporary.path() / "s", {}, {});
  const auto back = read_any(temporary.path() / "s", Axes::y_up).roots[0]->object;
  const Soup &a = object->sets[0].soup, &b = back->sets[0].soup;
  ASSERT_NE(b.rotations(), nullptr);
  for (std::size_t f = 0; f < b.faces().size(); ++f)
    EXPECT_EQ((*b.rotations())[b.faces()[f][0]], (*a.rotations())[a.faces()[f % 6][0]]) << f;
}

TEST(Pack, TwoTexturesBecomeOne) {
  const auto a = made_object({.columns = 4, .rows = 2}), b = made_object({.columns = 4, .rows = 2, .seed = 2});
  const PackedSets packed = pack({a->sets[0], b->sets[0]}, 4096, AlphaCode::halved);
  ASSERT_EQ(packed.sets.size(), 1U);
  EXPECT_EQ(packed.sets[0].soup.triangle_count(), a->triangle_count() + b->triangle_count());
  EXPECT_EQ(packed.sets[0].texels->opaque_count(), a->opaque_texel_count() + b->opaque_texel_count());
}

TEST(Pack, SmallTexturesSplitIntoSeveral) {
  const auto object = made_object();
  const PackedSets packed = pack(object->sets, 64, AlphaCode::halved);
  EXPECT_GT(packed.sets.size(), 1U);
  std::size_t triangles = 0;
  for (const TextureSet& set : packed.sets) {
    EXPECT_LE(set.texels->width(), 64);
    EXPECT_LE(set.texels->height(), 64);
    triangles += set.soup.triangle_count();
  }
  EXPECT_EQ(triangles, object->triangle_count());
}

}  // namespace
}  // namespace rebake::test
