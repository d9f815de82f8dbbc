#include "mesh_ops/light/learned/dprt_transfer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <numbers>
#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/light/learned/dprt_ranges.h"
#include "mesh_ops/light/learned/transfer_model.h"

namespace rebake {
namespace {

constexpr int image_side = 32, image_channels = 8;
constexpr std::size_t vertices = image_side * image_side;

DprtNetwork network_with_weights(float size) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  std::vector<float> weights(unet_weight_count(UnetForm::concatenated, image_channels));
  for (float& w : weights) w = size * normal(random);
  DprtNetwork::Ranges ranges;
  ranges.low.fill(-1);
  ranges.high.fill(2);
  return {Unet(UnetForm::concatenated, image_side, image_channels, weights), ranges};
}

std::vector<LightSite> sites_of_wave() {
  std::vector<LightSite> sites;
  for (int y = 0; y < image_side; ++y)
    for (int x = 0; x < image_side; ++x)
      sites.push_back({{0.03 * x, 0.03 * y, 0.1 * std::sin(0.3 * x)}, {0, 0, 1}, {1, 0, 0}, {0, 0}});
  return sites;
}

TransferModel model_of(DprtTransfer published) {
  TransferModel model;
  model.sites = 2 * vertices;
  for (std::uint32_t k = 0; k < vertices; ++k) model.keys.push_back(2 * k);
  model.facing.assign(vertices, 1);
  model.learned.probes = {0, 1};
  model.learned.space = PoseSpace({Vec3(0, 0, 0), Vec3(1, 0, 0)}, {{{0, 0, 0}, {1, 0.5, 0}}, {{0, 0.1, 0}, {1, 0, 0}}});
  model.learned.linear.resize(0, model.learned.space.dimensions() + 1);
  model.published.emplace(std::move(published));
  model.net_error = 0.25;
  return model;
}

TEST(DprtTransfer, PredictsAtVerticesWhatTheNetworkPredictsAtTexels) {
  const DprtNetwork network = network_with_weights(0.05F);
  const DprtTransfer transfer(grid_chart(image_side), vertices, network, 1);
  const Eigen::VectorXf found = transfer.predict(sites_of_wave());
  const std::vector<float> planes = network.predict(sites_of_wave());
  for (std::size_t v = 0; v < vertices; ++v)
    for (std::size_t c = 0; c < sh::count; ++c)
      ASSERT_NEAR(found[static_cast<Eigen::Index>(v * sh::count + c)], planes[c * vertices + v], 1e-4F);
}

TEST(DprtTransfer, ModelsReturnCoefficientsInRotatedFrames) {
  const TransferModel model = model_of({grid_chart(image_side), vertices, network_with_weights(0.05F), 1});
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 3, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const std::vector<Mat3> same(vertices, Mat3::Identity()), turned(vertices, turn);
  const Eigen::VectorXf plain = model.predict({}, sites_of_wave(), same),
                        local = model.predict({}, sites_of_wave(), turned);
  EXPECT_LT((plain - model.published->predict(sites_of_wave())).norm(), 1e-5 * plain.norm());
  for (Eigen::Index v = 0; v < 50; ++v) {
    const sh::Coefficients back =
        sh::Rotation(turn) * sh::Coefficients(local.segment<sh::count>(v * sh::count).cast<double>());
    ASSERT_LT((back - plain.segment<sh::count>(v * sh::count).cast<double>()).norm(), 1e-4);
  }
}

TEST(DprtTransfer, FilesHoldOnlyWhatPredictsAndRefuseDamage) {
  const TransferModel model = model_of({grid_chart(image_side), vertices, network_with_weights(0.05F), 1});
  const std::string bytes = bytes_of(model);
  const std::size_t weights = unet_weight_count(UnetForm::concatenated, image_channels) * sizeof(float);
  // Besides: indices and sides of the keys, the chart of 1024 vertices and 1922 triangles.
  EXPECT_LT(bytes.size(), weights + vertices * (4 + 4 + 4 + 16) + 2 * vertices * sizeof(Face) + 4000);
  const TransferModel read = transfer_model_of(bytes);
  EXPECT_EQ(bytes_of(read), bytes);
  EXPECT_EQ(read.error(), 0.25);
  EXPECT_EQ(read.published->predict(sites_of_wave()), model.published->predict(sites_of_wave()));
  for (std::size_t size = 0; size < bytes.size(); size += bytes.size() / 9)
    EXPECT_THROW(transfer_model_of(std::string_view(bytes).substr(0, size)), Error);
  DiskChart wrong = grid_chart(image_side);
  wrong.uvs.front().x() = 2;
  EXPECT_THROW(DprtTransfer(wrong, vertices, network_with_weights(0), 1), std::invalid_argument);
}

// Version 2 kept the linear model beside a network; it is read, and written as version 3.
TEST(DprtTransfer, ModelsOfVersionTwoAreReadAndWrittenAgain) {
  TransferModel model = model_of({grid_chart(image_side), vertices, network_with_weights(0), 1});
  model.published.reset();
  const auto weights = unet_weight_count(UnetForm::added, 8);
  model.net.emplace(UnetTransfer::State{grid_chart(image_side), 64, 8, std::vector<float>(weights, 0.01F),
                                        Box(Vec3(0, 0, 0), Vec3(1, 1, 1)),
                                        Eigen::VectorXf::Constant(vertices * sh::count, 0.5F), 1, 2});
  // A file of version 2, made of one of version 3.
  const Eigen::Index size = vertices * sh::count, components = 2, dimensions = model.learned.space.dimensions();
  model.learned.mean = Eigen::VectorXf::Zero(size);
  model.learned.components = Eigen::MatrixXf::Zero(size, components);
  model.learned.linear = Eigen::MatrixXd::Zero(components, dimensions + 1);
  std::string old = bytes_of(model);
  const std::size_t at = old.find("rebake transfer model 3");
  ASSERT_NE(at, std::string::npos);
  old.replace(at, 23, "rebake transfer model 2");
  const std::uint64_t hash = content_hash(std::string_view(old).substr(0, old.size() - sizeof hash));
  std::memcpy(old.data() + old.size() - sizeof hash, &hash, sizeof hash);
  const TransferModel read = transfer_model_of(old);
  ASSERT_TRUE(read.net);
  EXPECT_EQ(read.learned.components.size(), 0);
  const TransferModel again = transfer_model_of(bytes_of(read));
  EXPECT_EQ(again.net->state().weights, model.net->state().weights);
}

TEST(DprtTransfer, RangesCoverTheTrainingPosesWithAMargin) {
  DprtRanges seen;
  std::vector<float> planes(2 * sh::count, 0);
  planes[0] = -1;
  planes[1] = 3;
  seen.add({Vec3(0, 0, 0), Vec3(4, 2, 1)}, planes);
  const DprtNetwork::Ranges ranges = seen.found();
  EXPECT_FLOAT_EQ(ranges.low[0], -1.2F);
  EXPECT_FLOAT_EQ(ranges.high[0], 3.2F);
  EXPECT_EQ(ranges.center, Vec3(2, 1, 0.5));
  EXPECT_EQ(ranges.reach, 2);
  const std::vector<float> targets = dprt_targets(planes, ranges);
  EXPECT_FLOAT_EQ(targets[0], 0.2F / 4.4F);
  EXPECT_FLOAT_EQ(targets[1], 4.2F / 4.4F);
  EXPECT_EQ(targets[2], 0.5F) << "a constant coefficient";
}

}  // namespace
}  // namespace rebake
