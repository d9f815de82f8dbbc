// Outputs of a run must not overwrite its inputs, by any path: its journal, script, project and cage meshes.
#include "editor/actions/session.h"
#include "editor/edits/nodes/import.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/mobilenerf/baked_files.h"
#include "tests/support/guards_fixture.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

TEST_F(Guards, RejectsOutputsOverTheJournal) {
  fs::create_directory_symlink(path("."), path("link"));
  for (const std::string out : {"work.journal", "link/work.journal", "./work.journal"})
    for (const std::string line :
         {R"({"op": "render", "out": "OUT", "width": 16, "height": 16})", R"({"op": "save_project", "out": "OUT"})",
          R"({"op": "export", "out": "OUT-folder", "plain": true, "report": "OUT"})"}) {
      std::string text = line;
      text.replace(text.find("OUT\""), 3, path(out).string());
      if (const std::size_t at = text.find("OUT-"); at != std::string::npos) text.replace(at, 3, path("x").string());
      write("script.jsonl", import_line() + text);
      EXPECT_EQ(program("run {}/script.jsonl --journal {}/work.journal"), 1) << line;
      EXPECT_EQ(program("recover {}/work.journal -o {}/back.rebake --replace"), 0) << line << '\n' << log();
      EXPECT_NE(log().find("1 edit recovered"), std::string::npos) << log();
      fs::remove(path("work.journal"));
    }
  write("script.jsonl", import_line());
  EXPECT_EQ(program("run {}/script.jsonl --journal {}/work.journal --list-files {}/work.journal"), 1);
  EXPECT_EQ(program("recover {}/work.journal -o {}/back.rebake --replace"), 0) << log();
}

TEST_F(Guards, ListsOfFilesReplaceOnlyLists) {
  write("script.jsonl", import_line() + fmt::format(R"({{"op": "render", "out": "{}", "width": 8, "height": 8}})",
                                                    path("r.png").string()));
  write("notes.txt", "mine\n");
  EXPECT_EQ(program("run {}/script.jsonl --list-files {}/notes.txt"), 1);
  EXPECT_NE(log().find("is not a list of files"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("notes.txt")), "mine\n");
  EXPECT_FALSE(fs::exists(path("r.png"))) << "refused before the run";
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(program("run {}/script.jsonl --list-files {}/list"), 0) << log();
  EXPECT_EQ(program("run {}/script.jsonl --list-files {}/r.png"), 1);
  EXPECT_TRUE(read_file(path("r.png")).starts_with("\x89PNG")) << "an output of the same run";
}

TEST_F(Guards, RejectsProjectOverAnotherJournal) {
  write("script.jsonl", import_line() + R"({"op": "no such op"})");
  EXPECT_EQ(program("run {}/script.jsonl --journal {}/other.rebake"), 1);
  write("save.jsonl",
        import_line() + fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}", path("other.rebake").string()));
  EXPECT_EQ(program("run {}/save.jsonl"), 1);
  EXPECT_NE(log().find("is a journal that may contain unsaved work:"), std::string::npos) << log();
  EXPECT_EQ(program("recover {}/other.rebake -o {}/back.rebake"), 0) << log();
}

TEST_F(Guards, RejectsOutputsOverAnotherRunsJournal) {
  write("failing.jsonl", import_line() + R"({"op": "remove", "node": "none"})");
  EXPECT_EQ(program("run {}/failing.jsonl --journal {}/left.journal"), 1);
  const std::string journal = read_file(path("left.journal"));
  write("script.jsonl", import_line());
  EXPECT_EQ(program("run {}/script.jsonl --list-files {}/left.journal"), 1);
  EXPECT_NE(log().find("may contain unsaved work"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("left.journal")), journal);
}

TEST_F(Guards, ProjectsAreNotReplacedByOtherOutputsNorBySmallerProjects) {
  const std::string save = fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}\n", path("p.rebake").string());
  write("large.jsonl", import_line() + R"({"op": "background", "color": [1, 0, 0]})" + "\n" + save);
  write("small.jsonl", import_line() + save);
  EXPECT_EQ(program("run {}/large.jsonl"), 0) << log();
  EXPECT_EQ(program("run {}/large.jsonl"), 0) << log();
  EXPECT_EQ(log().find("it replaced a project"), std::string::npos) << log();
  write("large.jsonl", import_line() + R"({"op": "background", "color": [0, 1, 0]})" + "\n" + save);
  EXPECT_EQ(program("run {}/large.jsonl"), 0) << log();
  EXPECT_NE(log().find("it replaced a project with 1 other edit\n"), std::string::npos) << log();
  const std::string project = read_file(path("p.rebake"));
  for (const char* command :
       {"run {}/small.jsonl", "run {}/small.jsonl --list-files {}/p.rebake", "render {}/p.rebake -o {}/p.rebake",
        "render " REBAKE_SOURCE "/samples/scenes/kettle -o {}/p.rebake --size 8x8"})
    EXPECT_EQ(program(command), 1) << command;
  write("views.jsonl", import_line() +
                           R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}})" + "\n" +
                           fmt::format("{{\"op\": \"export_views\", \"out\": \"{}\"}}", path("p.rebake").string()));
  EXPECT_EQ(program("run {}/views.jsonl"), 1);
  EXPECT_NE(log().find("is a project, whose edits would be lost"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("p.rebake")), project);
  write("p.rebake", R"({"rebake_project": 99, "sources": [], "edits": []})");
  EXPECT_EQ(program("run {}/large.jsonl"), 1);
  EXPECT_NE(log().find("newer version"), std::string::npos) << log();
}

TEST_F(Guards, ReportsOfTrainingAreReplacedWithTheirSceneButOtherFilesOfThatNameAreNot) {
  write("s.jsonl", import_line() + fmt::format("{{\"op\": \"export\", \"out\": \"{}\"}}\n", path("scene").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  write("scene/rebake_training.json", "notes");
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_EQ(read_file(path("scene/rebake_training.json")), "notes");
  write("scene/rebake_training.json", R"({"software": "Rebake", "scene": "0123456789abcdef"})");
  EXPECT_EQ(program("run {}/s.jsonl"), 1) << "the report of another scene";
  write("scene/rebake_training.json",
        fmt::format(R"({{"software": "Rebake", "scene": "{}"}})", hash_text(baked_hash(path("scene")))));
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  EXPECT_FALSE(fs::exists(path("scene/rebake_training.json"))) << "the report of the scene that was replaced";
}

TEST_F(Guards, ScriptsThatSaveOneProjectSeveralTimesRunAgain) {
  const std::string save = fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}\n", path("p.rebake").string());
  const std::string red = R"({"op": "background", "color": [1, 0, 0]})"
                          "\n";
  write("s.jsonl", import_line() + save + red + save + save);
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  EXPECT_EQ(log().find("a later line"), std::string::npos) << log();
  const std::string project = read_file(path("p.rebake"));
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  EXPECT_NE(log().find("has more edits already; a later line"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("p.rebake")), project);
  // A script that fails between its saves leaves the project of the run before.
  write("s.jsonl", import_line() + save + "{}\n" + save);
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_EQ(read_file(path("p.rebake")), project);
}

TEST_F(Guards, FilesBesideMeshesAreProtected) {
  fs::create_directories(path("obj"));
  write("obj/m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
  write("obj/m.mtl", "newmtl a\nKd 1 0 0\n");
  const std::string before = read_file(path("obj/m.mtl"));
  write("s.jsonl", import_line() + R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}})" +
                       "\n" +
                       fmt::format("{{\"op\": \"export_views\", \"out\": \"{0}/m.mtl\"}}\n"
                                   "{{\"op\": \"import\", \"path\": \"{0}/m.obj\"}}\n",
                                   path("obj").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_NE(log().find("is a file that this script reads"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("obj/m.mtl")), before);
}

TEST_F(Guards, JournalsAreRemovedAndLinksToThemStay) {
  write("script.jsonl", import_line() + "{\"op\": \"nothing\"}\n");
  EXPECT_EQ(program("run {}/script.jsonl --journal {}/work.journal"), 1);
  fs::create_symlink("work.journal", path("link"));
  EXPECT_EQ(program("recover {}/link -o {}/back.rebake"), 0) << log();
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_FALSE(fs::exists(path("work.journal")));
}

TEST_F(Guards, ExportsReplaceNoFilesThatOnlyHaveNamesOfTheScene) {
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  ASSERT_EQ(program("export " + kettle + " -o {}/out"), 0) << log();
  for (const char* name : {"shape99.obj", "shape1.obj", "shape7_3.obj", "shape5.pngfeat0.png"}) {
    write(std::string("out/") + name, "mine");
    EXPECT_EQ(program("export " + kettle + " -o {}/out"), 1) << name;
    EXPECT_NE(log().find("is not part of its scene"), std::string::npos) << log();
    EXPECT_EQ(read_file(path(std::string("out/") + name)), "mine");
    fs::remove(path(std::string("out/") + name));
  }
  EXPECT_EQ(program("export " + kettle + " -o {}/out"), 0) << log();
}

// Names that the system does not resolve, though their resolved form is a file.
TEST_F(Guards, AnotherSpellingOfAnOutputIsNotAnotherFile) {
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  fs::copy(kettle, path("kettle"));
  write_capture();
  write("notes.txt", "mine");
  write("user.glb", "mine");
  write("user.html", "mine");
  write("s.jsonl",
        import_line() + fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}\n", path("p.rebake").string()));
  ASSERT_EQ(program("run {}/s.jsonl"), 0) << log();
  write("failing.jsonl", import_line() + R"({"op": "remove", "node": "none"})");
  EXPECT_EQ(program("run {}/failing.jsonl --journal {}/left.journal"), 1);
  const auto before = folder_bytes(path(""));
  const auto unchanged = [&](const std::string& what) {
    const auto after = folder_bytes(path(""));
    for (const auto& [name, bytes] : before) {
      if (name.find("log") != std::string::npos) continue;
      EXPECT_TRUE(after.contains(name) && after.at(name) == bytes) << what << ": " << name;
    }
  };
  const auto spelled = [](const std::string& file, int how) {
    const std::size_t slash = file.rfind('/');
    const std::string in = slash == std::string::npos ? "" : file.substr(0, slash + 1), name = file.substr(in.size());
    return how == 0   ? file + "/"
           : how == 1 ? file + "/."
           : how == 2 ? in + "missing/../" + name
                      : in + "notes.txt/../" + name;
  };
  for (int how = 0; how < 4; ++how) {
    for (const char* file :
         {"p.rebake", "left.journal", "notes.txt", "kettle/mlp.json", "cap/transforms.json", "cap/images/0.png"}) {
      const std::string command = "render " + kettle + " --size 8x8 -o {}/" + spelled(file, how);
      EXPECT_EQ(program(command), 1) << command;
      unchanged(command);
    }
    for (const std::string& command : {"recover {}/left.journal --keep -o {}/" + spelled("p.rebake", how),
                                       "export " + kettle + " --format gltf -o {}/" + spelled("user.glb", how),
                                       "publish " + kettle + " --single-file -o {}/" + spelled("user.html", how),
                                       "run {}/s.jsonl --list-files {}/" + spelled("notes.txt", how),
                                       "render " + kettle + " --path turntable -o {}/" +
                                           (how < 2 ? std::string("cap/images") : spelled("cap/images", how))}) {
      EXPECT_NE(program(command), 0) << command;
      unchanged(command);
    }
  }
}

TEST_F(Guards, ProjectsOfLinkedFilesOpen) {
  fs::create_directories(path("blobs"));
  write("blobs/abc123", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
  fs::create_symlink(path("blobs/abc123"), path("m.obj"));
  write("s.jsonl",
        fmt::format("{{\"op\": \"import\", \"path\": \"{}\"}}\n{{\"op\": \"save_project\", \"out\": \"{}\"}}\n",
                    path("m.obj").string(), path("p.rebake").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  EXPECT_EQ(program("info {}/p.rebake"), 0) << log();
}

TEST_F(Guards, KeepsDamagedProjectsAndLeftoversThatAreRead) {
  write("failing.jsonl", import_line() + R"({"op": "remove", "node": "none"})");
  EXPECT_EQ(program("run {}/failing.jsonl --journal {}/left.journal"), 1);
  write("damaged.rebake", "{\"rebake_project\": 2, \"edits\": [");
  EXPECT_EQ(program("recover {}/left.journal -o {}/damaged.rebake --replace"), 1);
  EXPECT_NE(log().find("damaged project"), std::string::npos) << log();
  // The leftover of a killed export that the script imports.
  fs::copy(fs::path(REBAKE_SOURCE) / "samples/scenes/kettle", path(".ex.1234abcd.rebake-partial"));
  write("script.jsonl", import_line() + fmt::format("{{\"op\": \"export\", \"out\": \"{}\"}}\n", path("ex").string()) +
                            fmt::format("{{\"op\": \"import\", \"path\": \"{}\", \"as\": \"left\"}}\n",
                                        path(".ex.1234abcd.rebake-partial").string()));
  EXPECT_EQ(program("run {}/script.jsonl"), 0) << log();
}

TEST_F(Guards, EditFailsWithoutItsJournal) {
  Session session;
  session.document.keep_journal(path("work.journal"));
  Import import;
  import.path = REBAKE_SOURCE "/samples/scenes/kettle";
  session.edit(import);
  for (const bool replaced : {false, true}) {
    fs::remove(path("work.journal"));
    if (replaced) write("work.journal", "something else");
    EXPECT_THROW(session.edit(import), FileError);
    EXPECT_EQ(session.scene().roots.size(), 1U) << "an edit that is not acknowledged must not be applied";
  }
  session.document.discard_journal();
  EXPECT_EQ(read_file(path("work.journal")), "something else") << "a foreign file must stay";
}

TEST_F(Guards, RejectsImportThatContainsTheJournal) {
  fs::copy(REBAKE_SOURCE "/samples/scenes/kettle", path("kettle"), fs::copy_options::recursive);
  Session session;
  session.document.keep_journal(path("kettle/work.journal"));
  Import import;
  import.path = path("kettle");
  EXPECT_THROW(session.edit(import), FileError);
  EXPECT_TRUE(session.scene().roots.empty());
  session.document.discard_journal();
}

TEST_F(Guards, LaterImportsMayOnlyBeReplacedAsAWhole) {
  const auto line_of = [&](const char* form) { return fmt::format(fmt::runtime(form), path("later").string()); };
  fs::copy(fs::path(REBAKE_SOURCE) / "samples/scenes/kettle", path("later"), fs::copy_options::recursive);
  const std::string render =
                        line_of("{{\"op\": \"render\", \"out\": \"{}/mlp.json\", \"width\": 16, \"height\": 16}}\n"),
                    import = line_of("{{\"op\": \"import\", \"path\": \"{}\", \"as\": \"later\"}}\n"),
                    exported = line_of("{{\"op\": \"export\", \"out\": \"{}\"}}\n");
  const std::string decoder = read_file(path("later/mlp.json"));
  write("script.jsonl", import_line() + render + import);
  EXPECT_EQ(program("run {}/script.jsonl"), 1);
  EXPECT_EQ(read_file(path("later/mlp.json")), decoder);
  // If a later import expects other contents at that path, the export is refused, because they would be lost.
  write("script.jsonl", import_line() + exported +
                            line_of("{{\"op\": \"import\", \"path\": \"{}\", \"content\": \"0000000000000000\"}}\n"));
  EXPECT_EQ(program("run {}/script.jsonl"), 1);
  EXPECT_NE(log().find("would be written into"), std::string::npos) << log();
  // A script may import its own export, also when it runs again.
  write("script.jsonl", import_line() + exported + import);
  EXPECT_EQ(program("run {}/script.jsonl"), 0) << log();
  EXPECT_EQ(program("run {}/script.jsonl"), 0) << log();
}

TEST_F(Guards, RejectsOutputsOverInputs) {
  write("script.jsonl", import_line());
  EXPECT_EQ(program("run {}/script.jsonl --list-files {}/script.jsonl"), 1);
  EXPECT_EQ(read_file(path("script.jsonl")), import_line());

  write("script.jsonl",
        import_line() + fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}", path("p.rebake").string()));
  ASSERT_EQ(program("run {}/script.jsonl"), 0) << log();
  const std::string project = read_file(path("p.rebake"));
  EXPECT_EQ(program("render {}/p.rebake -o {}/p.rebake --size 16x16"), 1);
  EXPECT_EQ(read_file(path("p.rebake")), project);

  write("camera.json", R"({"eye": [0, 0, 3], "target": [0, 0, 0]})");
  EXPECT_EQ(program("render {}/p.rebake --camera {}/camera.json -o {}/camera.json --size 16x16"), 1);
  EXPECT_EQ(read_file(path("camera.json")), R"({"eye": [0, 0, 3], "target": [0, 0, 0]})");

  const std::string mesh = "v -9 -9 -9\nv 9 -9 -9\nv 0 9 -9\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  write("cage.obj", mesh);
  write(
      "script.jsonl",
      import_line() +
          fmt::format(
              "{{\"op\": \"cage\", \"node\": \"kettle\", \"mesh\": \"{0}\", \"moves\": [{{\"points\": [3], "
              "\"translate\": [0, 0, 1]}}]}}\n{{\"op\": \"render\", \"out\": \"{0}\", \"width\": 16, \"height\": 16}}",
              path("cage.obj").string()));
  EXPECT_EQ(program("run {}/script.jsonl"), 1);
  EXPECT_NE(log().find("a cage mesh that this run reads"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("cage.obj")), mesh);
}

// A file that a later line expects with a known content is not that of an earlier line.
TEST_F(Guards, FilesOfKnownContentAreNotReplacedBeforeTheyAreRead) {
  const std::string view = import_line() +
                           R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}})"
                           "\n";
  const std::string to_views =
      fmt::format("{{\"op\": \"export_views\", \"out\": \"{0}\"}}\n", path("views.json").string());
  write("s.jsonl", view + to_views);
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  const std::string before = read_file(path("views.json"));
  write("s.jsonl",
        view +
            R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 6], "target": [0, 0, 0]}})"
            "\n" +
            to_views +
            fmt::format("{{\"op\": \"import_views\", \"path\": \"{0}\", \"content\": \"0123456789abcdef\"}}\n",
                        path("views.json").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_EQ(read_file(path("views.json")), before);
}

}  // namespace
}  // namespace rebake::test
