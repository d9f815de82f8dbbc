// Plain export of any scene: PSNR of its pictures. The thresholds are those that the documentation promises.
#include "editor/actions/plain_scene.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "editor/actions/export_action.h"
#include "editor/actions/session.h"
#include "editor/actions/views.h"
#include "editor/script/script.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"
#include "render/compare.h"
#include "tests/support/document_fixture.h"
#include "tests/support/made_scenes.h"
#include "tests/support/power_loss.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

Renderer& renderer() {
  static Renderer one;
  return one;
}

PlainReport plain_report(const Scene& scene, const FuseOptions& options, int size = 800) {
  PlainReport report;
  const Scene plain = plain_scene(scene, {}, options, report, {});
  measure_pictures(renderer(), scene, {}, plain, report, {}, size);
  return report;
}

// Two objects side by side, the second rotated.
Scene two(const std::shared_ptr<const BakedObject>& a, const std::shared_ptr<const BakedObject>& b) {
  Scene scene;
  Node node;
  node.name = "a";
  node.object = a;
  node.to_parent = Eigen::Translation3d(-1.1, 0, 0);
  scene = with_added(scene, node, NodeId::none, 99);
  node.name = "b";
  node.object = b;
  node.to_parent = Eigen::Translation3d(1.1, 0.2, 0.3) * Eigen::AngleAxisd(1.1, Vec3(1, 2, 0.5).normalized());
  return with_added(scene, node, NodeId::none, 99);
}

TEST(Plain, TwoRealDecodersReach40Decibels) {
  REBAKE_ONLY_DEEP();
  const auto ball = morpheus_object("lego_ball", 24), tractor = morpheus_object("lego_tractor", 24);
  if (!ball) GTEST_SKIP() << "REBAKE_TEST_DATA has no lego_ball";
  const PlainReport report = plain_report(two(ball, tractor), {});
  EXPECT_GE(report.whole.psnr_db, 40);
}

TEST(Plain, TwoRealDecodersReach37DecibelsAtTheirWidth) {
  REBAKE_ONLY_DEEP();
  const auto ball = morpheus_object("lego_ball", 24), tractor = morpheus_object("lego_tractor", 24);
  if (!ball) GTEST_SKIP() << "REBAKE_TEST_DATA has no lego_ball";
  FuseOptions options;
  options.width = 16;
  const PlainReport report = plain_report(two(ball, tractor), options);
  EXPECT_GE(report.whole.psnr_db, 37);
  EXPECT_LE(report.hidden0, 16);
}

// Sample scenes with edits, as in the README.
Scene edited(const std::vector<const char*>& lines) {
  Document document;
  for (const char* line : lines) {
    nlohmann::json edit = nlohmann::json::parse(line);
    if (edit["op"] == "import")
      edit["path"] = (std::filesystem::path(REBAKE_SOURCE) / "samples/scenes" / edit["as"].get<std::string>()).string();
    document.edit(read_edit(edit, document.scene()));
  }
  return document.scene();
}

TEST(Plain, ComposedSamplesReach44Decibels) {
  REBAKE_ONLY_DEEP();
  const Scene scene = edited({R"({"op": "import", "as": "ficus"})", R"({"op": "import", "as": "kettle"})",
                              R"({"op": "transform", "node": "kettle", "translate": [1.25, -0.55, 0.5], "scale": 0.7,
                                  "rotate": {"axis": [0, 1, 0], "degrees": 150}})"});
  const PlainReport report = plain_report(scene, {}, 400);
  EXPECT_GE(report.whole.psnr_db, 44);
  EXPECT_EQ(report.nodes.size(), 2U);
  // At edges of one object over the other, supersampling mixes features of two branches, which no decoder can undo: the
  // worst view has 36 dB. With one sample per pixel nothing is mixed.
  PlainReport made;
  const Scene plain = plain_scene(scene, {}, {}, made, {});
  for (View view : measurement_views(scene, 400)) {
    view.samples = 1;
    EXPECT_GE(compare(renderer().render(scene, view), renderer().render(plain, view), 2).psnr_db, 48);
  }
}

TEST(Plain, BentBranchReaches46Decibels) {
  REBAKE_ONLY_DEEP();
  const Scene scene =
      edited({R"({"op": "import", "as": "ficus"})",
              R"({"op": "bend", "node": "ficus", "degrees": 70, "axis": [1, 0.3, 0], "direction": [0, -1, 0],
                  "box": {"min": [0.52, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds", "falloff": 0.15})"});
  PlainReport report;
  const Scene plain = plain_scene(scene, {}, {}, report, {});
  // Same views as for an export without a fit, which has 43.5 dB over all four and 40.8 dB in the worst.
  const Camera front = framing_camera(scene, 1);
  double squares = 0, worst = 100;
  for (int side = 0; side < 4; ++side) {
    View view;
    view.width = view.height = 400;
    view.camera = front;
    view.camera.eye = front.target + Eigen::AngleAxisd(side * std::numbers::pi / 2, front.up.normalized()) *
                                         (front.eye - front.target);
    const double psnr = compare(renderer().render(scene, view), renderer().render(plain, view), 2).psnr_db;
    squares += std::pow(10, -psnr / 10) / 4;
    worst = std::min(worst, psnr);
  }
  EXPECT_GE(-10 * std::log10(squares), 46);
  EXPECT_GE(worst, 44);
}

// If texels of a leaf use different branches, it is full of specks, which PSNR alone does not show.
TEST(Plain, BentBranchWithKettleHasFewSpecks) {
  REBAKE_ONLY_DEEP();
  const Scene scene =
      edited({R"({"op": "import", "as": "ficus"})", R"({"op": "import", "as": "kettle"})",
              R"({"op": "transform", "node": "kettle", "translate": [1.25, -0.55, 0.5], "scale": 0.7})",
              R"({"op": "bend", "node": "ficus", "degrees": 70, "axis": [1, 0.3, 0], "direction": [0, -1, 0],
                  "box": {"min": [0.52, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds", "falloff": 0.15})"});
  FuseOptions options;
  options.way = FuseMethod::side_by_side;
  options.iterations = 2;
  const PlainReport report = plain_report(scene, options, 400);
  // With mixed branches: 37.8 dB and a share of 0.0042.
  EXPECT_GE(report.whole.psnr_db, 39.2);
  EXPECT_LE(report.whole.far_off_share, 0.0032);
}

// Options for a fast export: decoders fit side by side, so training can be short.
FuseOptions quick(Layout layout = Layout::split) {
  FuseOptions options;
  options.width = 40;
  options.sample = 512;
  options.training.steps = 50;
  options.layout = layout;
  return options;
}

TEST(Plain, MirroredStretchedAndForwardFacingNodesOfAnyAlphaCode) {
  MadeObject plain{.seed = 2, .code = AlphaCode::plain, .layout = Layout::unsplit, .axes = Axes::forward};
  Scene scene = two(made_object({.seed = 1}), made_object(plain));
  scene = with_changed(scene, scene.roots[0]->id, [](Node& node) {
    node.to_parent = Affine(Eigen::Translation3d(-1.2, 0, 0) * Eigen::Scaling(-0.7, 1.3, 1.0));
  });
  for (const Layout layout :
       is_deep ? std::vector{Layout::split, Layout::unsplit, Layout::chunked} : std::vector{Layout::unsplit}) {
    const PlainReport report = plain_report(scene, quick(layout), 300);
    EXPECT_GE(report.whole.psnr_db, 40);
    EXPECT_GE(report.whole.worst_psnr_db, 38);
  }
}

TEST(Plain, SeveralTextureSets) {
  auto both = std::make_shared<BakedObject>(*made_object({.seed = 1}));
  both->sets.push_back(made_object({.seed = 1, .radius = 0.6})->sets[0]);
  EXPECT_GE(plain_report(two(both, made_object({.seed = 2})), quick(), 300).whole.psnr_db, 40);
}

// A square of two triangles, 2 units wide, of one colour: (152, 164, 175) for `sign` 1, by a decoder that passes
// features through. Of the `side`² texels, the top-left `opaque`² are opaque. `sign`: of the output weights.
std::shared_ptr<const BakedObject> square(int side, int opaque, double sign) {
  Decoder decoder;
  decoder.weights0 = Eigen::MatrixXd::Zero(Decoder::inputs, 16);
  for (int k = 0; k < Decoder::inputs; ++k) decoder.weights0(k, k) = 1;
  decoder.weights1 = Eigen::MatrixXd::Identity(16, 16);
  decoder.weights2 = Eigen::MatrixXd::Zero(16, 3);
  for (int k = 0; k < 3; ++k) decoder.weights2(k, k) = sign;
  decoder.bias0 = decoder.bias1 = Eigen::VectorXd::Zero(16);
  decoder.bias2 = Eigen::VectorXd::Zero(3);
  auto object = std::make_shared<BakedObject>();
  object->decoder = std::make_shared<const Decoder>(decoder);
  const double low = 0.5 / side, high = (opaque - 0.5) / side;
  const std::vector<Vec3> positions{{-1, 1, 0}, {-1, -1, 0}, {1, 1, 0}, {1, -1, 0}};
  const std::vector<Vec2> uvs{{low, 1 - low}, {low, 1 - high}, {high, 1 - low}, {high, 1 - high}};
  object->sets.push_back({Soup(positions, uvs, {Face{0, 1, 3}, Face{0, 3, 2}}),
                          std::make_shared<const FeatureTexture>(
                              FeatureTexture::from_rows(side, side, AlphaCode::halved, [&](int y, Texel* row) {
                                for (int x = 0; x < side; ++x)
                                  row[x] = x < opaque && y < opaque ? Texel{{100, 150, 200, 200}, {100, 150, 200, 200}}
                                                                    : empty_texel(AlphaCode::halved);
                              }))});
  return object;
}

// An object of few texels may fill the picture: the decoder of the larger object alone would show it at 16.7 dB.
TEST(Plain, SmallObjectsKeepTheirColours) {
  for (const int large : is_deep ? std::vector{96, 272, 512} : std::vector{272}) {
    const auto small = square(64, 17, 1), other = square(1024, large, -1);
    Scene scene;
    Node node;
    for (const auto& [name, object, place] :
         {std::tuple("A", small, Vec3(0, 0, 0)), std::tuple("B", other, Vec3(0, 0, -1)),
          std::tuple("copy", small, Vec3(3, 0, 0))}) {
      node.name = name;
      node.object = object;
      node.to_parent = Affine(Eigen::Translation3d(place));
      scene = with_added(scene, node, NodeId::none, 99);
    }
    FuseOptions options;
    options.training.steps = 50;
    PlainReport report;
    const Scene plain = best_plain_scene(
        scene, {}, options, []() -> Renderer& { return renderer(); }, [](const DeviceError&) { FAIL(); }, report, {});
    for (const FuseReport::Part& part : report.texels.parts)
      EXPECT_GE(part.errors.psnr_db, 60) << part.node << " beside " << large;
    // From all sides, at edges of one object over the other, features are mixed before decoding instead of colours
    // after it.
    for (const PlainReport::NodeQuality& of : report.nodes) EXPECT_GE(of.psnr_db, 40) << of.node << " beside " << large;
    // Views from the front and from the back contain no such edge.
    for (const double side : {1.0, -1.0}) {
      View view;
      view.width = view.height = 300;
      view.camera.eye = Vec3(1, 0, 8 * side);
      view.camera.target = Vec3(1, 0, 0);
      view.camera.near_plane = 1;
      view.camera.far_plane = 20;
      EXPECT_GE(compare(renderer().render(scene, view), renderer().render(plain, view), 2).psnr_db, 60)
          << "from side " << side << " beside " << large;
    }
    const auto lines = lines_of(report);
    EXPECT_TRUE(std::any_of(lines.begin(), lines.end(),
                            [](const std::string& line) { return line == "copy: shares the texels of A"; }));
  }
}

// A square with a random decoder of 4 to 8 neurons per layer and random features, different in each quarter.
std::shared_ptr<const BakedObject> random_square(std::mt19937& random, int opaque) {
  auto object = std::make_shared<BakedObject>(*square(std::max(64, opaque), opaque, 1));
  const auto neurons = [&] { return 4 + static_cast<int>(random() % 5); };
  object->decoder = std::make_shared<const Decoder>(made_decoder(random(), neurons(), neurons()));
  std::array<Texel, 4> quarters;
  for (Texel& texel : quarters) {
    for (auto* bytes : {&texel.feat0, &texel.feat1})
      for (std::uint8_t& byte : *bytes) byte = static_cast<std::uint8_t>(1 + random() % 255);
    texel.feat0[3] = texel.feat0[3] / 2 + 128;
    texel.feat1[3] = texel.feat1[3] / 2 + 128;
  }
  const auto& old = object->sets[0].texels;
  object->sets[0].texels = std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(old->width(), old->height(), AlphaCode::halved, [&](int y, Texel* row) {
        for (int x = 0; x < old->width(); ++x)
          row[x] = old->opaque(x, y) ? quarters[static_cast<std::size_t>(2 * y / opaque + 2 * (2 * x / opaque)) % 4]
                                     : empty_texel(AlphaCode::halved);
      }));
  return object;
}

// For two objects with any ratio of texels: if decoders side by side reproduce both well, the chosen method must
// reproduce each of them as well.
TEST(Plain, NeverWorseThanSideBySide) {
  std::mt19937 random(11);
  int held = 0;
  for (int k = 0; k < cases(1, 6); ++k) {
    const double ratio = std::exp(std::uniform_real_distribution<double>(0, std::log(1000.0))(random));
    const auto few = static_cast<int>(8 + random() % 8), many = static_cast<int>(few * std::sqrt(ratio));
    const Scene scene = two(random_square(random, few), random_square(random, many));
    const auto worst_part = [&](std::optional<FuseMethod> way) {
      FuseOptions options;
      options.training.steps = 50;
      options.way = way;
      PlainReport report;
      best_plain_scene(
          scene, {}, options, []() -> Renderer& { return renderer(); }, [](const DeviceError&) { FAIL(); }, report, {},
          200);
      double worst = std::numeric_limits<double>::infinity();
      for (const FuseReport::Part& part : report.texels.parts) worst = std::min(worst, part.errors.psnr_db);
      return worst;
    };
    if (worst_part(FuseMethod::side_by_side) < 50) continue;
    ++held;
    EXPECT_GE(worst_part(std::nullopt), 50) << "case " << k << ", 1 : " << ratio;
  }
  EXPECT_GT(held, 0);
}

// Plain export to files, as users run it.
class PlainExport : public DocumentTest {
 protected:
  PlainExport() {
    session_.say = [this](const std::string& line) { said_ += line + "\n"; };
    // Few texels, for a fast fit.
    export_scene(scene_of(made_object({.columns = 4, .rows = 2})), path("sources/small"), {});
    act(session_.document, nlohmann::json{{"op", "import"}, {"path", path("sources/small").string()}, {"as", "ball"}});
    act(session_.document, R"({"op": "duplicate", "node": "ball", "translate": [2.5, 0, 0]})");
    act(session_.document,
        R"({"op": "transform", "node": "ball.2", "rotate": {"axis": [1, 1, 0], "degrees": 60}, "pivot": [2.5, 0, 0]})");
    action_.out = path("plain").string();
    action_.plain = true;
    action_.width.neurons = 40;
    action_.picture_size = 200;
    action_.report = path("report.json").string();
  }
  Session session_;
  ExportAction action_;
  std::string said_;
};

TEST_F(PlainExport, ExportedFolderHasTheReportedPsnr) {
  run(session_, action_);
  EXPECT_FALSE(std::filesystem::exists(path("plain") / "scene.json"));
  const Scene read = read_any(path("plain"), Axes::y_up);
  ASSERT_EQ(placed_nodes(read).size(), 1U);
  PlainReport report;
  measure_pictures(renderer(), session_.scene(), {}, read, report, {}, action_.picture_size);
  const nlohmann::json written = nlohmann::json::parse(read_file(path("report.json")));
  EXPECT_NEAR(written["pictures"]["psnr_db"].get<double>(), report.whole.psnr_db, 0.1);
  EXPECT_GT(report.whole.psnr_db, 38);
  EXPECT_EQ(written["trials"][0]["way"], "decoders side by side");
  EXPECT_NE(said_.find("texels"), std::string::npos);
}

TEST_F(PlainExport, ExactForOneDecoder) {
  act(session_.document, R"({"op": "remove", "node": "ball.2"})");
  run(session_, action_);
  EXPECT_NE(said_.find("exactly"), std::string::npos);
  EXPECT_TRUE(nlohmann::json::parse(read_file(path("report.json")))["exact"]);
}

// Invisibly small rotations do not count as another orientation, and no triangle is lost.
TEST_F(PlainExport, ExactForInvisibleRotations) {
  act(session_.document, R"({"op": "remove", "node": "ball.2"})");
  act(session_.document,
      R"({"op": "select", "node": "ball", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"})");
  act(session_.document,
      R"({"op": "transform", "node": "ball", "selection": true, "rotate": {"axis": [0, 1, 0], "degrees": 1e-8}})");
  const std::size_t triangles = session_.scene().roots[0]->object->triangle_count();
  run(session_, action_);
  EXPECT_EQ(read_any(path("plain"), Axes::y_up).roots[0]->object->triangle_count(), triangles);
}

TEST_F(PlainExport, CancelOrFailureKeepsPreviousFolder) {
  action_.way = FuseMethod::side_by_side;  // the fastest method
  run(session_, action_);
  const auto before = folder_bytes(path("plain"));
  std::atomic<bool> stop = false;
  session_.progress = Progress([&](std::string_view what, double) { stop = what == "fitting features"; }, &stop);
  action_.way.reset();
  action_.keep = "none";
  EXPECT_THROW(run(session_, action_), Cancelled);
  session_.progress = {};
  {
    // Simulates a disk that is full while the result is written.
    PowerLoss calls;
    calls.fail_at(8, ENOSPC);
    const ReplacedFileCalls full(calls);
    action_.way = FuseMethod::side_by_side;
    action_.keep = "auto";
    EXPECT_THROW(run(session_, action_), FileError);
  }
  const auto refuses = [&](const char* fields) {
    nlohmann::json line = nlohmann::json::parse(fields);
    line["op"] = "export";
    line["out"] = path("plain").string();
    if (!line.contains("plain")) line["plain"] = true;
    EXPECT_THROW(run_script(session_, line.dump(), "script", {}), Error) << fields;
  };
  for (const char* fields :
       {R"({"width": 3})", R"({"width": 257})", R"({"width": "wide"})", R"({"keep": "nobody"})", R"({"psnr": -1})",
        R"({"seconds": -1})", R"({"format": "rebake"})", R"({"way": "magic"})", R"({"keep": "ball", "way": "new"})",
        R"({"keep": "ball", "width": 8})", R"({"way": "side_by_side", "width": 20})", R"({"picture_size": 8})",
        R"({"plain": false, "picture_size": 100})", R"({"plain": false, "width": 16})",
        R"({"report": "/nowhere/at/all.json"})"})
    refuses(fields);
  act(session_.document, R"({"op": "hide", "node": "ball"})");
  act(session_.document, R"({"op": "hide", "node": "ball.2"})");
  refuses("{}");
  EXPECT_TRUE(folder_bytes(path("plain")) == before);
  action_.out = path("sources/small").string();
  EXPECT_THROW(run(session_, action_), Error);
}

}  // namespace
}  // namespace rebake::test
