// Cage meshes as other programs write them.
#include "mesh_ops/formats/cage_file.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class ReadCage : public ::testing::Test {
 protected:
  ReadCage() : cage_(lattice_cage(Box(Vec3(1e6, -1e6, 0.1), Vec3(1e6 + 1.7, -1e6 + 1.1, 0.3)), 1, 1, 1)) {}
  Cage read(const std::string& name, const std::string& text) const {
    write_text(folder_.path() / name, text);
    return read_cage(folder_.path() / name);
  }
  std::string error_of(const std::string& name, const std::string& text) const {
    try {
      read(name, text);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }
  // The cage as text, with `before` each vertex and face, `after` each, and indices from `first`.
  std::string lines(const char* vertex, const char* face, int first, const char* after = "") const {
    std::string text;
    for (const Vec3& v : cage_.vertices) text += fmt::format("{}{} {} {}\n", vertex, v.x(), v.y(), v.z());
    for (const Face& f : cage_.faces)
      text += fmt::format("{}{} {} {}{}\n", face, f[0] + static_cast<unsigned>(first),
                          f[1] + static_cast<unsigned>(first), f[2] + static_cast<unsigned>(first), after);
    return text;
  }
  TemporaryFolder folder_;
  Cage cage_;
};

TEST_F(ReadCage, ObjKeepsEveryBitAndIgnoresMaterials) {
  EXPECT_EQ(read("a.obj", "mtllib missing.mtl\no cage\nusemtl red\n" + lines("v ", "f ", 1)), cage_);
}

TEST_F(ReadCage, OffWithCommentsHeaderInOneLineAndColours) {
  EXPECT_EQ(read("a.off", "OFF\n8 12 0\n" + lines("", "3 ", 0)), cage_);
  EXPECT_EQ(read("b.off", "# made by hand\n\nOFF\n# counts\n8 12 0\n" + lines("", "3 ", 0)), cage_);
  EXPECT_EQ(read("c.off", "OFF 8 12 0\n" + lines("", "3 ", 0, " 255 0 0")), cage_);
}

TEST_F(ReadCage, PlyIsReadInSinglePrecision) {
  const Cage read_back = read("a.ply",
                              "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\n"
                              "property double z\nelement face 12\nproperty list uchar int vertex_indices\n"
                              "end_header\n" +
                                  lines("", "3 ", 0));
  EXPECT_EQ(read_back.faces, cage_.faces);
  EXPECT_LE((read_back.vertices[3] - cage_.vertices[3]).norm(), 0.1);
}

TEST_F(ReadCage, ErrorsNameTheLine) {
  EXPECT_NE(error_of("a.obj", "v 0 nan 0\n" + lines("v ", "f ", 1)).find("line 1: \"nan\""), std::string::npos);
  EXPECT_NE(error_of("a.off", "OFF\n8 12 0\n" + lines("", "3 ", 0).substr(0, 100)).find("a.off: "), std::string::npos);
  EXPECT_NE(error_of("a.off", "OFF\n8 12 0\n" + lines("", "2 ", 0)).find("is not a face"), std::string::npos);
  EXPECT_NE(error_of("a.off", "OFF\n").find("is truncated"), std::string::npos);
}

}  // namespace
}  // namespace rebake::test
