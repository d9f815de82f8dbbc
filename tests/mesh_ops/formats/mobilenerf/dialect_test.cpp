// Dialects of other tools: read into the published form, and written back as they were.
#include "mesh_ops/formats/mobilenerf/dialect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/mlp_json.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "mesh_ops/select/regions.h"
#include "mesh_ops/texture/linear_filter.h"
#include "tests/support/document_fixture.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

std::vector<Dialect> dialects() {
  return {{true, false, false, {}},           {false, true, false, {}},
          {false, false, true, {}},           {false, false, false, AlphaCode::plain},
          {false, false, false, {}, true},    {true, true, true, AlphaCode::plain},
          {false, false, false, {}, false, 3}};
}

// What the decoder of a file returns in its dialect, by the definition of the dialect: eleven inputs, layer by layer.
Color by_definition(const Decoder& file, const Dialect& dialect, const std::array<double, 8>& features,
                    Vec3 direction) {
  if (dialect.half_direction) direction = (direction + Vec3::Ones()) / 2;
  Eigen::VectorXd inputs(11);
  for (int k = 0; k < 8; ++k) inputs[dialect.direction_first ? 3 + k : k] = features[static_cast<std::size_t>(k)];
  for (int k = 0; k < 3; ++k) inputs[dialect.direction_first ? k : 8 + k] = direction[k];
  const Eigen::VectorXd first = (file.weights0.transpose() * inputs + file.bias0).cwiseMax(0);
  const Eigen::VectorXd second = (file.weights1.transpose() * first + file.bias1).cwiseMax(0);
  const Eigen::Vector3d out = file.weights2.transpose() * second + file.bias2;
  return (1 + (-out.array()).exp()).inverse();
}

TEST(Dialect, DecodersGiveTheSameColours) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Dialect& dialect : dialects())
    for (int round = 0; round < 20; ++round) {
      const Decoder file = made_decoder(static_cast<unsigned>(round), 16, 24);
      std::array<double, 8> features{};
      for (double& feature : features) feature = unit(random);
      const Vec3 direction = Vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5).normalized();
      const Color expected = by_definition(file, dialect, features, direction);
      EXPECT_LE((decode(from_dialect(file, dialect), features, direction) - expected).cwiseAbs().maxCoeff(), 1e-14);
    }
}

TEST(Dialect, DecodersRoundTrip) {
  for (const Dialect& dialect : dialects()) {
    const Decoder file = made_decoder(3, 16, 24), back = to_dialect(from_dialect(file, dialect), dialect);
    EXPECT_EQ(back.weights0, file.weights0);
    EXPECT_LE((back.bias0 - file.bias0).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_EQ(back.weights2, file.weights2);
  }
}

// Texels at the triangles' centres, which stay when an export packs the textures again, and how often they come.
std::map<std::array<std::uint8_t, 8>, int> texels_at_centers(const BakedObject& object) {
  std::map<std::array<std::uint8_t, 8>, int> counts;
  for (const TextureSet& set : object.sets) {
    const TexelReader reader(*set.texels);
    for (const Face& face : set.soup.faces()) {
      Vec2 center = Vec2::Zero();
      for (const std::uint32_t vertex : face) center += set.soup.uvs()[vertex] / 3;
      const Texel& texel = reader.sample(center.x(), center.y());
      std::array<std::uint8_t, 8> bytes{};
      std::copy(texel.feat0.begin(), texel.feat0.end(), bytes.begin());
      std::copy(texel.feat1.begin(), texel.feat1.end(), bytes.begin() + 4);
      ++counts[bytes];
    }
  }
  return counts;
}

class DialectFolder : public DocumentTest {
 protected:
  // The published ball as a folder in a dialect.
  fs::path written(const Dialect& dialect) const {
    Scene scene = read_any(path("sources/ball"), Axes::y_up);
    scene = with_changed(scene, scene.roots[0]->id, [&](Node& node) {
      auto object = std::make_shared<BakedObject>(*node.object);
      object->dialect = dialect;
      if (dialect.linear != 0)
        for (TextureSet& set : object->sets)
          set.texels = std::make_shared<const FeatureTexture>(subdivided(*set.texels, dialect.linear));
      node.object = object;
    });
    export_scene(scene, path("dialect"), {});
    return path("dialect");
  }
  static void expect_texels(const BakedObject& a, const BakedObject& b) {
    for (const int image : {0, 1})
      EXPECT_TRUE(write_feature_png(*a.sets[0].texels, image) == write_feature_png(*b.sets[0].texels, image)) << image;
  }
};

TEST_F(DialectFolder, ReadingUndoesWriting) {
  const auto published_ball = read_baked_folder(path("sources/ball"), Axes::y_up);
  for (const Dialect& dialect : dialects()) {
    const auto read = read_baked_folder(written(dialect), {Axes::y_up, dialect});
    EXPECT_LE((read->decoder->bias0 - published_ball->decoder->bias0).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_EQ(read->decoder->weights0, published_ball->decoder->weights0);
    if (dialect.no_holes || dialect.linear != 0) continue;
    if (dialect.alpha)
      EXPECT_EQ(read->sets[0].texels->alpha_code(), AlphaCode::plain);
    else
      expect_texels(*read, *published_ball);
  }
}

TEST_F(DialectFolder, ChannelsAreSwappedInTheFiles) {
  const auto plain = read_baked_folder(path("sources/ball"), Axes::y_up);
  const auto swapped = read_baked_folder(written({false, false, true, {}}), Axes::y_up);
  const TexelReader a(*plain->sets[0].texels), b(*swapped->sets[0].texels);
  for (int k = 0; k < 50; ++k) {
    const Texel x = a.at(k, 5), y = b.at(k, 5);
    EXPECT_EQ(x.feat0[0], y.feat0[2]);
    EXPECT_EQ(x.feat1[2], y.feat1[0]);
    EXPECT_EQ(x.feat0[3], y.feat0[3]);
  }
}

TEST_F(DialectFolder, WithoutHolesEveryTexelIsOpaque) {
  const Dialect dialect{.no_holes = true};
  const Scene scene = read_any(path("sources/ball"), {Axes::y_up, dialect});
  const auto plain = read_baked_folder(path("sources/ball"), Axes::y_up);
  const FeatureTexture &now = *scene.roots[0]->object->sets[0].texels, &before = *plain->sets[0].texels;
  const auto all = static_cast<std::uint64_t>(now.width()) * static_cast<std::uint64_t>(now.height());
  EXPECT_EQ(now.opaque_count(), all);
  ASSERT_EQ(assumptions_of(scene).size(), 1U);
  EXPECT_NE(assumptions_of(scene)[0].find(std::to_string(all - before.opaque_count()) + " texels with red 0"),
            std::string::npos)
      << assumptions_of(scene)[0];
  const TexelReader a(now), b(before);
  for (int y = 0; y < now.height(); ++y)
    for (int x = 0; x < now.width(); ++x) {
      Texel expected = b.at(x, y);
      if (!expected.opaque()) expected.feat0[0] = 1;
      ASSERT_EQ(a.at(x, y), expected);
    }
}

TEST_F(DialectFolder, UneditedFoldersExportByteForByte) {
  for (const Dialect& dialect : dialects()) {
    const fs::path folder = written(dialect);
    export_scene(read_any(folder, {Axes::y_up, dialect}), path("copy"), {});
    EXPECT_EQ(folder_bytes(path("copy")), folder_bytes(folder));
  }
}

TEST_F(DialectFolder, EditedFoldersKeepTheirDialect) {
  for (const Dialect& dialect : dialects()) {
    Scene scene = read_any(written(dialect), {Axes::y_up, dialect});
    scene = apply(scene,
                  read_edit({{"op", "select"}, {"half_space", {{"point", {0, 0, 0}}, {"normal", {0, 1, 0}}}}}, scene))
                .scene;
    scene = apply(scene, read_edit({{"op", "delete"}}, scene)).scene;
    export_scene(scene, path("edited"), {});
    const Scene back = read_any(path("edited"), {Axes::y_up, dialect});
    const BakedObject &a = *scene.roots[0]->object, &b = *back.roots[0]->object;
    EXPECT_EQ(a.triangle_count(), b.triangle_count());
    EXPECT_LE((a.decoder->bias0 - b.decoder->bias0).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_EQ(a.opaque_texel_count() > 0, b.opaque_texel_count() > 0);
  }
}

// Between an object's texels the picture shows their linear mixture, and exports write the texels themselves.
TEST_F(DialectFolder, LinearFilteringKeepsTheTexelsOfTheFiles) {
  const auto plain = read_baked_folder(path("sources/ball"), Axes::y_up);
  const fs::path folder = written({.linear = 3});
  const auto coarse = read_baked_folder(folder, Axes::y_up);
  expect_texels(*coarse, *plain);
  const auto fine = read_baked_folder(folder, {Axes::y_up, {.linear = 3}});
  EXPECT_EQ(fine->sets[0].texels->width(), 3 * plain->sets[0].texels->width());
  EXPECT_TRUE(is_subdivided(*fine->sets[0].texels, 3));
}

// An eraser clears single fine texels, which no coarse texture can show.
TEST_F(DialectFolder, FoldersForLinearFilteringBecomeNearestWhenNeeded) {
  const fs::path folder = written({.linear = 3});
  Scene scene = read_any(folder, {Axes::y_up, {.linear = 3}});
  scene = apply(scene, read_edit({{"op", "erase"}, {"sphere", {{"center", {0, 1, 0}}, {"radius", 0.3}}}}, scene)).scene;
  const ExportReport report = export_scene(scene, path("edited"), {});
  EXPECT_TRUE(std::any_of(report.notes.begin(), report.notes.end(), [](const std::string& note) {
    return note.find("written for nearest sampling, 3 times as fine") != std::string::npos;
  }));
  const auto back = read_baked_folder(path("edited"), Axes::y_up);
  EXPECT_TRUE(texels_at_centers(*back) == texels_at_centers(*scene.roots[0]->object));
}

// One texture for several sets is packed, off the grid of the original texels.
TEST_F(DialectFolder, UnsplitFoldersOfSeveralSetsAreForNearestSampling) {
  const Scene scene = read_any(written({.linear = 3}), {Axes::y_up, {.linear = 3}});
  const Scene two = with_changed(scene, scene.roots[0]->id, [&](Node& node) {
    auto object = std::make_shared<BakedObject>(*node.object);
    object->sets.push_back(object->sets[0]);
    object->sets[1].texels = std::make_shared<const FeatureTexture>(*object->sets[0].texels);
    node.object = object;
  });
  const ExportReport report = export_scene(two, path("unsplit"), {.layout = Layout::unsplit, .sources = {}});
  EXPECT_TRUE(std::any_of(report.notes.begin(), report.notes.end(), [](const std::string& note) {
    return note.find("open the folder without linear") != std::string::npos;
  }));
  auto expected = texels_at_centers(*two.roots[0]->object);
  EXPECT_EQ(read_baked_folder(path("unsplit"), Axes::y_up)->triangle_count(), two.roots[0]->object->triangle_count());
  std::size_t same = 0;
  for (const auto& [texel, count] : texels_at_centers(*read_baked_folder(path("unsplit"), Axes::y_up))) {
    // Alpha is plain in unsplit folders.
    same += std::any_of(expected.begin(), expected.end(), [&, texel = texel](const auto& one) {
      return std::equal(texel.begin(), texel.begin() + 3, one.first.begin()) &&
             std::equal(texel.begin() + 4, texel.begin() + 7, one.first.begin() + 4);
    });
  }
  EXPECT_EQ(same, texels_at_centers(*read_baked_folder(path("unsplit"), Axes::y_up)).size());
}

TEST_F(DialectFolder, LinearTakesOddFactors) {
  Document document;
  for (const int factor : {0, 2, 4, 11})
    EXPECT_THROW(
        act(document, nlohmann::json{{"op", "import"}, {"path", path("sources/ball").string()}, {"linear", factor}}),
        FieldError);
}

TEST_F(DialectFolder, RebakeScenesAreInThePublishedForm) {
  const Dialect dialect{true, true, true, AlphaCode::plain};
  const Scene scene = read_any(written(dialect), {Axes::y_up, dialect});
  format_named("rebake").write(scene, path("scene"), {}, {});
  const Scene back = read_any(path("scene"), Axes::y_up);
  const BakedObject &a = *scene.roots[0]->object, &b = *back.roots[0]->object;
  EXPECT_EQ(*a.decoder, *b.decoder);
  EXPECT_EQ(b.dialect, Dialect{});
  EXPECT_EQ(b.sets[0].texels->alpha_code(), AlphaCode::halved);
}

TEST_F(DialectFolder, ImportsAndProjectsKeepTheDialect) {
  const Dialect dialect{true, true, true, AlphaCode::plain};
  const fs::path folder = written(dialect);
  Document document;
  act(document, nlohmann::json{{"op", "import"},
                               {"path", folder.string()},
                               {"half_direction", true},
                               {"direction_first", true},
                               {"bgr", true},
                               {"alpha", "plain"}});
  EXPECT_EQ(document.scene().roots[0]->object->dialect, dialect);
  Document published_form;
  import(published_form);
  for (const char* field : {"half_direction", "direction_first", "bgr", "alpha", "no_holes", "linear"})
    EXPECT_FALSE(to_json(published_form.history().edits()[0]).contains(field)) << "earlier versions do not know it";
  document.save(path("a.rebake"), {});
  const Scene opened = Document::open(path("a.rebake"), {}, {}).scene();
  EXPECT_EQ(opened.roots[0]->object->dialect, dialect);
  export_scene(opened, path("copy"), {});
  EXPECT_EQ(folder_bytes(path("copy")), folder_bytes(folder));
}

TEST_F(DialectFolder, OneFolderOfTwoDialectsIsPublished) {
  const Dialect dialect{false, false, true, {}};
  Document document;
  import(document);
  act(document, nlohmann::json{{"op", "import"}, {"path", written(dialect).string()}, {"bgr", true}, {"as", "other"}});
  const ExportReport report = export_scene(document.scene(), path("both"), {});
  ASSERT_TRUE(report.one_folder);
  const Scene back = read_any(path("both"), Axes::y_up);
  EXPECT_EQ(back.roots[0]->object->triangle_count(), 2 * document.scene().roots[0]->object->triangle_count());
  auto expected = texels_at_centers(*document.scene().roots[0]->object);
  for (auto& [texel, number] : expected) number *= 2;
  EXPECT_TRUE(texels_at_centers(*back.roots[0]->object) == expected);
}

}  // namespace
}  // namespace rebake::test
