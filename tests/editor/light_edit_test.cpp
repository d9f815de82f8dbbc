// Light as an edit: it is data like the others, edits remember what light was baked on, and results are kept.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "editor/commands/plain_scene.h"
#include "editor/commands/session.h"
#include "editor/document/project.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/formats/scene_folder.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/light/irradiance.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/light/transfer_model.h"
#include "render/graph/effects.h"
#include "render/picture.h"
#include "tests/support/document_fixture.h"
#include "tests/support/edits.h"
#include "tests/support/light_pictures.h"
#include "tests/support/lit_objects.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

struct Remembered final : Results {
  std::map<std::string, std::string> held;
  int found = 0;
  std::optional<std::string> find(const std::string& key) override {
    const auto it = held.find(key);
    if (it == held.end()) return std::nullopt;
    ++found;
    return it->second;
  }
  void keep(const std::string& key, std::string_view bytes) override { held[key] = bytes; }
};

// A box over a ground, which it shades under a uniform sky: one object.
Scene table() {
  std::vector<LitQuad> quads = box_quads({-0.3, 0.02, -0.3}, {0.3, 0.6, 0.3}, 2);
  quads.push_back(flat_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 4, 4));
  const auto grey = [](const Vec3&) -> Radiance { return Radiance::Constant(0.4); };
  const auto shape = lit_object(quads, grey);
  const SceneRays rays({{rays_of(*shape), Affine::Identity(), 3}});
  Light sky;
  sky.sky = SkyMap(Radiance::Constant(1));
  return scene_of(lit_object(quads,
                             [&](const Vec3& p) -> Radiance {
                               if (p.y() > 0.01) return Radiance::Constant(0.4);
                               const std::vector<LightSite> site{{p, {0, 1, 0}, {1, 0, 0}, 1e-3}};
                               const std::vector<std::uint8_t> up{1};
                               return 0.4 * traced_light(site, up, rays, sky, Mat3::Identity(), {64})[0].irradiance[0];
                             }),
                  "table");
}

Scene with_light(const Scene& scene) {
  return apply(scene, read_edit({{"op", "light"}, {"source", "uniform"}, {"zenith", {1, 1, 1}}, {"rays", 64}}, scene))
      .scene;
}

bool runs(const Lighting& lighting, const std::string& name) {
  return std::any_of(lighting.decisions.begin(), lighting.decisions.end(),
                     [&](const LightDecision& one) { return one.name == name && one.runs; });
}

const LightDecision* decided(const Lighting& lighting, const std::string& name) {
  for (const LightDecision& one : lighting.decisions)
    if (one.name == name) return &one;
  return nullptr;
}

TEST(LightEdit, IsReadBackAsItWasWritten) {
  const Scene scene = table();
  const json line = {{"op", "light"},        {"effects", {"self", "match"}}, {"source", "sky"}, {"zenith", {1, 2, 3}},
                     {"sun", {0, 1, 1}},     {"sun_degrees", 3.5},           {"budget", 2},     {"rays", 128},
                     {"bounce", {0, 0, 0.5}}};
  const Edit edit = read_edit(line, scene);
  EXPECT_EQ(to_json(edit), to_json(read_edit(to_json(edit), scene)));
  const Scene lit = apply(scene, edit).scene;
  ASSERT_NE(lit.light, nullptr);
  EXPECT_TRUE(lit.light->self && lit.light->match && !lit.light->cast && !lit.light->removed);
  EXPECT_EQ(lit.light->zenith, Radiance(1, 2, 3));
  EXPECT_NEAR(lit.light->sun.direction.norm(), 1, 1e-15);
  EXPECT_EQ(apply(lit, read_edit({{"op", "light"}, {"effects", {"none"}}}, lit)).scene.light, nullptr);
}

TEST(LightEdit, NamesTheFieldThatIsWrong) {
  const Scene scene = table();
  for (const auto& [field, value] : std::vector<std::pair<std::string, json>>{{"effects", {"shade"}},
                                                                              {"effects", json::array()},
                                                                              {"source", "moon"},
                                                                              {"rays", 1},
                                                                              {"budget", -1},
                                                                              {"sun", {0, 0, 0}},
                                                                              {"sun_degrees", 90},
                                                                              {"zenith", {-1, 0, 0}},
                                                                              {"picture_degrees", nullptr},
                                                                              {"content", "0"}}) {
    try {
      json line = {{"op", "light"}, {"source", "sky"}};
      line[field] = value;
      apply(scene, read_edit(line, scene));
      ADD_FAILURE() << field << " was taken: " << value;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  }
}

TEST_F(DocumentTest, LightIsUndoneAndSavedWithTheScene) {
  Document document;
  act(document, R"({"op": "light", "effects": ["cast"], "source": "sky"})");
  ASSERT_NE(document.scene().light, nullptr);
  document.undo();
  EXPECT_EQ(document.scene().light, nullptr);
  document.redo();
  Scene scene = with_added(table(), *scene_of(made_object()).roots.front(), NodeId::none, 1);
  scene.light = document.scene().light;
  format_named("rebake").write(scene, path("lit"), {}, {});
  const Scene back = read_scene_folder(path("lit"), {});
  ASSERT_NE(back.light, nullptr);
  EXPECT_EQ(*back.light, *scene.light);
}

TEST_F(DocumentTest, PictureOfLightIsASourceLikeWhatIsImported) {
  write_light_picture(path("sky.exr"), 64, [](const Vec3& d) { return Radiance(1 + d.x(), 1 + d.y(), 1); });
  Document document;
  document.keep_journal(path("journal"));
  import(document);
  act(document, {{"op", "light"}, {"source", "picture"}, {"picture", path("sky.exr").string()}});
  const SceneLight light = *document.scene().light;
  // Turned by a quarter, +x comes to lie where −z was.
  act(document,
      {{"op", "light"}, {"source", "picture"}, {"picture", path("sky.exr").string()}, {"picture_degrees", 90}});
  EXPECT_NEAR(given_light(*document.scene().light)->sky.at({0, 0, -1})[0], given_light(light)->sky.at({1, 0, 0})[0],
              0.02);
  document.undo();
  EXPECT_THROW(document.save(path("sky.exr")), FileError);
  document.save(path("beside.rebake"));
  EXPECT_EQ(*read_project(path("beside.rebake")).scenes.back().light->picture, *light.picture);

  fs::create_directory(path("elsewhere"));
  fs::rename(path("sky.exr"), path("elsewhere/sky.exr"));
  try {
    read_project(path("beside.rebake"));
    ADD_FAILURE() << "opened without its picture";
  } catch (const SourcesGone& gone) {
    ASSERT_EQ(gone.sources.size(), 1U);
    EXPECT_EQ(gone.sources[0].path, path("sky.exr"));
  }
  const Relinked links{{path("sky.exr"), path("elsewhere/sky.exr")}};
  EXPECT_EQ(read_project(path("beside.rebake"), links).scenes.back().light->picture->light, light.picture->light);
  document = Document();
  EXPECT_EQ(Document::recover(path("journal")).gone.size(), 1U);
  EXPECT_TRUE(Document::recover(path("journal"), links).gone.empty());
  EXPECT_THROW(act(document, {{"op", "light"}, {"effects", {"none"}}, {"picture", path("sky.exr").string()}}),
               FieldError);
  EXPECT_THROW(act(document, {{"op", "light"}, {"source", "picture"}}), FieldError);
  EXPECT_THROW(act(document, {{"op", "light"}, {"source", "picture"}, {"picture", path("sky.exr").string()}}),
               FileError);
  // Another picture of that name is not the one that was taken.
  write_light_picture(path("sky.exr"), 64, [](const Vec3&) { return Radiance(1, 1, 1); });
  EXPECT_THROW(read_project(path("beside.rebake")), SourcesGone);
}

TEST_F(DocumentTest, SavedScenesHoldThePictureOfTheirLight) {
  write_light_picture(path("sky.exr"), 512, [](const Vec3& d) {
    return d.dot(Vec3(0.6, 0.8, 0)) > 0.9998 ? Radiance(2000, 2000, 1000) : Radiance(1 + d.x(), 1 + d.y(), 1);
  });
  Scene scene = scene_of(made_object());
  scene =
      apply(
          scene,
          read_edit(
              {{"op", "light"}, {"source", "picture"}, {"picture", path("sky.exr").string()}, {"picture_degrees", 30}},
              scene))
          .scene;
  ASSERT_EQ(scene.light->picture->light.suns.size(), 1U);
  format_named("rebake").write(scene, path("lit"), {}, {});
  fs::remove(path("sky.exr"));
  const Scene back = read_scene_folder(path("lit"), {});
  ASSERT_TRUE(back.light && back.light->picture);
  EXPECT_EQ(*back.light->picture, *scene.light->picture);
  EXPECT_EQ(*back.light, *scene.light);
  EXPECT_EQ(*given_light(*back.light), *given_light(*scene.light));
}

// What deletes, moves, erases, separates and joins: light knows what there was when it was baked.
TEST(LightEdit, EditsRememberWhatLightWasBakedOn) {
  const Scene scene = with_light(table());
  EXPECT_TRUE(lighting_of(scene).maps.empty());
  const auto after = [](const Scene& from, std::vector<json> lines) {
    Scene made = from;
    for (const json& line : lines) made = apply(made, read_edit(line, made)).scene;
    return made;
  };
  const json box = {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}};
  const Scene cut = after(scene, {box, {{"op", "delete"}}});
  EXPECT_TRUE(runs(lighting_of(cut), "removed shadow table"));
  const Scene lifted =
      after(scene, {box, {{"op", "transform"}, {"node", "table"}, {"selection", true}, {"translate", {0, 2, 0}}}});
  EXPECT_TRUE(runs(lighting_of(lifted), "self-shadow table"));
  EXPECT_FALSE(runs(lighting_of(lifted), "removed shadow table"));
  // Put back, all is as it was but for the rounding of floats.
  const Scene back =
      after(lifted, {{{"op", "transform"}, {"node", "table"}, {"selection", true}, {"translate", {0, -2, 0}}}});
  EXPECT_FALSE(runs(lighting_of(back), "self-shadow table"));
  // Two nodes of one body shade each other as they were baked to.
  const Scene apart = after(scene, {box, {{"op", "separate"}, {"node", "table"}, {"as", "box"}}});
  EXPECT_TRUE(lighting_of(apart).maps.empty());
  EXPECT_TRUE(lighting_of(after(apart, {{{"op", "merge"}, {"nodes", {"table", "box"}}}})).maps.empty());
  EXPECT_TRUE(runs(lighting_of(after(apart, {{{"op", "remove"}, {"node", "box"}}})), "removed shadow table"));
  const Scene erased = after(scene, {{{"op", "erase"}, {"box", {{"min", {-0.4, 0.3, -0.4}}, {"max", {0.4, 1, 0.4}}}}}});
  EXPECT_TRUE(runs(lighting_of(erased), "removed shadow table"));
  // What was separated and moved away leaves its shadow behind no more, and shades where it is now.
  const Scene beside = after(apart, {{{"op", "transform"}, {"node", "box"}, {"translate", {0.5, 0, 0}}}});
  EXPECT_TRUE(runs(lighting_of(beside), "removed shadow table"));
  EXPECT_TRUE(runs(lighting_of(beside), "cast shadow box→table"));
  // A copy is another object; it does not stand for what was removed.
  const Scene copied = after(cut, {{{"op", "duplicate"}, {"node", "table"}, {"translate", {2.1, 0, 0}}}});
  EXPECT_TRUE(runs(lighting_of(copied), "removed shadow table"));
  EXPECT_NE(decided(lighting_of(copied), "cast shadow table.2→table"), nullptr);
  // A little bent and then cut: both are traced as one.
  const Scene both = after(
      scene, {{{"op", "bend"}, {"node", "table"}, {"degrees", 0.01}, {"axis", {1, 0, 0}}, {"direction", {0, 1, 0}}},
              box,
              {{"op", "delete"}}});
  const Lighting of_both = lighting_of(both);
  EXPECT_TRUE(runs(of_both, "self-shadow table") && runs(of_both, "removed shadow table"));
  double most = 1;
  for (const Eigen::Vector3f& gain : of_both.maps.begin()->second.front()->gain)
    most = std::max(most, static_cast<double>(gain[0]));
  EXPECT_GT(most, 1.2);
  // Objects that are joined in another place keep what they were baked on.
  Scene two = after(scene, {{{"op", "duplicate"}, {"node", "table"}, {"translate", {50, 0, 0}}}});
  two = after(two, {{{"op", "merge"}, {"nodes", {"table", "table.2"}}}});
  const Lighting joined = lighting_of(two);
  EXPECT_FALSE(runs(joined, "self-shadow table"));
  EXPECT_FALSE(runs(joined, "removed shadow table"));
}

// A saved scene knows what light was baked on: opened again, light makes the same picture of it.
TEST_F(DocumentTest, SavedScenesKeepWhatLightWasBakedOn) {
  const Scene scene = with_light(table());
  const json box = {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}};
  const json separate = {{"op", "separate"}, {"node", "table"}, {"as", "box"}};
  const std::map<std::string, std::vector<json>> edits = {
      {"cut", {box, {{"op", "delete"}}}},
      {"lifted", {box, {{"op", "transform"}, {"node", "table"}, {"selection", true}, {"translate", {0, 0.4, 0}}}}},
      {"erased", {{{"op", "erase"}, {"box", {{"min", {-0.4, 0.3, -0.4}}, {"max", {0.4, 1, 0.4}}}}}}},
      {"bent", {{{"op", "bend"}, {"node", "table"}, {"degrees", 40}, {"axis", {1, 0, 0}}, {"direction", {0, 1, 0}}}}},
      {"apart", {box, separate}},
      {"beside", {box, separate, {{"op", "transform"}, {"node", "box"}, {"translate", {0.5, 0, 0}}}}},
      {"joined twice",
       {{{"op", "duplicate"}, {"node", "table"}, {"translate", {0.7, 0, 0}}},
        {{"op", "transform"}, {"node", "table.2"}, {"scale", {-1, 1, 1}}},
        {{"op", "merge"}, {"nodes", {"table", "table.2"}}},
        {{"op", "bend"}, {"node", "table"}, {"degrees", 20}, {"axis", {1, 0, 0}}, {"direction", {0, 1, 0}}}}},
      {"joined",
       {{{"op", "duplicate"}, {"node", "table"}, {"translate", {0.7, 0, 0}}},
        {{"op", "merge"}, {"nodes", {"table", "table.2"}}}}},
      {"whole", {}}};
  View view;
  view.camera.eye = {0, 2, 2};
  view.camera.near_plane = 0.1;
  view.camera.far_plane = 10;
  view.width = view.height = 64;
  view.samples = 4;
  Renderer renderer;
  for (const auto& [name, lines] : edits) {
    SCOPED_TRACE(name);
    Scene made = scene;
    for (const json& line : lines) made = apply(made, read_edit(line, made)).scene;
    format_named("rebake").write(made, path(name), {}, {});
    const Scene back = read_scene_folder(path(name), {});
    const Lighting before = lighting_of(made), after = lighting_of(back);
    EXPECT_EQ(before.maps.size(), after.maps.size());
    const Image lit = renderer.render(made, view, {}, &before), again = renderer.render(back, view, {}, &after);
    EXPECT_EQ(lit, again);
    EXPECT_NE(lit == renderer.render(made, view), after.maps.size() > 0) << "light is to be seen where it changes any";
    // Written once more, it is the same, and nothing is there twice.
    format_named("rebake").write(back, path(name + " again"), {}, {});
    EXPECT_EQ(scene_files(path(name)), scene_files(path(name + " again")));
    for (const fs::path& file : scene_files(path(name)))
      EXPECT_EQ(read_file(path(name) / file), read_file(path(name + " again") / file)) << file;
  }
  const auto folders = [&](const std::string& name) {
    return std::count_if(fs::directory_iterator(path(name)), fs::directory_iterator(),
                         [](const auto& entry) { return entry.is_directory(); });
  };
  EXPECT_EQ(folders("whole"), 1) << "nothing was edited";
  EXPECT_EQ(folders("cut"), 2);
  EXPECT_EQ(folders("apart"), 3) << "two parts of one body";
  EXPECT_EQ(folders("joined"), 2) << "two bodies of one shape";
  // Where light does not follow edits, nothing of that is written.
  Scene unlit = apply(scene, read_edit({{"op", "light"}, {"effects", {"none"}}}, scene)).scene;
  for (const json& line : edits.at("lifted")) unlit = apply(unlit, read_edit(line, unlit)).scene;
  format_named("rebake").write(unlit, path("unlit"), {}, {});
  EXPECT_EQ(folders("unlit"), 1);
  EXPECT_FALSE(fs::exists(path("unlit/table/baked.bin")));
  // Nor of a scene that was opened with it.
  Scene dark = read_scene_folder(path("lifted"), {});
  dark.light = nullptr;
  format_named("rebake").write(dark, path("dark"), {}, {});
  EXPECT_EQ(folders("dark"), 1);
  EXPECT_EQ(read_file(path("dark/scene.json")), read_file(path("unlit/scene.json")));
}

TEST_F(DocumentTest, WhatLightWasBakedOnIsReadAsFarAsItCanBe) {
  const Scene scene = with_light(table());
  const json box = {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}};
  const auto moved_by = [&](double way) {
    Scene made = scene;
    for (const json& line : std::vector<json>{
             box, {{"op", "transform"}, {"node", "table"}, {"selection", true}, {"translate", {0, way, 0}}}})
      made = apply(made, read_edit(line, made)).scene;
    return made;
  };
  // Farther than a float reaches.
  format_named("rebake").write(moved_by(1e60), path("far"), {}, {});
  EXPECT_EQ(read_scene_folder(path("far"), {}).roots.size(), 1U);
  // A name as long as file systems take.
  Scene named = moved_by(1);
  named = with_changed(named, named.roots[0]->id, [](Node& node) { node.name = std::string(250, 'n'); });
  format_named("rebake").write(named, path("named"), {}, {});
  EXPECT_EQ(read_scene_folder(path("named"), {}).roots[0]->name, named.roots[0]->name);
  // What is said to be there must be there, and be a list.
  format_named("rebake").write(moved_by(1), path("near"), {}, {});
  const json good = json::parse(read_file(path("near/scene.json")));
  const auto refused = [&](const std::string& what, const std::function<void(json & node)>& change) {
    json changed = good;
    change(changed["nodes"][0]);
    write_text(path("near/scene.json"), changed.dump());
    try {
      read_scene_folder(path("near"), {});
    } catch (const FileError& error) {
      return std::string(error.what()).find(what) != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refused("bodies", [](json& node) { node["bodies"] = {{"a", node["bodies"][0]}}; }));
  EXPECT_TRUE(refused("bodies", [](json& node) { node["bodies"] = json::array(); }));
  EXPECT_TRUE(refused("below the scene", [](json& node) { node["bodies"][0]["folder"] = "../near/table"; }));
  EXPECT_TRUE(refused("12 numbers", [](json& node) { node["bodies"][0]["transform"] = {1, 2}; }));
  fs::remove(path("near/table/baked.bin"));
  EXPECT_TRUE(refused("baked.bin", [](json&) {}));
}

TEST(LightEdit, APlainFolderShowsWhatLightMakesOfColours) {
  Scene scene = with_light(table());
  for (const json& line : std::vector<json>{
           {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}}, {{"op", "delete"}}})
    scene = apply(scene, read_edit(line, scene)).scene;
  const Lighting lighting = lighting_of(scene);
  ASSERT_FALSE(lighting.maps.empty());
  PlainReport report;
  FuseOptions options;
  options.way = FuseWay::keep;
  options.training.steps = 500;
  const Scene plain = plain_scene(scene, lighting, options, report, {});
  EXPECT_FALSE(report.exact) << "one decoder, nothing bent: but the colours are others";
  EXPECT_EQ(plain.light, nullptr);
  Renderer renderer;
  measure_pictures(renderer, scene, lighting, plain, report, {}, 200);
  // As it was baked, the shadow of what is gone stays in the folder.
  PlainReport baked;
  measure_pictures(renderer, scene, lighting, scene, baked, {}, 200);
  // Partly covered pixels limit it: this steep decoder shows them otherwise in another light.
  EXPECT_GT(report.whole.psnr_db, 30);
  EXPECT_GT(report.whole.psnr_db, baked.whole.psnr_db + 15);
  // Without light it needs no fit at all.
  PlainReport exact;
  plain_scene(scene, {}, {}, exact, {});
  EXPECT_TRUE(exact.exact);
}

TEST(LightEdit, GoesAlongWithTrianglesThatMove) {
  const auto after = [](Scene made, const std::vector<json>& lines) {
    for (const json& line : lines) made = apply(made, read_edit(line, made)).scene;
    return made;
  };
  const Scene rest =
      after(table(), {{{"op", "light"}, {"source", "sky"}, {"sun_color", {0, 0, 0}}, {"rays", 1024}},
                      {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}}});
  const NodeId node = rest.roots.front()->id;
  const LightingOptions options{.turning = {node}};
  const Lighting start = lighting_of(rest, options);
  // Nothing moved: nothing changes.
  const auto same = turned_lighting(rest, start, rest);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->maps, start.maps);
  EXPECT_EQ(same->decisions.size(), start.decisions.size());
  const auto turned_by = [&](const json& box, double degrees) {
    json line = {
        {"op", "bend"}, {"node", "table"}, {"degrees", degrees}, {"axis", {0, 1, 0}}, {"direction", {1, 0, 0}}};
    line["box"] = box;
    return after(rest, {line});
  };
  // The box alone is bent: its vertices are split from what stays, and the map is of the new ones.
  const Scene bent = turned_by({{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}, 60);
  const auto turned = turned_lighting(rest, start, bent);
  ASSERT_TRUE(turned);
  EXPECT_NE(turned->map_of(node, 0, bent.roots.front()->object->sets.front()), nullptr);
  EXPECT_TRUE(runs(*turned, "self-shadow table"));
  // Where all turns together, it is what tracing says.
  const Scene tilted = after(rest, {{{"op", "select"}, {"box", {{"min", {-9, -9, -9}}, {"max", {9, 9, 9}}}}},
                                    {{"op", "transform"},
                                     {"node", "table"},
                                     {"selection", true},
                                     {"rotate", {{"axis", {1, 0, 0}}, {"degrees", 40}}}}});
  const Lighting truth = lighting_of(tilted, options);
  const auto &going = start.turning.at(node), &traced = truth.turning.at(node);
  const std::vector<Radiance> light = going->light_on(*tilted.roots.front()->object);
  double off = 0, all = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    off += (light[i] - traced->start().after[i]).squaredNorm();
    all += (going->start().after[i] - traced->start().after[i]).squaredNorm();
  }
  EXPECT_GT(std::sqrt(all / static_cast<double>(light.size())), 0.1);
  EXPECT_LT(std::sqrt(off / all), 0.1) << "64 rays of the transfer are 4 % off";
  // Where more than triangles moved, it says nothing.
  EXPECT_FALSE(turned_lighting(rest, start, after(rest, {{{"op", "delete"}}})));
  EXPECT_FALSE(
      turned_lighting(rest, start, after(rest, {{{"op", "transform"}, {"node", "table"}, {"translate", {1, 0, 0}}}})));
  EXPECT_FALSE(turned_lighting(rest, lighting_of(rest), bent)) << "nobody asked for this node";
}

TEST(LightEdit, WhatWasLearntIsUsedWithinItsRange) {
  // The box is lifted: nothing turns, but the ground below sees the sky again.
  Scene rest = with_light(table());
  const json box = {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}};
  rest = apply(rest, read_edit(box, rest)).scene;
  const NodeId node = rest.roots.front()->id;
  const auto lifted = [&](double by) {
    const json line = {{"op", "transform"}, {"node", "table"}, {"selection", true}, {"translate", {0, by, 0}}};
    return apply(rest, read_edit(line, rest)).scene;
  };
  Remembered store;
  LightingOptions options;
  options.results = &store;
  options.turning = {node};
  const auto turning_now = [&](const Scene& scene) { return lighting_of(scene, options).turning.at(node); };
  const auto plain = turning_now(rest);
  const TransferModel model = learnt_model(*plain, [&](int k) { return lifted(0.02 * k).roots.front()->object; },
                                           {.poses = 24, .rays = 64, .keys = 600});
  const std::string bytes = bytes_of(model);
  store.keep(transfer_model_key(*rest.roots.front()->object, model.sites), bytes);
  const auto learnt = turning_now(rest);
  const Scene moved = lifted(0.31);
  const std::vector<Radiance> truth = turning_now(moved)->start().after;
  const auto off = [&](const TurnedLight& turning) {
    const std::vector<Radiance> light = turning.light_on(*moved.roots.front()->object);
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += (light[i] - truth[i]).squaredNorm();
    return std::sqrt(sum);
  };
  EXPECT_LT(off(*learnt), 0.45 * off(*plain));
  EXPECT_EQ(learnt->light_on(*rest.roots.front()->object), learnt->start().after) << "nothing jumps";
  const auto why = [&](const Scene& scene) {
    const auto lighting = turned_lighting(rest, lighting_of(rest, options), scene);
    return lighting->decisions.back().why;
  };
  EXPECT_NE(why(moved).find("as was learnt"), std::string::npos) << why(moved);
  const Scene far = lifted(5);
  EXPECT_NE(why(far).find("times as far out"), std::string::npos) << why(far);
  EXPECT_EQ(learnt->light_on(*far.roots.front()->object), plain->light_on(*far.roots.front()->object));

  // As bytes it is the same; damaged or of something else it is refused.
  const TransferModel read = transfer_model_of(bytes);
  EXPECT_EQ(bytes_of(read), bytes);
  for (const std::size_t size : {std::size_t{0}, std::size_t{40}, bytes.size() / 2, bytes.size() - 1})
    EXPECT_THROW(transfer_model_of(std::string_view(bytes).substr(0, size)), Error);
  std::string damaged = bytes;
  damaged[bytes.size() / 2] ^= 1;
  EXPECT_THROW(transfer_model_of(damaged), Error);
  EXPECT_THROW(transfer_model_of("P6 1 1 255\n"), Error);
  // Of another object it is not even asked for.
  const Scene other = with_light(scene_of(
      lit_object(box_quads({0, 0, 0}, {1, 1, 1}), [](const Vec3&) -> Radiance { return Radiance::Constant(0.4); }),
      "other"));
  LightingOptions of_other = options;
  of_other.turning = {other.roots.front()->id};
  EXPECT_EQ(lighting_of(other, of_other).turning.begin()->second->start().model, nullptr);
  // And not learnt from an object that edits moved.
  EXPECT_THROW(learnt_model(*turning_now(moved), [&](int) { return moved.roots.front()->object; }, {.poses = 8}),
               Error);
}

TEST(LightEdit, ResultsAreFoundAgain) {
  const Scene scene = with_light(table());
  const Edit bend = read_edit({{"op", "bend"}, {"node", "table"}, {"degrees", 40}, {"axis", {0, 1, 0}}}, scene);
  const Scene bent = apply(scene, bend).scene;
  Remembered results;
  const Lighting first = lighting_of(bent, {.results = &results});
  const int before = results.found;
  const std::size_t held = results.held.size();
  const Lighting again = lighting_of(bent, {.results = &results});
  EXPECT_GT(results.found, before);
  EXPECT_EQ(results.held.size(), held);
  const auto& a = *first.maps.begin()->second.front();
  const auto& b = *again.maps.begin()->second.front();
  EXPECT_EQ(a.gain, b.gain);
  // What is kept is what is worked out without a place to keep it, but for its rounding to floats.
  const Lighting without = lighting_of(bent);
  for (std::size_t k = 0; k < a.gain.size(); ++k)
    EXPECT_LT((a.gain[k] - without.maps.begin()->second.front()->gain[k]).norm(), 1e-4F);
  // Damaged results count as not there.
  for (auto& [key, bytes] : results.held) bytes.resize(bytes.size() / 2);
  EXPECT_EQ(lighting_of(bent, {.results = &results}).maps.begin()->second.front()->gain, a.gain);
}

// A picture changes where light does, and keeps its bytes where nothing was edited.
TEST(LightEdit, PicturesChangeWithTheLightOnly) {
  const Scene scene = with_light(table());
  const Scene cut = [&] {
    Scene made = scene;
    for (const json& line : std::vector<json>{
             {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}}, {{"op", "delete"}}})
      made = apply(made, read_edit(line, made)).scene;
    return made;
  }();
  Renderer renderer;
  for (const int samples : {1, 4}) {
    View view;
    view.camera.eye = {0, 2, 2};
    view.camera.near_plane = 0.1;
    view.camera.far_plane = 10;
    view.width = view.height = 64;
    view.samples = samples;
    const Lighting nothing = lighting_of(scene), light = lighting_of(cut);
    EXPECT_EQ(renderer.render(scene, view, {}, &nothing), renderer.render(scene, view));
    const Image plain = renderer.render(cut, view), lit = renderer.render(cut, view, {}, &light);
    // The middle was in the box's shade.
    const std::size_t middle = (32 * 64 + 32) * 3;
    EXPECT_GT(lit.rgb[middle], plain.rgb[middle] + 20) << samples;
    RenderOptions deferred;
    deferred.shading = RenderOptions::Shading::deferred;
    const Image other = renderer.render(cut, view, deferred, &light);
    EXPECT_NEAR(other.rgb[middle], lit.rgb[middle], 1);
    const FramePlan frame = plan(cut, view, {}, nullptr, &light);
    EXPECT_TRUE(frame.runs(effects::light));
    EXPECT_FALSE(plan(scene, view, {}, nullptr, &nothing).runs(effects::light));
  }
}

}  // namespace
}  // namespace rebake::test
