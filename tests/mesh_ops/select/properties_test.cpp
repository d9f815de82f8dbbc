// Properties of selections that hold for any input, tried on random ones.
#include <gtest/gtest.h>

#include <random>

#include "mesh_ops/index/index.h"
#include "mesh_ops/index/traits.h"
#include "mesh_ops/select/picture.h"
#include "mesh_ops/select/regions.h"
#include "mesh_ops/select/triangle_appearance.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

constexpr int texture_side = 8;

// One triangle in the plane z = 0 with the given UVs.
BakedObject triangle_with(const std::array<Vec2, 3>& uvs, const std::vector<bool>& opaque) {
  BakedObject object;
  object.decoder = std::make_shared<const Decoder>(diffuse_decoder());
  const auto texels = FeatureTexture::from_rows(texture_side, texture_side, AlphaCode::plain, [&](int y, Texel* row) {
    for (int x = 0; x < texture_side; ++x)
      row[x] =
          opaque[static_cast<std::size_t>(y * texture_side + x)] ? Texel{{255, 90, 60, 30}, {0, 0, 0, 255}} : Texel{};
  });
  object.sets.push_back(
      {Soup({Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0)}, {uvs.begin(), uvs.end()}, {Face{0, 1, 2}}),
       std::make_shared<const FeatureTexture>(texels)});
  return object;
}

// Share of points of a regular grid on the triangle that show an opaque texel.
double shown_share(const BakedObject& object) {
  constexpr int steps = 200;
  const auto& uvs = object.sets[0].soup.uvs();
  int all = 0, opaque = 0;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; i + j < steps; ++j) {
      const double u = (i + 1.0 / 3) / steps, v = (j + 1.0 / 3) / steps;
      const Vec2 at = uvs[0] * (1 - u - v) + uvs[1] * u + uvs[2] * v;
      ++all;
      opaque += object.sets[0].texels->opaque_at(at.x(), at.y()) ? 1 : 0;
    }
  return static_cast<double>(opaque) / all;
}

TEST(SelectionProperty, WhatShowsIsOpaqueAndSeen) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-0.1, 1.1);
  int borders = 0;
  for (int round = 0; round < 500; ++round) {
    std::array<Vec2, 3> uvs{Vec2(unit(random), unit(random)), Vec2(unit(random), unit(random)),
                            Vec2(unit(random), unit(random))};
    // As exporters place them: corners at centres of texels, with six decimals.
    if (round % 2 == 0)
      for (Vec2& uv : uvs) uv = ((uv * texture_side).array().floor() + 0.5) / texture_side + 4e-7 * unit(random);
    std::vector<bool> opaque(texture_side * texture_side);
    for (std::size_t k = 0; k < opaque.size(); ++k) opaque[k] = random() % 4 == 0;
    const BakedObject object = triangle_with(uvs, opaque);
    const double shown = shown_share(object);
    const Vec2 a = uvs[1] - uvs[0], b = uvs[2] - uvs[0];
    if (std::abs(a.x() * b.y() - a.y() * b.x()) < 1e-3) continue;
    const auto traits = texel_traits(object.sets[0], *object.decoder);
    const TriangleSet unseen = triangles_unseen(object, {{Vec3(0, 0, 5), Vec3::Zero()}});
    EXPECT_EQ(shows_opaque(object.sets[0], 0), traits[0].opacity > 0);
    if (shown > 0) {
      EXPECT_GT(traits[0].opacity, 0) << round;
      EXPECT_NEAR(traits[0].color[0], 90 / 255.0, 1e-6);
      EXPECT_EQ(unseen[0], 0) << round;
      borders += traits[0].opacity < 0.01F ? 1 : 0;
    } else {
      EXPECT_LT(traits[0].opacity, 0.01F);
    }
  }
}

TEST(SelectionProperty, RelativeBoxesIncludeTheirBoundary) {
  std::mt19937 random(4);
  for (int round = 0; round < 300; ++round) {
    const auto coordinate = [&] { return static_cast<double>(static_cast<int>(random() % 400) - 200) / 100; };
    const Vec3 low(coordinate(), coordinate(), coordinate()),
        high = low + Vec3(0.01, 0.01, 0.01) * static_cast<double>(1 + random() % 300);
    // Triangles in the faces of a box.
    std::vector<Vec3> positions;
    std::vector<Face> faces;
    for (int axis = 0; axis < 3; ++axis)
      for (const Vec3& end : {low, high}) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (int k = 0; k < 3; ++k) {
          Vec3 corner = k == 1 ? high : low;
          if (k == 2) corner[(axis + 1) % 3] = high[(axis + 1) % 3];
          corner[axis] = end[axis];
          positions.push_back(corner);
        }
        faces.push_back({first, first + 1, first + 2});
      }
    BakedObject object;
    object.sets.push_back({Soup(positions, std::vector<Vec2>(positions.size(), Vec2(0, 0)), faces), nullptr});
    Node node;
    node.object = std::make_shared<const BakedObject>(object);
    const Scene scene = with_added({}, node, NodeId::none, 0);
    const FrameTransform frame(CoordinateFrame::bounds, placed_nodes(scene)[0]);
    const auto inside = region_of(frame, BoxRegion{Vec3::Zero(), Vec3::Ones()}).inside;
    EXPECT_EQ(count(triangles_by_centre(object, inside)), 6U);
    for (const Vec3& p : positions) EXPECT_TRUE(inside(p));
    EXPECT_TRUE(region_of(frame, HalfSpaceRegion{Vec3::Ones(), Vec3(0, -1, 0)}).inside(high));
  }
}

// Areas of very large and very small triangles.
TEST(SelectionProperty, SizesDoNotDependOnTheScale) {
  for (const double scale : {1e-40, 1e-23, 1.0, 1e19, 1e40}) {
    BakedObject object =
        triangle_with({Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}, std::vector<bool>(texture_side * texture_side, true));
    std::vector<Vec3> positions;
    std::vector<Vec2> uvs;
    std::vector<Face> faces;
    for (std::uint32_t k = 0; k < 6; ++k) {
      const double side = scale * std::exp2(0.5 * k);  // the areas double
      for (const Vec3& p : {Vec3(0, 0, k * scale), Vec3(side, 0, k * scale), Vec3(0, side, k * scale)}) {
        positions.push_back(p);
        uvs.push_back(object.sets[0].soup.uvs()[0]);
      }
      faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    }
    object.sets[0].soup = Soup(positions, uvs, faces);
    Node node;
    node.object = std::make_shared<const BakedObject>(object);
    const Scene scene = with_added({}, node, NodeId::none, 0);
    const std::vector<PlacedNode> placed = placed_nodes(scene);
    const TriangleAppearance model = mean_appearance(placed, {TriangleSet{0, 0, 1, 0, 0, 0}});
    AppearanceBounds bounds;
    bounds.size = 2.01;
    EXPECT_EQ(triangles_like(placed[0], model, bounds), (TriangleSet{0, 1, 1, 1, 0, 0})) << scale;
  }
}

TEST(SelectionProperty, ATriangleIsLikeItself) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 300; ++round) {
    BakedObject object =
        triangle_with({Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}, std::vector<bool>(texture_side * texture_side, true));
    std::vector<Vec3> positions;
    for (int k = 0; k < 3; ++k) positions.emplace_back(normal(random), normal(random), normal(random));
    object.sets[0].soup = Soup(positions, object.sets[0].soup.uvs(), object.sets[0].soup.faces());
    Node node;
    node.object = std::make_shared<const BakedObject>(object);
    node.selection = std::make_shared<const TriangleSet>(TriangleSet{1});
    const Scene scene = with_added({}, node, NodeId::none, 0);
    const std::vector<PlacedNode> placed = placed_nodes(scene);
    const TriangleAppearance model = mean_appearance(placed, {TriangleSet{1}});
    for (const double degrees : {0.0, 1e-9, 1.0, 90.0})
      EXPECT_EQ(count(triangles_like(placed[0], model, {{}, {}, {}, {}, degrees})), 1U) << degrees;
  }
}

std::array<float, 3> normal_of(const std::vector<Vec3>& corners) {
  BakedObject object =
      triangle_with({Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}, std::vector<bool>(texture_side * texture_side, true));
  object.sets[0].soup = Soup(corners, object.sets[0].soup.uvs(), object.sets[0].soup.faces());
  return (*traits_of(object))[0].normal;
}

TEST(SelectionProperty, ThinTrianglesFarFromTheOriginHaveAnOrientation) {
  // 2^20 away, where doubles are 2^-32 apart.
  const double away = std::ldexp(1, 20);
  for (const double height : {1.0, 1e-3, 1e-7})
    EXPECT_EQ(normal_of({Vec3(away, away, away), Vec3(away + 1, away, away), Vec3(away, away + height, away)}),
              (std::array<float, 3>{0, 0, 1}))
        << height;
  EXPECT_EQ(normal_of({Vec3(1, 1, 0), Vec3(2, 1, 0), Vec3(1, 1 + 1e-13, 0)}), (std::array<float, 3>{0, 0, 1}));
}

// Corners on one line, of which rounding makes triangles with random normals, also after transforms.
TEST(SelectionProperty, CollinearCornersHaveNoOrientation) {
  std::mt19937 random(10);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-8, 8);
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  for (int round = 0; round < 2000; ++round) {
    const Vec3 start = vector() * std::pow(10, exponent(random)), along = vector() * std::pow(10, exponent(random));
    Affine motion = Affine::Identity();
    motion.linear() << vector(), vector(), vector();
    motion.translation() = vector();
    EXPECT_EQ(normal_of({motion * start, motion * Vec3(start + along), motion * Vec3(start + 2.7 * along)}),
              (std::array<float, 3>{}))
        << round;
  }
}

}  // namespace
}  // namespace rebake::test
