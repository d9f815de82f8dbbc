// The light edit: JSON, environment maps as sources, cached results, plain folders and pictures.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "editor/actions/plain_scene.h"
#include "editor/actions/session.h"
#include "editor/document/project.h"
#include "editor/edits/nodes/light.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "mesh_ops/light/lighting.h"
#include "render/graph/effects.h"
#include "render/picture.h"
#include "tests/support/document_fixture.h"
#include "tests/support/edits.h"
#include "tests/support/light_pictures.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

TEST(LightEdit, RoundTripsThroughJson) {
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

TEST(LightEdit, ErrorsNameTheField) {
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

TEST_F(DocumentTest, UndoesAndSavesLight) {
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

Scene last_scene(const fs::path& project, const SourceLinks& links = {}) {
  Scene last;
  read_project(
      project, [&](const History::Entry&, const Scene& after) { last = after; }, links);
  return last;
}

// A scene holds its environment map, so changes of other settings must not need the map's file.
TEST_F(DocumentTest, LightOfAnImportedSceneChangesWithoutThePicturesFile) {
  write_light_picture(path("sky.exr"), 64, [](const Vec3& d) { return Radiance(1 + d.x(), 1, 1); });
  {
    Document first;
    import(first);
    act(first, {{"op", "light"}, {"picture", path("sky.exr").string()}});
    format_named("rebake").write(first.scene(), path("saved"), {}, {});
  }
  fs::remove(path("sky.exr"));
  {
    Document document;
    document.keep_journal(path("journal"));
    act(document, {{"op", "import"}, {"path", path("saved").string()}});
    SceneLight wanted = *document.scene().light;
    wanted.rays = 512;
    document.edit(light_edit(wanted, document.scene()));
    act(document, {{"op", "background"}, {"color", {1, 0, 0}}});
  }
  const Document::Recovered again = Document::recover(path("journal"));
  EXPECT_TRUE(again.gone.empty());
  EXPECT_EQ(again.edits, 3U);
  EXPECT_EQ(again.document.scene().light->rays, 512);
  EXPECT_NE(again.document.scene().light->picture, nullptr);
}

TEST_F(DocumentTest, EnvironmentMapIsASource) {
  write_light_picture(path("sky.exr"), 64, [](const Vec3& d) { return Radiance(1 + d.x(), 1 + d.y(), 1); });
  Document document;
  document.keep_journal(path("journal"));
  import(document);
  // The field "picture" implies the source.
  act(document, {{"op", "light"}, {"picture", path("sky.exr").string()}});
  EXPECT_EQ(document.scene().light->source, SceneLight::Source::picture);
  const SceneLight light = *document.scene().light;
  // Rotated by 90°, +x moves to −z.
  act(document,
      {{"op", "light"}, {"source", "picture"}, {"picture", path("sky.exr").string()}, {"picture_degrees", 90}});
  EXPECT_NEAR(given_light(*document.scene().light)->sky.at({0, 0, -1})[0], given_light(light)->sky.at({1, 0, 0})[0],
              0.02);
  document.undo();
  EXPECT_THROW(document.save(path("sky.exr")), FileError);
  document.save(path("beside.rebake"));
  EXPECT_EQ(*last_scene(path("beside.rebake")).light->picture, *light.picture);

  fs::create_directory(path("elsewhere"));
  fs::rename(path("sky.exr"), path("elsewhere/sky.exr"));
  try {
    last_scene(path("beside.rebake"));
    ADD_FAILURE() << "opened without its picture";
  } catch (const SourcesUnavailable& gone) {
    ASSERT_EQ(gone.sources.size(), 1U);
    EXPECT_EQ(gone.sources[0].path, path("sky.exr"));
  }
  const SourceLinks links{{path("sky.exr"), path("elsewhere/sky.exr")}};
  EXPECT_EQ(last_scene(path("beside.rebake"), links).light->picture->light, light.picture->light);
  document = Document();
  EXPECT_EQ(Document::recover(path("journal")).gone.size(), 1U);
  EXPECT_TRUE(Document::recover(path("journal"), links).gone.empty());
  EXPECT_THROW(act(document, {{"op", "light"}, {"effects", {"none"}}, {"picture", path("sky.exr").string()}}),
               FieldError);
  EXPECT_THROW(act(document, {{"op", "light"}, {"source", "picture"}}), FieldError);
  EXPECT_THROW(act(document, {{"op", "light"}, {"source", "picture"}, {"picture", path("sky.exr").string()}}),
               FileError);
  // Another picture at the same path is not accepted.
  write_light_picture(path("sky.exr"), 64, [](const Vec3&) { return Radiance(1, 1, 1); });
  EXPECT_THROW(last_scene(path("beside.rebake")), SourcesUnavailable);
}

TEST_F(DocumentTest, SavedScenesContainTheirEnvironmentMap) {
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

TEST(LightEdit, PlainFolderContainsCorrectedColours) {
  Scene scene = with_light(table());
  for (const json& line : std::vector<json>{
           {{"op", "select"}, {"box", {{"min", {-0.4, 0.01, -0.4}}, {"max", {0.4, 1, 0.4}}}}}, {{"op", "delete"}}})
    scene = apply(scene, read_edit(line, scene)).scene;
  const Lighting lighting = lighting_of(scene);
  ASSERT_FALSE(lighting.maps.empty());
  PlainReport report;
  FuseOptions options;
  options.way = FuseMethod::keep;
  options.training.steps = 500;
  const Scene plain = plain_scene(scene, lighting, options, report, {});
  EXPECT_FALSE(report.exact) << "one decoder and no bend, but corrected colours";
  EXPECT_EQ(plain.light, nullptr);
  Renderer renderer;
  measure_pictures(renderer, scene, lighting, plain, report, {}, 200);
  // For comparison: as baked, with the shadow of the deleted box.
  PlainReport baked;
  measure_pictures(renderer, scene, lighting, scene, baked, {}, 200);
  // Partly covered pixels limit the PSNR: their mixed features decode differently once light is fitted into them.
  EXPECT_GT(report.whole.psnr_db, 30);
  EXPECT_GT(report.whole.psnr_db, baked.whole.psnr_db + 15);
  // Without light the plain folder is exact.
  PlainReport exact;
  plain_scene(scene, {}, {}, exact, {});
  EXPECT_TRUE(exact.exact);
}

TEST(LightEdit, CachesResults) {
  const Scene scene = with_light(table());
  const Edit bend = read_edit({{"op", "bend"}, {"node", "table"}, {"degrees", 40}, {"axis", {0, 1, 0}}}, scene);
  const Scene bent = apply(scene, bend).scene;
  CountingResults results;
  const Lighting first = lighting_of(bent, {.results = &results});
  const int before = results.found;
  const std::size_t held = results.held.size();
  const Lighting again = lighting_of(bent, {.results = &results});
  EXPECT_GT(results.found, before);
  EXPECT_EQ(results.held.size(), held);
  const auto& a = *first.maps.begin()->second.front();
  const auto& b = *again.maps.begin()->second.front();
  EXPECT_EQ(a.gain, b.gain);
  // Cached results equal uncached ones, up to rounding to float.
  const Lighting without = lighting_of(bent);
  for (std::size_t k = 0; k < a.gain.size(); ++k)
    EXPECT_LT((a.gain[k] - without.maps.begin()->second.front()->gain[k]).norm(), 1e-4F);
  // Damaged results are ignored.
  for (auto& [key, bytes] : results.held) bytes.resize(bytes.size() / 2);
  EXPECT_EQ(lighting_of(bent, {.results = &results}).maps.begin()->second.front()->gain, a.gain);
}

// Light changes pictures of edited scenes; pictures of unedited scenes keep every byte.
TEST(LightEdit, ChangesPicturesOnlyWhereLightChanges) {
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
    // The centre was in the shadow of the deleted box.
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
