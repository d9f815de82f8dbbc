// Export: which folders it replaces, and its report.
#include <gtest/gtest.h>

#include <algorithm>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

TEST(Export, RejectsFolderWithOtherFiles) {
  const TemporaryFolder temporary;
  write_text(temporary.path() / "thesis.tex", "precious");
  EXPECT_THROW(export_scene(scene_of(made_object()), temporary.path(), {}), FileError);
  EXPECT_EQ(folder_bytes(temporary.path()), (std::map<std::string, std::string>{{"thesis.tex", "precious"}}));
}

TEST(Export, RejectsFolderOfOtherScenes) {
  const TemporaryFolder temporary;
  for (const char* name : {"a", "b"}) export_scene(scene_of(made_object()), temporary.path() / "library" / name, {});
  const auto before = folder_bytes(temporary.path());
  EXPECT_THROW(export_scene(scene_of(made_object()), temporary.path() / "library", {}), FileError);
  EXPECT_EQ(folder_bytes(temporary.path()), before);
}

// Files with the names of scene files but other contents do not make a folder a scene.
TEST(Export, RejectsFilesWithoutSceneContents) {
  for (const auto& [name, text] : {std::pair("scene.json", R"({"mine": 1})"), std::pair("mlp.json", "{}"),
                                   std::pair("shape12.obj", "v 0 0 0"), std::pair("turns.bin", "")}) {
    const TemporaryFolder temporary;
    fs::create_directories(temporary.path() / "out");
    write_text(temporary.path() / "out" / name, text);
    const auto before = folder_bytes(temporary.path());
    EXPECT_THROW(export_scene(scene_of(made_object()), temporary.path() / "out", {}), FileError) << name;
    EXPECT_EQ(folder_bytes(temporary.path()), before);
  }
}

// Two scenes in one folder are read as one of them; the files of the other are not replaced.
TEST(Export, RejectsFoldersOfTwoScenes) {
  Scene two = scene_of(made_object({.columns = 4, .rows = 2, .seed = 1}));
  Node other;
  other.object = made_object({.columns = 4, .rows = 2, .seed = 2});
  two = with_added(two, other, NodeId::none, 9);
  const Scene one = scene_of(made_object({.columns = 4, .rows = 2}));
  for (const bool rebake_first : {false, true}) {
    const TemporaryFolder temporary;
    const fs::path out = temporary.path() / "out", added = temporary.path() / "added";
    export_scene(rebake_first ? two : one, out, {});
    export_scene(rebake_first ? one : two, added, {});
    fs::copy(added, out, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    const auto before = folder_bytes(out);
    EXPECT_THROW(export_scene(one, out, {}), FileError) << rebake_first;
    EXPECT_EQ(folder_bytes(out), before);
  }
}

TEST(Export, ReplacesSidecarFilesByTheirContentOnly) {
  const TemporaryFolder temporary;
  const Scene scene = scene_of(made_object({.columns = 4, .rows = 2}));
  for (const char* name : {"baked.bin", "turns.bin", "turns.json", "rebake_training.json"}) {
    const fs::path out = temporary.path() / name;
    export_scene(scene, out, {});
    export_scene(scene, out, {});
    write_text(out / name, R"({"software": "Rebake", "my notes": ""})");
    EXPECT_THROW(export_scene(scene, out, {}), FileError) << name;
    EXPECT_TRUE(read_file(out / name).starts_with("{"));
  }
}

TEST(Export, FollowsLinksAndReplacesItsOwnScene) {
  const TemporaryFolder temporary;
  Scene two = scene_of(made_object({.seed = 1}));
  Node other;
  other.object = made_object({.seed = 2});
  two = with_added(two, other, NodeId::none, 9);
  EXPECT_FALSE(export_scene(two, temporary.path() / "real", {}).one_folder);
  fs::create_directory_symlink(temporary.path() / "real", temporary.path() / "link");
  EXPECT_TRUE(export_scene(scene_of(made_object()), temporary.path() / "link", {}).one_folder);
  EXPECT_TRUE(fs::is_symlink(temporary.path() / "link"));
  EXPECT_FALSE(fs::exists(temporary.path() / "real/scene.json"));
}

TEST(Export, OmitsHiddenNodesAndJoinsEqualRotations) {
  const TemporaryFolder temporary;
  Scene scene = scene_of(made_object());
  Node other;
  other.object = scene.roots[0]->object;
  scene = with_added(scene, other, NodeId::none, 9);
  const Eigen::AngleAxisd turn(0.5, Vec3(1, 2, 3).normalized());
  scene = with_changed(scene, scene.roots[0]->id, [&](Node& n) { n.to_parent = turn; });
  scene = with_changed(scene, scene.roots[1]->id, [&](Node& n) { n.to_parent = Affine(turn * Eigen::Scaling(2.0)); });
  EXPECT_TRUE(export_scene(scene, temporary.path() / "both", {}).one_folder);
  scene = with_changed(scene, scene.roots[1]->id, [&](Node& n) { n.visible = false; });
  const ExportReport report = export_scene(scene, temporary.path() / "one", {});
  EXPECT_TRUE(report.one_folder);
  EXPECT_NE(report.notes.front().find("hidden"), std::string::npos);
  EXPECT_EQ(read_any(temporary.path() / "one", Axes::y_up).roots[0]->object->triangle_count(), 256U);
}

TEST(Export, ReportsChangedDrawingOrder) {
  const auto notes_of = [](std::initializer_list<unsigned> seeds) {
    Scene scene;
    for (const unsigned seed : seeds) {
      Node node;
      node.object = made_object({.columns = 4, .rows = 2, .seed = seed});
      scene = with_added(scene, node, NodeId::none, 99);
    }
    const TemporaryFolder out;
    std::string all;
    for (const std::string& note : export_scene(scene, out.path() / "out", {}).notes) all += note;
    return all;
  };
  EXPECT_NE(notes_of({1, 2, 1}).find("drawn together"), std::string::npos);
  EXPECT_EQ(notes_of({1, 1, 2}).find("drawn together"), std::string::npos);
}

TEST(Export, SaysWhatSeparatesFolders) {
  const auto note_of = [](std::initializer_list<std::pair<unsigned, Layout>> objects) {
    Scene scene;
    for (const auto& [seed, layout] : objects) {
      Node node;
      node.object = made_object({.columns = 4, .rows = 2, .seed = seed, .layout = layout});
      scene = with_added(scene, node, NodeId::none, 99);
    }
    const TemporaryFolder out;
    const auto notes = export_scene(scene, out.path() / "out", {}).notes;
    const auto found =
        std::find_if(notes.begin(), notes.end(), [](const auto& note) { return note.starts_with("one folder holds"); });
    return found == notes.end() ? "" : *found;
  };
  EXPECT_EQ(note_of({{1, Layout::split}, {2, Layout::split}}),
            "one folder holds one decoder in one orientation: wrote scene.json with 2 folders");
  EXPECT_EQ(note_of({{1, Layout::split}, {1, Layout::chunked}}),
            "one folder holds one file layout (option layout): wrote scene.json with 2 folders");
  EXPECT_EQ(note_of({{1, Layout::split}, {2, Layout::chunked}}),
            "one folder holds one decoder in one orientation, one file layout (option layout): wrote scene.json with 2 "
            "folders");
}

TEST(Export, OntoItsOwnSourceIsSafe) {
  const TemporaryFolder temporary;
  export_scene(scene_of(made_object()), temporary.path() / "a", {});
  const auto before = folder_bytes(temporary.path() / "a");
  export_scene(read_any(temporary.path() / "a", Axes::y_up), temporary.path() / "a", {});
  EXPECT_EQ(folder_bytes(temporary.path() / "a"), before);
}

TEST(Export, FailureKeepsPreviousFolder) {
  const TemporaryFolder temporary;
  export_scene(scene_of(made_object()), temporary.path() / "a", {});
  const auto before = folder_bytes(temporary.path() / "a");
  Scene broken = scene_of(made_object({.seed = 2}));
  auto object = std::make_shared<BakedObject>(*broken.roots[0]->object);
  object->sets[0].soup = Soup();  // no triangles to write
  broken = with_changed(broken, broken.roots[0]->id, [&](Node& n) { n.object = object; });
  EXPECT_THROW(export_scene(broken, temporary.path() / "a", {}), Error);
  EXPECT_EQ(folder_bytes(temporary.path() / "a"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(temporary.path()), {}), 1);
}

}  // namespace
}  // namespace rebake::test
