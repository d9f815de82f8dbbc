#include "mesh_ops/simulation/cloth.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

namespace rebake {
namespace {

// A chain of `links` rigid links along x, with equal masses; its ends are held.
Cloth chain(int links, double link, bool held_at_the_end) {
  std::vector<Vec3> positions;
  std::vector<double> masses;
  std::vector<Cloth::Spring> springs;
  for (int k = 0; k <= links; ++k) {
    positions.emplace_back(k * link, 0, 0);
    masses.push_back(k == 0 || (held_at_the_end && k == links) ? 0 : 0.1);
    if (k > 0) springs.push_back({{static_cast<std::uint32_t>(k - 1), static_cast<std::uint32_t>(k)}, link, 0});
  }
  return {positions, masses, springs};
}

// Places of the points of a hanging chain of rigid links: the horizontal force is the same in all links, the vertical
// force changes by the weight of each point. In long double.
std::vector<std::array<long double, 2>> hanging(int links, long double link, long double span) {
  const auto places = [&](long double force) {  // in weights of a point
    std::vector<std::array<long double, 2>> result{{0, 0}};
    for (int k = 0; k < links; ++k) {
      const long double down = (links - 1) / 2.0L - k, length = std::hypot(force, down);
      result.push_back({result.back()[0] + link * force / length, result.back()[1] - link * down / length});
    }
    return result;
  };
  long double low = 1e-6L, high = 1e6L;
  for (int k = 0; k < 300; ++k) {
    const long double middle = std::sqrt(low * high);
    (places(middle).back()[0] < span ? low : high) = middle;
  }
  return places(low);
}

TEST(Cloth, AHangingChainTakesTheShapeOfTheBalanceOfForces) {
  constexpr int links = 20;
  constexpr double link = 0.05, span = 0.7;
  Cloth one = chain(links, link, true);
  for (Vec3& p : one.positions) p.x() *= span / (links * link);
  one.drag = 4;
  for (int k = 0; k < 600; ++k) one.advance(1 / 60.0, 80);
  const auto truth = hanging(links, link, span);
  double off = 0;
  for (std::size_t k = 0; k < truth.size(); ++k)
    off = std::max(off, std::hypot(one.positions[k].x() - static_cast<double>(truth[k][0]),
                                   one.positions[k].y() - static_cast<double>(truth[k][1])));
  EXPECT_LT(off, 2e-3 * links * link);
  EXPECT_LT(one.largest_stretch(), 1e-3);
}

// Angular frequency of the slowest swing of a chain of point masses: the smallest root of det(K − ω² M).
double frequency(int links, double link, double gravity) {
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(links, links);
  for (int k = 0; k < links; ++k) {
    const double tension = gravity * (links - k) / link;  // per mass, of the link above point k
    stiffness(k, k) += tension;
    if (k > 0) {
      stiffness(k - 1, k - 1) += tension;
      stiffness(k, k - 1) -= tension;
      stiffness(k - 1, k) -= tension;
    }
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues()[0]);
}

TEST(Cloth, ASwingingSheetHasThePeriodOfItsColumns) {
  // Columns of a sheet that moves as a whole across its plane swing like chains.
  SheetOptions options{.side = 9, .stretching = 0, .shearing = 0, .bending = 1e9};
  Cloth sheet = hanging_sheet(options);
  const double link = options.width / (options.side - 1), omega = frequency(options.side - 1, link, 9.81);
  for (int column = 0; column < options.side; ++column) sheet.masses[static_cast<std::size_t>(column)] = 0;
  // Deflected along the slowest swing, by little.
  for (Vec3& p : sheet.positions) {
    const double down = options.width / 2 - p.y();
    p.z() = 0.01 * down * (0.6 + 0.4 * down);
  }
  const auto lowest = [&] { return sheet.positions.back().z(); };
  std::vector<double> crossings;
  double last = lowest();
  constexpr double frame = 1 / 240.0;
  while (crossings.size() < 5 && sheet.time() < 20) {
    sheet.advance(frame, 20);
    const double now = lowest();
    if ((last < 0) != (now < 0)) crossings.push_back(sheet.time() - frame * now / (now - last));
    last = now;
  }
  ASSERT_EQ(crossings.size(), 5U);
  const double period = (crossings[4] - crossings[0]) / 2;
  EXPECT_NEAR(period * omega / (2 * std::numbers::pi), 1, 0.02);
  EXPECT_LT(sheet.largest_stretch(), 1e-3);
}

Cloth tumbling() {
  Cloth sheet = hanging_sheet({.side = 7});
  sheet.gravity = {0, 0, 0};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> speed(-1, 1);
  for (Vec3& v : sheet.velocities)
    for (double& c : v) c = speed(random);
  return sheet;
}

TEST(Cloth, MomentumStaysAndAngularMomentumDriftsWithTheStep) {
  double drift[2];
  for (int k = 0; k < 2; ++k) {
    Cloth sheet = tumbling();
    const Vec3 momentum = sheet.momentum(), angular = sheet.angular_momentum();
    double scale = 0, angular_scale = 0;
    for (std::size_t p = 0; p < sheet.masses.size(); ++p) {
      scale += sheet.masses[p] * sheet.velocities[p].norm();
      angular_scale += sheet.masses[p] * sheet.positions[p].norm() * sheet.velocities[p].norm();
    }
    sheet.advance(0.2, k == 0 ? 200 : 800);
    EXPECT_LT((sheet.momentum() - momentum).norm(), 1e-12 * scale);
    drift[k] = (sheet.angular_momentum() - angular).norm() / angular_scale;
  }
  EXPECT_LT(drift[0], 0.05);
  EXPECT_LT(drift[1], 0.5 * drift[0]) << "a quarter of the step";
}

TEST(Cloth, EnergyOnlyFallsAndLessWithSmallSteps) {
  double lost[2];
  for (int k = 0; k < 2; ++k) {
    Cloth one = chain(10, 0.1, false);
    const double start = one.energy(), scale = 10 * 0.1 * 9.81 * 1.0;  // weight times length
    double highest = start;
    for (int frame = 0; frame < 30; ++frame) {
      one.advance(1 / 60.0, k == 0 ? 20 : 80);
      highest = std::max(highest, one.energy());
    }
    EXPECT_LT(highest - start, 1e-3 * scale);
    lost[k] = (start - one.energy()) / scale;
  }
  EXPECT_GT(lost[1], 0);
  EXPECT_LT(lost[1], 0.5 * lost[0]);
  EXPECT_LT(lost[1], 0.05);
}

TEST(Cloth, IsStableWhenAMillionTimesAsStiffAndAtAHundredTimesTheStep) {
  for (const double stiffer : {1.0, 1e6})
    for (const double longer : {1.0, 100.0}) {
      SheetOptions options{.side = 15};
      options.stretching /= stiffer;
      options.shearing /= stiffer;
      options.bending /= stiffer;
      Cloth sheet = hanging_sheet(options);
      sheet.masses[0] = sheet.masses[14] = 0;
      // Coarse steps let it fall far, but it does not gain from step to step.
      double farthest[3] = {0, 0, 0};
      for (int k = 0; k < 300; ++k) {
        sheet.advance(longer / 60, 1);
        for (const Vec3& p : sheet.positions) farthest[k / 100] = std::max(farthest[k / 100], p.norm());
        ASSERT_TRUE(std::isfinite(farthest[k / 100])) << stiffer << " " << longer;
      }
      EXPECT_LT(farthest[2], 1.1 * farthest[0]) << stiffer << " " << longer;
      // It recovers.
      sheet.drag = 20;  // per second, against the speed at which it is pulled back
      for (int k = 0; k < 240; ++k) sheet.advance(1 / 60.0, 60);
      double longest = 0;
      for (const Cloth::Spring& spring : sheet.springs)
        if (spring.compliance == options.stretching)
          longest = std::max(
              longest, (sheet.positions[spring.points[0]] - sheet.positions[spring.points[1]]).norm() / spring.rest);
      double fastest = 0, reach = 0;
      for (std::size_t p = 0; p < sheet.positions.size(); ++p) {
        fastest = std::max(fastest, sheet.velocities[p].norm());
        reach = std::max(reach, sheet.positions[p].norm());
      }
      EXPECT_LT(fastest, 0.1) << stiffer << " " << longer;
      EXPECT_LT(reach, 3) << stiffer << " " << longer;
      // Steps of two seconds tangle it: springs that are turned inside out stay so.
      EXPECT_LT(longest, longer == 1 ? 1.02 : 10) << stiffer << " " << longer;
    }
}

TEST(Cloth, RefusesWhatDoesNotFit) {
  EXPECT_THROW(Cloth({{0, 0, 0}}, {1}, {{{0, 1}, 1, 0}}), std::invalid_argument);
  EXPECT_THROW(Cloth({{0, 0, 0}}, {}, {}), std::invalid_argument);
  Cloth one = chain(2, 1, true);
  const std::vector<Vec3> too_few{Vec3(0, 0, 0)};
  EXPECT_THROW(one.advance(1, 1, &too_few), std::invalid_argument);
  EXPECT_THROW(one.advance(1, 0), std::invalid_argument);
}

}  // namespace
}  // namespace rebake
