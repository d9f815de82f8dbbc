// Deformations along a polyline: equal to the closed form on a straight one; parts beyond move rigidly, also where the
// polyline turns back.
#include "mesh_ops/deform/bends/curved_form.h"

#include <gtest/gtest.h>

#include <numbers>
#include <optional>
#include <random>

#include "mesh_ops/base/error.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

TEST(CurvedForm, AlongAStraightLineMatchesTheClosedForm) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.5, 1);
  for (const ClosedForm::Kind kind : {ClosedForm::Kind::bend, ClosedForm::Kind::twist, ClosedForm::Kind::stretch})
    for (const double radians : {1.3, -4.7, 12.0}) {
      ClosedForm form;
      form.kind = kind;
      form.origin = {0.1, 0.2, -0.1};
      form.axis = {0.2, 1, 0.1};
      form.from = -0.2;
      form.to = 0.7;
      form.factor = 0.4;
      form.radians = radians;
      const Vec3 along = form.axis.normalized();
      ClosedForm from_start = form;
      from_start.origin = form.origin - 0.5 * along;  // arc length is measured from the curve's first point
      from_start.from += 0.5;
      from_start.to += 0.5;
      const auto curved =
          along_curve(from_start, {from_start.origin, form.origin, form.origin + 0.4 * along, form.origin + 3 * along});
      for (int k = 0; k < 100; ++k) {
        const Vec3 point(0.3 * any(random), 2 * any(random), 0.3 * any(random));  // also far beyond both limits
        const Deformed want = deform(form, point), got = deform(curved, point);
        EXPECT_LE((got.point - want.point).norm(), 1e-13);
        EXPECT_LE((got.jacobian - want.jacobian).norm(), 1e-12);
      }
    }
}

// At the limits and at the joints of a spine, where the share of a piece is 0, rotations depend on the point too.
TEST(CurvedForm, AtLimitsAndJointsItMatchesTheClosedForm) {
  for (const ClosedForm::Kind kind : {ClosedForm::Kind::bend, ClosedForm::Kind::twist, ClosedForm::Kind::stretch}) {
    ClosedForm form;
    form.kind = kind;
    form.origin = {0, 0, 0};
    form.axis = {0, 1, 0};
    form.direction = {1, 0, 0};
    form.from = 0;
    form.to = 2;
    form.factor = 1.5;
    form.radians = 6;
    const auto curved = along_curve(form, {{0, 0, 0}, {0, 1, 0}, {0, 1.5, 0}, {0, 2, 0}});
    for (const double along : {0.0, 1.0, 1.5, 2.0})
      for (const Vec3& aside : {Vec3(0.5, 0, 0), Vec3(0, 0, -0.3), Vec3(-0.2, 0, 0.4)}) {
        const Vec3 point = aside + along * Vec3::UnitY();
        const Deformed want = deform(form, point), got = deform(curved, point);
        EXPECT_LE((got.point - want.point).norm(), 1e-14) << along;
        EXPECT_LE((got.jacobian - want.jacobian).norm(), 1e-13) << along << "\n"
                                                                << got.jacobian << "\n"
                                                                << want.jacobian;
      }
  }
}

TEST(CurvedForm, PreservesLengthAndMovesTheRestRigidly) {
  std::vector<Vec3> curve;
  for (int k = 0; k <= 12; ++k) curve.emplace_back(std::sin(0.1 * k), 0.12 * k, 0.3 * std::cos(0.15 * k));
  double length = 0;
  for (std::size_t k = 0; k + 1 < curve.size(); ++k) length += (curve[k + 1] - curve[k]).norm();
  for (const ClosedForm::Kind kind : {ClosedForm::Kind::bend, ClosedForm::Kind::twist}) {
    ClosedForm form;
    form.kind = kind;
    form.radians = 1.1;
    form.to = length;
    const auto curved = along_curve(form, curve);
    double after = 0;
    Vec3 last = deform(curved, curve[0]).point;
    EXPECT_EQ(last, curve[0]) << "the first point must stay";
    constexpr int steps = 2000;
    for (std::size_t k = 0; k + 1 < curve.size(); ++k)
      for (int i = 1; i <= steps; ++i) {
        const Vec3 next = deform(curved, curve[k] + (curve[k + 1] - curve[k]) * i / steps).point;
        after += (next - last).norm();
        last = next;
      }
    EXPECT_NEAR(after, length, 1e-6 * length);
    const Vec3 end = (curve[12] - curve[11]).normalized();
    for (const double far : {0.1, 3.0}) {
      const Deformed beyond = deform(curved, curve[12] + far * end + Vec3(0.02, 0, 0.01));
      EXPECT_LE((beyond.jacobian.transpose() * beyond.jacobian - Mat3::Identity()).norm(), 1e-12);
      EXPECT_NEAR(Eigen::AngleAxisd(Mat3(beyond.jacobian)).angle(), 1.1, kind == ClosedForm::Kind::bend ? 1e-13 : 0.2);
    }
  }
  // Jacobians match finite differences.
  ClosedForm form;
  form.radians = 0.9;
  form.to = length;
  const auto curved = along_curve(form, curve);
  const Vec3 point(0.5, 0.71, 0.33);
  Mat3 want;
  for (int axis = 0; axis < 3; ++axis)
    want.col(axis) = (deform(curved, Vec3(point + 1e-5 * Vec3::Unit(axis))).point -
                      deform(curved, Vec3(point - 1e-5 * Vec3::Unit(axis))).point) /
                     2e-5;
  EXPECT_LE((deform(curved, point).jacobian - want).norm(), 1e-8);
  form.kind = ClosedForm::Kind::taper;
  EXPECT_THROW(along_curve(form, curve), FieldError);
  form.kind = ClosedForm::Kind::bend;
  EXPECT_THROW(along_curve(form, {curve[0]}), FieldError);
  EXPECT_THROW(along_curve(form, {curve[0], curve[0]}), FieldError);
}

// A straight line is the same spine however finely it is cut, and the angle of a bend is the one that was asked for,
// also where the line is not perpendicular to the axis of rotation.
TEST(CurvedForm, TiltedSpinesBendByTheirAngleHoweverTheyAreCut) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const double tilt : {0.0, 1e-9, 0.17, 0.8, 1.5})
    for (const double radians : {1.57, -0.4, 5.0}) {
      ClosedForm form;
      form.axis = {0, 1, 0};
      form.direction = {1, 0, 0};
      form.radians = radians;
      form.from = 0.2;
      form.to = 1.0;
      const Vec3 start(0.3, -0.9, -0.2), along(0, std::cos(tilt), std::sin(tilt));
      const auto cut = [&](int pieces) {
        std::vector<Vec3> spine;
        for (int k = 0; k <= pieces; ++k) spine.push_back(start + along * (2.0 * k / pieces));
        return along_curve(form, spine);
      };
      const CurvedForm whole = cut(1);
      const Mat3 end = Eigen::AngleAxisd(radians, Vec3(1, 0, 0).cross(Vec3(0, 1, 0)) * -1).toRotationMatrix();
      for (int k = 0; k < 50; ++k) {
        const Vec3 point = start + along * (1 + any(random)) + 0.3 * Vec3(any(random), any(random), any(random));
        const Deformed want = deform(whole, point);
        for (const int pieces : {4, 64}) {
          const Deformed got = deform(cut(pieces), point);
          EXPECT_LE((got.point - want.point).norm(), 1e-13) << tilt << " " << pieces;
          EXPECT_LE((got.jacobian - want.jacobian).norm(), 1e-12) << tilt << " " << pieces;
        }
        Mat3 differences;
        for (int axis = 0; axis < 3; ++axis)
          differences.col(axis) = (deform(whole, Vec3(point + 1e-6 * Vec3::Unit(axis))).point -
                                   deform(whole, Vec3(point - 1e-6 * Vec3::Unit(axis))).point) /
                                  2e-6;
        const double height = along.dot(point - start);
        if (std::min(std::abs(height - 0.2), std::abs(height - 1.0)) < 1e-5) continue;
        EXPECT_LE((want.jacobian - differences).norm(), 1e-8);
      }
      const Mat3 beyond = deform(whole, Vec3(start + along * 1.7)).jacobian;
      EXPECT_LE(std::min((beyond - end).norm(), (beyond - end.transpose()).norm()), 1e-13) << tilt << " " << radians;
    }
}

// A planar curve of equal segments that turns steadily.
std::vector<Vec3> turning_curve(double total_turn, int segments, double length) {
  std::vector<Vec3> curve{{0, 0, 0}};
  for (int k = 0; k < segments; ++k) {
    const double angle = total_turn * k / segments;
    curve.push_back(curve.back() + length / segments * Vec3(std::sin(angle), std::cos(angle), 0));
  }
  return curve;
}

TEST(CurvedForm, SpinesThatTurnBackMoveOnlyWhatComesAfter) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int trial = 0; trial < 60; ++trial) {
    const double total_turn = 1.5 + 2.3 * (1 + any(random)) / 2;  // up to 218°
    constexpr int segments = 30;
    const std::vector<Vec3> curve = turning_curve(total_turn, segments, 3);
    const double tube = 0.5 * 3 / total_turn;  // half of the radius of curvature
    ClosedForm form;
    form.kind = trial % 3 == 0   ? ClosedForm::Kind::bend
                : trial % 3 == 1 ? ClosedForm::Kind::twist
                                 : ClosedForm::Kind::stretch;
    form.radians = 0.7;
    form.factor = 1.4;
    form.direction = {1, 0, 0};
    form.from = 1.2;
    form.to = 1.8;
    const CurvedForm curved = along_curve(form, curve);
    std::optional<Deformed> end;
    for (int i = 0; i < 300; ++i) {
      const auto k = static_cast<std::size_t>(i) % segments;
      const Vec3 along = (curve[k + 1] - curve[k]).normalized(), aside(along.y(), -along.x(), 0);
      const Vec3 point =
          (curve[k] + curve[k + 1]) / 2 + tube * any(random) * aside + tube * any(random) * Vec3::UnitZ();
      const Deformed one = deform(curved, point);
      const double at = (static_cast<double>(k) + 0.5) * 3 / segments;
      // Points beside a corner of the polyline belong to both of its segments.
      constexpr double margin = 3.0 / segments;
      if (at < form.from - margin) {
        EXPECT_EQ(one.point, point) << "before the limits, " << total_turn << " " << at;
      } else if (at > form.to + margin) {
        if (!end) end = one;
        EXPECT_LE((one.jacobian - end->jacobian).norm(), 1e-13) << total_turn << " " << at;
        EXPECT_LE((one.jacobian.transpose() * one.jacobian - Mat3::Identity()).norm(), 1e-13);
      }
    }
  }
}

// Parallel segments of a winding spine are different parts: points beyond the limit must move rigidly.
TEST(CurvedForm, LegsOfAWindingSpineBeyondTheLimitMoveRigidly) {
  std::vector<Vec3> spine;
  const auto arc = [&](const Vec3& centre, double from, double to) {
    for (int k = 0; k <= 8; ++k) {
      const double angle = from + (to - from) * k / 8;
      spine.emplace_back(centre + 0.3 * Vec3(std::cos(angle), std::sin(angle), 0));
    }
  };
  spine.emplace_back(0, 0, 0);
  arc({2, 0.3, 0}, -std::numbers::pi / 2, std::numbers::pi / 2);
  arc({0, 0.9, 0}, -std::numbers::pi / 2, -3 * std::numbers::pi / 2);
  spine.emplace_back(2, 1.2, 0);
  for (const ClosedForm::Kind kind : {ClosedForm::Kind::bend, ClosedForm::Kind::twist, ClosedForm::Kind::stretch}) {
    ClosedForm form;
    form.kind = kind;
    form.axis = {1, 0, 0};
    form.direction = {0, 0, 1};
    form.radians = 1.5;
    form.factor = 1.4;
    form.to = 1.5;
    const CurvedForm curved = along_curve(form, spine);
    std::vector<Vec3> rest, moved;
    for (const double x : {0.1, 0.7, 1.3, 1.9})
      for (const double z : {-0.05, 0.05}) {
        rest.emplace_back(x, 1.2, z);
        moved.push_back(deform(curved, rest.back()).point);
      }
    for (std::size_t a = 0; a < rest.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) EXPECT_NEAR((moved[a] - moved[b]).norm(), (rest[a] - rest[b]).norm(), 1e-12);
  }
}

TEST(CurvedForm, ContinuousAroundSpinesThatTurnBack) {
  const std::vector<Vec3> curve = turning_curve(3.6, 40, 3);
  for (const ClosedForm::Kind kind : {ClosedForm::Kind::bend, ClosedForm::Kind::twist, ClosedForm::Kind::stretch}) {
    ClosedForm form;
    form.kind = kind;
    form.radians = 1.2;
    form.direction = {1, 0, 0};
    form.factor = 1.5;
    form.to = 3;
    const CurvedForm curved = along_curve(form, curve);
    const double radius = 3 / 3.6;
    for (const double off : {-0.5, -0.2, 0.2, 0.5}) {
      // A circle beside the spine, from its beginning to its end.
      const Vec3 center(radius, 0, 0);
      const int steps = cases(20000, 20000, 2000);
      Vec3 last_point(0, 0, 0), last(0, 0, 0);
      for (int i = 0; i <= steps; ++i) {
        const double angle = 3.5 * i / steps;
        const Vec3 point =
            center + (1 + off) * radius * Vec3(-std::cos(angle), std::sin(angle), 0) + Vec3(0, 0, 0.1 * radius);
        const Vec3 now = deform(curved, point).point;
        if (i > 0) {
          EXPECT_LT((now - last).norm(), 8 * (point - last_point).norm()) << angle << " " << off;
        }
        last_point = point;
        last = now;
      }
    }
  }
}

}  // namespace
}  // namespace rebake::test
