#include "mesh_ops/reconstruction/exposures.h"

#include <gtest/gtest.h>

#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/scene/scene_light.h"

using namespace rebake;

TEST(Exposures, GainsAreFoundInLinearLightUpToAFactor) {
  const std::vector<Vec3> wanted{Vec3(0.5, 0.5, 0.5), Vec3(2, 2, 2), Vec3(1, 1, 1)};
  Exposures exposures(3);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 0.4);
  for (int k = 0; k < 300; ++k) {
    const Vec3 light(unit(random), unit(random), unit(random));
    const auto photograph = static_cast<std::size_t>(k % 3);
    const auto display = [](const Vec3& linear) {
      return Vec3(linear.unaryExpr([](double v) { return to_display(v); }));
    };
    exposures.add(photograph, display(light.cwiseProduct(wanted[photograph])), display(light));
    exposures.add(photograph, Vec3::Ones(), display(light));  // clipped
  }
  const std::vector<Vec3> gains = exposures.gains();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((gains[k] - wanted[k]).norm(), 1e-9);
  EXPECT_GT(exposures.spread(), 0.4);
  EXPECT_TRUE(exposures.differ());
  EXPECT_EQ(Exposures(3).spread(), 0);
  EXPECT_FALSE(Exposures(3).differ());
}

TEST(Exposures, ErrorsOfAScenePartlyLearnedAreNotTakenForExposures) {
  // The scene is 20 % too bright and noisy, in each photograph differently by chance.
  Exposures exposures(20);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0.05, 0.5), wrong(0.6, 1.8);
  for (std::size_t k = 0; k < 20; ++k)
    for (int n = 0; n < 30; ++n) {
      const Vec3 color(unit(random), unit(random), unit(random));
      exposures.add(k, color, wrong(random) * color);
    }
  EXPECT_GT(exposures.spread(), 0.04);
  EXPECT_FALSE(exposures.differ());
}

TEST(Exposures, AreRestored) {
  Exposures exposures(2), other(2), more(3);
  exposures.add(1, Vec3(0.2, 0.3, 0.4), Vec3(0.4, 0.3, 0.2));
  std::string bytes;
  exposures.save(bytes);
  std::string_view rest = bytes;
  other.load(rest);
  EXPECT_EQ(other.gains(), exposures.gains());
  rest = bytes;
  EXPECT_THROW(more.load(rest), Error);
}
