// Folders of nerf2mesh: read, drawn, edited and written back.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/nerf2mesh/nerf2mesh_folder.h"
#include "mesh_ops/formats/nerf2mesh/nerf2mesh_mlp.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/texture/decoder_bounds.h"
#include "mesh_ops/training/texel_colors.h"
#include "tests/support/made_scenes.h"
#include "tests/support/nerf2mesh_example.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

Scene with_first_triangle_deleted(const Scene& scene) {
  Node node = *scene.roots.front();
  BakedObject object = *node.object;
  TriangleSet kept(object.sets.front().soup.triangle_count(), 1);
  kept.front() = 0;
  object.sets.front().soup = subset(object.sets.front().soup, kept, 0, true);
  node.object = std::make_shared<const BakedObject>(std::move(object));
  Scene result = scene;
  result.roots.front() = std::make_shared<const Node>(std::move(node));
  return result;
}

TEST(Nerf2Mesh, ColoursFollowThePublishedFormula) {
  for (const int hidden : {4, 32, 64}) {
    const TemporaryFolder folder;
    const Nerf2MeshNumbers numbers = write_nerf2mesh_example(folder.path() / "n", {1, hidden, false, 64, 5});
    const auto object = read_nerf2mesh_folder(folder.path() / "n");
    const TexelReader texels(*object->sets.front().texels);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (int round = 0; round < 200; ++round) {
      const Texel& texel = texels.at(static_cast<int>(random() % 64), static_cast<int>(random() % 64));
      const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
      const Vec3 diffuse = Vec3(texel.feat0[1], texel.feat0[2], texel.feat0[3]) / 255,
                 specular = Vec3(texel.feat1[0], texel.feat1[1], texel.feat1[2]) / 255;
      const Vec3 expected = numbers.color(diffuse, specular, direction);
      const auto features = decode_features(texel, AlphaCode::plain);
      EXPECT_LE((decode(*object->decoder, features, direction) - expected).cwiseAbs().maxCoeff(), 1e-13);
      Color batch;
      TexelColors(*object->decoder, {direction}).decode_into({&features, 1}, {&batch, 1});
      EXPECT_LE((batch - expected).cwiseAbs().maxCoeff(), 1e-5);
      // A pixel of which a quarter is covered has the colour of its covered samples.
      auto quarter = features;
      for (double& feature : quarter) feature /= 4;
      EXPECT_LE((decode(*object->decoder, quarter, direction / 4) - expected).cwiseAbs().maxCoeff(), 1e-13);
      const ColorRange range = color_range(*object->decoder, {true, features, features}, 0.25);
      EXPECT_TRUE(((expected - range.low).array() >= 0).all() && ((range.high - expected).array() >= 0).all());
    }
  }
}

// A folder by nerf2mesh itself; its mlp.json has rows of weights per input, the direction's three first.
TEST(Nerf2Mesh, ReadsWhatNerf2MeshWrote) {
  const fs::path source = fs::path(REBAKE_SOURCE) / "tests/mesh_ops/formats/nerf2mesh/written_by_nerf2mesh";
  const auto object = read_nerf2mesh_folder(source);
  ASSERT_EQ(object->sets.size(), 2U);
  EXPECT_EQ(object->sets[0].soup.triangle_count(), 80U);
  EXPECT_EQ(object->sets[1].soup.triangle_count(), 6U);
  const nlohmann::json mlp = nlohmann::json::parse(read_file(source / "mlp.json"));
  const auto& first = mlp.at("net.0.weight");
  const auto& second = mlp.at("net.1.weight");
  ASSERT_EQ(first.size(), 6U);
  const std::array<double, 8> features{1, 0.25, 0.5, 0.125, 0.9, 0.1, 0.6, 0};
  const Vec3 direction = Vec3(0.3, -0.8, 0.4).normalized();
  const double inputs[] = {direction.x(), direction.y(), direction.z(), features[4], features[5], features[6]};
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0;
    for (std::size_t h = 0; h < second.size(); ++h) {
      double hidden = 0;
      for (std::size_t k = 0; k < 6; ++k) hidden += inputs[k] * first.at(k).at(h).get<double>();
      sum += std::max(hidden, 0.0) * second.at(h).at(c).get<double>();
    }
    const double expected = std::min(1.0, features[1 + c] + 1 / (1 + std::exp(-sum)));
    EXPECT_NEAR(decode(*object->decoder, features, direction)[static_cast<Eigen::Index>(c)], expected, 1e-12);
  }
  const TemporaryFolder folder;
  const Scene scene = read_any(source, Axes::y_up);
  EXPECT_TRUE(format_named("nerf2mesh").write(scene, folder.path() / "out", {}, {}).notes.empty());
  auto expected = folder_bytes(source);
  expected.erase("README.md");
  EXPECT_EQ(folder_bytes(folder.path() / "out"), expected);
}

TEST(Nerf2Mesh, StandsUpright) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n");
  const Scene scene = read_any(folder.path() / "n", Axes::y_up);
  EXPECT_EQ(scene.roots.front()->to_parent * Vec3(0, -4, 0), Vec3(0, 0, 4));
  EXPECT_EQ(scene.roots.front()->to_parent * Vec3(0, 0, 1), Vec3(0, 1, 0));
}

TEST(Nerf2Mesh, UneditedFoldersAreWrittenByteForByte) {
  for (const bool jpeg : {false, true}) {
    const TemporaryFolder folder;
    write_nerf2mesh_example(folder.path() / "n", {3, 32, jpeg, 48, 2});
    const Scene scene = read_any(folder.path() / "n", Axes::y_up);
    const ExportReport report = format_named("nerf2mesh").write(scene, folder.path() / "out", {}, {});
    EXPECT_TRUE(report.notes.empty());
    EXPECT_EQ(folder_bytes(folder.path() / "out"), folder_bytes(folder.path() / "n"));
  }
}

TEST(Nerf2Mesh, EditedFoldersKeepTheirImages) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n", {2, 32, true, 48, 2});
  const Scene scene = with_first_triangle_deleted(read_any(folder.path() / "n", Axes::y_up));
  const ExportReport report = format_named("nerf2mesh").write(scene, folder.path() / "out", {}, {});
  const auto before = folder_bytes(folder.path() / "n"), after = folder_bytes(folder.path() / "out");
  for (const char* name :
       {"mlp.json", "feat0_0.jpg", "feat1_0.jpg", "feat0_1.jpg", "feat1_1.jpg", "mesh_1.obj", "mesh_0.mtl"})
    EXPECT_EQ(after.at(name), before.at(name)) << name;
  EXPECT_TRUE(after.at("mesh_0.obj").starts_with("mtllib mesh_0.mtl\nusemtl defaultMat\nv "));
  const Scene back = read_any(folder.path() / "out", Axes::y_up);
  EXPECT_EQ(back.roots.front()->object->triangle_count(), scene.roots.front()->object->triangle_count());
}

TEST(Nerf2Mesh, TurnedObjectsFoldTheirRotation) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n");
  Scene scene = read_any(folder.path() / "n", Axes::y_up);
  Node node = *scene.roots.front();
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  node.to_parent = Affine(turn) * node.to_parent;
  scene.roots.front() = std::make_shared<const Node>(node);
  format_named("nerf2mesh").write(scene, folder.path() / "out", {}, {});
  const Node back = *read_any(folder.path() / "out", Axes::y_up).roots.front();
  const std::array<double, 8> features{1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 1};
  const Vec3 world = Vec3(3, -1, 2).normalized();
  const Color before = decode(*node.object->decoder, features, node.to_parent.linear().transpose() * world),
              after = decode(*back.object->decoder, features, back.to_parent.linear().transpose() * world);
  EXPECT_LE((before - after).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Nerf2Mesh, RebakeScenesKeepAllBits) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n", {2, 32, true, 48, 2});
  const Scene scene = read_any(folder.path() / "n", Axes::y_up);
  format_named("rebake").write(scene, folder.path() / "scene", {}, {});
  const Scene back = read_any(folder.path() / "scene", Axes::y_up);
  EXPECT_EQ(*back.roots.front()->object->decoder, *scene.roots.front()->object->decoder);
  EXPECT_EQ(back.roots.front()->to_parent.matrix(), scene.roots.front()->to_parent.matrix());
  for (std::size_t s = 0; s < 2; ++s) {
    const TexelReader a(*back.roots.front()->object->sets[s].texels), b(*scene.roots.front()->object->sets[s].texels);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) ASSERT_EQ(a.at(x, y), b.at(x, y));
  }
  // The images are then encoded, which is said.
  EXPECT_EQ(format_named("nerf2mesh").write(back, folder.path() / "again", {}, {}).notes.size(), 1U);
  const Scene again = read_any(folder.path() / "again", Axes::y_up);
  EXPECT_EQ(TexelReader(*again.roots.front()->object->sets[1].texels).at(7, 9),
            TexelReader(*scene.roots.front()->object->sets[1].texels).at(7, 9));
}

TEST(Nerf2Mesh, ScenesThatTheFormatCannotHoldAreRefused) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n");
  const Scene foreign = read_any(folder.path() / "n", Axes::y_up), ball = scene_of(made_object(), "ball");
  Scene both = foreign;
  both.roots.push_back(ball.roots.front());
  EXPECT_THROW(format_named("nerf2mesh").write(ball, folder.path() / "out", {}, {}), EditError);
  EXPECT_THROW(format_named("nerf2mesh").write(both, folder.path() / "out", {}, {}), EditError);
  EXPECT_THROW(format_named("mobilenerf").write(foreign, folder.path() / "out", {}, {}), EditError);
  EXPECT_THROW(format_named("nerf2mesh").write(foreign, folder.path() / "out", {Layout::split, {}}, {}), FieldError);
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

TEST(Nerf2Mesh, EmptyMeshesDoNotCount) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "n", {2, 32, false, 32, 1});
  write_text(folder.path() / "n/mesh_1.obj", "v 0 0 0\nvt 0 0\n");
  const Scene scene = read_any(folder.path() / "n", Axes::y_up);
  format_named("nerf2mesh").write(scene, folder.path() / "out", {}, {});
  EXPECT_EQ(read_any(folder.path() / "out", Axes::y_up).roots[0]->object->sets.size(), 1U);
}

// Which of two images belongs to a scene is unknown, so no export may remove one.
TEST(Nerf2Mesh, DamagedFoldersAreNotReplaced) {
  const TemporaryFolder folder;
  const fs::path n = folder.path() / "n";
  write_nerf2mesh_example(n);
  EXPECT_NO_THROW(refuse_foreign_content(n));
  write_text(n / "feat0_0.jpg", "mine");
  EXPECT_TRUE(own_nerf2mesh_files(n).empty());
  EXPECT_THROW(refuse_foreign_content(n), FileError);
}

TEST(Nerf2Mesh, DamageIsNamed) {
  const TemporaryFolder folder;
  const fs::path n = folder.path() / "n";
  const auto problem = [&](const std::string& file, const std::string& bytes) {
    fs::remove_all(n);
    write_nerf2mesh_example(n);
    if (bytes.empty())
      fs::remove(n / file);
    else
      write_text(n / file, bytes);
    try {
      read_any(n, Axes::y_up);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(problem("feat0_0.png", "").find("feat0_0"), std::string::npos);
  EXPECT_NE(problem("feat1_0.png", "no image").find("neither PNG"), std::string::npos);
  EXPECT_NE(problem("feat0_0.jpg", "x").find("remove one"), std::string::npos);
  EXPECT_NE(problem("mesh_0.obj", "v 0 0 0\n").find("no triangles"), std::string::npos);
  EXPECT_NE(problem("mlp.json", "{").find("JSON"), std::string::npos);
  EXPECT_NE(problem("mlp.json", R"({"net.0.weight":[[1]]})").find("6 rows"), std::string::npos);
  EXPECT_NE(
      problem("mlp.json", R"({"net.0.weight":[[1],[1],[1],[1],[1],[1]],"net.1.weight":[[1,2]]})").find("3 numbers"),
      std::string::npos);
  EXPECT_NE(problem("mlp.json", R"({"net.0.weight":[[1],[1],[1],[1],[1],[1]],"net.1.weight":[[1,2,3]],"cascade":0.5})")
                .find("cascade"),
            std::string::npos);
}

}  // namespace
}  // namespace rebake::test
