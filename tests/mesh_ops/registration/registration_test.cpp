// Captures brought together: similarities from pairs, and their refinement by surfaces.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "editor/edits/edit.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/registration/trimmed_icp.h"
#include "tests/support/overlapping_captures.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

Similarity some_motion(double scale, const Vec3& shift) {
  return {Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix(), scale, {0.3, -0.2, 0.1}, shift};
}

std::string problem_of(const std::vector<Vec3>& from, const std::vector<Vec3>& onto) {
  try {
    fit_pairs(from, onto, true);
  } catch (const FieldError& error) {
    return error.what();
  }
  return "none";
}

TEST(FitPairs, RecoversSimilaritiesAnywhere) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (const double offset : {0.0, 1.0, 1e6, 1e9})
    for (const double size : {1e-6, 1.0, 1e6})
      for (int round = 0; round < 20; ++round) {
        std::vector<Vec3> from, onto;
        const Similarity truth = some_motion(2.5, {offset, -offset, 7});
        for (int k = 0; k < 3 + round % 4; ++k) {
          from.push_back(Vec3(offset, 0, offset) + size * Vec3(normal(random), normal(random), normal(random)));
          onto.push_back(truth(from.back()));
        }
        const PairFit fit = fit_pairs(from, onto, true);
        // What the coordinates themselves resolve, amplified by narrow triangles.
        const double resolution = 4e-16 * (3 * offset + 10 + 3 * size) / fit.spread;
        EXPECT_LE(fit.rms, 10 * resolution + 1e-14 * size) << offset << ' ' << size;
        EXPECT_LE((fit.motion.rotation - truth.rotation).norm(), 100 * resolution / size + 1e-13);
        EXPECT_NEAR(fit.motion.scale, 2.5, 100 * resolution / size + 1e-12);
        EXPECT_NEAR(fit.motion.rotation.determinant(), 1, 1e-12);
      }
}

TEST(FitPairs, RigidMotionsKeepTheSize) {
  const std::vector<Vec3> from{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, onto{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  EXPECT_NEAR(fit_pairs(from, onto, false).motion.scale, 1, 1e-14);
  EXPECT_GT(fit_pairs(from, onto, false).rms, 0.3);
}

TEST(FitPairs, RefusesWhatDecidesNoMotion) {
  const std::vector<Vec3> good{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_NE(problem_of({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}}).find("at least three"), std::string::npos);
  EXPECT_NE(problem_of(good, {{0, 0, 0}, {1, 0, 0}}).find("as many"), std::string::npos);
  EXPECT_NE(problem_of({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, good).find("coincide"), std::string::npos);
  EXPECT_NE(problem_of({{0, 0, 0}, {1, 1, 1}, {3, 3, 3 + 1e-9}}, good).find("on a line"), std::string::npos);
  EXPECT_NE(problem_of(good, {{1e6, 0, 0}, {1e6 + 1, 0, 0}, {1e6 + 5, 0, 0}}).find("on a line"), std::string::npos);
  // Nearly on a line, but decided: accepted, and said.
  EXPECT_LT(fit_pairs({{0, 0, 0}, {1, 0, 0}, {2, 1e-3, 0}}, {{0, 0, 0}, {1, 0, 0}, {2, 1e-3, 0}}, true).spread, 0.05);
  // Four solid points of which two are swapped between left and right.
  const std::vector<Vec3> solid{{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      swapped{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_NE(problem_of(solid, swapped).find("mirrored"), std::string::npos);
}

TEST(FitPairs, NamesSwappedPairs) {
  std::vector<Vec3> from{{0, 0, 0}, {1, 0, 0.1}, {0.2, 1, 0}, {0.3, 0.1, 1}, {0.9, 0.8, 0.4}}, onto;
  for (const Vec3& p : from) onto.push_back(some_motion(2, {5, 0, 0})(p));
  EXPECT_EQ(problem_of(from, onto), "none");
  std::swap(onto[1], onto[3]);
  EXPECT_NE(problem_of(from, onto).find("pairs 2 and 4 are swapped"), std::string::npos) << problem_of(from, onto);
}

TEST(Register, RefusesSurfacesThatDoNotOverlap) {
  const OverlappingCaptures captures = overlapping_captures(0.5, 0, some_motion(1, {40, 0, 0}));
  const nlohmann::json edit{{"op", "register"}, {"node", "moved"}, {"to", "fixed"}};
  EXPECT_THROW(apply(captures.scene, read_edit(edit, captures.scene)), Error);
}

TEST(Register, FindsThePlaceByAStripOfOverlap) {
  for (const double away : {0.0, 1e6}) {
    const OverlappingCaptures captures = overlapping_captures(0.2, 0.05, some_motion(1.7, {away + 3, -2, away}));
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    nlohmann::json edit{{"op", "register"}, {"node", "moved"}, {"to", "fixed"}};
    // Clicks that are off by half a percent of the diagonal.
    for (std::size_t k = 0; k < captures.points.size(); ++k) {
      const Vec3 off = 0.005 * captures.diagonal / 1.7 * Vec3(normal(random), normal(random), normal(random));
      const Vec3 from = captures.points[k] + off, onto = captures.onto[k];
      edit["points"].push_back({from.x(), from.y(), from.z()});
      edit["onto"].push_back({onto.x(), onto.y(), onto.z()});
    }
    const Outcome outcome = apply(captures.scene, read_edit(edit, captures.scene));
    const Affine motion = outcome.scene.roots[1]->to_parent;
    EXPECT_LE(place_error(captures, motion), 0.002) << outcome.report.lines.back();
    EXPECT_LE(rotation_error(captures, motion), 0.2) << outcome.report.lines.back();
    edit["refine"] = false;
    const Affine unrefined = apply(captures.scene, read_edit(edit, captures.scene)).scene.roots[1]->to_parent;
    EXPECT_GT(place_error(captures, unrefined), 0.004);
  }
}

TEST(Register, PlanesAreSaidToSlide) {
  SurfaceSamples plane;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) {
      plane.points.emplace_back(i, j, 0);
      plane.normals.emplace_back(0, 0, 1);
    }
  SurfaceSamples lifted = plane;
  for (Vec3& p : lifted.points) p.z() += 0.3;
  const IcpResult result = trimmed_icp(lifted, plane, {});
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.motion(Vec3(3, 4, 0.3)).z(), 0, 1e-9);
  EXPECT_EQ(result.free_directions, 4);  // two translations, a rotation and the scale
}

TEST_F(Script, LengthsScaleTheScene) {
  run(import + R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 1]}}
{"op": "ground", "height": -2}
{"op": "set_length", "points": [[0, 0, 0], [0, 3, 4]], "length": 0.5})");
  EXPECT_DOUBLE_EQ(session.scene().views.at("v").eye.z(), 0.5);
  EXPECT_DOUBLE_EQ(session.scene().ground.height, -0.2);
  EXPECT_NEAR(world_bounds(session.scene()).max().y(), 0.1, 1e-3);
  expect_error(R"({"op": "set_length", "points": [[1, 2, 3], [1, 2, 3]], "length": 2})", "coincide");
  expect_error(R"({"op": "set_length", "points": [[1, 2, 3], [1, 2, 4]], "length": 0})", "above 0");
  expect_error(R"({"op": "register", "node": "ball"})", "no visible object that could stay");
}

}  // namespace
}  // namespace rebake::test
