// Edits remember the geometry that light was baked on, and saved scenes store it.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "editor/actions/session.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/light/lighting.h"
#include "render/picture.h"
#include "tests/support/document_fixture.h"
#include "tests/support/edits.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Light knows the geometry at baking time after delete, transform, separate, merge, remove, erase, duplicate and bend.
TEST(LightEdit, EditsRememberBakedGeometry) {
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
  // Moved back, the geometry is as baked, up to rounding to float.
  const Scene back =
      after(lifted, {{{"op", "transform"}, {"node", "table"}, {"selection", true}, {"translate", {0, -2, 0}}}});
  EXPECT_FALSE(runs(lighting_of(back), "self-shadow table"));
  // The shadows between two nodes of one body are already in the baked colours.
  const Scene apart = after(scene, {box, {{"op", "separate"}, {"node", "table"}, {"as", "box"}}});
  EXPECT_TRUE(lighting_of(apart).maps.empty());
  EXPECT_TRUE(lighting_of(after(apart, {{{"op", "merge"}, {"nodes", {"table", "box"}}}})).maps.empty());
  EXPECT_TRUE(runs(lighting_of(after(apart, {{{"op", "remove"}, {"node", "box"}}})), "removed shadow table"));
  const Scene erased = after(scene, {{{"op", "erase"}, {"box", {{"min", {-0.4, 0.3, -0.4}}, {"max", {0.4, 1, 0.4}}}}}});
  EXPECT_TRUE(runs(lighting_of(erased), "removed shadow table"));
  // A part that was separated and moved takes away its baked shadow and casts a new one where it is now.
  const Scene beside = after(apart, {{{"op", "transform"}, {"node", "box"}, {"translate", {0.5, 0, 0}}}});
  EXPECT_TRUE(runs(lighting_of(beside), "removed shadow table"));
  EXPECT_TRUE(runs(lighting_of(beside), "cast shadow box→table"));
  // A copy is another object and does not replace the removed part.
  const Scene copied = after(cut, {{{"op", "duplicate"}, {"node", "table"}, {"translate", {2.1, 0, 0}}}});
  EXPECT_TRUE(runs(lighting_of(copied), "removed shadow table"));
  EXPECT_NE(decision_named(lighting_of(copied), "cast shadow table.2→table"), nullptr);
  // Bent slightly and then cut: both changes are traced together.
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
  // Objects that are merged from different places keep the geometry that they were baked on.
  Scene two = after(scene, {{{"op", "duplicate"}, {"node", "table"}, {"translate", {50, 0, 0}}}});
  two = after(two, {{{"op", "merge"}, {"nodes", {"table", "table.2"}}}});
  const Lighting joined = lighting_of(two);
  EXPECT_FALSE(runs(joined, "self-shadow table"));
  EXPECT_FALSE(runs(joined, "removed shadow table"));
}

// A saved scene stores the geometry that light was baked on: read again, light gives the same picture.
TEST_F(DocumentTest, SavedScenesStoreBakedGeometry) {
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
    EXPECT_NE(lit == renderer.render(made, view), after.maps.size() > 0)
        << "light must change the picture if it has maps";
    // Saved again, the files are the same, without duplicates.
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
  // If light does not follow edits, none of that is written.
  Scene unlit = apply(scene, read_edit({{"op", "light"}, {"effects", {"none"}}}, scene)).scene;
  for (const json& line : edits.at("lifted")) unlit = apply(unlit, read_edit(line, unlit)).scene;
  format_named("rebake").write(unlit, path("unlit"), {}, {});
  EXPECT_EQ(folders("unlit"), 1);
  EXPECT_FALSE(fs::exists(path("unlit/table/baked.bin")));
  // Nor for a scene that was read with it.
  Scene dark = read_scene_folder(path("lifted"), {});
  dark.light = nullptr;
  format_named("rebake").write(dark, path("dark"), {}, {});
  EXPECT_EQ(folders("dark"), 1);
  EXPECT_EQ(read_file(path("dark/scene.json")), read_file(path("unlit/scene.json")));
}

TEST_F(DocumentTest, ReadsExtremeBakedGeometryAndRejectsInvalid) {
  const Scene scene = with_light(table());
  const json box = {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}};
  const auto moved_by = [&](double way) {
    Scene made = scene;
    for (const json& line : std::vector<json>{
             box, {{"op", "transform"}, {"node", "table"}, {"selection", true}, {"translate", {0, way, 0}}}})
      made = apply(made, read_edit(line, made)).scene;
    return made;
  };
  // Beyond the range of float.
  format_named("rebake").write(moved_by(1e60), path("far"), {}, {});
  EXPECT_EQ(read_scene_folder(path("far"), {}).roots.size(), 1U);
  // A name of the maximum length of file systems.
  Scene named = moved_by(1);
  named = with_changed(named, named.roots[0]->id, [](Node& node) { node.name = std::string(250, 'n'); });
  format_named("rebake").write(named, path("named"), {}, {});
  EXPECT_EQ(read_scene_folder(path("named"), {}).roots[0]->name, named.roots[0]->name);
  // Bodies that are missing or malformed are errors.
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
  EXPECT_TRUE(
      refused("must be inside the scene's folder", [](json& node) { node["bodies"][0]["folder"] = "../near/table"; }));
  EXPECT_TRUE(refused("12 numbers", [](json& node) { node["bodies"][0]["transform"] = {1, 2}; }));
  fs::remove(path("near/table/baked.bin"));
  EXPECT_TRUE(refused("baked.bin", [](json&) {}));
}

}  // namespace
}  // namespace rebake::test
