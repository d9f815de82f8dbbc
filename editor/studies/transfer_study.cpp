#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "editor/studies/posed_body.h"
#include "editor/studies/study.h"
#include "mesh_ops/light/learned/learned_transfer.h"
#include "mesh_ops/light/learned/unet_transfer.h"
#include "mesh_ops/light/relight/cached_light.h"
#include "mesh_ops/light/transport/rotated_product.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int training_poses = 480, training_rays = 256, truth_rays = 2048;
constexpr int image_side = 64;
constexpr double amplitude = 0.06, beyond = 1.6;

// A test pose.
struct TestPose {
  ProxyMesh mesh;
  TracedPose truth;
};

// Test poses: random ones in the range of the training set, random ones in a wider range, and bent ones.
std::array<std::vector<TestPose>, 3> make_test_poses(const PosedBody& body, const Progress& progress) {
  std::array<std::vector<TestPose>, 3> sets;
  constexpr std::uint32_t each = 8, seed = 100000;
  for (std::uint32_t k = 0; k < each; ++k) {
    progress.at("truth of " + body.name, static_cast<double>(k) / each);
    const std::array<ProxyMesh, 3> poses{body.random_pose(seed + k, amplitude),
                                         body.random_pose(seed + each + k, beyond * amplitude),
                                         body.bent(-90 + 180.0 * k / (each - 1))};
    for (std::size_t kind = 0; kind < 3; ++kind)
      sets[kind].push_back({poses[kind], traced_pose(body.rest, poses[kind], truth_rays)});
  }
  return sets;
}

TransferTraining trained_poses(const PosedBody& body, UnetTransfer::Training* images, const Progress& progress) {
  const Clock::time_point start = Clock::now();
  TransferTraining training(body.rest.vertices, training_poses, TransferTraining::Frames::both);
  for (std::uint32_t k = 0; k < training_poses; ++k) {
    progress.at("poses of " + body.name, static_cast<double>(k) / training_poses);
    const ProxyMesh posed = body.random_pose(k, amplitude);
    const TracedPose traced = traced_pose(body.rest, posed, training_rays);
    training.set(k, posed.vertices, traced.turns, traced.transfer.sites);
    if (images != nullptr) images->add(traced.sites, traced.turns, traced.transfer.sites);
  }
  training.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return training;
}

using Coefficients = std::vector<sh::Coefficients>;

// A method that predicts the radiance transfer of a pose.
struct Way {
  std::string name;
  std::function<Coefficients(const TestPose&)> transfer;  // coefficients in the body's space, to measure errors
  std::function<void(const TestPose&)> light;             // computes the light per point, to measure time
  double bytes = 0, tracing_seconds = 0, learning_seconds = 0, undersampled = 0;  // see GeometryImage::undersampled
};

Coefficients turned(const Coefficients& local, const std::vector<Mat3>& turns) {
  return rotated_transfer({local, 0}, turns).sites;
}

Coefficients unpacked(const Eigen::VectorXf& values) {
  Coefficients result(static_cast<std::size_t>(values.size()) / sh::count);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = values.segment<sh::count>(static_cast<Eigen::Index>(i * sh::count)).cast<double>();
  return result;
}

// Adds a row per way: time of the light, and the error of the transfer on each set of test poses. `every_pose`: bytes
// of the transfer of all training poses.
void measure(const StudyInput& input, const PosedBody& body, const std::vector<Way>& ways,
             const std::array<std::vector<TestPose>, 3>& tests, double every_pose, StudyTable& table) {
  const std::size_t points = body.rest.vertices.size();
  for (const Way& way : ways) {
    input.progress.at(way.name, 0.9);
    StudyTable::Row row{body.name + ": " + way.name, {}};
    row.values.push_back(median_milliseconds(input.frames, [&] { way.light(tests[0].front()); }));
    for (const std::vector<TestPose>& set : tests) {
      double off = 0, all = 0;
      for (const TestPose& test : set) {
        const Coefficients found = way.transfer(test);
        for (std::size_t i = 0; i < points; ++i) {
          off += (found[i] - test.truth.transfer.sites[i]).squaredNorm();
          all += test.truth.transfer.sites[i].squaredNorm();
        }
      }
      row.values.push_back(100 * std::sqrt(off / all));
    }
    row.values.push_back(way.bytes / 1024);
    row.values.push_back(way.bytes > 0 ? every_pose / way.bytes : 0);
    row.values.push_back(way.tracing_seconds);
    row.values.push_back(way.learning_seconds);
    row.values.push_back(100 * way.undersampled);
    table.rows.push_back(std::move(row));
  }
}

void study_body(const StudyInput& input, const PosedBody& body, StudyTable& table) {
  const TracedPose rest = traced_pose(body.rest, body.rest, truth_rays);
  const auto tests = make_test_poses(body, input.progress);
  std::optional<UnetTransfer::Training> images;
  if (can_train_unet()) images.emplace(body.rest, GeometryImage(body.chart, image_side));
  const TransferTraining training = trained_poses(body, images ? &*images : nullptr, input.progress);
  const std::size_t points = body.rest.vertices.size();
  const double every_pose =
      static_cast<double>(training_poses) * static_cast<double>(points) * sh::count * sizeof(float);
  const RotatedProduct sky(
      projected_sky(sky_and_sun({0.34, 0.3, 0.27}, {0.75, 0.88, 1.1}, {}, {0, 0, 0}), Mat3::Identity()));
  std::vector<Radiance> light(points);
  const auto lit = [&](const Coefficients& local, const std::vector<Mat3>* turns) {
    for (std::size_t i = 0; i < points; ++i)
      light[i] = sky(turns != nullptr ? (*turns)[i] : Mat3::Identity(), local[i]);
  };
  std::vector<Way> ways;
  ways.push_back({"unchanged", [&](const TestPose&) { return rest.transfer.sites; },
                  [&](const TestPose&) { lit(rest.transfer.sites, nullptr); }, every_pose / training_poses});
  ways.push_back({"rotated", [&](const TestPose& t) { return turned(rest.transfer.sites, t.truth.turns); },
                  [&](const TestPose& t) { lit(rest.transfer.sites, &t.truth.turns); }, every_pose / training_poses});
  std::vector<LearnedTransfer> models;
  models.reserve(3);
  for (const auto& [name, way] : {std::pair{"linear", TransferMethod::linear},
                                  {"rotated + linear", TransferMethod::rotated_linear},
                                  {"rotated + kernel", TransferMethod::rotated_kernel}}) {
    input.progress.at(name, 0.5);
    models.push_back(LearnedTransfer::learned(training, {.way = way}));
    const LearnedTransfer* model = &models.back();
    const bool turns = way != TransferMethod::linear;
    const auto local = [model](const TestPose& t) {
      return unpacked(model->predict(model->space.place(model->probes_in(t.mesh.vertices))));
    };
    ways.push_back({name, [=](const TestPose& t) { return turns ? turned(local(t), t.truth.turns) : local(t); },
                    [=, &lit](const TestPose& t) { lit(local(t), turns ? &t.truth.turns : nullptr); },
                    static_cast<double>(model->memory()), training.seconds, model->seconds});
  }
  std::vector<UnetTransfer> nets;
  nets.reserve(2);
  for (const int channels : {8, 16}) {
    if (!images) break;
    nets.push_back(images->learned({.channels = channels}, input.progress));
    const UnetTransfer* net = &nets.back();
    const auto local = [net, &body](const TestPose& t) {
      return unpacked(net->predict(vertex_sites(body.rest, t.mesh, t.truth.turns)));
    };
    ways.push_back({fmt::format("rotated + U-Net, {} channels", channels),
                    [=](const TestPose& t) { return turned(local(t), t.truth.turns); },
                    [=, &lit](const TestPose& t) { lit(local(t), &t.truth.turns); }, static_cast<double>(net->memory()),
                    training.seconds, net->seconds(), GeometryImage(body.chart, image_side).undersampled(body.rest)});
  }
  for (const int rays : {16, 64, 256, 1024}) {
    const auto trace = [rays, &body](const TestPose& t) { return traced_pose(body.rest, t.mesh, rays).transfer.sites; };
    ways.push_back({fmt::format("traced, {} rays", rays), trace, [=](const TestPose& t) { trace(t); }});
  }
  // As the program does it: outside the model's trusted range, only rotate the transfer at rest.
  {
    const LearnedTransfer* model = &models[1];
    const auto inside = [model](const TestPose& t) {
      return model->space.place(model->probes_in(t.mesh.vertices)).range <= LearnedTransfer::trusted_range;
    };
    const Way along = ways[1], learned = ways[3];
    ways.push_back({"rotated + linear within its range",
                    [=](const TestPose& t) { return inside(t) ? learned.transfer(t) : along.transfer(t); },
                    [=](const TestPose& t) { inside(t) ? learned.light(t) : along.light(t); }, learned.bytes,
                    learned.tracing_seconds, learned.learning_seconds});
  }
  measure(input, body, ways, tests, every_pose, table);
}

}  // namespace

StudyTable study_transfer(const StudyInput& input) {
  StudyTable table{{"milliseconds", "error % in the training range", "error % in 1.6 times that range",
                    "error % when bent", "kilobytes", "compression ratio to all poses", "tracing seconds",
                    "training seconds", "% of surface undersampled"},
                   {},
                   0,
                   1,
                   true,
                   true};
  study_body(input, bumpy_sheet(64), table);
  study_body(input, wrapped_part(input.scene, Box(Vec3(0.52, 0.5, 0), Vec3(1, 1, 1)), 0.03), table);
  return table;
}

}  // namespace rebake
