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

TEST_F(ReadCage, ErrorsNamePointsThatDoNotExist) {
  const auto expect_error = [&](const char* name, const std::string& text, const char* says) {
    EXPECT_NE(error_of(name, text).find(says), std::string::npos) << error_of(name, text);
  };
  const std::string obj = lines("v ", "f ", 1);
  expect_error("a.off", "OFF\n8 13 0\n" + lines("", "3 ", 0) + "3 0 1 8\n",
               "line 23: a face names point 8, but points have the numbers 0 to 7");
  expect_error("a.obj", obj + "f 1 9 2\n",
               "line 21: a face names point 9, but points have the numbers 1 to 8, or backwards from -1");
  expect_error("a.obj", obj + "f 1 -9/1 2 # back\n", "line 21: a face names point -9");
  expect_error("a.obj", obj + "f 1 -9223372036854775808 2\n", "line 21: a face names point -9223372036854775808");
  expect_error("a.obj", obj + "f 1 2 x\n", "line 21: \"x\" is not the corner of a face");
}

TEST(CageFile, ReadsThreeFormatsAndRejectsInvalidMeshes) {
  TemporaryFolder folder;
  const Cage cage = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 0.3, 2)), 2, 1, 2);
  // A text file from a header, a line per vertex and a line per face.
  const auto write = [&](const char* name, const std::string& header, const char* vertex, const char* face,
                         std::uint32_t first) {
    std::string text = header;
    for (const Vec3& v : cage.vertices) text += fmt::format("{}{} {} {}\n", vertex, v.x(), v.y(), v.z());
    for (const Face& f : cage.faces)
      text += fmt::format("{}{} {} {}\n", face, f[0] + first, f[1] + first, f[2] + first);
    write_text(folder.path() / name, text);
  };
  const std::size_t vertices = cage.vertices.size(), faces = cage.faces.size();
  write("cage.obj", "", "v ", "f ", 1);
  write("cage.off", fmt::format("OFF\n{} {} 0\n", vertices, faces), "", "3 ", 0);
  write(
      "cage.ply",
      fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
                  "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                  vertices, faces),
      "", "3 ", 0);
  for (const char* name : {"cage.obj", "cage.off", "cage.ply"}) {
    EXPECT_EQ(read_cage(folder.path() / name).faces, cage.faces) << name;
    const std::vector<Vec3> read = read_cage(folder.path() / name).vertices;
    ASSERT_EQ(read.size(), cage.vertices.size());
    for (std::size_t v = 0; v < read.size(); ++v)
      EXPECT_LE((read[v] - cage.vertices[v]).norm(), 1e-7) << name << ": OpenMesh reads coordinates as floats";
  }
  const auto refused = [&](const std::string& name, const std::string& text, const std::string& says) {
    write_text(folder.path() / name, text);
    try {
      read_cage(folder.path() / name);
      ADD_FAILURE() << name << " was read";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\n";
  refused("open.obj", corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 5 4 2\n", "open");
  refused("quads.obj", corners + "f 1 2 3 4\n", "not triangles");
  refused("fan.obj", corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 2 5\n", "manifold");
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  refused("beyond.ply", ply + "3 0 1 3\n", "its points must exist and differ");
  refused("twice.ply", ply + "3 0 1 1\n", "its points must exist and differ");
  refused("cage.stl", "solid\n", "ends in .obj");
  refused("none.ply", "ply\n", "contains no readable mesh");
}

}  // namespace
}  // namespace rebake::test
