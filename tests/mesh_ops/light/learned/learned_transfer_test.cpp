// Learned transfer: pose spaces and their range, fitted models, disk charts, geometry images, and the U-Net.
#include "mesh_ops/light/learned/learned_transfer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/cages/wrap.h"
#include "mesh_ops/light/learned/disk_chart.h"
#include "mesh_ops/light/learned/proxy_mesh.h"
#include "mesh_ops/light/learned/unet_transfer.h"

namespace rebake::test {
namespace {

constexpr int sheet_side = 12;

ProxyMesh grid(const std::function<Vec3(double x, double y)>& place, int count = sheet_side) {
  const DiskChart chart = grid_chart(count);
  ProxyMesh mesh;
  mesh.faces = chart.faces;
  for (const Vec2& uv : chart.uvs) mesh.vertices.push_back(place(2 * uv.x() - 1, 2 * uv.y() - 1));
  return mesh;
}
ProxyMesh flat() {
  return grid([](double x, double y) { return Vec3(x, y, 0); });
}
// Poses with two parameters: bowls (a) and saddles (b).
ProxyMesh curved(double a, double b) {
  return grid([=](double x, double y) { return Vec3(x, y, a * x * x + b * x * y); });
}
ProxyMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

// Analytic transfer: the clamped cosine, scaled by a linear function of the pose parameters.
std::vector<sh::Coefficients> known(const std::vector<LightSite>& sites, double a, double b) {
  std::vector<sh::Coefficients> transfer;
  for (const LightSite& site : sites)
    transfer.push_back((1 - 0.2 * a * site.position.x() + 0.1 * b) * sh::clamped_cosine(site.normal));
  return transfer;
}

TransferTraining some_poses(int count, bool bent = false) {
  const ProxyMesh rest = flat();
  TransferTraining training(rest.vertices, static_cast<std::size_t>(count), TransferTraining::Frames::both, 16);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-0.3, 0.3);
  for (int k = 0; k < count; ++k) {
    const double a = number(random), b = number(random);
    const ProxyMesh posed = curved(a, b);
    const auto turns = vertex_rotations(rest, posed);
    const auto sites = vertex_sites(rest, posed, turns);
    training.set(static_cast<std::size_t>(k), posed.vertices, turns, known(sites, bent ? a * a * 3 : a, b));
  }
  return training;
}

double error_at(const LearnedTransfer& model, double a, double b, bool bent = false) {
  const ProxyMesh rest = flat(), posed = curved(a, b);
  const auto turns = vertex_rotations(rest, posed);
  const auto sites = vertex_sites(rest, posed, turns);
  const Eigen::VectorXf found = model.predict(model.space.place(model.probes_in(posed.vertices)));
  const auto truth = known(sites, bent ? a * a * 3 : a, b);
  double off = 0, all = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sh::Coefficients one = found.segment<sh::count>(static_cast<Eigen::Index>(i * sh::count)).cast<double>();
    if (model.way != TransferMethod::linear) one = sh::Rotation(turns[i]) * one;
    off += (one - truth[i]).squaredNorm();
    all += truth[i].squaredNorm();
  }
  return std::sqrt(off / all);
}

TEST(LearnedTransfer, ProbesLieFarApart) {
  const ProxyMesh mesh = flat();
  const auto probes = PoseSpace::probes_of(mesh.vertices, 4);
  ASSERT_EQ(probes.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GE((mesh.vertices[probes[i]] - mesh.vertices[probes[j]]).norm(), 2 - 1e-12) << "the sheet's corners";
  EXPECT_EQ(PoseSpace::probes_of({{1, 2, 3}, {1, 2, 3}}, 5).size(), 1U) << "coincident points give one probe";
  EXPECT_TRUE(PoseSpace::probes_of({}, 5).empty());
}

TEST(LearnedTransfer, MeasuresDistanceFromTrainingPoses) {
  const LearnedTransfer model = LearnedTransfer::learned(some_poses(40), {});
  EXPECT_EQ(model.space.dimensions(), 2) << "the poses have two parameters";
  const auto range = [&](const ProxyMesh& posed) { return model.space.place(model.probes_in(posed.vertices)).range; };
  EXPECT_LE(range(curved(0.2, -0.1)), 1);
  EXPECT_GT(range(curved(0.8, 0)), 1.5);
  EXPECT_GT(range(grid([](double x, double y) { return Vec3(x, y, 0.3 * std::sin(4 * y)); })), 1.5)
      << "a pose of another kind";
}

TEST(LearnedTransfer, FitsLinearAndNonlinearTransfer) {
  const TransferTraining linear = some_poses(60), bent = some_poses(200, true);
  const double unchanged = [&] {
    LearnedTransfer model = LearnedTransfer::learned(linear, {.way = TransferMethod::linear});
    model.linear.setZero();
    return error_at(model, 0.25, -0.2);
  }();
  const LearnedTransfer plain = LearnedTransfer::learned(linear, {.way = TransferMethod::linear}),
                        turned = LearnedTransfer::learned(linear, {.way = TransferMethod::rotated_linear});
  EXPECT_LT(error_at(plain, 0.25, -0.2), 0.3 * unchanged);
  EXPECT_LT(error_at(turned, 0.25, -0.2), 0.1 * error_at(plain, 0.25, -0.2)) << "rotation is not linear";
  EXPECT_LT(error_at(turned, 0.25, -0.2), 2e-3);
  EXPECT_LT(turned.held_back_error, 2e-3);
  const LearnedTransfer line = LearnedTransfer::learned(bent, {.way = TransferMethod::rotated_linear}),
                        kernel = LearnedTransfer::learned(bent, {.way = TransferMethod::rotated_kernel});
  EXPECT_LT(error_at(kernel, 0.2, 0.1, true), 0.2 * error_at(line, 0.2, 0.1, true));
  EXPECT_THROW(LearnedTransfer::learned(some_poses(7), {}), Error);
}

TEST(LearnedTransfer, SurvivesDegenerateBodies) {
  // Poses without any motion, vertices without triangles, slivers.
  ProxyMesh rest{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}}, {{0, 1, 2}}};
  const auto turns = vertex_rotations(rest, rest);
  for (const Mat3& turn : turns) EXPECT_TRUE(turn.isIdentity(0));
  const auto sites = vertex_sites(rest, rest, turns);
  TransferTraining training(rest.vertices, 8, TransferTraining::Frames::turned);
  for (std::size_t k = 0; k < 8; ++k)
    training.set(k, rest.vertices, turns, std::vector<sh::Coefficients>(4, sh::Coefficients::Zero()));
  const LearnedTransfer model = LearnedTransfer::learned(training, {});
  const auto place = model.space.place(model.probes_in(rest.vertices));
  EXPECT_EQ(place.range, 0);
  EXPECT_TRUE(model.predict(place).isZero(0));
  rest.vertices[3].x() += 1;
  EXPECT_GT(model.space.place(model.probes_in(rest.vertices)).range, 1) << "the training poses have no motion";
}

TEST(ProxyMesh, RotatesWithThePoseAtAnyScale) {
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (const double scale : {1e-6, 1.0, 1e6}) {
    ProxyMesh rest = curved(0.3, 0.2);
    for (Vec3& p : rest.vertices) p *= scale;
    ProxyMesh posed = rest;
    for (Vec3& p : posed.vertices) p = turn * p + Vec3(3, 1, 2) * scale;
    const auto turns = vertex_rotations(rest, posed);
    const auto before = vertex_sites(rest, rest, std::vector<Mat3>(turns.size(), Mat3::Identity())),
               after = vertex_sites(rest, posed, turns);
    for (std::size_t v = 0; v < turns.size(); ++v) {
      EXPECT_LT((turns[v] - turn).norm(), 1e-12);
      EXPECT_LT((after[v].normal - turn * before[v].normal).norm(), 1e-12);
      EXPECT_LT((after[v].tangent - turn * before[v].tangent).norm(), 1e-12);
      EXPECT_NEAR(after[v].offset[0], before[v].offset[0], 1e-9 * scale);
    }
  }
}

TEST(GeometryImage, ReproducesLinearFunctions) {
  const ProxyMesh mesh = flat();
  const GeometryImage image(grid_chart(sheet_side), 64);
  std::vector<float> plane;
  for (const GeometryImage::Texel& texel : image.texels()) {
    Vec3 p = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      p += static_cast<double>(texel.weights[static_cast<Eigen::Index>(k)]) * mesh.vertices[texel.vertices[k]];
    plane.push_back(static_cast<float>(p.x() + 2 * p.y()));
  }
  const Eigen::VectorXf values = image.at_vertices(plane, 1);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    EXPECT_NEAR(values[static_cast<Eigen::Index>(v)], mesh.vertices[v].x() + 2 * mesh.vertices[v].y(), 1e-5);
  EXPECT_EQ(image.undersampled(mesh), 0);
}

// Checks the Euler characteristic (1 for a disk), the orientation of UV triangles, that they fill the unit square, and
// the vertex mapping.
void expect_disk(const DiskChart& chart, const ProxyMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Face& face : chart.faces)
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[{std::min(face[k], face[(k + 1) % 3]), std::max(face[k], face[(k + 1) % 3])}];
  EXPECT_EQ(
      static_cast<int>(chart.source.size()) - static_cast<int>(edges.size()) + static_cast<int>(chart.faces.size()), 1);
  double area = 0;
  for (const Face& face : chart.faces) {
    const Vec2 e = chart.uvs[face[1]] - chart.uvs[face[0]], f = chart.uvs[face[2]] - chart.uvs[face[0]];
    EXPECT_GE(e.x() * f.y() - e.y() * f.x(), -1e-12);
    area += (e.x() * f.y() - e.y() * f.x()) / 2;
  }
  EXPECT_NEAR(area, 1, 1e-9);
  EXPECT_EQ(chart.faces.size(), mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(chart.source[chart.faces[f][k]], mesh.faces[f][k]);
}

TEST(DiskChart, ParametrisesOpenClosedAndPuncturedSurfaces) {
  const ProxyMesh sheet = curved(0.4, 0.3);
  EXPECT_TRUE(seams_of(sheet, 6).empty()) << "a disk is not cut";
  expect_disk(disk_chart(sheet), sheet);
  expect_disk(disk_chart(tetrahedron()), tetrahedron());
  // A torus, then the same torus with two faces removed.
  ProxyMesh torus;
  constexpr std::uint32_t around = 16, across = 8;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      torus.vertices.emplace_back((1 + 0.4 * std::cos(v)) * std::cos(u), (1 + 0.4 * std::cos(v)) * std::sin(u),
                                  0.4 * std::sin(v));
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return a % around * across + b % across; };
      torus.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      torus.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  expect_disk(disk_chart(torus), torus);
  torus.faces.erase(torus.faces.begin() + 100);
  torus.faces.erase(torus.faces.begin() + 20);
  expect_disk(disk_chart(torus), torus);
}

TEST(DiskChart, LaysOutNeedles) {
  // A sheet that is a thousand times as fine along one axis: long, thin triangles with obtuse angles.
  ProxyMesh sheet = curved(0.4, 0.3);
  for (Vec3& p : sheet.vertices) p.y() = 1e-3 * p.y() + 2e-3 * p.x() * p.x();
  expect_disk(disk_chart(sheet), sheet);
}

TEST(DiskChart, RejectsInvalidMeshes) {
  ProxyMesh two = tetrahedron();
  for (const Vec3& p : tetrahedron().vertices) two.vertices.push_back(p + Vec3(5, 0, 0));
  for (const Face& face : tetrahedron().faces) two.faces.push_back({face[0] + 4, face[1] + 4, face[2] + 4});
  ProxyMesh turned = tetrahedron();
  std::swap(turned.faces[0][0], turned.faces[0][1]);
  ProxyMesh fin = tetrahedron();
  fin.vertices.emplace_back(1, 1, 1);
  fin.faces.push_back({0, 1, 4});
  for (const ProxyMesh& bad : {two, turned, fin, ProxyMesh{}, ProxyMesh{{{0, 0, 0}}, {{0, 0, 0}}}})
    EXPECT_THROW(disk_chart(bad), Error);
}

class UnetForms : public testing::TestWithParam<UnetForm> {};

// Square planes without a border, as [plane][row][column].
struct PlainPlanes {
  int count, side;
  std::vector<double> values;
  double at(int c, int y, int x) const {
    return y < 0 || x < 0 || y >= side || x >= side ? 0 : values[static_cast<std::size_t>((c * side + y) * side + x)];
  }
  PlainPlanes doubled() const {
    PlainPlanes wide{count, 2 * side, {}};
    for (int c = 0; c < count; ++c)
      for (int y = 0; y < wide.side; ++y)
        for (int x = 0; x < wide.side; ++x) wide.values.push_back(at(c, y / 2, x / 2));
    return wide;
  }
};

TEST_P(UnetForms, MatchPlainConvolutions) {
  // Compared with plain convolutions, with random weights.
  const UnetForm form = GetParam();
  constexpr int channels = 8, width = 64;
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::vector<float> weights(unet_weight_count(form, channels)), image(unet_inputs * width * width);
  // Small weights keep the sigmoid in its steep part.
  for (float& w : weights) w = (form == UnetForm::concatenated ? 0.04F : 0.1F) * normal(random);
  for (float& v : image) v = normal(random);
  const std::vector<float> found = Unet(form, width, channels, weights).run(image);

  using Planes = PlainPlanes;
  const auto layers = unet_layers(form, channels);
  std::size_t next = 0;
  const float* w = weights.data();
  const auto convolved = [&](const Planes& in) {
    const UnetLayer& layer = layers[next++];
    Planes out{layer.outputs, in.side / layer.stride, {}};
    const int reach = layer.kernel / 2, taps = layer.inputs * layer.kernel * layer.kernel;
    for (int o = 0; o < layer.outputs; ++o)
      for (int y = 0; y < out.side; ++y)
        for (int x = 0; x < out.side; ++x) {
          double sum = static_cast<double>(w[taps * layer.outputs + o]);
          const float* tap = w + o * taps;
          for (int i = 0; i < layer.inputs; ++i)
            for (int dy = -reach; dy <= reach; ++dy)
              for (int dx = -reach; dx <= reach; ++dx)
                sum += static_cast<double>(*tap++) * in.at(i, y * layer.stride + dy, x * layer.stride + dx);
          out.values.push_back(sum);
        }
    w += taps * layer.outputs + layer.outputs;
    return out;
  };
  const auto ramp = [](Planes x, const Planes* added = nullptr) {
    for (std::size_t k = 0; k < x.values.size(); ++k)
      x.values[k] = std::max(0.0, x.values[k] + (added != nullptr ? added->values[k] : 0));
    return x;
  };
  const auto residual = [&](const Planes& in) {
    const Planes inner = ramp(convolved(in));
    return ramp(convolved(inner), &in);
  };
  Planes x{unet_inputs, width, {image.begin(), image.end()}};
  x = ramp(convolved(x));
  std::vector<Planes> skipped;
  for (int l = 0; l < unet_levels(form); ++l) {
    skipped.push_back(residual(x));
    x = ramp(convolved(skipped.back()));
  }
  x = residual(x);
  for (int l = unet_levels(form) - 1; l >= 0; --l) {
    Planes wide = x.doubled();
    const Planes& skip = skipped[static_cast<std::size_t>(l)];
    if (form == UnetForm::concatenated) {
      wide.count += skip.count;
      wide.values.insert(wide.values.end(), skip.values.begin(), skip.values.end());
      x = residual(ramp(convolved(wide)));
    } else {
      x = residual(ramp(convolved(wide), &skip));
    }
  }
  x = convolved(x);
  if (form == UnetForm::concatenated)
    for (double& value : x.values) value = 1 / (1 + std::exp(-value));
  ASSERT_EQ(found.size(), x.values.size());
  double largest = 0, off = 0, least = 1e9;
  for (std::size_t k = 0; k < found.size(); ++k) {
    largest = std::max(largest, std::abs(x.values[k]));
    least = std::min(least, x.values[k]);
    off = std::max(off, std::abs(x.values[k] - static_cast<double>(found[k])));
  }
  EXPECT_LT(off, form == UnetForm::concatenated ? 2e-6 : 1e-4 * largest);
  EXPECT_GT(largest - least, 0.01) << "the outputs differ";
}

TEST_P(UnetForms, RefuseSizesThatDoNotFit) {
  const UnetForm form = GetParam();
  const std::vector<float> weights(unet_weight_count(form, 8));
  EXPECT_THROW(Unet(form, 60, 8, weights), std::invalid_argument);
  EXPECT_THROW(Unet(form, 64, 12, weights), std::invalid_argument);
  EXPECT_THROW(Unet(form, 64, 16, weights), std::invalid_argument);
}
INSTANTIATE_TEST_SUITE_P(Form, UnetForms, testing::Values(UnetForm::added, UnetForm::concatenated));

TEST(UnetLayers, HaveAsManyParametersAsPublished) {
  // The paper's compression ratio of 40.022 is that of 450 poses of 256² texels with 16 coefficients.
  const double published = 450.0 * 256 * 256 * 16 / 40.022;
  const auto found = static_cast<double>(unet_parameter_count(UnetForm::concatenated, 32));
  EXPECT_NEAR(found / published, 1, 1e-3) << found;
}

TEST(Unet, TrainsWithLibTorch) {
  if (!can_train_unet()) GTEST_SKIP() << "built without LibTorch";
  // On its training poses the network, with batch normalisation folded into its weights, must be far better than the
  // mean transfer over the poses, rotated with the surface.
  const ProxyMesh rest = flat();
  UnetTransfer::Training training(rest, GeometryImage(grid_chart(sheet_side), 64));
  struct Seen {
    std::vector<LightSite> sites;
    std::vector<Mat3> turns;
    std::vector<sh::Coefficients> truth;
  };
  std::vector<Seen> poses;
  for (const double a : {-0.4, -0.2, 0.2, 0.4}) {
    const ProxyMesh mesh = curved(a, 0);
    const auto turns = vertex_rotations(rest, mesh);
    const auto sites = vertex_sites(rest, mesh, turns);
    poses.push_back({sites, turns, known(sites, 4 * a, 0)});
    training.add(sites, turns, poses.back().truth);
  }
  const UnetTransfer model = training.learned({.channels = 8, .epochs = 120, .batch = 4, .rate = 1e-2});
  double off = 0, all = 0;
  for (const Seen& pose : poses) {
    const Eigen::VectorXf found = model.predict(pose.sites);
    for (std::size_t i = 0; i < pose.truth.size(); ++i) {
      const sh::Coefficients one = found.segment<sh::count>(static_cast<Eigen::Index>(i * sh::count)).cast<double>();
      off += (sh::Rotation(pose.turns[i]) * one - pose.truth[i]).squaredNorm();
      all += (sh::clamped_cosine(pose.sites[i].normal) - pose.truth[i]).squaredNorm();
    }
  }
  EXPECT_LT(std::sqrt(off / all), 0.5);
  std::atomic<bool> stop = true;
  EXPECT_THROW(training.learned({.channels = 8}, Progress({}, &stop)), Cancelled);
}

}  // namespace
}  // namespace rebake::test
