// Local rotations are orthogonal for any matrix and equal the polar factor if that is defined. Closed forms of
// deformation.
#include "mesh_ops/base/polar.h"

#include <gtest/gtest.h>

#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/closed_form.h"

namespace rebake::test {
namespace {

Mat3 random_matrix(std::mt19937& random) {
  std::normal_distribution<double> any;
  Mat3 m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = any(random);
  return m;
}

void expect_rotation(const Mat3& r) {
  EXPECT_LE((r.transpose() * r - Mat3::Identity()).norm(), 1e-14);
  EXPECT_GT(r.determinant(), 0);
}

TEST(LocalRotation, RotationForEveryMatrix) {
  std::mt19937 random(1);
  for (int k = 0; k < 2000; ++k) {
    Mat3 m = random_matrix(random);
    if (k % 4 == 1) m.col(0) = m.col(1) * 2 - m.col(2);                              // rank 2
    if (k % 4 == 2) m = m.col(0) * m.row(0);                                         // rank 1
    if (k % 4 == 3) m.col(2) = -m.col(0).cross(m.col(1)) * std::pow(10.0, -k % 20);  // mirrored, and nearly flat
    for (const double scale : {1.0, 1e-150, 1e150}) expect_rotation(local_rotation(m * scale).rotation);
  }
  for (const Mat3& m : {Mat3(Mat3::Zero()), Mat3(-Mat3::Identity()), Mat3(Mat3::Constant(std::nan("")))}) {
    expect_rotation(local_rotation(m).rotation);
    EXPECT_FALSE(local_rotation(m).defined);
  }
  EXPECT_TRUE(local_rotation(Mat3::Identity()).rotation.isIdentity(0));
}

TEST(LocalRotation, NewtonAndSingularValuesAgree) {
  std::mt19937 random(2);
  double worst = 0;
  for (int k = 0; k < 2000; ++k) {
    Mat3 m = random_matrix(random);
    if (m.determinant() < 0) m.col(0) = -m.col(0);
    if (m.determinant() < 1e-2 * std::pow(m.norm(), 3)) continue;
    worst = std::max(worst, (newton_polar_factor(m) - svd_rotation(m).rotation).norm());
  }
  EXPECT_LE(worst, 1e-13);
}

TEST(LocalRotation, RecoversTheRotationOfAStretch) {
  std::mt19937 random(3);
  for (int k = 0; k < 500; ++k) {
    const Mat3 r = Eigen::AngleAxisd(k * 0.0126, random_matrix(random).col(0).normalized()).toRotationMatrix();
    const Mat3 half = random_matrix(random);
    const Mat3 stretch = half * half.transpose() + 0.1 * Mat3::Identity();
    EXPECT_LE((local_rotation(r * stretch).rotation - r).norm(), 1e-12);
  }
}

ClosedForm form_of(ClosedForm::Kind kind) {
  ClosedForm form;
  form.kind = kind;
  form.origin = {0.1, 0.2, -0.1};
  form.axis = {0.2, 1, 0.1};
  form.from = -0.2;
  form.to = 0.7;
  form.radians = 1.3;
  form.factor = 0.4;
  return form;
}

TEST(ClosedForms, JacobiansMatchFiniteDifferences) {
  using Kind = ClosedForm::Kind;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const Kind kind : {Kind::bend, Kind::twist, Kind::taper, Kind::stretch}) {
    const ClosedForm form = form_of(kind);
    for (int k = 0; k < 200; ++k) {
      const Vec3 point(any(random), any(random), any(random));
      const double step = 1e-5;
      const double along = form.axis.normalized().dot(point - form.origin);
      if (std::min(std::abs(along - form.from), std::abs(along - form.to)) < 2 * step) continue;  // kinks
      Mat3 want;
      for (int axis = 0; axis < 3; ++axis)
        want.col(axis) = (deform(form, point + step * Vec3::Unit(axis)).point -
                          deform(form, point - step * Vec3::Unit(axis)).point) /
                         (2 * step);
      EXPECT_LE((deform(form, point).jacobian - want).norm(), 1e-8);
    }
  }
}

TEST(ClosedForms, AlongAStraightLineMatchesTheClosedForm) {
  using Kind = ClosedForm::Kind;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.5, 1);
  for (const Kind kind : {Kind::bend, Kind::twist, Kind::stretch})
    for (const double radians : {1.3, -4.7, 12.0}) {
      ClosedForm form = form_of(kind);
      form.radians = radians;
      const Vec3 along = form.axis.normalized();
      ClosedForm from_start = form;
      from_start.origin = form.origin - 0.5 * along;  // arc length is measured from the curve's first point
      from_start.from += 0.5;
      from_start.to += 0.5;
      const auto pieces =
          along_curve(from_start, {from_start.origin, form.origin, form.origin + 0.4 * along, form.origin + 3 * along});
      for (int k = 0; k < 100; ++k) {
        const Vec3 point(0.3 * any(random), 2 * any(random), 0.3 * any(random));  // also far beyond both limits
        const Deformed want = deform(form, point), got = deform(pieces, point);
        EXPECT_LE((got.point - want.point).norm(), 1e-13);
        EXPECT_LE((got.jacobian - want.jacobian).norm(), 1e-12);
      }
    }
}

TEST(ClosedForms, AlongACurvePreservesLengthAndMovesTheRestRigidly) {
  std::vector<Vec3> curve;
  for (int k = 0; k <= 12; ++k) curve.emplace_back(std::sin(0.1 * k), 0.12 * k, 0.3 * std::cos(0.15 * k));
  double length = 0;
  for (std::size_t k = 0; k + 1 < curve.size(); ++k) length += (curve[k + 1] - curve[k]).norm();
  for (const ClosedForm::Kind kind : {ClosedForm::Kind::bend, ClosedForm::Kind::twist}) {
    ClosedForm form;
    form.kind = kind;
    form.radians = 1.1;
    form.to = length;
    const auto pieces = along_curve(form, curve);
    double after = 0;
    Vec3 last = deform(pieces, curve[0]).point;
    EXPECT_EQ(last, curve[0]) << "the first point must stay";
    constexpr int steps = 2000;
    for (std::size_t k = 0; k + 1 < curve.size(); ++k)
      for (int i = 1; i <= steps; ++i) {
        const Vec3 next = deform(pieces, curve[k] + (curve[k + 1] - curve[k]) * i / steps).point;
        after += (next - last).norm();
        last = next;
      }
    EXPECT_NEAR(after, length, 1e-6 * length);
    const Vec3 end = (curve[12] - curve[11]).normalized();
    for (const double far : {0.1, 3.0}) {
      const Deformed beyond = deform(pieces, curve[12] + far * end + Vec3(0.02, 0, 0.01));
      EXPECT_LE((beyond.jacobian.transpose() * beyond.jacobian - Mat3::Identity()).norm(), 1e-12);
      EXPECT_NEAR(Eigen::AngleAxisd(Mat3(beyond.jacobian)).angle(), 1.1, kind == ClosedForm::Kind::bend ? 1e-3 : 0.2);
    }
  }
  // Jacobians match finite differences.
  ClosedForm form;
  form.radians = 0.9;
  form.to = length;
  const auto pieces = along_curve(form, curve);
  const Vec3 point(0.5, 0.71, 0.33);
  Mat3 want;
  for (int axis = 0; axis < 3; ++axis)
    want.col(axis) = (deform(pieces, Vec3(point + 1e-5 * Vec3::Unit(axis))).point -
                      deform(pieces, Vec3(point - 1e-5 * Vec3::Unit(axis))).point) /
                     2e-5;
  EXPECT_LE((deform(pieces, point).jacobian - want).norm(), 1e-8);
  form.kind = ClosedForm::Kind::taper;
  EXPECT_THROW(along_curve(form, curve), FieldError);
  form.kind = ClosedForm::Kind::bend;
  EXPECT_THROW(along_curve(form, {curve[0]}), FieldError);
  EXPECT_THROW(along_curve(form, {curve[0], curve[0]}), FieldError);
}

TEST(ClosedForms, DeterminantsMatchBarr) {
  // Barr 1984: 1 for twists, r² for tapers, 1 − κ x for bends.
  const Vec3 point(0.3, 0.4, 0.2);
  ClosedForm form = form_of(ClosedForm::Kind::twist);
  EXPECT_NEAR(deform(form, point).jacobian.determinant(), 1, 1e-14);
  form.kind = ClosedForm::Kind::taper;
  const double share = (form.axis.normalized().dot(point - form.origin) - form.from) / (form.to - form.from);
  const double r = 1 + (form.factor - 1) * share;
  EXPECT_NEAR(deform(form, point).jacobian.determinant(), r * r, 1e-14);
  form = {};
  form.radians = 2;
  for (const double off : {-1e-12, 1e-12}) {
    // Just before and just beyond the fold, at x = 1 / κ = 0.5.
    const Deformed one = deform(form, Vec3(0.5 * (1 + off), 0.5, 0));
    EXPECT_NEAR(one.jacobian.determinant(), -off, 1e-15);
    EXPECT_TRUE(one.point.allFinite());
  }
  form.kind = ClosedForm::Kind::taper;
  form.factor = 0;
  EXPECT_EQ(deform(form, Vec3(0.5, 1, 0)).jacobian.determinant(), 0);
}

TEST(ClosedForms, FixedBelowTheLimitAndAccurateForSmallAngles) {
  ClosedForm form = form_of(ClosedForm::Kind::bend);
  const Vec3 below = form.origin + form.axis.normalized() * -0.3 + Vec3(0.01, 0, 0.02);
  EXPECT_EQ(deform(form, below).point, below);
  form = {};
  form.radians = 1e-9;
  const Vec3 point(0.2, 0.7, 0.1);
  // x moves by κ z² / 2, which a difference of cosines would lose.
  EXPECT_NEAR((deform(form, point).point - point).x() / (1e-9 * 0.49 / 2), 1, 1e-6);
  form.axis = {0, 0, 0};
  EXPECT_THROW(check(form), FieldError);
  form = {};
  form.direction = form.axis;
  EXPECT_THROW(check(form), FieldError);
}

}  // namespace
}  // namespace rebake::test
