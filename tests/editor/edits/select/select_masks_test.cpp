// Selections from masks of photographs: masks that are cast from known nodes, also wrong, noisy and missing ones.
#include "editor/edits/select/select_masks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <set>

#include "editor/script/script_inputs.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/index/index.h"
#include "tests/support/document_fixture.h"

namespace rebake::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

class SelectMasksTest : public DocumentTest {
 protected:
  static constexpr int photographs = 12, width = 160, height = 120;

  // Two balls beside each other; the cameras stand on a ring around them.
  SelectMasksTest() {
    import(document_);
    act(document_, R"({"op": "duplicate", "node": "ball", "as": "other", "translate": [2.5, 0, 0]})");
    std::vector<PhotoCamera> cameras;
    for (int k = 0; k < photographs; ++k) {
      const double angle = 2 * std::numbers::pi * k / photographs;
      Camera view;
      view.target = {1.25, 0, 0};
      view.eye = view.target + Vec3(6 * std::cos(angle), 2 * std::sin(3 * angle), 6 * std::sin(angle));
      view.fov_degrees = 50;
      cameras.push_back(photo_camera(view, "photo" + std::to_string(k) + ".jpg", width, height));
    }
    cameras_ = cameras;
    fs::create_directories(path("shoot/masks"));
    const CameraFormat& format = camera_format_named("transforms");
    write_text(path("shoot/transforms.json"), format.write(from_y_up(cameras, format.up)));
  }

  // The label of a photograph's pixel: 0 for the background, else the number of the node that is seen, from 1.
  std::vector<std::uint8_t> labels_seen(const PhotoCamera& camera) const {
    const std::vector<PlacedNode> nodes = placed_nodes(document_.scene());
    const SceneRays rays = rays_through(nodes);
    std::vector<std::uint8_t> labels;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Vec3 direction = camera.axes * Vec3((x + 0.5 - camera.center.x()) / camera.focal.x(),
                                                  -(y + 0.5 - camera.center.y()) / camera.focal.y(), -1);
        const auto hit = rays.nearest(camera.eye, direction, 0, 1e9);
        labels.push_back(hit ? static_cast<std::uint8_t>(hit->instance + 1) : 0);
      }
    return labels;
  }
  // Writes the masks of all photographs; `change` may alter each.
  void write_masks(const std::function<std::uint8_t(int photo, std::uint8_t label)>& value) const {
    for (int k = 0; k < photographs; ++k) {
      std::vector<std::uint8_t> pixels;
      for (const std::uint8_t label : labels_seen(cameras_[static_cast<std::size_t>(k)]))
        pixels.insert(pixels.end(), 3, value(k, label));
      write_text(path("shoot/masks/photo" + std::to_string(k) + ".png"), encode_png(width, height, 3, pixels, 1));
    }
  }
  json edit() const { return {{"op", "select_masks"}, {"path", path("shoot").string()}}; }
  // Share of a node's triangles with an opaque texel that are selected.
  double selected_share(const std::string& name) const {
    const NodePtr node = find(document_.scene(), name);
    if (!node->selection) return 0;
    return static_cast<double>(count(*node->selection)) / static_cast<double>(node->object->triangle_count());
  }

  Document document_;
  std::vector<PhotoCamera> cameras_;
};

TEST_F(SelectMasksTest, SelectsTheNodeThatTheMasksShow) {
  write_masks([](int, std::uint8_t label) { return label == 2 ? 255 : 0; });
  act(document_, edit());
  EXPECT_GT(selected_share("other"), 0.97);
  EXPECT_LT(selected_share("ball"), 0.01);
}

TEST_F(SelectMasksTest, OutvotesWrongNoisyAndMissingMasks) {
  std::mt19937 random(3);
  write_masks([&](int photo, std::uint8_t label) -> std::uint8_t {
    const bool inside = label == 2;
    const bool wrong = photo == 4;          // of 12
    const bool noise = random() % 10 == 0;  // a tenth of all pixels
    return inside != (wrong != noise) ? 255 : 0;
  });
  fs::remove(path("shoot/masks/photo7.png"));
  act(document_, edit());
  EXPECT_GT(selected_share("other"), 0.93);
  EXPECT_LT(selected_share("ball"), 0.03);
}

TEST_F(SelectMasksTest, AddsTheVotesOfAllLabels) {
  // Each photograph gives the ball another label: none has half of the votes, but all together.
  write_masks([](int photo, std::uint8_t label) { return static_cast<std::uint8_t>(label == 2 ? 10 + photo : 0); });
  json wanted = edit();
  for (int photo = 0; photo < photographs; ++photo) wanted["labels"].push_back(10 + photo);
  act(document_, wanted);
  EXPECT_GT(selected_share("other"), 0.9);
  EXPECT_EQ(selected_share("ball"), 0);
}

TEST_F(SelectMasksTest, StoresASelectionPerLabel) {
  write_masks([](int, std::uint8_t label) { return static_cast<std::uint8_t>(label * 10); });
  json line = edit();
  line["labels"] = {10, 20, 30};
  line["store"] = "mask";
  act(document_, line);
  EXPECT_GT(selected_share("ball"), 0.97);
  EXPECT_GT(selected_share("other"), 0.97);
  const auto &ball = find(document_.scene(), "ball")->saved_selections,
             &other = find(document_.scene(), "other")->saved_selections;
  EXPECT_EQ(count(*ball.at("mask 10")), count(*find(document_.scene(), "ball")->selection));
  EXPECT_EQ(count(*other.at("mask 20")), count(*find(document_.scene(), "other")->selection));
  EXPECT_EQ(count(*other.at("mask 10")), 0U);
  EXPECT_EQ(count(*other.at("mask 30")), 0U);
}

TEST_F(SelectMasksTest, CocoRunLengths) {
  json file = {{"images", json::array()}, {"annotations", json::array()}};
  for (int k = 0; k < photographs; ++k) {
    const auto labels = labels_seen(cameras_[static_cast<std::size_t>(k)]);
    json runs = json::array();
    std::uint8_t inside = 0;
    int run = 0;
    for (int x = 0; x < width; ++x)  // down the columns
      for (int y = 0; y < height; ++y) {
        const std::uint8_t now = labels[static_cast<std::size_t>(y * width + x)] == 2 ? 1 : 0;
        if (now != inside) runs.push_back(std::exchange(run, 0)), inside = now;
        ++run;
      }
    runs.push_back(run);
    file["images"].push_back({{"id", 100 + k}, {"file_name", "images/photo" + std::to_string(k) + ".jpg"}});
    file["annotations"].push_back(
        {{"image_id", 100 + k}, {"category_id", 7}, {"segmentation", {{"counts", runs}, {"size", {height, width}}}}});
  }
  write_text(path("shoot/coco.json"), file.dump());
  json line = edit();
  line["masks"] = "coco.json";
  act(document_, line);
  EXPECT_GT(selected_share("other"), 0.97);
  EXPECT_LT(selected_share("ball"), 0.01);
  line["labels"] = {8};
  act(document_, line);
  EXPECT_EQ(selected_share("other"), 0);
}

TEST_F(SelectMasksTest, MasksOfAnotherSizeHaveTheSameFrame) {
  for (int k = 0; k < photographs; ++k) {
    const auto labels = labels_seen(cameras_[static_cast<std::size_t>(k)]);
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < height * 2; ++y)
      for (int x = 0; x < width * 2; ++x)
        pixels.insert(pixels.end(), 3, labels[static_cast<std::size_t>(y / 2 * width + x / 2)] == 2 ? 255 : 0);
    write_text(path("shoot/masks/photo" + std::to_string(k) + ".jpg.png"),
               encode_png(width * 2, height * 2, 3, pixels, 1));
  }
  act(document_, edit());
  EXPECT_GT(selected_share("other"), 0.97);
  EXPECT_LT(selected_share("ball"), 0.01);
}

TEST_F(SelectMasksTest, MasksOfOnePixel) {
  write_masks([](int, std::uint8_t) { return 0; });
  for (int k = 0; k < photographs; ++k)
    write_text(path("shoot/masks/photo" + std::to_string(k) + ".png"),
               encode_png(1, 1, 3, std::vector<std::uint8_t>(3, 255), 1));
  act(document_, edit());
  EXPECT_GT(selected_share("ball"), 0.97) << "every point in a picture is inside";
}

TEST_F(SelectMasksTest, ReplayNoticesChangedMasks) {
  write_masks([](int, std::uint8_t label) { return label == 2 ? 255 : 0; });
  act(document_, edit());
  document_.save(path("a.rebake"), {});
  const Document opened = Document::open(path("a.rebake"), {}, {});
  EXPECT_EQ(*find(opened.scene(), "other")->selection, *find(document_.scene(), "other")->selection);
  EXPECT_THROW(document_.sources().check_file(path("shoot/masks/photo3.png")), FileError) << "masks are protected";
  EXPECT_TRUE(document_.save(path("a.rebake"), {}).opens);
  write_masks([](int, std::uint8_t label) { return label == 1 ? 255 : 0; });
  EXPECT_THROW(Document::open(path("a.rebake"), {}, {}), Error);
  EXPECT_FALSE(document_.save(path("a.rebake"), {}).opens);
  fs::remove_all(path("shoot/masks"));
  EXPECT_FALSE(document_.save(path("a.rebake"), {}).opens);
}

TEST_F(SelectMasksTest, MovedMasksAreFoundBesideTheMovedCapture) {
  write_masks([](int, std::uint8_t label) { return label == 2 ? 255 : 0; });
  fs::create_directories(path("elsewhere"));
  fs::rename(path("shoot/masks"), path("elsewhere/masks"));
  json line = edit();
  line["masks"] = path("elsewhere/masks").string();
  act(document_, line);
  document_.save(path("a.rebake"), {});
  fs::create_directories(path("moved"));
  fs::rename(path("shoot"), path("moved/shoot"));
  fs::rename(path("elsewhere"), path("moved/elsewhere"));
  const Document opened = Document::open(path("a.rebake"), {{path("shoot"), path("moved/shoot")}}, {});
  EXPECT_EQ(*find(opened.scene(), "other")->selection, *find(document_.scene(), "other")->selection);
}

TEST_F(SelectMasksTest, AbsoluteMasksOfACaptureBehindALink) {
  write_masks([](int, std::uint8_t label) { return label == 2 ? 255 : 0; });
  fs::create_directories(path("deep/er"));
  fs::rename(path("shoot"), path("deep/er/shoot"));
  fs::rename(path("deep/er/shoot/masks"), path("masks"));
  fs::create_directory_symlink(path("deep/er"), path("link"));
  act(document_, {{"op", "select_masks"}, {"path", path("link/shoot").string()}, {"masks", path("masks").string()}});
  EXPECT_NE(find(document_.scene(), "other")->selection, nullptr);
}

TEST_F(SelectMasksTest, ScriptsProtectMasksAndPhotographsOfLaterLines) {
  write_masks([](int, std::uint8_t label) { return label == 2 ? 255 : 0; });
  write_text(path("shoot/photo0.jpg"), "a photograph");
  const json line = edit();
  std::set<fs::path> inputs;
  for (const ScriptInput& input : script_inputs(line.dump() + "\n", {}))
    inputs.insert(fs::weakly_canonical(input.path));
  for (const char* file : {"shoot/transforms.json", "shoot/masks/photo3.png", "shoot/photo0.jpg"})
    EXPECT_TRUE(inputs.contains(fs::weakly_canonical(path(file)))) << file;
  act(document_, line);
  EXPECT_THROW(document_.sources().check_file(path("shoot/photo0.jpg")), FileError);
}

TEST_F(SelectMasksTest, ErrorsNameTheField) {
  EXPECT_THROW(act(document_, edit()), FieldError) << "there are no masks";
  write_masks([](int, std::uint8_t label) { return label == 2 ? 255 : 0; });
  for (const auto& [field, value] : std::vector<std::pair<std::string, json>>{{"path", ""},
                                                                              {"scale", 0},
                                                                              {"threshold", 0},
                                                                              {"threshold", 1.5},
                                                                              {"labels", {0}},
                                                                              {"labels", {256}},
                                                                              {"labels", {7, 7}},
                                                                              {"store", "name"},
                                                                              {"masks", "nowhere"}}) {
    json line = edit();
    line[field] = value;
    try {
      act(document_, line);
      ADD_FAILURE() << field << " was taken: " << value;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
    }
  }
  write_text(path("shoot/masks/photo0.png"), "not a picture");
  EXPECT_THROW(act(document_, edit()), FileError);
}

}  // namespace
}  // namespace rebake::test
