// Views from camera files, and camera files from views.
#include "editor/edits/nodes/import_views.h"

#include <gtest/gtest.h>

#include "editor/actions/export_views.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "tests/support/document_fixture.h"

namespace rebake::test {
namespace {

using nlohmann::json;

class ImportViewsTest : public DocumentTest {
 protected:
  // Two cameras where z points up: at (0, −4, 0), looking at the origin, and 1 higher.
  std::string cameras(const std::string& name, double distance = 4) const {
    json frames = json::array();
    for (int k = 0; k < 2; ++k)
      frames.push_back({{"file_path", "train/r_" + std::to_string(k)},
                        {"transform_matrix", {{1, 0, 0, 0}, {0, 0, -1, -distance}, {0, 1, 0, k}, {0, 0, 0, 1}}}});
    std::filesystem::create_directories(path(name).parent_path());
    write_text(path(name), json{{"w", 80}, {"h", 60}, {"fl_x", 70}, {"frames", frames}}.dump());
    return path(name).string();
  }
  json import_of(const std::string& name) const { return {{"op", "import_views"}, {"path", path(name).string()}}; }
};

TEST_F(ImportViewsTest, NamesThemAfterThePhotographs) {
  cameras("transforms.json");
  Document document;
  json edit = import_of("transforms.json");
  edit["prefix"] = "photo ";
  edit["scale"] = 2.5;
  act(document, edit);
  const auto& views = document.scene().views;
  ASSERT_EQ(views.size(), 2U);
  EXPECT_EQ(views.at("photo r_0").eye, Vec3(0, 0, 10));
  EXPECT_EQ(views.at("photo r_1").eye, Vec3(0, 2.5, 10));
  EXPECT_EQ(views.at("photo r_0").up, Vec3(0, 1, 0));
  document.undo(1, {});
  EXPECT_TRUE(document.scene().views.empty());
}

TEST_F(ImportViewsTest, WorldAxisCanBeGiven) {
  cameras("transforms.json");
  Document document;
  json edit = import_of("transforms.json");
  edit["world"] = "y_up";
  edit["format"] = "transforms";
  act(document, edit);
  EXPECT_EQ(document.scene().views.at("r_0").eye, Vec3(0, -4, 0));
}

TEST_F(ImportViewsTest, ErrorsNameTheField) {
  cameras("transforms.json");
  Document document;
  for (const auto& [field, value] : std::vector<std::pair<std::string, json>>{
           {"path", ""}, {"format", "obj"}, {"world", "up"}, {"scale", 0}, {"scale", -1}, {"content", "0"}}) {
    json edit = import_of("transforms.json");
    edit[field] = value;
    try {
      act(document, edit);
      ADD_FAILURE() << field << " was taken: " << value;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(field == "content" ? "has changed" : field), std::string::npos)
          << error.what();
    }
  }
  EXPECT_THROW(act(document, import_of("nowhere.json")), FileError);
}

TEST_F(ImportViewsTest, ProjectsReplayThemAndNoticeChanges) {
  cameras("shoot/transforms.json");
  Document document;
  import(document);
  act(document, import_of("shoot"));
  document.save(path("a.rebake"), {});
  const Document opened = Document::open(path("a.rebake"), {}, {});
  EXPECT_EQ(opened.scene().views.at("r_0"), document.scene().views.at("r_0"));
  cameras("shoot/transforms.json", 5);
  EXPECT_THROW(Document::open(path("a.rebake"), {}, {}), SourcesUnavailable);
  cameras("moved/transforms.json");
  EXPECT_EQ(Document::open(path("a.rebake"), {{path("shoot"), path("moved")}}, {}).scene().views,
            document.scene().views);
}

TEST_F(ImportViewsTest, ColmapModelsAreHashedAsAWhole) {
  std::filesystem::create_directories(path("shoot/sparse/0"));
  write_text(path("shoot/sparse/0/cameras.txt"), "1 PINHOLE 80 60 70 70 40 30\n");
  write_text(path("shoot/sparse/0/images.txt"), "1 1 0 0 0 0 0 4 1 a.png\n\n");
  Document document;
  act(document, import_of("shoot"));
  EXPECT_EQ(document.scene().views.at("a").eye, Vec3(0, 0, -4));
  document.save(path("a.rebake"), {});
  EXPECT_EQ(Document::open(path("a.rebake"), {}, {}).scene().views, document.scene().views);
  write_text(path("shoot/sparse/0/cameras.txt"), "1 PINHOLE 80 60 71 70 40 30\n");
  EXPECT_THROW(Document::open(path("a.rebake"), {}, {}), SourcesUnavailable);
  EXPECT_THROW(document.sources().check_file(path("shoot/sparse/0/cameras.txt")), FileError);
}

TEST_F(ImportViewsTest, FormatDecidesWhereAFolderHasTwo) {
  cameras("shoot/transforms.json");
  std::filesystem::create_directories(path("shoot/sparse/0"));
  write_text(path("shoot/sparse/0/cameras.txt"), "1 PINHOLE 80 60 70 70 40 30\n");
  write_text(path("shoot/sparse/0/images.txt"), "1 1 0 0 0 0 0 4 1 a.png\n\n");
  Document document;
  json edit = import_of("shoot");
  edit["format"] = "colmap";
  act(document, edit);
  EXPECT_EQ(document.scene().views.size(), 1U);
  document.save(path("a.rebake"), {});
  EXPECT_EQ(Document::open(path("a.rebake"), {}, {}).scene().views, document.scene().views);
}

TEST_F(ImportViewsTest, SizesOfPhotographsBelongToTheContent) {
  std::string text = R"({"camera_angle_x": 0.7, "frames": [{"file_path": "a", "transform_matrix":)"
                     R"( [[1,0,0,0],[0,0,-1,-4],[0,1,0,0],[0,0,0,1]]}]})";
  std::filesystem::create_directories(path("shoot"));
  write_text(path("shoot/transforms.json"), text);
  write_text(path("shoot/a.png"), encode_png(40, 10, 3, std::vector<std::uint8_t>(1200), 1));
  Document document;
  act(document, import_of("shoot"));
  document.save(path("a.rebake"), {});
  EXPECT_NO_THROW(Document::open(path("a.rebake"), {}, {}));
  std::filesystem::remove(path("shoot/a.png"));
  EXPECT_THROW(Document::open(path("a.rebake"), {}, {}), SourcesUnavailable) << "the field of view would change";
}

TEST_F(ImportViewsTest, ExportedViewsAreImportedAgain) {
  Session session;
  for (int k = 0; k < 3; ++k) {
    Camera camera;
    camera.eye = {3.0 + k, 2, 1};
    camera.target = {0.1, 0.2, 0.3};
    camera.near_plane = camera.far_plane = 0;
    session.edit(
        read_edit({{"op", "view"}, {"name", "v" + std::to_string(k)}, {"camera", Codec<Camera>::write(camera)}},
                  session.scene()));
  }
  for (const char* format : {"transforms", "nerfstudio_path"}) {
    const auto action = read_action<ExportViewsAction>(
        {{"out", path("out.json").string()}, {"format", format}, {"views", {"v2", "v0"}}, {"width", 64}},
        session.scene());
    run(session, action);
    Document document;
    act(document, import_of("out.json"));
    const auto& views = document.scene().views;
    ASSERT_EQ(views.size(), 2U) << format;
    const Camera& back = views.at(std::string(format) == "transforms" ? "v0" : "camera 1");
    EXPECT_LE((back.eye - Vec3(3, 2, 1)).norm(), 1e-15) << format;
    EXPECT_LE((back.target - Vec3(0.1, 0.2, 0.3)).norm(), 1e-12) << format;
    EXPECT_NEAR(back.fov_degrees, 39, 1e-12) << format;
  }
}

TEST_F(ImportViewsTest, PhotographsOutsideTheFolderAreProtected) {
  json frames =
      json::array({{{"file_path", "../photos/a"}, {"transform_matrix", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 2}}}}});
  std::filesystem::create_directories(path("photos"));
  std::filesystem::create_directories(path("shoot"));
  write_text(path("photos/a.png"), "a photograph");
  write_text(path("shoot/transforms.json"), json{{"w", 80}, {"h", 60}, {"fl_x", 70}, {"frames", frames}}.dump());
  Document document;
  act(document, import_of("shoot/transforms.json"));
  EXPECT_THROW(document.sources().check_file(path("photos/a.png")), FileError);
}

TEST_F(ImportViewsTest, ExportNeverReplacesAJournal) {
  Session session;
  session.edit(read_edit({{"op", "view"}, {"name", "v"}, {"camera", json::object()}}, session.scene()));
  write_text(path("j"), "{\"rebake_journal\": 3}\n");
  EXPECT_THROW(run(session, read_action<ExportViewsAction>({{"out", path("j").string()}}, session.scene())), FileError);
}

TEST_F(ImportViewsTest, ExportErrorsNameTheField) {
  Session session;
  const std::string out = path("out.json").string();
  session.edit(read_edit({{"op", "view"}, {"name", "v"}, {"camera", {{"ortho_height", 2}}}}, session.scene()));
  for (const auto& [field, value] : std::vector<std::pair<std::string, json>>{
           {"out", ""}, {"format", "colmap"}, {"views", {"w"}}, {"width", 0}, {"height", -1}, {"camera", nullptr}}) {
    json line = {{"out", out}};
    if (!value.is_null()) line[field] = value;
    try {
      run(session, read_action<ExportViewsAction>(line, session.scene()));
      ADD_FAILURE() << field << " was taken: " << value;
    } catch (const FieldError& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace rebake::test
