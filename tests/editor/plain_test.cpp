// Any scene as one plain folder, by the pictures that it then shows: the bars are those that the format's users were
// promised.
#include "editor/commands/plain_scene.h"

#include <gtest/gtest.h>

#include "render/compare.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

Renderer& renderer() {
  static Renderer one;
  return one;
}

PlainReport plain_report(const Scene& scene, const FuseOptions& options) {
  PlainReport report;
  const Scene plain = plain_scene(scene, options, report, {});
  measure_pictures(renderer(), scene, plain, report, {});
  return report;
}

// Two objects side by side, the second turned.
Scene two(const std::shared_ptr<const BakedObject>& a, const std::shared_ptr<const BakedObject>& b) {
  Scene scene;
  Node node;
  node.name = "a";
  node.object = a;
  node.to_parent = Eigen::Translation3d(-1.1, 0, 0);
  scene = with_added(scene, node, NodeId::none, 99);
  node.name = "b";
  node.object = b;
  node.to_parent = Eigen::Translation3d(1.1, 0.2, 0.3) * Eigen::AngleAxisd(1.1, Vec3(1, 2, 0.5).normalized());
  return with_added(scene, node, NodeId::none, 99);
}

TEST(Plain, TwoRealDecodersReachFortyDecibels) {
  const auto ball = morpheus_object("lego_ball", 24), tractor = morpheus_object("lego_tractor", 24);
  if (!ball) GTEST_SKIP() << "shared data is absent";
  const PlainReport report = plain_report(two(ball, tractor), {});
  EXPECT_GE(report.whole.psnr_db, 40);
}

TEST(Plain, TwoRealDecodersInOneOfTheirWidthReachThirtySeven) {
  const auto ball = morpheus_object("lego_ball", 24), tractor = morpheus_object("lego_tractor", 24);
  if (!ball) GTEST_SKIP() << "shared data is absent";
  FuseOptions options;
  options.width = 16;
  const PlainReport report = plain_report(two(ball, tractor), options);
  EXPECT_GE(report.whole.psnr_db, 37);
  EXPECT_LE(report.hidden0, 16);
}

}  // namespace
}  // namespace rebake::test
