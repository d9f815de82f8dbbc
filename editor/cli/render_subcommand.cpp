#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/actions/lit.h"
#include "editor/actions/views.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "mesh_ops/base/error.h"
#include "render/compare.h"
#include "render/picture.h"

namespace rebake {

namespace {

using nlohmann::json;

struct Rendering {
  std::vector<std::string> folders;
  std::string out;
  std::string axes = "360";
  ViewOptions view;
  bool plan = false, json = false, audit = false;
  int time = 0;
};

// Minimum, median and maximum.
json spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const double median = n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
  return {{"min", values.front()}, {"median", median}, {"max", values.back()}};
}

json measure(Renderer& renderer, const Scene& scene, const View& view, const RenderOptions& options,
             const Lighting& lighting, int frames) {
  std::vector<double> frame_ms;
  std::map<std::string, std::vector<double>> pass_ms;
  // The first frames compile shaders. Frames and passes are timed separately, because waiting after each pass takes
  // time.
  for (const bool each_pass : {false, true}) renderer.time_frame(scene, view, options, each_pass, &lighting);
  for (int i = 0; i < frames; ++i) {
    frame_ms.push_back(renderer.time_frame(scene, view, options, false, &lighting).frame_ms);
    for (const auto& [name, ms] : renderer.time_frame(scene, view, options, true, &lighting).pass_ms)
      pass_ms[name].push_back(ms);
  }
  json passes = json::object();
  for (const auto& [name, values] : pass_ms) passes[name] = spread(values);
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return {{"frame_ms", spread(frame_ms)},
          {"passes", passes},
          {"frames", frames},
          {"device", renderer.device()},
          {"peak_cpu_bytes", static_cast<std::uint64_t>(use.ru_maxrss) * 1024},
          {"peak_gpu_bytes", renderer.peak_gpu_bytes()}};
}

void print_times(const json& times) {
  const auto line = [](const std::string& name, const json& s) {
    fmt::print("{:<12} min {:8.2f}   median {:8.2f}   max {:8.2f} ms\n", name, s.at("min").get<double>(),
               s.at("median").get<double>(), s.at("max").get<double>());
  };
  fmt::print("{} frames on {}\n", times.at("frames").get<int>(), times.at("device").get<std::string>());
  line("frame", times.at("frame_ms"));
  for (const auto& [name, s] : times.at("passes").items()) line("  " + name, s);
  fmt::print("peak memory  {:.1f} MB CPU, {:.1f} MB GPU\n", times.at("peak_cpu_bytes").get<double>() / 1e6,
             times.at("peak_gpu_bytes").get<double>() / 1e6);
}

// Also renders with all omitted passes and light effects, and compares. Throws Error if too many pixels differ by more
// than the bounds and estimates.
json run_audit(const Scene& scene, const View& view, const RenderOptions& how, const Lighting& lighting, bool quiet) {
  const Lighting everything = lit(scene, progress_bar(), true);
  RenderOptions all = how;
  all.everything = true;
  // In 1/255; plus 1 because both pictures are rounded.
  const double allowed = (lighting.left_out + plan(scene, view, how, nullptr, &lighting).left_out) * 255 + 1;
  const double max_beyond = lighting.estimated ? Lighting::max_beyond : 0;
  Renderer renderer;
  const Difference difference =
      compare(renderer.render(scene, view, how, &lighting), renderer.render(scene, view, all, &everything),
              static_cast<int>(std::min(255.0, allowed)));
  const std::string found = fmt::format(
      "omitted effects change pixels by at most {}/255, and {:.2g} % of them by more than the {:.2f}/255 that {} "
      "allow",
      difference.largest, difference.share_beyond * 100, allowed,
      lighting.estimated ? "bounds and estimates" : "bounds");
  if (!quiet) fmt::print("audit: {}\n", found);
  if (difference.share_beyond > max_beyond)
    throw Error(fmt::format("audit failed at pixel {}, {}: {}; {:g} % are allowed", difference.x, difference.y, found,
                            max_beyond * 100));
  return {{"largest", difference.largest}, {"allowed", allowed}, {"share_beyond", difference.share_beyond}};
}

void render(const Rendering& options) {
  if (options.out.empty() && !options.plan && !options.audit && options.time == 0)
    throw FieldError("-o", "is missing: name a PNG to write, or use --plan, --audit or --time");
  if (!options.out.empty()) check_png_path(options.out, {});
  auto [scene, sources] = load_scenes(options.folders, options.axes, progress_bar());
  options.view.protect_files(sources);
  if (!options.out.empty()) check_png_path(options.out, sources);
  options.view.set_background(scene);
  const View view = options.view.view(scene);
  const RenderOptions how = options.view.render_options();
  const Lighting lighting = lit(scene, progress_bar());
  json report = json::object();
  if (options.audit) report["audit"] = run_audit(scene, view, how, lighting, options.json);
  std::optional<Renderer> renderer;
  if (!options.out.empty() || options.time > 0) {
    renderer.emplace();
    if (!options.out.empty()) {
      const Image picture = renderer->render(scene, view, how, &lighting);
      write_png(picture, options.out, sources);
      if (const auto why = blank_reason(scene, view, picture)) write_stderr(fmt::format("note: {}\n", *why));
    }
    if (options.time > 0) {
      const json times = measure(*renderer, scene, view, how, lighting, options.time);
      if (!options.json) print_times(times);
      report.update(times);
    }
  }
  if (options.plan) {
    // The plan of the drawn picture, if there is one, contains the results of occlusion culling.
    const std::vector<PlannedPass> passes =
        renderer ? renderer->passes() : plan(scene, view, how, nullptr, &lighting).passes;
    if (!options.json) fmt::print("{}", describe(passes));
    report["plan"] = json::array();
    for (const PlannedPass& pass : passes)
      report["plan"].push_back({{"pass", pass.name}, {"runs", pass.runs}, {"why", pass.why}});
  }
  if (options.json) fmt::print("{}\n", report.dump(1));
}

}  // namespace

void describe_render(SubcommandDescription& command) {
  auto options = std::make_shared<Rendering>();
  command.option("folders", options->folders, "folders and scenes to render together", "FOLDER|SCENE|PROJECT...")
      .required();
  command.option("-o,--out", options->out, "PNG to write", "OUT.png");
  options->view.add_to(command);
  add_axes_option(command, options->axes);
  command.flag("--plan", options->plan, "print which passes run or are omitted, and why");
  command.flag("--audit", options->audit,
               "also render with all omitted effects, and fail if the picture differs by more than the bounds "
               "and estimates allow");
  command.option("--time", options->time, "measure the time of N frames", "N").between(1, 100000);
  command.flag("--json", options->json, "print plan and times as JSON");
  command.does([options] { render(*options); });
}

}  // namespace rebake
