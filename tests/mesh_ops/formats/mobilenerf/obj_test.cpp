// The supported OBJ subset: round trips, accepted variants, and errors with line numbers.
#include "mesh_ops/formats/mobilenerf/obj.h"

#include <gtest/gtest.h>

#include <numbers>

#include "mesh_ops/base/error.h"

namespace rebake::test {
namespace {

const std::string quad =
    "v 0.000000 0.000000 0.000000\nv 1.000000 0.000000 0.000000\nv 0.000000 1.000000 0.000000\nv 1.000000 1.000000 "
    "0.000000\n"
    "vt 0.100000 0.900000\nvt 0.200000 0.900000\nvt 0.100000 0.800000\nvt 0.200000 0.800000\nf 1/1 2/2 4/4\nf 1/1 4/4 "
    "3/3\n";

TEST(Obj, ExporterFilesRoundTripByteForByte) {
  const std::string two = quad + "v 0.5 0 0\nv 1 0 0\nv 0 1 0\n";
  const ObjMesh mesh = read_obj(quad, "a.obj");
  EXPECT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.faces.size(), 2U);
  EXPECT_EQ(write_obj(mesh.positions, mesh.uvs, mesh.faces, 0, 2), quad);
}

TEST(Obj, ValuesRoundTripBitExactly) {
  const std::vector<Vec3> positions{{1.0 / 3, 1e-30, 1e30}, {std::numbers::pi, -0.1, 123456789.125}, {5e-324, 0, 1}};
  const std::vector<Vec2> uvs{{1.0 / 7, 0.5}, {0, 1}, {0.25, 0.75}};
  const ObjMesh back = read_obj(write_obj(positions, uvs, {{0, 1, 2}}, 0, 1), "a.obj");
  EXPECT_EQ(back.positions, positions);
  EXPECT_EQ(back.uvs, uvs);
}

TEST(Obj, NegativeIndicesPolygonsNormalsAndBlanks) {
  const ObjMesh mesh = read_obj(
      "# x\r\nv 0 0 0\r\nv 1 0 0 \r\nv 1 1 0 1.0\r\nv 0 1 0\n vt 0 0\nvt 1 0 0\nvt 1 1\nvt 0 1\nvn 0 0 1\ng a\n\nf "
      "-4/-4/1 -3/-3/1 -2/-2/1 -1/-1/1",
      "a.obj");
  ASSERT_EQ(mesh.faces.size(), 2U);  // the quad becomes a fan of two triangles
  EXPECT_EQ(mesh.faces[1], (Face{0, 2, 3}));
}

TEST(Obj, SplitsCornersWithSeveralUvs) {
  const ObjMesh mesh = read_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 2/2 3/1\n", "a.obj");
  EXPECT_EQ(mesh.positions.size(), 5U);
  EXPECT_EQ(mesh.uvs[mesh.faces[1][0]], Vec2(1, 1));
  EXPECT_EQ(mesh.positions[mesh.faces[1][0]], Vec3(0, 0, 0));
}

TEST(Obj, ReadsWhatModellersWrite) {
  const ObjMesh mesh = read_obj(
      "mtllib a.mtl\no first\nv 0 0 0 0.5 0.5 0.5\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\ns off\n"
      "f 1/1 2/2 \\\n 3/3\no second\nl 1 2\np 1\ncurv 1 2\nf 3/3 \\\r\n2/2 1/1 # behind\n",
      "a.obj");
  EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}, {2, 1, 0}}));
  EXPECT_TRUE(mesh.needs_repair) << "viewers draw objects with lines as lines";
  const std::vector<std::string> expected{
      "line 1: objects, groups, materials and normals are skipped; all faces are one mesh (5 in total)",
      "line 16: unknown statements such as \"curv\" are skipped (1 in total)",
      "line 3: numbers after x y z (vertex colours or weights) are skipped (1 in total)",
      "line 14: lines and points are skipped (2 in total)"};
  EXPECT_EQ(mesh.assumptions, expected);
}

TEST(Obj, RepeatedCornersOfPolygonsAreDropped) {
  const std::string l_shape =
      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
      "vt 0 0\nvt 1 0\nvt 1 0.5\nvt 0.5 0.5\nvt 0.5 1\nvt 0 1\n";
  const auto faces = [&](const std::string& face) { return read_obj(l_shape + "f " + face + "\n", "a.obj").faces; };
  const auto plain = faces("1/1 2/2 3/3 4/4 5/5 6/6");
  EXPECT_EQ(plain.size(), 4U);
  EXPECT_EQ(faces("1/1 2/2 3/3 4/4 5/5 6/6 1/1"), plain) << "closed";
  EXPECT_EQ(faces("1/1 2/2 2/2 3/3 4/4 4/4 5/5 6/6"), plain) << "doubled";
  EXPECT_EQ(faces("1/1 1/1 2/2 2/2").size(), 2U) << "without area";
}

TEST(Obj, CommentsAreNotContinued) {
  const ObjMesh mesh = read_obj("# C:\\models\\\n" + quad + "f 1/1 2/2 \\\n3/3\n", "a.obj");
  EXPECT_EQ(mesh.positions.size(), read_obj(quad, "a.obj").positions.size());
}

TEST(Obj, CutsConcavePolygons) {
  const ObjMesh mesh = read_obj(
      "v 0 0 0\nv 2 -1 0\nv 0 3 0\nv -2 -1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 2/2 3/3 4/4 1/1\nf 1/1 2/2 3/3\n",
      "a.obj");
  ASSERT_EQ(mesh.faces.size(), 3U);
  for (std::size_t f = 0; f < 2; ++f)
    EXPECT_NE(std::find(mesh.faces[f].begin(), mesh.faces[f].end(), 0U), mesh.faces[f].end()) << "cut at the notch";
  ASSERT_EQ(mesh.assumptions.size(), 1U);
  EXPECT_EQ(mesh.assumptions[0], "line 9: concave polygons are cut by clipping ears (1 in total)");
  EXPECT_TRUE(mesh.needs_repair);
}

struct BadObj {
  const char* name;
  std::string text;
  const char* says;
};
class BadObjFile : public ::testing::TestWithParam<BadObj> {};
INSTANTIATE_TEST_SUITE_P(
    Obj, BadObjFile,
    ::testing::Values(
        BadObj{"range", quad + "f 1/1 2/2 9/9\n", "line 11: vertex index 9 is out of range"},
        BadObj{"uv_range", quad + "v 1 1 1\nf 1/1 2/2 5/5\n", "line 12: vt index 5 is out of range"},
        BadObj{"negative_range", quad + "f -1/-1 -2/-2 -5/-1\n", "out of range"},
        BadObj{"zero", quad + "f 0/1 2/2 3/3\n", "not a vertex index"},
        BadObj{"no_vt", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no texture coordinates"},
        BadObj{"no_vt_normals", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n", "no texture coordinates"},
        BadObj{"nan", "v 0 nan 0\n", "line 1: \"nan\" is not a finite number"},
        BadObj{"inf", "v 0 1e999 0\n", "not a finite number"}, BadObj{"short_v", "v 0 1\n", "line 1: is truncated"},
        BadObj{"short_f", quad + "f 1/1 2/2\n", "three corners"}, BadObj{"text", "v a b c\n", "is not a number"},
        BadObj{"continued", quad + "f 1/1 \\\n2/2 9/9\n\nf 1/1\n", "line 14: a face needs"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST_P(BadObjFile, RejectsWithFileAndLine) {
  try {
    read_obj(GetParam().text, "scene/shape0.obj");
    FAIL() << "was accepted";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().says), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).rfind("scene/shape0.obj: ", 0), 0U);
  }
}

}  // namespace
}  // namespace rebake::test
