// Folders that other tools have changed open with a list of assumptions, and an export repairs them.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "mesh_ops/formats/scene_files.h"
#include "tests/support/made_scenes.h"
#include "tests/support/picture_files.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

class ForeignFolder : public ::testing::Test {
 protected:
  explicit ForeignFolder(Layout layout = Layout::split) {
    export_scene(scene_of(made_object({.layout = layout})), folder(), {});
    before_ = read_baked_folder(folder(), Axes::y_up);
  }
  fs::path folder() const { return temporary_.path() / "scene"; }
  fs::path out() const { return temporary_.path() / "out"; }
  std::string file(const std::string& name) const { return read_file(folder() / name); }
  void write(const std::string& name, const std::string& bytes) const { write_text(folder() / name, bytes); }
  void rename(const std::string& from, const std::string& to) const { fs::rename(folder() / from, folder() / to); }

  // Reads the folder and expects these beginnings of assumptions. Exports it, and expects the export to be read without
  // any, with the same triangles and texels.
  // With `copied`, the export keeps the files as they are, since other programs read them alike.
  std::shared_ptr<const BakedObject> expect_assumed(const std::vector<std::string>& expected,
                                                    bool copied = false) const {
    const Scene scene = read_any(folder(), Axes::y_up);
    const std::vector<std::string> assumed = assumptions_of(scene);
    EXPECT_EQ(assumed.size(), expected.size());
    for (std::size_t k = 0; k < std::min(assumed.size(), expected.size()); ++k)
      EXPECT_NE(assumed[k].find(expected[k]), std::string::npos) << assumed[k];
    export_scene(scene, out(), {});
    const Scene back = read_any(out(), Axes::y_up);
    EXPECT_EQ(assumptions_of(back), copied ? assumed : std::vector<std::string>());
    const auto &read = scene.roots[0]->object, &repaired = back.roots[0]->object;
    EXPECT_EQ(repaired->sets.size(), read->sets.size());
    for (std::size_t k = 0; k < std::min(repaired->sets.size(), read->sets.size()); ++k)
      expect_equal(repaired->sets[k], read->sets[k]);
    return read;
  }
  static void expect_equal(const TextureSet& a, const TextureSet& b) {
    ASSERT_EQ(a.soup.triangle_count(), b.soup.triangle_count());
    for (std::size_t f = 0; f < a.soup.triangle_count(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(a.soup.positions()[a.soup.faces()[f][k]], b.soup.positions()[b.soup.faces()[f][k]]);
        EXPECT_EQ(a.soup.uvs()[a.soup.faces()[f][k]], b.soup.uvs()[b.soup.faces()[f][k]]);
      }
    for (const int image : {0, 1})
      EXPECT_TRUE(write_feature_png(*a.texels, image) == write_feature_png(*b.texels, image)) << image;
  }

  TemporaryFolder temporary_;
  std::shared_ptr<const BakedObject> before_;
};

TEST_F(ForeignFolder, UpperCaseNames) {
  rename("shape0.obj", "Shape0.OBJ");
  rename("shape0.pngfeat0.png", "shape0.PNGfeat0.png");
  const auto read = expect_assumed({"Shape0.OBJ is read as shape0.obj, and other files likewise"});
  expect_equal(read->sets[0], before_->sets[0]);
  EXPECT_EQ(read_file(out() / "shape0.obj"), file("Shape0.OBJ"));
  const std::vector<fs::path> files = scene_files(folder());
  EXPECT_NE(std::find(files.begin(), files.end(), "Shape0.OBJ"), files.end()) << "it is hashed and protected";
}

TEST_F(ForeignFolder, NamesThatDifferInCaseOnlyAreAmbiguous) {
  write("Shape0.obj", file("shape0.obj"));
  EXPECT_TRUE(assumptions_of(read_any(folder(), Axes::y_up)).empty()) << "the exact name is preferred";
  rename("shape0.obj", "SHAPE0.obj");
  EXPECT_THROW(read_any(folder(), Axes::y_up), FileError);
}

TEST_F(ForeignFolder, StrayChunksBesideAWholeFile) {
  write("shape0_1.obj", file("shape0.obj"));
  const auto read = expect_assumed({"shape0_1.obj … are not read"});
  EXPECT_EQ(read->triangle_count(), before_->triangle_count());
}

TEST_F(ForeignFolder, TrailingCommasInTheDecoder) {
  std::string text = file("mlp.json");
  text.insert(text.rfind('}'), ",\n");
  text.insert(text.find("]]"), " , ");
  write("mlp.json", text);
  expect_assumed({"mlp.json: 2 commas after last elements are skipped; the first in line 1"});
  // The place of an error is that in the file.
  text.insert(text.find("\"1_bias\":[") + 10, "NaN,");
  write("mlp.json", text);
  try {
    read_any(folder(), Axes::y_up);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("NaN"), std::string::npos) << error.what();
  }
}

TEST_F(ForeignFolder, LinesInTheMeshAreDroppedByExports) {
  write("shape0.obj", "o ball\n" + file("shape0.obj") + "l 1 2\n");
  expect_assumed({"shape0.obj: line 1: objects, groups", "shape0.obj: line "});
  EXPECT_EQ(read_file(out() / "shape0.obj").find("\nl "), std::string::npos);
}

TEST_F(ForeignFolder, HarmlessStatementsAreCopied) {
  write("shape0.obj", "mtllib a.mtl\no ball\ns off\n" + file("shape0.obj"));
  const Scene scene = read_any(folder(), Axes::y_up);
  EXPECT_EQ(assumptions_of(scene).size(), 1U);
  export_scene(scene, out(), {});
  EXPECT_EQ(read_file(out() / "shape0.obj"), file("shape0.obj")) << "an unedited folder exports byte for byte";
}

TEST_F(ForeignFolder, SetsWithoutTriangles) {
  for (const char* name : {".obj", ".pngfeat0.png", ".pngfeat1.png"})
    write(std::string("shape1") + name, file(std::string("shape0") + name));
  write("shape0.obj", "v 0 0 0\nvt 0 0\n");
  std::string mlp = file("mlp.json");
  mlp.replace(mlp.find("\"obj_num\":1"), 11, "\"obj_num\":2");
  write("mlp.json", mlp);
  const auto read = expect_assumed({"shape0.obj has no triangles: its texture set is left out"});
  ASSERT_EQ(read->sets.size(), 1U);
  expect_equal(read->sets[0], before_->sets[0]);
}

class ChunkedForeignFolder : public ForeignFolder {
 protected:
  ChunkedForeignFolder() : ForeignFolder(Layout::chunked) {}
};

TEST_F(ChunkedForeignFolder, ChunksCountedFromOne) {
  for (int j = 8; j-- > 0;) rename("shape0_" + std::to_string(j) + ".obj", "shape0_" + std::to_string(j + 1) + ".obj");
  const auto read = expect_assumed({"shape0 has no chunk 0: its chunks are assumed to be counted from 1"});
  expect_equal(read->sets[0], before_->sets[0]);
  EXPECT_TRUE(fs::exists(out() / "shape0_0.obj"));
  EXPECT_FALSE(fs::exists(out() / "shape0_8.obj"));
}

TEST_F(ChunkedForeignFolder, BackupsWithAnotherSpellingDoNotCount) {
  write("Shape0.obj", file("shape0_0.obj"));
  const auto read = expect_assumed({"Shape0.obj is not read: the set has chunks"});
  expect_equal(read->sets[0], before_->sets[0]);
}

TEST_F(ChunkedForeignFolder, MissingChunks) {
  const std::size_t lost = read_obj(file("shape0_3.obj"), "a.obj").faces.size();
  fs::remove(folder() / "shape0_3.obj");
  const auto read = expect_assumed({"shape0_3.obj is missing: its triangles are lost"});
  EXPECT_EQ(read->triangle_count() + lost, before_->triangle_count());
  for (std::size_t j = 0; j < chunks_per_set; ++j)
    EXPECT_TRUE(fs::exists(out() / geometry_name(Layout::chunked, 0, j))) << j;
}

// Writes the pixels of an image of the folder in another format, from its bytes [texel][4].
class FeatureImages : public ForeignFolder {
 protected:
  std::vector<std::uint8_t> texels(int image) const {
    const FeatureTexture& texture = *before_->sets[0].texels;
    const TexelReader reader(texture);
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < texture.height(); ++y)
      for (int x = 0; x < texture.width(); ++x) {
        const Texel texel = reader.at(x, y);
        const auto& four = image == 0 ? texel.feat0 : texel.feat1;
        bytes.insert(bytes.end(), four.begin(), four.end());
      }
    return bytes;
  }
  // Rewrites an image with `channels` channels, which `value(texel bytes, channel)` computes, 0 … 1.
  void rewrite(int image, const std::string& extension, int channels, const std::string& type,
               const std::function<float(const std::uint8_t* texel, int channel)>& value) const {
    const FeatureTexture& texture = *before_->sets[0].texels;
    const std::vector<std::uint8_t> bytes = texels(image);
    std::vector<float> pixels;
    for (std::size_t k = 0; k < bytes.size(); k += 4)
      for (int c = 0; c < channels; ++c) pixels.push_back(value(&bytes[k], c));
    const std::string name = "shape0.pngfeat" + std::to_string(image);
    fs::remove(folder() / (name + ".png"));
    write_picture(folder() / (name + extension), {texture.width(), texture.height(), channels, type}, pixels);
  }
};

TEST_F(FeatureImages, WithoutAlphaTheFourthFeatureIsOne) {
  for (const int image : {0, 1})
    rewrite(image, ".png", 3, "uint8",
            [](const std::uint8_t* texel, int c) { return static_cast<float>(texel[c]) / 255; });
  const auto read = expect_assumed({"shape0.pngfeat0.png has no alpha: the fourth feature has the byte 255",
                                    "shape0.pngfeat1.png has no alpha: the fourth feature has the byte 255"},
                                   true);
  const TexelReader now(*read->sets[0].texels), old(*before_->sets[0].texels);
  for (int y = 0; y < before_->sets[0].texels->height(); ++y)
    for (int x = 0; x < before_->sets[0].texels->width(); ++x) {
      Texel expected = old.at(x, y);
      expected.feat0[3] = expected.feat1[3] = 255;
      ASSERT_EQ(now.at(x, y), expected) << x << " " << y;
    }
}

TEST_F(FeatureImages, GreyImages) {
  rewrite(1, ".png", 1, "uint8", [](const std::uint8_t* texel, int) { return static_cast<float>(texel[0]) / 255; });
  const auto read = expect_assumed({"shape0.pngfeat1.png is grey", "shape0.pngfeat1.png has no alpha"}, true);
  const TexelReader now(*read->sets[0].texels), old(*before_->sets[0].texels);
  const std::uint8_t grey = old.at(3, 3).feat1[0];
  EXPECT_EQ(now.at(3, 3).feat1, (std::array<std::uint8_t, 4>{grey, grey, grey, 255}));
  EXPECT_EQ(now.at(3, 3).feat0, old.at(3, 3).feat0);
}

TEST_F(FeatureImages, GreyImagesWithAlpha) {
  rewrite(1, ".png", 2, "uint8",
          [](const std::uint8_t* texel, int c) { return static_cast<float>(texel[c == 0 ? 0 : 3]) / 255; });
  const auto read = expect_assumed({"shape0.pngfeat1.png is grey"}, true);
  const TexelReader now(*read->sets[0].texels), old(*before_->sets[0].texels);
  const std::uint8_t grey = old.at(5, 7).feat1[0];
  EXPECT_EQ(now.at(5, 7).feat1, (std::array<std::uint8_t, 4>{grey, grey, grey, old.at(5, 7).feat1[3]}));
}

TEST_F(FeatureImages, SixteenBitsNeverMakeHoles) {
  // Each value is up to half a step of 8 bits away from its byte; red ones that are almost 0 stay opaque.
  for (const int image : {0, 1})
    rewrite(image, ".png", 4, "uint16", [&](const std::uint8_t* texel, int c) {
      const float shift = texel[c] == 255 ? -100.0F : texel[c] == 0 ? 0.0F : 100.0F;
      return (static_cast<float>(texel[c]) * 257 + shift) / 65535;
    });
  const auto read = expect_assumed({"shape0.pngfeat0.png has 16 bits per channel, which are rounded to 8",
                                    "shape0.pngfeat1.png has 16 bits per channel, which are rounded to 8"});
  expect_equal(read->sets[0], before_->sets[0]);
  rewrite(0, ".png", 4, "uint16", [&](const std::uint8_t* texel, int c) {
    if (c == 0) return texel[0] == 0 ? 0.0F : 3.0F / 65535;
    return static_cast<float>(texel[c]) / 255;
  });
  const auto almost_holes = read_baked_folder(folder(), Axes::y_up);
  const TexelReader low(*almost_holes->sets[0].texels), old(*before_->sets[0].texels);
  for (int y = 0; y < before_->sets[0].texels->height(); ++y)
    for (int x = 0; x < before_->sets[0].texels->width(); ++x)
      ASSERT_EQ(low.at(x, y).feat0[0], old.at(x, y).feat0[0] == 0 ? 0 : 1);
}

TEST_F(FeatureImages, ColourSpacesAreLeftOut) {
  std::string png = file("shape0.pngfeat1.png");
  // A gamma of 1/2.2 after the header, with its checksum.
  png.insert(33, std::string("\0\0\0\4gAMA\0\0\xb1\x8f\x0b\xfc\x61\x05", 16));
  write("shape0.pngfeat1.png", png);
  const auto read = expect_assumed({"shape0.pngfeat1.png states a colour space"});
  expect_equal(read->sets[0], before_->sets[0]);
  EXPECT_EQ(read_file(out() / "shape0.pngfeat1.png").find("gAMA"), std::string::npos);
}

TEST_F(FeatureImages, LosslessWebP) {
  for (const int image : {0, 1})
    rewrite(image, ".webp", 4, "uint8",
            [](const std::uint8_t* texel, int c) { return static_cast<float>(texel[c]) / 255; });
  const Scene scene = read_any(folder(), Axes::y_up);
  ASSERT_GE(assumptions_of(scene).size(), 2U);
  EXPECT_NE(assumptions_of(scene)[0].find("is read as shape0.pngfeat0.png"), std::string::npos);
  expect_equal(scene.roots[0]->object->sets[0], before_->sets[0]);
  export_scene(scene, out(), {});
  EXPECT_TRUE(read_file(out() / "shape0.pngfeat0.png").starts_with("\x89PNG"));
  write("shape0.pngfeat1.webp", file("shape0.pngfeat1.webp").substr(0, 200));
  EXPECT_THROW(read_any(folder(), Axes::y_up), FileError);
}

}  // namespace
}  // namespace rebake::test
