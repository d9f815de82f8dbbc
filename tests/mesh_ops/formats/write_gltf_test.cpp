// Scenes as glTF: places, mean colours, names, cameras. Read back by Rebake's reader, and as JSON.
#include "mesh_ops/formats/write_gltf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/features/distill/diffuse_network.h"
#include "mesh_ops/features/distill/mean_colors.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/meshes/gltf_scene.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/motion_samples.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/motion/scene_at.h"
#include "tests/support/document_fixture.h"

namespace rebake::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

class WriteGltf : public DocumentTest {
 protected:
  WriteGltf() {
    import(document_);
    act(document_, R"({"op": "transform", "node": "ball", "translate": [5, 0, 0], "scale": 2})");
    act(document_, R"({"op": "group", "nodes": ["ball"], "as": "all"})");
    act(document_, R"({"op": "view", "name": "front \"one\"", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]}})");
  }
  json written(const fs::path& file) const {
    report_ = write_gltf(document_.scene(), file, {}, {});
    const std::string bytes = read_file(file);
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k)
      length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[12 + k])) << (8 * k);
    EXPECT_EQ(bytes.size() % 4, 0U);
    return json::parse(bytes.substr(20, length));
  }
  Document document_;
  mutable ExportReport report_;
};

TEST_F(WriteGltf, HasTheTreeNamesAndCamerasOfTheScene) {
  const json root = written(path("a.glb"));
  const json& nodes = root.at("nodes");
  const json& scene = root.at("scenes")[0].at("nodes");
  ASSERT_EQ(scene.size(), 2U);
  const json& group = nodes[scene[0].get<std::size_t>()];
  EXPECT_EQ(group.at("name"), "all");
  const json& ball = nodes[group.at("children")[0].get<std::size_t>()];
  EXPECT_EQ(ball.at("name"), "ball");
  EXPECT_EQ(ball.at("matrix")[0], 2);
  EXPECT_EQ(ball.at("matrix")[12], 5);
  const json& view = nodes[scene[1].get<std::size_t>()];
  EXPECT_EQ(view.at("name"), "front \"one\"");
  EXPECT_EQ(view.at("matrix")[14], 4);
  EXPECT_GT(root.at("cameras")[0].at("perspective").at("znear").get<double>(), 0);
  EXPECT_NEAR(root.at("cameras")[0].at("perspective").at("yfov").get<double>(), 39 * std::numbers::pi / 180, 1e-12);
  EXPECT_EQ(root.at("extensionsUsed"), json::array({"KHR_materials_unlit"}));
  EXPECT_FALSE(root.contains("extensionsRequired"));
  EXPECT_NE(report_.notes[0].find("loses its view dependence"), std::string::npos) << report_.notes[0];
}

TEST_F(WriteGltf, KeyframesBecomeAnimations) {
  act(document_, R"({"op": "key", "node": "ball", "time": 0, "interpolation": "linear"})");
  act(document_,
      R"({"op": "key", "node": "ball", "time": 2, "position": [1, 2, 3], "rotation": {"axis": [0, 1, 0], "degrees": 90}})");
  act(document_, R"({"op": "key", "node": "ball", "time": 0, "degrees": 0})");
  act(document_, R"({"op": "key", "node": "ball", "time": 1, "degrees": 40})");
  act(document_, R"({"op": "key", "time": 0, "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]}})");
  act(document_, R"({"op": "key", "time": 1, "camera": {"eye": [4, 0, 0], "target": [0, 0, 0]}})");
  const json root = written(path("a.glb"));
  const json& animation = root.at("animations").at(0);
  std::map<std::string, std::vector<std::string>> paths;  // by name of the node
  for (const json& channel : animation.at("channels")) {
    const json& node = root.at("nodes").at(channel.at("target").at("node").get<std::size_t>());
    EXPECT_FALSE(node.contains("matrix")) << "animated nodes have no matrix";
    paths[node.at("name")].push_back(channel.at("target").at("path"));
    const json& sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
    const json& times = root.at("accessors").at(sampler.at("input").get<std::size_t>());
    const json& values = root.at("accessors").at(sampler.at("output").get<std::size_t>());
    EXPECT_EQ(times.at("min").at(0), 0);
    if (channel.at("target").at("path") != "weights") {
      EXPECT_EQ(values.at("count"), times.at("count"));
      continue;
    }
    const json& mesh = root.at("meshes").at(node.at("mesh").get<std::size_t>());
    const std::size_t targets = mesh.at("primitives").at(0).at("targets").size();
    EXPECT_GT(targets, 4U);
    EXPECT_EQ(mesh.at("weights").size(), targets);
    EXPECT_EQ(values.at("count").get<std::size_t>(), targets * times.at("count").get<std::size_t>());
  }
  EXPECT_EQ(paths.at("ball"), (std::vector<std::string>{"translation", "rotation", "scale"}));
  EXPECT_EQ(paths.at("film camera"), (std::vector<std::string>{"translation", "rotation"}));
  EXPECT_EQ(paths.at("ball triangles"), std::vector<std::string>{"weights"});
}

// Largest distance between the corners of an object at a time and those that poses give there.
double pose_error(const Node& node, const BendPoses& poses, double seconds) {
  const auto exact = bent(node, [&](const BendTrack& track) { return value_at(track.degrees, seconds); });
  std::size_t k = 0;
  while (poses.seconds[k + 1] <= seconds) ++k;
  const double share = (seconds - poses.seconds[k]) / (poses.seconds[k + 1] - poses.seconds[k]);
  double largest = 0;
  for (std::size_t s = 0; s < exact->sets.size(); ++s)
    for (std::size_t f = 0; f < exact->sets[s].soup.triangle_count(); ++f)
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = [&](const BakedObject& one) {
          return one.sets[s].soup.positions()[one.sets[s].soup.faces()[f][c]];
        };
        largest = std::max(largest,
                           ((1 - share) * at(*poses.poses[k]) + share * at(*poses.poses[k + 1]) - at(*exact)).norm());
      }
  return largest;
}

TEST_F(WriteGltf, PosesOfBendsAreAsCloseAsTheReportSays) {
  act(document_, R"({"op": "key", "node": "ball", "time": 0, "degrees": -60})");
  act(document_, R"({"op": "key", "node": "ball", "time": 1, "degrees": 90, "interpolation": "step"})");
  act(document_, R"({"op": "key", "node": "ball", "time": 2, "degrees": 0})");
  const Node& ball = *find(document_.scene(), "ball");
  const BendPoses poses = bend_poses(ball);
  EXPECT_LE(poses.deviation, poses.rest->bounds().diagonal().norm() / 500);
  EXPECT_EQ(poses.poses.back()->sets[0].soup.positions(), poses.rest->sets[0].soup.positions());
  for (double t = 0; t < 0.999; t += 0.037) EXPECT_LE(pose_error(ball, poses, t), 1.5 * poses.deviation) << t;
}

TEST_F(WriteGltf, SmallSmoothBendsKeepTheirEasing) {
  act(document_, R"({"op": "key", "node": "ball", "time": 0, "degrees": 0})");
  act(document_, R"({"op": "key", "node": "ball", "time": 4, "degrees": 3})");
  const Node& ball = *find(document_.scene(), "ball");
  const BendPoses poses = bend_poses(ball);
  const double travel = pose_error(ball, {poses.rest, {0, 8}, {poses.rest, poses.rest}, 0}, 4);
  for (double t = 0; t < 3.99; t += 0.1) EXPECT_LE(pose_error(ball, poses, t), 0.03 * travel) << t;
}

TEST_F(WriteGltf, BendsOfARegionSplitItsBorderInAllPoses) {
  act(document_,
      R"({"op": "key", "node": "ball", "time": 0, "degrees": 0, "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"})");
  act(document_, R"({"op": "key", "node": "ball", "time": 1, "degrees": 60})");
  act(document_,
      R"({"op": "key", "node": "ball", "time": 0, "degrees": 0, "track": "other", "box": {"min": [0, 0, 0], "max": [0.5, 1, 1]}, "frame": "bounds"})");
  act(document_, R"({"op": "key", "node": "ball", "time": 1, "degrees": -30, "track": "other"})");
  const json root = written(path("a.glb"));
  EXPECT_GT(root.at("meshes").at(0).at("primitives").at(0).at("targets").size(), 2U);
  const Node& ball = *find(document_.scene(), "ball");
  const BendPoses poses = bend_poses(ball);
  EXPECT_GT(poses.rest->vertex_count(), ball.object->vertex_count());
  for (const auto& pose : poses.poses) EXPECT_EQ(pose->sets[0].soup.faces(), poses.rest->sets[0].soup.faces());
  for (double t = 0; t < 0.999; t += 0.05) EXPECT_LE(pose_error(ball, poses, t), 1.5 * poses.deviation) << t;
}

TEST_F(WriteGltf, TrianglesStayInPlaceAndHolesStayHoles) {
  written(path("a.glb"));
  const auto back = read_gltf_object(path("a.glb"));
  const PlacedNode placed = *find_placed(document_.scene(), find(document_.scene(), "ball")->id);
  Box before;
  for (const Vec3& p : placed.node->object->sets[0].soup.positions()) before.extend(placed.to_world * p);
  EXPECT_LE((back->bounds().min() - before.min()).norm(), 1e-5);
  EXPECT_LE((back->bounds().max() - before.max()).norm(), 1e-5);
  EXPECT_GT(back->opaque_texel_count(), 0U);
  // Triangles without opaque texels are left out; the others keep their holes.
  EXPECT_LE(back->triangle_count(), placed.node->object->triangle_count());
  const TexelReader texels(*back->sets[0].texels);
  std::size_t holes = 0;
  for (int y = 0; y < back->sets[0].texels->height(); ++y)
    for (int x = 0; x < back->sets[0].texels->width(); ++x) holes += texels.at(x, y).opaque() ? 0 : 1;
  EXPECT_GT(holes, 0U);
}

// Each way of compression and all together: the same triangles within the stated errors, and equal texels.
TEST_F(WriteGltf, CompressedFilesHoldTheSame) {
  written(path("plain.glb"));
  const auto plain = read_gltf_object(path("plain.glb"));
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"quantized"}, {"meshopt"}, {"webp"}, {"quantized", "meshopt", "webp"}}) {
    const fs::path file = path(words.back() + std::to_string(words.size()) + ".glb");
    ExportOptions options;
    options.compression = gltf_compression(words);
    write_gltf(document_.scene(), file, options, {});
    EXPECT_LT(fs::file_size(file), fs::file_size(path("plain.glb"))) << words.back();
    const auto back = read_gltf_object(file);
    ASSERT_EQ(back->sets.size(), plain->sets.size());
    const Soup &now = back->sets[0].soup, &then = plain->sets[0].soup;
    ASSERT_EQ(now.triangle_count(), then.triangle_count());
    const double step = plain->bounds().sizes().maxCoeff() / 65534;
    const double bound = options.compression.quantized ? step + 1e-6 : 0;
    for (std::size_t f = 0; f < now.triangle_count(); ++f) {
      // Meshopt may rotate the corners of a triangle.
      double nearest = 1;
      for (std::size_t turn = 0; turn < 3; ++turn) {
        double farthest = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = now.faces()[f][(k + turn) % 3], b = then.faces()[f][k];
          farthest = std::max({farthest, (now.positions()[a] - then.positions()[b]).cwiseAbs().maxCoeff(),
                               (now.uvs()[a] - then.uvs()[b]).cwiseAbs().maxCoeff()});
        }
        nearest = std::min(nearest, farthest);
      }
      EXPECT_LE(nearest, bound) << words.back() << " triangle " << f;
    }
    EXPECT_EQ(back->sets[0].texels->width(), plain->sets[0].texels->width());
    const TexelReader texels(*back->sets[0].texels), before(*plain->sets[0].texels);
    for (int y = 0; y < plain->sets[0].texels->height(); ++y)
      for (int x = 0; x < plain->sets[0].texels->width(); ++x) {
        if (!before.at(x, y).opaque()) continue;
        EXPECT_EQ(texels.at(x, y), before.at(x, y));
      }
  }
  EXPECT_THROW(gltf_compression({"draco"}), FieldError);
}

TEST_F(WriteGltf, DamagedCompressionIsNamed) {
  ExportOptions options;
  options.compression.meshopt = true;
  write_gltf(document_.scene(), path("a.glb"), options, {});
  const std::string bytes = read_file(path("a.glb"));
  const auto problem = [&](const std::string& from, const std::string& to) {
    std::string changed = bytes;
    changed.replace(changed.find(from), from.size(), to);
    write_text(path("b.glb"), changed);
    try {
      read_gltf_object(path("b.glb"));
    } catch (const FileError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(problem(R"("mode":"ATTRIBUTES")", R"("mode":"ATTRIBUTEZ")").find("mode"), std::string::npos);
  EXPECT_NE(problem(R"("byteStride":12,"count")", R"("byteStride":13,"count")").find("mode"), std::string::npos);
  // Flipped bits in compressed triangles.
  std::size_t length = 0;
  for (std::size_t k = 0; k < 4; ++k)
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[12 + k])) << (8 * k);
  std::vector<std::pair<std::size_t, std::size_t>> packed;  // places in the file
  const json root = json::parse(bytes.substr(20, length));
  for (const json& view : root.at("bufferViews"))
    if (view.contains("extensions")) {
      const json& extension = view.at("extensions").at("EXT_meshopt_compression");
      packed.emplace_back(28 + length + extension.at("byteOffset").get<std::size_t>(),
                          extension.at("byteLength").get<std::size_t>());
    }
  ASSERT_EQ(packed.size(), 3U);
  std::mt19937 random(1);
  for (int k = 0; k < 200; ++k) {
    std::string changed = bytes;
    for (int flips = 0; flips < 5; ++flips) {
      const auto [first, count] = packed[random() % packed.size()];
      changed[first + random() % count] ^= static_cast<char>(1U << random() % 8);
    }
    write_text(path("b.glb"), changed);
    try {
      read_gltf_object(path("b.glb"));  // finds the damage, or reads other numbers
    } catch (const FileError&) {
      continue;
    }
  }
}

// Every direction shows the same colour, so nothing is lost, and the bytes are the object's own.
TEST_F(WriteGltf, ColoursWithoutViewDependenceAreKept) {
  auto object = std::make_shared<BakedObject>(*find(document_.scene(), "ball")->object);
  object->decoder = std::make_shared<const Decoder>(diffuse_decoder());
  object->dialect.alpha = AlphaCode::plain;
  const auto texels = FeatureTexture::from_rows(
      object->sets[0].texels->width(), object->sets[0].texels->height(), AlphaCode::plain, [&](int y, Texel* row) {
        for (int x = 0; x < object->sets[0].texels->width(); ++x)
          row[x] = {{255, static_cast<std::uint8_t>(x % 256), static_cast<std::uint8_t>(y % 256), 77}, {0, 0, 0, 255}};
      });
  object->sets[0].texels = std::make_shared<const FeatureTexture>(texels);
  const Scene scene = scene_of(object);
  const std::vector<PlacedNode> placed = placed_nodes(scene);
  const SceneRays rays = rays_through(placed);
  MeanColorLoss loss;
  const MeanColors colors = mean_colors(object->sets[0], placed[0], rays, 2, 32, loss);
  // Single precision of the network's evaluation remains.
  EXPECT_GE(loss.psnr_db(), 99);
  std::size_t shown = 0;
  for (int y = 0; y < colors.height; ++y)
    for (int x = 0; x < colors.width; ++x) {
      const auto k =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(colors.width) + static_cast<std::size_t>(x));
      if (colors.rgba[k + 3] == 0) continue;
      ++shown;
      // Texels beside a triangle have a neighbour's colour.
      EXPECT_LE(std::abs(colors.rgba[k] - x % 256), 2);
      EXPECT_LE(std::abs(colors.rgba[k + 1] - y % 256), 2);
      EXPECT_EQ(colors.rgba[k + 2], 77);
    }
  EXPECT_GT(shown, 1000U);
}

// The mean of two lobes is between them, and the loss is that of a known variance.
TEST_F(WriteGltf, LossIsTheDeviationFromTheMean) {
  MeanColorLoss loss;
  loss.squares = 0.01 * 12;
  loss.weight = 12;
  EXPECT_NEAR(loss.psnr_db(), 20, 1e-12);
  EXPECT_EQ(MeanColorLoss().psnr_db(), 100);
}

TEST_F(WriteGltf, ReplacesOnlyItsOwnFiles) {
  for (int twice = 0; twice < 2; ++twice) written(path("a.glb"));
  write_text(path("b.glb"), "mine");
  EXPECT_THROW(write_gltf(document_.scene(), path("b.glb"), {}, {}), FileError);
  EXPECT_EQ(read_file(path("b.glb")), "mine");
  EXPECT_THROW(write_gltf(document_.scene(), path("c.gltf"), {}, {}), FieldError);
  EXPECT_THROW(write_gltf({}, path("c.glb"), {}, {}), EditError);
  EXPECT_THROW(write_gltf(document_.scene(), path("c.glb"), {.layout = Layout::split, .sources = {}}, {}), FieldError);
}

// Two objects that share nothing, the second one bent, with keyframes, views, a group and a stored background.
TEST_F(WriteGltf, ColoursCanBeThoseOfAView) {
  written(path("means.glb"));
  const std::string means = report_.notes[0];
  ExportOptions options;
  options.colors_from = Vec3(0, 0, 40);
  const ExportReport report = write_gltf(document_.scene(), path("view.glb"), options, {});
  EXPECT_NE(report.notes[0].find("those from the given view"), std::string::npos) << report.notes[0];
  // The means are the best constant colours.
  const auto db = [](const std::string& note) { return std::stod(note.substr(note.find("dependence: ") + 12)); };
  EXPECT_LT(db(report.notes[0]), db(means));
}

class GltfFeatures : public DocumentTest {
 protected:
  GltfFeatures() {
    import(document_);
    act(document_, R"({"op": "bend", "node": "ball", "degrees": 60})");
    act(document_,
        R"({"op": "transform", "node": "ball", "translate": [5e5, 0.1, 0], "rotate": {"axis": [1, 2, 3], "degrees": 33}})");
    act(document_, json{{"op", "import"}, {"path", path("sources/ball").string()}, {"as", "other"}});
    act(document_, R"({"op": "duplicate", "node": "other", "as": "copy"})");
    act(document_, R"({"op": "group", "nodes": ["ball", "copy"], "as": "all"})");
    act(document_, R"({"op": "view", "name": "front", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]}})");
    act(document_, R"({"op": "background", "color": [0.1, 0.2, 0.3]})");
    act(document_, R"({"op": "key", "node": "other", "time": 1, "position": [1, 0, 0]})");
  }
  Document document_;
};

TEST_F(GltfFeatures, TheSameSceneIsReadBack) {
  const ExportReport report = write_gltf_features(document_.scene(), path("a.glb"), {}, {});
  EXPECT_TRUE(report.preserves_scene);
  const Scene read = read_any(path("a.glb"), {});
  const Scene& scene = document_.scene();
  EXPECT_EQ(read.views, scene.views);
  EXPECT_EQ(read.background, scene.background);
  const auto before = placed_nodes(scene), after = placed_nodes(read);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_EQ(after[k].node->name, before[k].node->name);
    EXPECT_EQ(after[k].node->to_parent.matrix(), before[k].node->to_parent.matrix());
    ASSERT_EQ(after[k].node->object != nullptr, before[k].node->object != nullptr);
    if (!before[k].node->object) continue;
    const BakedObject &was = *before[k].node->object, &is = *after[k].node->object;
    EXPECT_EQ(*is.decoder, *was.decoder);
    ASSERT_EQ(is.sets.size(), was.sets.size());
    for (std::size_t s = 0; s < was.sets.size(); ++s) {
      EXPECT_EQ(is.sets[s].soup.positions(), was.sets[s].soup.positions());
      EXPECT_EQ(is.sets[s].soup.uvs(), was.sets[s].soup.uvs());
      EXPECT_EQ(is.sets[s].soup.faces(), was.sets[s].soup.faces());
      ASSERT_EQ(is.sets[s].soup.rotations() != nullptr, was.sets[s].soup.rotations() != nullptr);
      for (const int image : {0, 1})
        EXPECT_EQ(write_feature_png(*is.sets[s].texels, image), write_feature_png(*was.sets[s].texels, image));
    }
  }
  EXPECT_EQ(*find(read, "other")->motion, *find(scene, "other")->motion);
  EXPECT_EQ(find(read, "other")->object, find(read, "copy")->object) << "copies share their data";
  // A second round gives the same bytes.
  write_gltf_features(read, path("b.glb"), {}, {});
  EXPECT_EQ(read_file(path("a.glb")), read_file(path("b.glb")));
}

TEST_F(GltfFeatures, UnknownMembersKeepTheirSpelling) {
  const std::map<std::string, std::string> members{{"id", "123456789012345678901"}, {"note", "\"a\""}};
  Scene scene = document_.scene();
  const NodeId other = find(scene, "other")->id;
  scene = with_changed(scene, other, [&](Node& node) {
    auto object = std::make_shared<BakedObject>(*node.object);
    object->other_members = members;
    node.object = object;
  });
  write_gltf_features(scene, path("a.glb"), {}, {});
  EXPECT_EQ(find(read_any(path("a.glb"), {}), "other")->object->other_members, members);
}

TEST_F(GltfFeatures, HiddenNodesAreLeftOutWithANote) {
  act(document_, R"({"op": "hide", "node": "copy"})");
  const ExportReport report = write_gltf_features(document_.scene(), path("a.glb"), {}, {});
  EXPECT_FALSE(report.preserves_scene);
  EXPECT_NE(report.notes.back().find("hidden node \"copy\""), std::string::npos) << report.notes.back();
  EXPECT_EQ(find(read_any(path("a.glb"), {}), "copy"), nullptr);
}

TEST_F(GltfFeatures, DamageIsNamed) {
  write_gltf_features(document_.scene(), path("a.glb"), {}, {});
  const std::string bytes = read_file(path("a.glb"));
  for (const auto& [what, by] : {std::pair("\"version\":1", "\"version\":7"),
                                 {"\"rule\":\"network\"", "\"rule\":\"notwork\""},
                                 {"\"faces\":", "\"facez\":"}}) {
    std::string damaged = bytes;
    const std::size_t at = damaged.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    damaged.replace(at, std::string(what).size(), by);
    write_text(path("damaged.glb"), damaged);
    try {
      read_any(path("damaged.glb"), {});
      ADD_FAILURE() << what;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("damaged.glb"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace rebake::test
