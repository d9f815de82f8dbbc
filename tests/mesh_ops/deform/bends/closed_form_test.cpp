// Closed forms of deformation: Jacobians, determinants and limits.
#include "mesh_ops/deform/bends/closed_form.h"

#include <gtest/gtest.h>

#include <random>

#include "mesh_ops/base/error.h"

namespace rebake::test {
namespace {

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
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const ClosedForm::Kind kind :
       {ClosedForm::Kind::bend, ClosedForm::Kind::twist, ClosedForm::Kind::taper, ClosedForm::Kind::stretch}) {
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
