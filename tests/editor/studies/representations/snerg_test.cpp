#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "editor/studies/representations/marched_volume.h"
#include "editor/studies/representations/snerg_files.h"
#include "editor/studies/representations/snerg_pack.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "render/compare.h"
#include "tests/support/made_scenes.h"
#include "tests/support/marched_picture.h"

namespace rebake {
namespace {

namespace fs = std::filesystem;

SnergDecoder random_snerg_decoder(std::mt19937& random) {
  const auto filled = [&](Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd m(rows, columns);
    for (Eigen::Index k = 0; k < m.size(); ++k) m.data()[k] = random() / 2147483647.5 - 1;
    return m;
  };
  SnergDecoder decoder{filled(SnergDecoder::inputs, 16), filled(16, 16), filled(16, 3), {}, {}, {}};
  decoder.bias0 = filled(16, 1), decoder.bias1 = filled(16, 1), decoder.bias2 = filled(3, 1);
  return decoder;
}

// A ball with smooth colours and opacities, off the origin.
SnergScene ball_of_voxels(int resolution) {
  std::mt19937 random(7);
  std::vector<Vec3> points;
  for (int k = 0; k < 60 * resolution * resolution; ++k) {
    const Vec3 p(random() / 2147483647.5 - 1, random() / 2147483647.5 - 1, random() / 2147483647.5 - 1);
    if (p.norm() > 0.1 && p.norm() < 1) points.push_back(Vec3(0.3, -0.2, 0.1) + p.normalized());
  }
  const VoxelCells cells = cells_around(points, resolution, 2, false);
  std::vector<SnergValues> values(cells.count());
  for (std::size_t cell = 0; cell < cells.count(); ++cell) {
    const auto [x, y, z] = cells.at[cell];
    const float alpha = cells.surface[cell] != 0 ? 0.7F : 0.1F;
    for (std::size_t c = 0; c < snerg_channels; ++c)
      values[cell][c] = c == snerg_alpha
                            ? alpha
                            : alpha * (0.5F + 0.5F * std::sin(0.3F * static_cast<float>(x + y) + static_cast<float>(c) +
                                                              0.2F * static_cast<float>(z)));
  }
  return pack_snerg(
      cells, [&](std::size_t cell) { return values[cell].data(); }, random_snerg_decoder(random));
}

View view_of_ball() {
  View view;
  view.camera.eye = {2, 1.2, 2.6};
  view.camera.target = {0.3, -0.2, 0.1};
  view.width = 72, view.height = 56;
  return view;
}

// Independent march in double precision: voxels are looked up in their own blocks, without the padding.
class SnergReference {
 public:
  explicit SnergReference(const SnergScene& scene) : scene_(scene) {}

  Color march(const Vec3& eye, const Vec3& direction) const {
    const Vec3 origin = (eye - scene_.min) / scene_.voxel_size;
    const auto [enter, leave] = range(origin, direction, Vec3::Zero(), size());
    if (enter > leave) return Color::Ones();
    Eigen::Matrix<double, 7, 1> sum = Eigen::Matrix<double, 7, 1>::Zero();
    double light = 1;
    for (double t = std::max(0.0, enter) + 0.5; t < leave && light > 1.0 / 255;) {
      const Vec3 at = origin + t * direction, block = (at / scene_.block_size).array().floor();
      const Vec3 low = block * scene_.block_size;
      if (!occupied(block)) {
        t = 0.5 + std::max(t, range(origin, direction, low, low.array() + scene_.block_size).second);
        continue;
      }
      const auto value = interpolated(at);
      if (value[7] > 0.5 / 255) {
        sum += light * value.head<7>();
        light *= 1 - value[7];
      }
      t += 1;
    }
    Color color = sum.head<3>().array() + light;
    if (light > 254.0 / 255) return color;
    const auto encoded = encoded_direction(direction);
    Eigen::VectorXd input(SnergDecoder::inputs);
    for (std::size_t k = 0; k < encoded.size(); ++k) input[static_cast<Eigen::Index>(k)] = encoded[k];
    input.segment<3>(SnergDecoder::encoding) = color;
    input.tail<4>() = sum.tail<4>();
    const SnergDecoder& d = scene_.decoder;
    const Eigen::VectorXd first = (d.weights0.transpose() * input + d.bias0).cwiseMax(0),
                          second = (d.weights1.transpose() * first + d.bias1).cwiseMax(0),
                          out = d.weights2.transpose() * second + d.bias2;
    for (Eigen::Index c = 0; c < 3; ++c) color[c] += 1 / (1 + std::exp(-out[c]));
    return color;
  }

 private:
  Vec3 size() const { return {double(scene_.grid[0]), double(scene_.grid[1]), double(scene_.grid[2])}; }
  static std::pair<double, double> range(const Vec3& origin, const Vec3& direction, const Vec3& low, const Vec3& high) {
    const Vec3 a = (low - origin).cwiseQuotient(direction), b = (high - origin).cwiseQuotient(direction);
    return {a.cwiseMin(b).maxCoeff(), a.cwiseMax(b).minCoeff()};
  }
  const std::array<std::uint8_t, 3>* place(const Vec3& block) const {
    const auto blocks = scene_.blocks();
    std::size_t index = 0;
    for (int a = 2; a >= 0; --a) {
      if (block[a] < 0 || block[a] >= blocks[static_cast<std::size_t>(a)]) return nullptr;
      index =
          index * static_cast<std::size_t>(blocks[static_cast<std::size_t>(a)]) + static_cast<std::size_t>(block[a]);
    }
    return scene_.block_places[index][0] == 255 ? nullptr : &scene_.block_places[index];
  }
  bool occupied(const Vec3& block) const { return place(block) != nullptr; }
  Eigen::Matrix<double, 8, 1> voxel(const Vec3& at) const {
    Eigen::Matrix<double, 8, 1> value = Eigen::Matrix<double, 8, 1>::Zero();
    const Vec3 block = (at / scene_.block_size).array().floor();
    const auto* where = place(block);
    if (where == nullptr) return value;
    const auto atlas = scene_.atlas;
    std::size_t index = 0;
    for (int a = 2; a >= 0; --a) {
      const auto axis = static_cast<std::size_t>(a);
      const double local = at[a] - block[a] * scene_.block_size + 1 + (*where)[axis] * (scene_.block_size + 2);
      index = index * static_cast<std::size_t>(atlas[axis]) + static_cast<std::size_t>(local);
    }
    for (std::size_t c = 0; c < 3; ++c) value[static_cast<Eigen::Index>(c)] = scene_.colors[4 * index + c] / 255.0;
    for (std::size_t c = 0; c < 4; ++c)
      value[static_cast<Eigen::Index>(3 + c)] = scene_.features[4 * index + c] / 255.0;
    value[7] = scene_.colors[4 * index + 3] / 255.0;
    return value;
  }
  Eigen::Matrix<double, 8, 1> interpolated(const Vec3& at) const {
    const Vec3 shifted = at.array() - 0.5, floor = shifted.array().floor(), f = shifted - floor;
    Eigen::Matrix<double, 8, 1> sum = Eigen::Matrix<double, 8, 1>::Zero();
    for (int k = 0; k < 8; ++k) {
      const Vec3 step(k & 1, k >> 1 & 1, k >> 2);
      sum += (step.x() > 0 ? f.x() : 1 - f.x()) * (step.y() > 0 ? f.y() : 1 - f.y()) *
             (step.z() > 0 ? f.z() : 1 - f.z()) * voxel(floor + step);
    }
    return sum;
  }
  const SnergScene& scene_;
};

TEST(SnergDrawing, AgreesWithAMarchInDoublePrecision) {
  const SnergScene scene = ball_of_voxels(40);
  ASSERT_TRUE(std::any_of(scene.block_places.begin(), scene.block_places.end(),
                          [](const auto& place) { return place[0] == 255; }));
  const auto context = gl::make_headless_context();
  MarchedVolume drawing(scene, *context);
  const View view = view_of_ball();
  const SnergReference reference(scene);
  const Image expected = test::marched_picture(
      view, [&](const Vec3& eye, const Vec3& direction) { return reference.march(eye, direction); });
  const Difference difference = compare(drawing.picture(view), expected, 2);
  EXPECT_GT(difference.psnr_db, 50) << "largest " << difference.largest << " at " << difference.x << ", "
                                    << difference.y;
  // The test sees a wrong feature or a wrong rotation.
  SnergScene wrong = scene;
  for (std::size_t k = 3; k < wrong.features.size(); k += 4) wrong.features[k] = 0;
  EXPECT_LT(compare(MarchedVolume(wrong, *context).picture(view), expected, 2).psnr_db, 40);
}

class SnergFiles : public testing::Test {
 protected:
  void SetUp() override { write_snerg(scene_, folder_, {}); }
  // The error of reading after `change`, which must name `file`.
  void expect_refusal(const std::string& file, const std::string& why) {
    try {
      read_snerg(folder_);
      ADD_FAILURE() << "was read, expected: " << why;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  }
  void replace_in_parameters(const std::string& from, const std::string& to) {
    std::string text = read_file(folder_ / "scene_params.json");
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, from.size(), to);
    write_file_atomically(folder_ / "scene_params.json", text, {});
  }
  test::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
  SnergScene scene_ = ball_of_voxels(24);
};

TEST_F(SnergFiles, KeepEverything) {
  const SnergScene read = read_snerg(folder_);
  EXPECT_EQ(read.voxel_size, scene_.voxel_size);
  EXPECT_EQ(read.block_size, scene_.block_size);
  EXPECT_EQ(read.grid, scene_.grid);
  EXPECT_EQ(read.min, scene_.min);
  EXPECT_EQ(read.atlas_blocks, scene_.atlas_blocks);
  EXPECT_EQ(read.atlas, scene_.atlas);
  EXPECT_EQ(read.atlas[2] % 4, 0) << "the published viewer uploads whole pictures of four planes";
  EXPECT_EQ(read.block_places, scene_.block_places);
  EXPECT_EQ(read.colors, scene_.colors);
  EXPECT_EQ(read.features, scene_.features);
  EXPECT_EQ(read.decoder.weights0, scene_.decoder.weights0);
  EXPECT_EQ(read.decoder.weights1, scene_.decoder.weights1);
  EXPECT_EQ(read.decoder.weights2, scene_.decoder.weights2);
  EXPECT_EQ(read.decoder.bias0, scene_.decoder.bias0);
  EXPECT_EQ(read.decoder.bias2, scene_.decoder.bias2);
}

TEST_F(SnergFiles, AreRefusedByNameIfTruncated) {
  const std::string picture = read_file(folder_ / "rgba_000.png");
  for (const double share : {0.0, 0.3, 0.9}) {
    std::ofstream(folder_ / "rgba_000.png", std::ios::binary)
        << picture.substr(0, static_cast<std::size_t>(share * static_cast<double>(picture.size())));
    expect_refusal("rgba_000.png", "");
  }
  fs::remove(folder_ / "rgba_000.png");
  expect_refusal("rgba_000.png", "");
}

TEST_F(SnergFiles, AreRefusedByNameIfParametersAreCut) {
  const std::string text = read_file(folder_ / "scene_params.json");
  for (std::size_t size = 0; size < text.size(); size += 97) {
    std::ofstream(folder_ / "scene_params.json", std::ios::binary) << text.substr(0, size);
    expect_refusal("scene_params.json", "JSON");
  }
}

TEST_F(SnergFiles, AreRefusedIfTheAtlasIsSmallerThanStated) {
  replace_in_parameters("\"atlas_blocks_x\":", "\"atlas_blocks_x\":9");
  expect_refusal("scene_params.json", "atlas_width");
}

TEST_F(SnergFiles, AreRefusedIfTheGridHasOtherBlocks) {
  replace_in_parameters("\"grid_width\":", "\"grid_width\":1");
  expect_refusal("atlas_indices.png", "pixels");
}

TEST_F(SnergFiles, AreRefusedIfABlockLiesOutsideTheAtlas) {
  SnergScene lying = scene_;
  for (auto& place : lying.block_places)
    if (place[0] != 255) place[2] = 200;
  write_snerg(lying, folder_, {});
  expect_refusal("atlas_indices.png", "200");
}

TEST_F(SnergFiles, AreRefusedIfWeightsHaveAnotherShape) {
  replace_in_parameters("\"0_weights\":[[", "\"0_weights\":[[1.5,");
  expect_refusal("scene_params.json", "0_weights");
}

TEST_F(SnergFiles, AreRefusedIfTheNetworkIsTooWideOrItsWeightsTooLarge) {
  scene_.decoder.weights1 = Eigen::MatrixXd::Zero(16, 65);
  scene_.decoder.bias1 = Eigen::VectorXd::Zero(65);
  scene_.decoder.weights2 = Eigen::MatrixXd::Zero(65, 3);
  write_snerg(scene_, folder_, {});
  expect_refusal("scene_params.json", "at most 64");
  scene_ = ball_of_voxels(24);
  scene_.decoder.bias2[1] = 1e300;
  write_snerg(scene_, folder_, {});
  expect_refusal("scene_params.json", "2_bias");
}

TEST_F(SnergFiles, AreRefusedInNormalisedDeviceCoordinates) {
  replace_in_parameters("\"ndc\":false", "\"ndc\":true");
  expect_refusal("scene_params.json", "ndc");
}

}  // namespace
}  // namespace rebake
