// COCO masks: run lengths as lists and as text, and damaged files.
#include "mesh_ops/formats/cameras/coco_masks.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

using nlohmann::json;

class CocoMasksTest : public ::testing::Test {
 protected:
  CocoMasksTest() : cameras_(2) {
    cameras_[0].name = "images/a.jpg";
    cameras_[1].name = "images/b.jpg";
    for (PhotoCamera& camera : cameras_) camera.width = 4, camera.height = 3;
  }
  static json file(const json& counts) {
    return {{"images", {{{"id", 5}, {"file_name", "a.jpg"}}, {{"id", 6}, {"file_name", "other.jpg"}}}},
            {"annotations",
             {{{"image_id", 5}, {"category_id", 3}, {"segmentation", {{"counts", counts}, {"size", {3, 4}}}}}}}};
  }
  CocoMasks read(const json& content) const {
    write_text(folder_.path() / "coco.json", content.dump());
    return {folder_.path() / "coco.json", cameras_};
  }
  std::string error_of(const json& content) const {
    try {
      read(content);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
  std::vector<PhotoCamera> cameras_;
};

const std::vector<std::uint8_t> coco_mask{0, 3, 0, 0,  //
                                          0, 3, 0, 0,  //
                                          3, 0, 0, 3};

TEST_F(CocoMasksTest, RunsGoDownTheColumns) {
  const CocoMasks masks = read(file({2, 3, 6, 1}));
  EXPECT_EQ(masks.mask(0).width, 4);
  EXPECT_EQ(masks.mask(0).height, 3);
  EXPECT_EQ(masks.mask(0).labels, coco_mask);
  EXPECT_FALSE(masks.has(1));
}

TEST_F(CocoMasksTest, RunsAsText) {
  // 2, 3, 6, and 1 as the difference to the run before the last: 1 − 3 = −2.
  EXPECT_EQ(read(file("236N")).mask(0).labels, coco_mask);
  // 100 = 4 + 3 · 32 takes two characters.
  json wide = file("0T3");
  wide["annotations"][0]["segmentation"]["size"] = {10, 10};
  cameras_[0].width = cameras_[0].height = 10;
  EXPECT_EQ(read(wide).mask(0).labels, std::vector<std::uint8_t>(100, 3));
}

TEST_F(CocoMasksTest, LaterAnnotationsCount) {
  json two = file({2, 3, 6, 1});
  two["annotations"].push_back(two["annotations"][0]);
  two["annotations"][1]["category_id"] = 9;
  two["annotations"][1]["segmentation"]["counts"] = {0, 12};
  EXPECT_EQ(read(two).mask(0).labels, std::vector<std::uint8_t>(12, 9));
  EXPECT_EQ(read(two).mask(0, {9, 3}).labels, std::vector<std::uint8_t>(12, 9));
  EXPECT_EQ(read(two).mask(0, {3}).labels, coco_mask) << "only among the labels that are asked for";
}

TEST_F(CocoMasksTest, ImagesWithoutAnnotationsAreEmptyMasks) {
  json content = file({2, 3, 6, 1});
  content["images"].push_back({{"id", 8}, {"file_name", "images/b.jpg"}, {"width", 8}, {"height", 6}});
  const CocoMasks masks = read(content);
  ASSERT_TRUE(masks.has(1));
  EXPECT_EQ(masks.mask(1).labels, std::vector<std::uint8_t>(48));
}

TEST_F(CocoMasksTest, NamesThatFitSeveralPhotographs) {
  cameras_[1].name = "right/a.jpg";
  EXPECT_NE(error_of(file({12})).find("fits 2 photographs"), std::string::npos);
  json content = file({12});
  content["images"][0]["file_name"] = "right/a.jpg";
  EXPECT_TRUE(read(content).has(1));
}

TEST_F(CocoMasksTest, DamageIsNamed) {
  const auto with = [](const char* pointer, const json& value) {
    json content = file({2, 3, 6, 1});
    content[json::json_pointer(pointer)] = value;
    return content;
  };
  const std::vector<std::pair<json, std::string>> bad{
      {file({2, 3, 6}), "annotations[0]: field \"counts\": does not fit"},
      {file({2, 3, 6, 2}), "does not fit"},
      {file({-1, 13}), "does not fit"},
      {file({2, 3.5}), "whole numbers"},
      {file("2\x7f"), "other characters"},
      {file("2T"), "truncated"},
      {file("oooooooo0"), "too long"},
      {with("/annotations/0/segmentation", {{1, 2, 3, 4}}), "polygons are not read"},
      {with("/annotations/0/segmentation/size", {3, 0}), "size"},
      {with("/annotations/0/segmentation/size", {3, 100000}), "size"},
      {with("/annotations/0/category_id", 256), "category_id"},
      {with("/annotations/0/image_id", 7), "image_id"},
      {with("/images/0/id", "a"), "images[0]: field \"id\""},
      {with("/images/0/width", 30000), "much larger than the photograph"},
      {with("/annotations", 3), "no list \"annotations\""},
  };
  for (const auto& [content, message] : bad)
    EXPECT_NE(error_of(content).find(message), std::string::npos) << content << "\n" << error_of(content);
}

}  // namespace
}  // namespace rebake::test
