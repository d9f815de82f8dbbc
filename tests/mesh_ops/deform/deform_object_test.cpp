// Deforming objects: no cracks, unchanged data stays shared, soft borders, fold counts.
#include "mesh_ops/deform/deform_object.h"
#include "mesh_ops/base/polar.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/bends/closed_form.h"
#include "mesh_ops/deform/cages/wrap.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

SpaceDeformation closed(const ClosedForm& form) {
  return [form](const std::vector<Vec3>& points) {
    DeformedPoints result;
    for (const Vec3& p : points) {
      const Deformed one = deform(form, p);
      result.points.push_back(one.point);
      result.jacobians.push_back(one.jacobian);
    }
    return result;
  };
}
SpaceDeformation bend(double radians) {
  ClosedForm form;
  form.from = -1;
  form.radians = radians;
  return closed(form);
}
SpaceDeformation affine(const Mat3& linear) {
  return [linear](const std::vector<Vec3>& points) {
    DeformedPoints result;
    for (const Vec3& p : points) result.points.push_back(linear * p);
    result.jacobians.assign(points.size(), linear);
    return result;
  };
}

TriangleSet all(const BakedObject& object) { return TriangleSet(object.triangle_count(), 1); }
TriangleSet upper_half(const BakedObject& object) {
  TriangleSet flags;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces()) {
      const auto& p = set.soup.positions();
      flags.push_back((p[face[0]] + p[face[1]] + p[face[2]]).y() > 0 ? 1 : 0);
    }
  return flags;
}

// Maps each corner position before to the distinct positions after; exactly one each if nothing is torn.
std::map<std::array<double, 3>, std::vector<Vec3>> places(const BakedObject& before, const BakedObject& after) {
  std::map<std::array<double, 3>, std::vector<Vec3>> result;
  for (std::size_t s = 0; s < before.sets.size(); ++s)
    for (std::size_t f = 0; f < before.sets[s].soup.triangle_count(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& p = before.sets[s].soup.positions()[before.sets[s].soup.faces()[f][k]];
        const Vec3& q = after.sets[s].soup.positions()[after.sets[s].soup.faces()[f][k]];
        auto& found = result[{p.x(), p.y(), p.z()}];
        if (std::find(found.begin(), found.end(), q) == found.end()) found.push_back(q);
      }
  return result;
}

TEST(Deform, DuplicateVerticesMoveBitIdentically) {
  const auto object = made_object();
  const DeformedObject result = deformed(*object, Affine::Identity(), all(*object), 0, bend(1));
  for (const auto& [place, now] : places(*object, *result.object)) EXPECT_EQ(now.size(), 1U);
  EXPECT_NE(result.object->sets[0].soup.shared_positions(), object->sets[0].soup.shared_positions());
  EXPECT_EQ(result.object->sets[0].soup.shared_uvs(), object->sets[0].soup.shared_uvs()) << "UVs must stay shared";
  EXPECT_EQ(result.object->sets[0].texels, object->sets[0].texels);
}

TEST(Deform, IdentityChangesNothing) {
  const auto object = made_object();
  // A transform whose inverse is inexact.
  const Affine placed =
      Eigen::Translation3d(0.1, 0.2, 0.3) * Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()) * Eigen::Scaling(0.7);
  const DeformedObject result = deformed(*object, placed, all(*object), 0, bend(0));
  EXPECT_EQ(result.object->sets[0].soup.shared_positions(), object->sets[0].soup.shared_positions());
  EXPECT_EQ(result.object->sets[0].soup.rotations(), nullptr);
}

TEST(Deform, SoftBorderHasNoCracksHardBorderSplits) {
  const auto object = made_object({.columns = 32, .rows = 16});
  const TriangleSet flags = upper_half(*object);
  const DeformedObject soft =
      deformed(*object, Affine::Identity(), flags, 0.5, affine(Eigen::Scaling(1.5) * Mat3::Identity()));
  for (const auto& [place, now] : places(*object, *soft.object)) EXPECT_EQ(now.size(), 1U);
  const DeformedObject hard =
      deformed(*object, Affine::Identity(), flags, 0, affine(Eigen::Scaling(1.5) * Mat3::Identity()));
  std::size_t split = 0;
  for (const auto& [place, now] : places(*object, *hard.object)) split += now.size() > 1 ? 1 : 0;
  EXPECT_EQ(split, 32U) << "the equator's corners";
  // The Jacobian includes the falloff; a scaling that fades out does not fold.
  EXPECT_EQ(soft.report.folded, 0U);
}

// The falloff is a function of the distance to the border's edges. The distance to its corners would cause waves along
// the border, with slopes that differ by 1.5 over the falloff.
TEST(Deform, FalloffIsUniformAlongTheBorder) {
  // A sheet of 4 × 64 quads; the upper 48 rows rise, the border runs along x.
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  for (int row = 0; row <= 64; ++row)
    for (int column = 0; column <= 4; ++column) {
      positions.emplace_back(column * 0.5, row / 64.0, 0);
      uvs.emplace_back(0.1, 0.1);
    }
  TriangleSet flags;
  for (std::uint32_t row = 0; row < 64; ++row)
    for (std::uint32_t column = 0; column < 4; ++column) {
      const std::uint32_t a = row * 5 + column;
      faces.push_back({a, a + 1, a + 6});
      faces.push_back({a, a + 6, a + 5});
      flags.insert(flags.end(), 2, row >= 16 ? 1 : 0);
    }
  BakedObject sheet = *made_object({.columns = 4, .rows = 2});
  sheet.sets = {sheet.sets[0]};
  // Above the border, columns are shifted to lie between the border's corners.
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (positions[v].y() > 0.26) positions[v].x() += 0.25;
  sheet.sets[0].soup = Soup(positions, uvs, faces);
  const SpaceDeformation rise = [](const std::vector<Vec3>& points) {
    DeformedPoints result{points, std::vector<Mat3>(points.size(), Mat3::Identity()), {}};
    for (Vec3& p : result.points) p.z() += 1;
    return result;
  };
  const auto risen = deformed(sheet, Affine::Identity(), flags, 0.3, rise).object;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const double t = std::min(1.0, (positions[v].y() - 0.25) / 0.3);
    if (t <= 0 || positions[v].x() > 2) continue;  // beyond the border's end its corner is the nearest
    EXPECT_NEAR(risen->sets[0].soup.positions()[v].z(), t * t * (3 - 2 * t), 1e-12) << positions[v].transpose();
  }
}

// A stray vertex far away must not blur the search for the nearest piece of the border.
TEST(Deform, FalloffDoesNotDependOnFarTriangles) {
  const auto object = made_object({.columns = 32, .rows = 16});
  const SpaceDeformation grow = affine(Eigen::Scaling(1.5) * Mat3::Identity());
  const auto alone = deformed(*object, Affine::Identity(), upper_half(*object), 0.5, grow).object;
  for (const double far : {1e13, 1e17, 1e25}) {
    BakedObject more = *object;
    const Soup& soup = object->sets[0].soup;
    std::vector<Vec3> positions = soup.positions();
    std::vector<Vec2> uvs = soup.uvs();
    std::vector<Face> faces = soup.faces();
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (int k = 0; k < 3; ++k) {
      positions.emplace_back(-far, k, 0);
      uvs.emplace_back(0.1, 0.1);
    }
    faces.push_back({first, first + 1, first + 2});
    more.sets[0].soup = Soup(positions, uvs, faces);
    TriangleSet flags = upper_half(*object);
    flags.insert(flags.begin() + static_cast<std::ptrdiff_t>(soup.triangle_count()), 1);
    const auto with_stray = deformed(more, Affine::Identity(), flags, 0.5, grow).object;
    const std::vector<Vec3>&a = alone->sets[0].soup.positions(), &b = with_stray->sets[0].soup.positions();
    double worst = 0;
    for (std::size_t f = 0; f < soup.triangle_count(); ++f)
      for (std::size_t k = 0; k < 3; ++k)
        worst =
            std::max(worst, (a[alone->sets[0].soup.faces()[f][k]] - b[with_stray->sets[0].soup.faces()[f][k]]).norm());
    EXPECT_EQ(worst, 0) << far;
  }
}

TEST(Deform, CountsPlacesThatMoveOrRotate) {
  const auto object = made_object();
  std::set<std::array<double, 3>> beside;  // the plane y = 0
  for (const TextureSet& set : object->sets)
    for (const Vec3& p : set.soup.positions())
      if (p.y() != 0) beside.insert({p.x(), p.y(), p.z()});
  const auto changed = [&](const Mat3& linear) {
    return deformed(*object, Affine::Identity(), all(*object), 0, affine(linear)).report.changed;
  };
  EXPECT_EQ(changed(Mat3::Identity()), 0U);
  EXPECT_EQ(changed(Vec3(1, 2, 1).asDiagonal()), beside.size());
  // Also in a frame that is rotated about the axis.
  const Affine rotated(Eigen::AngleAxisd(0.3, Vec3::UnitY()));
  EXPECT_EQ(deformed(*object, rotated, all(*object), 0, affine(Vec3(1, 2, 1).asDiagonal())).report.changed,
            beside.size());
  const DeformationReport sheared =
      deformed(*object, Affine::Identity(), all(*object), 0, affine(Mat3{{1, 0.5, 0}, {0, 1, 0}, {0, 0, 1}})).report;
  EXPECT_EQ(sheared.changed, sheared.points) << "all rotate";
}

TEST(Deform, CountsFoldsWithoutNaN) {
  const auto object = made_object();
  // A curvature κ = 2 folds space beyond x = 0.5.
  ClosedForm form;
  form.from = -1;
  form.to = 1;
  form.radians = 4;
  const DeformedObject bent = deformed(*object, Affine::Identity(), all(*object), 0, closed(form));
  EXPECT_GT(bent.report.folded, 0U);
  EXPECT_LT(bent.report.min_determinant, 0);
  EXPECT_GT(count(folded_triangles(*bent.object)), 0U);
  EXPECT_LT(count(folded_triangles(*bent.object)), object->triangle_count());
  // Collapsed to a plane, a line, a point; mirrored.
  for (const Vec3& scale : {Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3(-1, 1, 1)}) {
    const DeformedObject flat = deformed(*object, Affine::Identity(), all(*object), 0, affine(scale.asDiagonal()));
    EXPECT_EQ(flat.report.folded, flat.report.points) << scale.transpose();
    for (const TextureSet& set : flat.object->sets) {
      for (const Vec3& p : set.soup.positions()) EXPECT_TRUE(p.allFinite());
      if (set.soup.rotations() == nullptr) continue;
      for (const PackedRotation& turn : *set.soup.rotations()) {
        EXPECT_TRUE(turn.matrix().isUnitary(1e-12));
        // Mirroring also mirrors view directions (determinant −1); collapsed vertices get a proper rotation.
        EXPECT_EQ(turn.matrix().determinant() > 0, scale.x() >= 0) << scale.transpose();
      }
    }
  }
}

TEST(Deform, MirroringTwiceIsTheIdentity) {
  const auto object = made_object();
  for (const Vec3& scale : {Vec3(-1, 1, 1), Vec3(1, -1, 1), Vec3(-1, -1, -1)}) {
    const DeformedObject once = deformed(*object, Affine::Identity(), all(*object), 0, affine(scale.asDiagonal()));
    for (const PackedRotation& turn : *once.object->sets[0].soup.rotations())
      EXPECT_LE((turn.matrix() - Mat3(scale.asDiagonal())).norm(), 1e-14) << scale.transpose();
    EXPECT_EQ(once.report.undefined, 0U);
    const DeformedObject twice =
        deformed(*once.object, Affine::Identity(), all(*object), 0, affine(scale.asDiagonal()));
    if (twice.object->sets[0].soup.rotations() == nullptr) continue;
    for (const PackedRotation& turn : *twice.object->sets[0].soup.rotations())
      EXPECT_LE((turn.matrix() - Mat3::Identity()).norm(), 1e-14) << scale.transpose();
  }
}

TEST(Deform, NonFinitePointsStay) {
  auto object = std::make_shared<BakedObject>(*made_object());
  auto positions = object->sets[0].soup.positions();
  positions[0].x() = std::nan("");
  positions[5].y() = std::numeric_limits<double>::infinity();
  object->sets[0].soup = Soup(positions, object->sets[0].soup.uvs(), object->sets[0].soup.faces());
  const DeformedObject result = deformed(*object, Affine::Identity(), all(*object), 0, bend(1));
  EXPECT_EQ(result.report.not_finite, 2U);
  EXPECT_TRUE(std::isnan(result.object->sets[0].soup.positions()[0].x()));
  EXPECT_EQ(result.object->sets[0].soup.positions()[5].y(), positions[5].y());
  const Cage cage = wrap({positions, object->sets[0].soup.faces()}, 0.2);
  EXPECT_GT(cage.faces.size(), 10U);
}

TEST(Deform, RotationsAccumulateOverSeveralBends) {
  const auto object = made_object();
  const Mat3 quarter = Eigen::AngleAxisd(0.5, Vec3::UnitX()).toRotationMatrix();
  const DeformedObject once = deformed(*object, Affine::Identity(), all(*object), 0, affine(quarter));
  const DeformedObject twice = deformed(*once.object, Affine::Identity(), all(*object), 0, affine(quarter));
  for (const PackedRotation& turn : *twice.object->sets[0].soup.rotations())
    EXPECT_LE((turn.matrix() - quarter * quarter).norm(), 1e-14);
  // In a node with a rotation and a non-uniform scale, rotations are stored in object space.
  const Affine placed = Eigen::AngleAxisd(1.1, Vec3(1, 1, 0).normalized()) * Eigen::Scaling(1.0, 3.0, 0.5);
  const DeformedObject turned = deformed(*object, placed, all(*object), 0, affine(quarter));
  const Mat3 frame = orthogonal_factor(placed.linear());
  for (const PackedRotation& turn : *turned.object->sets[0].soup.rotations())
    EXPECT_LE((turn.matrix() - frame.transpose() * quarter * frame).norm(), 1e-12);
}

}  // namespace
}  // namespace rebake::test
