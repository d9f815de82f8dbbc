#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "editor/studies/dprt/dprt_gloss.h"
#include "editor/studies/dprt/transfer_methods.h"
#include "editor/studies/study.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/light/learned/unet_trainer.h"
#include "tests/support/made_scenes.h"
#include "tests/support/thorough.h"

namespace rebake {
namespace {

// A wavy sheet of `points`² vertices in a frame of its animation.
std::vector<Vec3> wave(int points, int frame) {
  std::vector<Vec3> places;
  for (int y = 0; y < points; ++y)
    for (int x = 0; x < points; ++x) {
      const double u = x / (points - 1.0), v = y / (points - 1.0);
      places.emplace_back(u, v, 0.2 * std::sin(5 * u + 0.4 * frame) * std::cos(2 * v));
    }
  return places;
}

AnimatedObject waves(int points, int frames) {
  AnimatedObject object{"waves", {wave(points, 0), grid_chart(points).faces}, {}};
  for (int k = 0; k < frames; ++k) object.frames.push_back(wave(points, k));
  return object;
}

StudyTable studied(const std::filesystem::path& folder, const DprtOptions& options, std::string& said) {
  const std::unique_ptr<Renderer> renderer = std::make_unique<Renderer>();
  const Scene scene;
  return study_dprt({[&]() -> Renderer& { return *renderer; },
                     scene,
                     {},
                     1,
                     {},
                     {},
                     folder,
                     [&](const std::string& line) { said += line + "\n"; },
                     options,
                     {},
                     false});
}

TEST(DprtStudy, MeasuresMeshesOfFilesAndGoesOnWhereItWasStopped) {
  REBAKE_ONLY_DEEP();
  const test::TemporaryFolder folder;
  const AnimatedObject object = waves(9, 20);
  std::filesystem::create_directory(folder.path() / "waves");
  for (std::size_t k = 0; k < object.frames.size(); ++k) {
    std::string text;
    for (const Vec3& p : object.frames[k]) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    for (const Face& f : object.rest.faces) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
    write_file_atomically(folder.path() / fmt::format("waves/f{:02}.obj", k), text, {});
  }
  const auto out = folder.path() / "out";
  std::filesystem::create_directories(out / "dprt");
  DprtOptions options;
  options.meshes = (folder.path() / "waves/f*.obj").string();
  options.channels = 8;
  options.epochs = 1;
  std::string said;
  const StudyTable first = studied(out, options, said);
  EXPECT_NE(said.find("64² texels, 8 channels, 1 epochs"), std::string::npos) << said;
  const std::size_t networks = can_train_unet() ? 2 : 0;
  ASSERT_EQ(first.rows.size(), 8 + networks);
  const auto error = [&](const StudyTable& table, std::size_t row) { return table.rows[row].values[1]; };
  // Unchanged, rotated; tracing with more rays is nearer to the truth, which has 4096.
  EXPECT_GT(error(first, 0), error(first, 1));
  for (std::size_t row = first.rows.size() - 3; row < first.rows.size(); ++row)
    EXPECT_LT(error(first, row), error(first, row - 1)) << first.rows[row].choice;
  EXPECT_GT(error(first, first.rows.size() - 1), 0) << "1024 rays must not be compared with themselves";
  for (const char* file : {"waves.png", "waves-glossy.png"})
    EXPECT_EQ(std::filesystem::exists(out / "dprt" / file), networks > 0) << file;
  const StudyTable again = studied(out, options, said);
  ASSERT_EQ(again.rows.size(), first.rows.size());
  for (std::size_t row = 0; row < first.rows.size(); ++row)
    for (const std::size_t column : {1, 2, 3, 6, 7})
      EXPECT_EQ(again.rows[row].values[column], first.rows[row].values[column]) << first.rows[row].choice;
  options.side = 100;
  EXPECT_THROW(studied(out, options, said), FieldError);
}

TEST(DprtStudy, NothingIsLearntFromHeldOutFrames) {
  TracedFrames traced = traced_frames(waves(9, 12), 64, 4, {}, {});
  const auto predictions = [](const TracedFrames& of) {
    const test::TemporaryFolder folder;
    std::vector<DprtMethod> methods = linear_methods(of, {});
    if (can_train_unet()) {
      DprtCurve curve;
      DprtOptions options;
      options.side = 64;
      options.channels = 8;
      options.epochs = 1;
      methods.push_back(published_network(of, options, (folder.path() / "a").string(), curve, {}));
      methods.push_back(rotated_network(of, options, (folder.path() / "b").string(), {}));
    }
    std::vector<std::vector<float>> found;
    for (const DprtMethod& method : methods)
      found.push_back(method.predict(sites_of(of.rest, of.frames[3]), of.frames[3]));
    return found;
  };
  const auto before = predictions(traced);
  for (std::size_t k = 0; k < traced.frames.size(); ++k)
    if (is_held_out(k))
      for (float& value : traced.transfer[k]) value = 7;
  EXPECT_EQ(predictions(traced), before);
}

TEST(DprtStudy, ClothIsSimulatedOnce) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "cloth.frames";
  const AnimatedObject first = cached_cloth(3, file, {});
  int simulated = 0;
  const Progress progress([&](std::string_view, double) { ++simulated; });
  const AnimatedObject second = cached_cloth(3, file, progress);
  EXPECT_EQ(simulated, 0);
  EXPECT_EQ(first.frames, second.frames);
  std::string damaged = read_file(file);
  damaged[200] ^= 1;
  write_file_atomically(file, damaged, {});
  EXPECT_EQ(cached_cloth(3, file, progress).frames, first.frames);
  EXPECT_GT(simulated, 0);
}

TEST(DprtStudy, GlossyLightIsTheIntegralOverItsLobe) {
  const Vec3 n = Vec3(0.2, 0.5, 1).normalized(), eye(1, 2, 3);
  // A transfer of 1/π in all directions.
  std::vector<float> constant(sh::count, 0);
  constant[0] = static_cast<float>(1 / std::numbers::pi / sh::basis(n)[0]);
  const Radiance found = reflected(glossy_light({{{0, 0, 0}, n, {1, 0, 0}, {0, 0}}}, eye), constant).front();
  const Vec3 to_eye = eye.normalized(), mirrored = 2 * n.dot(to_eye) * n - to_eye, side = mirrored.unitOrthogonal(),
             up = mirrored.cross(side);
  Radiance expected = Radiance::Zero();
  constexpr int steps = 400;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const double cosine = (i + 0.5) / steps, sine = std::sqrt(1 - cosine * cosine),
                   angle = 2 * std::numbers::pi * (j + 0.5) / steps;
      const Vec3 direction = cosine * mirrored + sine * (std::cos(angle) * side + std::sin(angle) * up);
      expected += 18 / 2.0 / std::numbers::pi * std::pow(cosine, 16) * glossy_surroundings(direction) * 2 *
                  std::numbers::pi / (steps * steps);
    }
  EXPECT_LT((found - expected).norm(), 0.01 * expected.norm()) << found.transpose() << " / " << expected.transpose();
}

}  // namespace
}  // namespace rebake
