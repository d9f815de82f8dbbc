#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include "editor/studies/representations/marched_volume.h"
#include "editor/studies/representations/npz.h"
#include "editor/studies/representations/plenoctree_files.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "render/compare.h"
#include "tests/support/made_scenes.h"
#include "tests/support/marched_picture.h"

namespace rebake {
namespace {

namespace fs = std::filesystem;

// A tree of random depth around a ball, with random leaves of different sizes.
PlenOctree random_tree(int basis, unsigned seed, int deepest = 5) {
  PlenOctree tree;
  tree.basis = basis;
  tree.scale = {0.4, 0.4, 0.4};
  tree.offset = {0.45, 0.52, 0.5};
  std::mt19937 random(seed);
  const auto unit = [&] { return random() / 4294967296.0; };
  const std::function<void(const Vec3&, double, int)> add = [&](const Vec3& corner, double size, int depth) {
    const std::size_t node = tree.children.size();
    tree.children.push_back({});
    tree.data.resize(tree.children.size() * 8 * tree.record(), Eigen::half(0));
    for (std::size_t k = 0; k < 8; ++k) {
      const Vec3 low = corner + size / 2 * Vec3(k >> 2 & 1, k >> 1 & 1, k & 1);
      const double far = std::abs((low + Vec3::Constant(size / 4) - Vec3::Constant(0.5)).norm() - 0.33);
      if (far > 0.6 * size) continue;
      if (depth < deepest && unit() > 0.15) {
        tree.children[node][k] = static_cast<std::int32_t>(tree.children.size() - node);
        add(low, size / 2, depth + 1);
        continue;
      }
      Eigen::half* leaf = tree.leaf(node, k);
      for (int c = 0; c < 3 * basis; ++c) leaf[c] = Eigen::half(static_cast<float>(3 * unit() - 1.5));
      leaf[3 * basis] = Eigen::half(static_cast<float>(40 * unit()));
    }
  };
  add(Vec3::Zero(), 1, 1);
  return tree;
}

// Independent rendering in double precision: recursive descent, without a march.
class TreeReference {
 public:
  explicit TreeReference(const PlenOctree& tree) : tree_(tree) {}

  Color march(const Vec3& eye, const Vec3& direction) const {
    Ray ray{tree_.offset + tree_.scale.cwiseProduct(eye),
            tree_.scale.cwiseProduct(direction),
            tree_harmonics(direction),
            Color::Zero(),
            1,
            false};
    descend(0, Vec3::Zero(), 1, ray);
    return ray.ended ? Color(ray.color / (1 - ray.light)) : Color(ray.color.array() + ray.light);
  }

 private:
  // In tree coordinates; parameters are lengths in scene units, because the direction is scaled, too.
  struct Ray {
    Vec3 origin, direction;
    std::array<double, 16> harmonics;
    Color color;
    double light;
    bool ended;
  };
  static std::pair<double, double> range(const Ray& ray, const Vec3& low, double size) {
    const Vec3 a = (low - ray.origin).cwiseQuotient(ray.direction),
               b = (low - ray.origin + Vec3::Constant(size)).cwiseQuotient(ray.direction);
    return {std::max(0.0, a.cwiseMin(b).maxCoeff()), a.cwiseMax(b).minCoeff()};
  }
  void descend(std::size_t node, const Vec3& corner, double size, Ray& ray) const {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = 0; k < 8; ++k) {
      const auto [enter, leave] = range(ray, corner + size / 2 * Vec3(k >> 2 & 1, k >> 1 & 1, k & 1), size / 2);
      if (leave > enter) order.push_back({enter + leave, k});
    }
    std::sort(order.begin(), order.end());
    for (const auto& [when, k] : order) {
      if (ray.ended) return;
      const Vec3 low = corner + size / 2 * Vec3(k >> 2 & 1, k >> 1 & 1, k & 1);
      if (const std::int32_t child = tree_.children[node][k]; child != 0)
        descend(node + static_cast<std::size_t>(child), low, size / 2, ray);
      else
        absorb(tree_.leaf(node, k), range(ray, low, size / 2), ray);
    }
  }
  void absorb(const Eigen::half* leaf, const std::pair<double, double>& part, Ray& ray) const {
    const double density = static_cast<double>(static_cast<float>(leaf[3 * tree_.basis]));
    if (density <= 0.01) return;
    const double through = std::exp(-density * (part.second - part.first));
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (int b = 0; b < tree_.basis; ++b)
        sum += static_cast<double>(static_cast<float>(leaf[c * tree_.basis + b])) *
               ray.harmonics[static_cast<std::size_t>(b)];
      ray.color[c] += ray.light * (1 - through) / (1 + std::exp(-sum));
    }
    ray.light *= through;
    ray.ended = ray.light < 0.01;
  }
  const PlenOctree& tree_;
};

View view_of_tree() {
  View view;
  view.camera.eye = {1.9, 1.1, 2.4};
  view.camera.target = {0.1, 0, 0};
  view.width = 80, view.height = 60;
  return view;
}

Image reference_picture(const PlenOctree& tree, const View& view) {
  const TreeReference reference(tree);
  return test::marched_picture(view,
                               [&](const Vec3& eye, const Vec3& direction) { return reference.march(eye, direction); });
}

class PlenOctreeDrawing : public testing::TestWithParam<int> {};

TEST_P(PlenOctreeDrawing, AgreesWithADescentInDoublePrecision) {
  const PlenOctree tree = random_tree(GetParam(), 3);
  ASSERT_GT(tree.children.size(), 100U);
  const auto context = gl::make_headless_context();
  const View view = view_of_tree();
  const Image expected = reference_picture(tree, view);
  const Difference difference = compare(MarchedVolume(tree, *context).picture(view), expected, 2);
  EXPECT_GT(difference.psnr_db, 50) << "largest " << difference.largest << " at " << difference.x << ", "
                                    << difference.y;
  // The test sees a wrong coefficient.
  PlenOctree wrong = tree;
  for (std::size_t k = static_cast<std::size_t>(GetParam()) - 1; k < wrong.data.size(); k += wrong.record())
    wrong.data[k] = Eigen::half(-static_cast<float>(wrong.data[k]));
  EXPECT_LT(compare(MarchedVolume(wrong, *context).picture(view), expected, 2).psnr_db, 40);
}

INSTANTIATE_TEST_SUITE_P(Degrees, PlenOctreeDrawing, testing::Values(1, 4, 9, 16));

TEST(PlenOctreeDrawing, SeesFromInside) {
  const PlenOctree tree = random_tree(9, 5);
  const auto context = gl::make_headless_context();
  View view = view_of_tree();
  view.camera.eye = {0.1, -0.05, 0.02};
  view.camera.target = {1, 0.3, -0.4};
  EXPECT_GT(compare(MarchedVolume(tree, *context).picture(view), reference_picture(tree, view), 2).psnr_db, 50);
}

TEST(PlenOctreeDrawing, EndsFarFromAFineTree) {
  // Parameters of single precision that count from the eye would not advance from leaf to leaf.
  const PlenOctree tree = random_tree(1, 9, 9);
  const auto context = gl::make_headless_context();
  View view = view_of_tree();
  view.width = view.height = 24;
  view.camera.eye = Vec3(600, 350, 700);
  view.camera.fov_degrees = 0.2;
  view.camera.far_plane = 2000;
  EXPECT_GT(compare(MarchedVolume(tree, *context).picture(view), reference_picture(tree, view), 2).psnr_db, 30);
}

class PlenOctreeFiles : public testing::Test {
 protected:
  void expect_refusal(const Npz& arrays, const std::string& why) const {
    write_npz(arrays, file_, {});
    try {
      read_plenoctree(file_);
      ADD_FAILURE() << "was read, expected: " << why;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  }
  Npz written() const {
    write_plenoctree(tree_, file_, {});
    return read_npz(file_);
  }
  test::TemporaryFolder temporary_;
  fs::path file_ = temporary_.path() / "tree.npz";
  PlenOctree tree_ = random_tree(9, 11, 4);
};

TEST_F(PlenOctreeFiles, KeepEverything) {
  write_plenoctree(tree_, file_, {});
  const PlenOctree read = read_plenoctree(file_);
  EXPECT_EQ(read.basis, 9);
  EXPECT_EQ(read.children, tree_.children);
  EXPECT_TRUE(std::equal(read.data.begin(), read.data.end(), tree_.data.begin(), tree_.data.end(),
                         [](Eigen::half a, Eigen::half b) { return a.x == b.x; }));
  EXPECT_LT((read.scale - tree_.scale).norm(), 1e-7);
  EXPECT_LT((read.offset - tree_.offset).norm(), 1e-7);
}

TEST_F(PlenOctreeFiles, ForTheWebAreExactUpTo65536Colours) {
  write_quantised_plenoctree(tree_, file_, {});
  const Npz arrays = read_npz(file_);
  EXPECT_FALSE(arrays.contains("data"));
  const PlenOctree read = read_plenoctree(file_);
  for (std::size_t slot = 0; slot < tree_.children.size() * 8; ++slot) {
    const std::size_t record = slot * tree_.record();
    ASSERT_EQ(read.data[record + 27].x, tree_.data[record + 27].x);
    if (!(static_cast<float>(tree_.data[record + 27]) > 0)) continue;
    for (std::size_t k = 0; k < 27; ++k)
      ASSERT_EQ(static_cast<float>(read.data[record + k]), static_cast<float>(tree_.data[record + k]));
  }
}

TEST_F(PlenOctreeFiles, MayStateOneRadiusForAllAxes) {
  Npz arrays = written();
  const float radius = 0.4F;
  arrays.erase("invradius3");
  arrays["invradius"] = {"<f4", {}, std::string(reinterpret_cast<const char*>(&radius), sizeof radius)};
  write_npz(arrays, file_, {});
  EXPECT_EQ(read_plenoctree(file_).scale, Vec3::Constant(static_cast<double>(radius)));
}

TEST_F(PlenOctreeFiles, AreRefusedIfTheyLie) {
  const Npz good = written();
  for (const char* name : {"child", "data", "data_format", "offset", "invradius3"}) {
    Npz lacking = good;
    lacking.erase(name);
    expect_refusal(lacking, name == std::string("invradius3") ? "invradius" : name);
  }
  Npz wrong = good;
  wrong["data"].shape[4] = 27;
  wrong["data"].bytes.resize(wrong["data"].count() * 2);
  expect_refusal(wrong, "\"data\"");
  wrong = good;
  wrong["data"].shape[0] -= 1;
  wrong["data"].bytes.resize(wrong["data"].count() * 2);
  expect_refusal(wrong, "\"data\"");
  wrong = good;
  wrong["data_format"].bytes[0] = 'A';
  expect_refusal(wrong, "data_format");
  const auto first = std::find_if(tree_.children[0].begin(), tree_.children[0].end(), [](auto c) { return c != 0; });
  const auto slot = static_cast<std::size_t>(first - tree_.children[0].begin());
  struct Lie {
    std::size_t place;  // of a child in the array
    std::int32_t value;
  };
  // A child outside the tree, the root as a child, and a node with two parents.
  for (const Lie& lie : {Lie{9, 0x7fffffff}, Lie{9, -1}, Lie{(slot + 1) % 8, *first}}) {
    wrong = good;
    std::memcpy(wrong["child"].bytes.data() + 4 * lie.place, &lie.value, sizeof lie.value);
    expect_refusal(wrong, "\"child\"");
  }
  wrong = good;
  wrong["data_dim"].bytes[0] = 27;
  expect_refusal(wrong, "data_dim");
  wrong = good;
  wrong["data_format"].type = "<f4";
  expect_refusal(wrong, "data_format");
  // std::regex would overflow the stack.
  wrong = good;
  wrong["offset"].type = "<f4" + std::string(40'000, ' ');
  expect_refusal(wrong, "\"offset\"");
  wrong = good;
  wrong["data"].bytes[1] = '\x7c';  // an infinity in half precision
  wrong["data"].bytes[0] = '\0';
  expect_refusal(wrong, "finite");
}

TEST_F(PlenOctreeFiles, AreRefusedIfTheTreeIsTooDeep) {
  tree_ = {1, Vec3::Zero(), Vec3::Ones(), {}, {}};
  for (int level = 0; level < 40; ++level) tree_.children.push_back({level < 39 ? 1 : 0});
  tree_.data.assign(tree_.children.size() * 8 * tree_.record(), Eigen::half(1));
  expect_refusal(written(), "deeper than 16");
}

TEST_F(PlenOctreeFiles, AreRefusedWhereverTheyAreCutOrFlipped) {
  tree_ = random_tree(1, 2, 2);
  write_plenoctree(tree_, file_, {});
  const std::string bytes = read_file(file_);
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    std::ofstream(file_, std::ios::binary) << bytes.substr(0, size);
    EXPECT_THROW(read_plenoctree(file_), FileError) << "cut to " << size;
  }
  // A flipped byte is found, unless nothing reads it (dates, versions, attributes).
  std::mt19937 random(4);
  int refused = 0, same = 0;
  for (int k = 0; k < 400; ++k) {
    std::string damaged = bytes;
    const std::size_t at = random() % damaged.size();
    damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1U << random() % 8));
    std::ofstream(file_, std::ios::binary) << damaged;
    try {
      const PlenOctree read = read_plenoctree(file_);
      EXPECT_EQ(read.children, tree_.children) << "byte " << at;
      ++same;
    } catch (const FileError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 200);
  EXPECT_EQ(refused + same, 400);
}

}  // namespace
}  // namespace rebake
