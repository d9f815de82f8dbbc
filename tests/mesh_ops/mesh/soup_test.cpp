// Moving a part of a soup keeps its UVs, records its rotation, and splits vertices that it shares with the rest.
#include "mesh_ops/mesh/soup.h"
#include "mesh_ops/base/polar.h"

#include <gtest/gtest.h>

namespace rebake::test {
namespace {

Soup moved_faces(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first, const Affine& motion) {
  return move_faces(soup, flags, first, motion, orthogonal_factor(motion.linear()));
}

// 2──3
// │╲ │   two triangles that share an edge
// 0──1
Soup square() {
  return Soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 0}, {1, 0}, {0, 1}, {1, 1}}, {{0, 1, 2}, {1, 3, 2}});
}

TEST(Soup, MovedFacesSplitSharedVertices) {
  const Affine motion(Eigen::Translation3d(0, 0, 5));
  const Soup moved = moved_faces(square(), {0, 1}, 0, motion);
  EXPECT_EQ(moved.positions().size(), 6U);
  EXPECT_EQ(moved.faces()[0], (Face{0, 1, 2}));
  for (const std::uint32_t v : moved.faces()[1]) EXPECT_EQ(moved.positions()[v].z(), 5);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(moved.uvs()[moved.faces()[1][k]], square().uvs()[square().faces()[1][k]]);
  EXPECT_EQ(moved.rotations(), nullptr);  // a translation records no rotation
}

TEST(Soup, AccumulatesRotationsWithoutScale) {
  const Affine quarter(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitZ()) * Eigen::Scaling(3.0));
  Soup soup = moved_faces(square(), {1, 0}, 0, quarter);
  ASSERT_NE(soup.rotations(), nullptr);
  EXPECT_TRUE((*soup.rotations())[0].matrix().isApprox(
      Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitZ()).toRotationMatrix(), 1e-14));
  EXPECT_TRUE((*soup.rotations())[3].is_identity());
  soup = moved_faces(soup, {1, 0}, 0, quarter);
  EXPECT_TRUE(
      (*soup.rotations())[0].matrix().isApprox(Eigen::AngleAxisd(EIGEN_PI, Vec3::UnitZ()).toRotationMatrix(), 1e-14));
}

TEST(Soup, SubsetKeepsOrderAndDropsUnusedVertices) {
  const Soup part = subset(square(), {0, 1}, 0, true);
  EXPECT_EQ(part.positions(), (std::vector<Vec3>{{1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(part.faces(), (std::vector<Face>{{0, 2, 1}}));
}

// Attributes of any name and type follow their vertices and faces.
TEST(Soup, AttributesFollowTheirVerticesAndFaces) {
  const Soup plain = square();
  const Soup soup(plain.shared_positions(), plain.shared_uvs(), plain.shared_faces(),
                  Attributes().with("light", Values<float>::of({1, 2, 3, 4})),
                  Attributes().with("label", Values<int>::of({7, 8})));
  const auto light = [](const Soup& of, std::uint32_t v) { return of.vertex_attributes().find<float>("light")->at(v); };
  const Soup part = subset(soup, {0, 1}, 0, true);
  EXPECT_EQ(*part.vertex_attributes().find<float>("light"), (std::vector<float>{2, 3, 4}));
  EXPECT_EQ(*part.face_attributes().find<int>("label"), (std::vector<int>{8}));
  // Split vertices keep their values and get a rotation.
  const Soup moved = moved_faces(soup, {0, 1}, 0, Affine(Eigen::AngleAxisd(1, Vec3::UnitZ())));
  for (std::size_t f = 0; f < 2; ++f)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(light(moved, moved.faces()[f][k]), light(soup, soup.faces()[f][k]));
  EXPECT_NE(moved.rotations(), nullptr);
  EXPECT_EQ(*moved.face_attributes().find<int>("label"), (std::vector<int>{7, 8}));
  // United with a soup without these attributes, which gets neutral values.
  const Soup both = united(moved, plain);
  EXPECT_EQ(*both.face_attributes().find<int>("label"), (std::vector<int>{7, 8, 0, 0}));
  EXPECT_EQ(light(both, static_cast<std::uint32_t>(moved.positions().size())), 0.0F);
  EXPECT_TRUE(both.rotations()->back().is_identity());
  // Uniting all parts restores all attributes.
  const Soup whole = united(subset(soup, {0, 1}, 0, false), part);
  EXPECT_EQ(whole.vertex_attributes(), soup.vertex_attributes());
  EXPECT_EQ(whole.face_attributes(), soup.face_attributes());
  EXPECT_THROW(Soup(plain.shared_positions(), plain.shared_uvs(), plain.shared_faces(),
                    Attributes().with("light", Values<float>::of({1}))),
               std::invalid_argument);
}

TEST(Soup, RejectsFaceOutOfRange) { EXPECT_THROW(Soup({{0, 0, 0}}, {{0, 0}}, {{0, 0, 1}}), std::invalid_argument); }

TEST(OrthogonalFactor, KnownCases) {
  EXPECT_TRUE(orthogonal_factor(Mat3::Identity() * 1e-30).isIdentity(0));
  EXPECT_TRUE(orthogonal_factor(Vec3(2, -3, 1e-6).asDiagonal()).isApprox(Mat3(Vec3(1, -1, 1).asDiagonal()), 0));
  const Mat3 turn = Eigen::AngleAxisd(1, Vec3(1, 1, 1).normalized()).toRotationMatrix();
  for (const double scale : {1e-300, 1e-6, 1.0, 1e6, 1e300})
    EXPECT_TRUE(orthogonal_factor(turn * scale).isApprox(turn, 1e-14)) << scale;
  EXPECT_THROW(orthogonal_factor(Vec3(1, 1, 0).asDiagonal()), std::invalid_argument);
  EXPECT_THROW(orthogonal_factor(Mat3::Constant(NAN)), std::invalid_argument);
}

}  // namespace
}  // namespace rebake::test
