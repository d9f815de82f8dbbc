// Broken and ambiguous folders: an error that names file and field, or a warning that lists each assumption.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_calls.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/formats/mobilenerf/mlp_json.h"
#include "tests/support/made_scenes.h"
#include "tests/support/picture_files.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

std::string png_of(int width, int height, int channels, const std::string& type) {
  const fs::path path = fs::temp_directory_path() / ("rebake-png-" + std::to_string(getpid()) + ".png");
  write_picture(path, {width, height, channels, type},
                std::vector<float>(static_cast<std::size_t>(width * height * channels)));
  const std::string bytes = read_file(path);
  fs::remove(path);
  return bytes;
}

class BadFolder : public ::testing::Test {
 protected:
  BadFolder() { export_scene(scene_of(made_object()), folder(), {}); }
  fs::path folder() const { return temporary_.path() / "bad"; }
  void expect_refused(const std::string& says) const {
    try {
      read_any(folder(), Axes::y_up);
      FAIL() << "was accepted";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
  void replace_mlp(const std::string& from, const std::string& to) const {
    std::string text = read_file(folder() / "mlp.json");
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    write_text(folder() / "mlp.json", text.replace(at, from.size(), to));
  }

 private:
  TemporaryFolder temporary_;
};

TEST_F(BadFolder, RejectsMissingFiles) {
  fs::remove(folder() / "shape0.pngfeat1.png");
  expect_refused("shape0.pngfeat1.png: does not exist");
  fs::remove(folder() / "mlp.json");
  expect_refused("contains none of mlp.json (MobileNeRF)");
  fs::remove_all(folder());
  expect_refused("does not exist");
}
// If obj_num contradicts the files on disk, all consecutive shapes are read and the assumption is reported.
TEST_F(BadFolder, ReportsObjNumThatContradictsFiles) {
  for (const char* count : {"3", "7"}) {
    replace_mlp("\"obj_num\":1", std::string("\"obj_num\":") + count);
    const Scene scene = read_any(folder(), Axes::y_up);
    EXPECT_EQ(scene.roots[0]->object->sets.size(), 1U);
    ASSERT_EQ(assumptions_of(scene).size(), 1U);
    EXPECT_NE(assumptions_of(scene)[0].find(std::string("obj_num = ") + count), std::string::npos);
    replace_mlp(std::string("\"obj_num\":") + count, "\"obj_num\":1");
  }
  for (const char* name : {".obj", ".pngfeat0.png", ".pngfeat1.png"})
    fs::copy(folder() / (std::string("shape0") + name), folder() / (std::string("shape1") + name));
  const Scene two = read_any(folder(), Axes::y_up);
  EXPECT_EQ(two.roots[0]->object->sets.size(), 2U) << "the second shape must be read";
  EXPECT_EQ(assumptions_of(two).size(), 1U);
  const TemporaryFolder out;
  export_scene(two, out.path() / "out", {});
  EXPECT_EQ(read_mlp_json(read_file(out.path() / "out" / "mlp.json"), "mlp.json").obj_num, 2);
  EXPECT_TRUE(assumptions_of(read_any(out.path() / "out", Axes::y_up)).empty());
  fs::rename(folder() / "shape1.obj", folder() / "shape2.obj");
  EXPECT_EQ(read_any(folder(), Axes::y_up).roots[0]->object->sets.size(), 1U) << "a leftover";
  replace_mlp("\"obj_num\":1", "\"obj_num\":2");
  expect_refused("shape1.obj: does not exist, but files of shape2 do");
}
TEST_F(BadFolder, WholeMeshBesideChunks) {
  const std::string whole = read_file(folder() / "shape0.obj");
  const std::size_t triangles = read_any(folder(), Axes::y_up).roots[0]->object->triangle_count();
  write_text(folder() / "shape0_0.obj", whole);
  const Scene same = read_any(folder(), Axes::y_up);
  EXPECT_EQ(same.roots[0]->object->triangle_count(), triangles);
  ASSERT_EQ(assumptions_of(same).size(), 1U);
  EXPECT_NE(assumptions_of(same)[0].find("triangles each: they are assumed to be the same"), std::string::npos);
  write_text(folder() / "shape0_1.obj", whole);
  const Scene more = read_any(folder(), Axes::y_up);
  EXPECT_EQ(more.roots[0]->object->triangle_count(), 3 * triangles);
  EXPECT_NE(assumptions_of(more)[0].find("all are read"), std::string::npos);
  const TemporaryFolder out;
  export_scene(more, out.path() / "out", {});
  EXPECT_EQ(read_any(out.path() / "out", Axes::y_up).roots[0]->object->triangle_count(), 3 * triangles);
}
TEST_F(BadFolder, RejectsNegativeObjNum) {
  replace_mlp("\"obj_num\":1", "\"obj_num\":-1");
  expect_refused("\"obj_num\" must be a whole number");
}
TEST_F(BadFolder, RejectsMissingKey) {
  replace_mlp("1_bias", "1_bais");
  expect_refused("mlp.json: \"1_bias\" is missing");
}
TEST_F(BadFolder, RejectsNanInDecoder) {
  replace_mlp("\"2_bias\":[", "\"2_bias\":[NaN,");
  expect_refused("mlp.json: \"2_bias\"[0] is NaN, which is not a number");
}
TEST_F(BadFolder, RejectsWrongLayerSize) {
  replace_mlp("\"1_weights\":[[", "\"1_weights\":[[0.5,");
  expect_refused("\"1_weights\" is 16 rows of unequal lengths (row 1 differs from row 0), expected 16×16");
}
TEST_F(BadFolder, RejectsTransposedAndAdditionalLayers) {
  const std::string good = read_file(folder() / "mlp.json");
  const MlpFile file = read_mlp_json(good, "mlp.json");
  nlohmann::json mlp = nlohmann::json::parse(good);
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index c = 0; c < file.decoder.weights0.cols(); ++c) {
    rows.push_back(nlohmann::json::array());
    for (Eigen::Index r = 0; r < file.decoder.weights0.rows(); ++r) rows.back().push_back(file.decoder.weights0(r, c));
  }
  mlp["0_weights"] = rows;
  write_text(folder() / "mlp.json", mlp.dump());
  expect_refused("\"0_weights\" is 16×11, expected 11×16 (inputs × outputs). Transpose it");
  write_text(folder() / "mlp.json", good);
  replace_mlp("\"2_weights\":[[", "\"3_bias\":[0],\"2_weights\":[[");
  expect_refused("\"3_bias\" belongs to an additional layer");
}
TEST_F(BadFolder, RejectsNanAndInfinity) {
  for (const char* word : {"NaN", "Infinity", "-Infinity"}) {
    const std::string text = read_file(folder() / "mlp.json");
    replace_mlp("\"1_weights\":[[", std::string("\"1_weights\":[[") + word + ",");
    expect_refused(std::string("\"1_weights\"[0][0] is ") + word);
    write_text(folder() / "mlp.json", text);
  }
  replace_mlp("\"1_weights\":[[", "\"1_weights\":[[1e999,");
  expect_refused("mlp.json: cannot be read");
}
TEST_F(BadFolder, AcceptsObjNumAsFloatOrString) {
  for (const char* count : {"1.0", "\"1\""}) {
    replace_mlp("\"obj_num\":1", std::string("\"obj_num\":") + count);
    EXPECT_NO_THROW(read_any(folder(), Axes::y_up)) << count;
    replace_mlp(std::string("\"obj_num\":") + count, "\"obj_num\":1");
  }
}
TEST_F(BadFolder, PreservesUnknownMembersOfMlpJson) {
  const std::string members = R"("trained": {"psnr": 31.50, "by": "a \"b\""},"scale": 1e-03,"obj_num")";
  replace_mlp("\"obj_num\"", members);
  Scene scene = read_any(folder(), Axes::y_up);
  scene = with_changed(scene, scene.roots[0]->id, [](Node& node) {
    auto object = std::make_shared<BakedObject>(*node.object);
    Decoder decoder = *object->decoder;
    decoder.bias2[0] += 1;
    object->decoder = std::make_shared<const Decoder>(decoder);
    node.object = object;
  });
  const TemporaryFolder out;
  export_scene(scene, out.path() / "out", {});
  const std::string written = read_file(out.path() / "out" / "mlp.json");
  EXPECT_NE(written.find(R"({"psnr": 31.50, "by": "a \"b\""})"), std::string::npos) << written.substr(0, 300);
  EXPECT_NE(written.find("\"scale\":1e-03"), std::string::npos);
  EXPECT_NO_THROW(read_any(out.path() / "out", Axes::y_up));
}
TEST_F(BadFolder, RejectsEmptyMesh) {
  write_text(folder() / "shape0.obj", "v 0 0 0\nvt 0 0\n");
  expect_refused("has no triangles");
}
TEST_F(BadFolder, RejectsInvalidImages) {
  const fs::path png = folder() / "shape0.pngfeat1.png";
  const std::string good = read_file(png);
  write_text(png, "");
  expect_refused("is empty (0 bytes)");
  write_text(png, "GIF89a");
  expect_refused("is neither a PNG nor a WebP file");
  write_text(png, good.substr(0, good.size() / 2));
  expect_refused("shape0.pngfeat1.png: is truncated");
  write_text(png, png_of(16, 16, 4, "uint8"));
  expect_refused("both images of a set must have the same size");
  std::string huge = good;
  huge[16] = huge[17] = 0x7f;  // image width in the PNG header
  write_text(png, huge);
  expect_refused("shape0.pngfeat1.png: ");
}

TEST_F(BadFolder, RejectsFolderReplacedDuringReading) {
  // Replaces the folder between the first and the second stat() of it: same path, other inode.
  class Swap final : public FileCalls {
   public:
    explicit Swap(fs::path folder) : folder_(std::move(folder)) {}
    int stat(const char* path, struct stat* about) override {
      if (folder_ == path && asked_++ == 1) {
        fs::rename(folder_, folder_.string() + "-old");
        fs::copy(folder_.string() + "-old", folder_);
      }
      return FileCalls::stat(path, about);
    }

   private:
    fs::path folder_;
    int asked_ = 0;
  };
  Swap swap(folder());
  const ReplacedFileCalls calls(swap);
  expect_refused("was replaced while it was read");
}

}  // namespace
}  // namespace rebake::test
