#include "editor/studies/dprt/shape_space.h"

#include <fmt/format.h>

#include <limits>
#include <random>

#include "editor/studies/dprt/dprt_measure.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/light/learned/disk_chart.h"

namespace rebake {

namespace {

constexpr std::size_t jaw = 0;
constexpr int sweep_steps = 10;

using Weights = std::array<double, head_shapes>;

// 0 … 1.
double random_share(std::mt19937& random) { return random() / 4294967295.0; }

// An expression without an open jaw.
Weights random_expression(std::mt19937& random) {
  Weights weights{};
  for (std::size_t k = 0; k < head_shapes; ++k) {
    const double share = random_share(random);
    weights[k] = k == jaw ? 0 : 1.3 * share - 0.3;
  }
  return weights;
}

// A share of `head` between the plane (0) and the head (1).
std::vector<Vec3> between(const Weights& expression, double head) {
  static const std::vector<Vec3> plane = plane_like_head().vertices;
  std::vector<Vec3> shape = head_pose(expression);
  for (std::size_t v = 0; v < shape.size(); ++v) shape[v] = plane[v] + head * (shape[v] - plane[v]);
  return shape;
}

AnimatedObject random_shapes() {
  AnimatedObject object{"space", {between({}, 0.5), plane_like_head().faces}, {}};
  std::mt19937 random(7);
  for (int k = 0; k < dprt_frames; ++k) {
    const double head = random_share(random);
    object.frames.push_back(between(random_expression(random), head));
  }
  return object;
}

struct Sweep {
  std::string file, title, x;
  std::vector<std::vector<TestFrame>> steps;  ///< poses per step from 0 to 1
};

void write_sweep(const StudyInput& input, const Sweep& sweep, const std::vector<DprtMethod>& methods) {
  const std::string base = (own_folder(input, "dprt") / sweep.file).string();
  std::string csv = sweep.x;
  std::vector<PlottedLine> lines;
  for (const DprtMethod& method : methods) {
    csv += fmt::format(",\"{}, error %\"", method.name);
    lines.push_back({method.name, {}});
  }
  csv += "\n";
  for (std::size_t k = 0; k < sweep.steps.size(); ++k) {
    const double at = static_cast<double>(k) / sweep_steps;
    csv += fmt::format("{}", at);
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const double error = percent_off(methods[m], sweep.steps[k], input.progress);
      csv += fmt::format(",{:.4g}", error);
      lines[m].points.push_back({at, error});
    }
    csv += "\n";
  }
  write_file_atomically(base + ".csv", csv, {});
  try {
    write_line_plot(sweep.title, sweep.x, "error %", false, lines, base);
  } catch (const Error& error) {
    input.say(fmt::format("warning: {} was not plotted: {}", sweep.file, error.what()));
  }
}

}  // namespace

void study_shape_space(const StudyInput& input, const DprtOptions& options, StudyTable& table) {
  const AnimatedObject object = random_shapes();
  const TracedFrames traced =
      traced_frames(object, options.side, training_rays,
                    own_folder(input, "dprt") / fmt::format("space-{}", options.side), input.progress);
  say_layout(input, object.name, traced);
  const GeometryImage image(disk_chart(object.rest), options.side);
  const auto test = [&](const Weights& expression, double head) {
    return test_frame(traced, texel_positions(image, between(expression, head)));
  };
  std::vector<DprtMethod> methods;
  add_learned_methods(input, options, object.name, traced, methods);
  const std::vector<TestFrame> tests = held_out_frames(traced);
  for (const DprtMethod& method : methods) {
    StudyTable::Row row{"space: " + method.name, std::vector<double>(table.columns.size(), DprtMethod::nan)};
    row.values[0] = milliseconds_of(method, traced, tests.front(), input.frames);
    row.values[1] = percent_off(method, tests, input.progress);
    row.values[4] = method.loss;
    row.values[5] = method.held_out_loss;
    row.values[6] = method.parameters / 1e6;
    row.values[7] = method.bytes / 1e6;
    row.values[9] = method.minutes;
    table.rows.push_back(std::move(row));
  }
  Sweep over{"space-sweep", "shapes between a plane (0) and a head (1)", "share of the head", {}};
  Sweep along{"space-path",
              "from the half-way shape (0) to an open jaw (1), which no training shape has",
              "share of the path",
              {}};
  for (int k = 0; k <= sweep_steps; ++k) {
    input.progress.at("truth of the sweeps", static_cast<double>(k) / sweep_steps);
    const double share = static_cast<double>(k) / sweep_steps;
    std::mt19937 random(1000);
    over.steps.emplace_back();
    for (int expression = 0; expression < 3; ++expression) {
      const Weights weights = random_expression(random);
      over.steps.back().push_back(test(weights, share));
    }
    Weights open{};
    open[jaw] = share;
    along.steps.push_back({});
    along.steps.back().push_back(test(open, 0.5 + 0.5 * share));
  }
  write_sweep(input, over, methods);
  write_sweep(input, along, methods);
}

}  // namespace rebake
