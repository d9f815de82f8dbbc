#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/actions/lit.h"
#include "editor/actions/picture_output.h"
#include "editor/actions/views.h"
#include "editor/cli/film_options.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/document/replaced_work.h"
#include "editor/fields/codec.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/photo_names.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "mesh_ops/motion/scene_at.h"
#include "render/compare.h"
#include "render/picture.h"

namespace rebake {

namespace {

using nlohmann::json;

struct Rendering {
  std::vector<std::string> folders;
  std::string out;
  FolderOptions reading;
  ViewOptions view;
  std::string cameras, camera_format = "auto", world;
  bool plan = false, json = false, audit = false;
  int time = 0;
  PictureContent content;
  std::string sheet;
  std::optional<double> at;
  FilmOptions film;
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
  fmt::print("{} on {}\n", counted(times.at("frames").get<std::size_t>(), "frame"),
             times.at("device").get<std::string>());
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

// Throws FieldError for options that rendering of photographs does not have.
void check_photograph_options(const Rendering& options) {
  const ViewOptions& view = options.view;
  for (const auto& [given, name] : {std::pair(!view.camera_file.empty(), "--camera"),
                                    {!view.eye.empty(), "--eye"},
                                    {!view.target.empty(), "--target"},
                                    {!view.up.empty(), "--up"},
                                    {view.fov.has_value(), "--fov"},
                                    {view.near_plane.has_value(), "--near"},
                                    {view.far_plane.has_value(), "--far"},
                                    {view.size != ViewOptions().size, "--size"},
                                    {options.plan, "--plan"},
                                    {options.audit, "--audit"},
                                    {options.json, "--json"},
                                    {options.time > 0, "--time"},
                                    {options.at.has_value(), "--at"},
                                    {!options.sheet.empty(), "--sheet"},
                                    {!options.content.passes.empty(), "--passes"},
                                    {options.content.panorama, "--panorama"},
                                    {options.content.separate, "--separate"}})
    if (given) throw FieldError(name, "cannot be combined with --cameras");
  if (options.out.empty()) throw FieldError("-o", "is missing: name a folder for the pictures");
}

// Pictures named after photographs must replace neither other photographs or masks of the capture, nor what links
// refer to.
void refuse_replacing_capture(const std::filesystem::path& file, const std::filesystem::path& cameras) {
  std::error_code error;
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, error))) return;
  const std::filesystem::path inside =
      std::filesystem::weakly_canonical(file, error)
          .lexically_relative(std::filesystem::weakly_canonical(capture_folder(cameras), error));
  const bool in_capture = !inside.empty() && *inside.begin() != "..";
  if (std::filesystem::is_symlink(file, error) || !is_rendered_picture(file))
    throw FileError(file, in_capture ? "exists in the capture's folder; name a new folder for the pictures"
                                     : "exists and was not rendered by Rebake, was changed since, is of an earlier "
                                       "build, or is a link; name a new folder");
}

// Writes a picture for each camera of a file into a folder, named after the photographs.
void render_photographs(const Rendering& options) {
  check_photograph_options(options);
  auto [scene, sources] = load_scenes(options.folders, options.reading, progress_bar());
  options.view.set_background(scene);
  std::optional<WorldUp> up;
  if (!options.world.empty()) up = Codec<WorldUp>::read(json(options.world), scene);
  std::vector<std::string> notes;
  const std::string format = options.camera_format == "auto" ? "" : options.camera_format;
  const std::vector<PhotoCamera> cameras = read_cameras(options.cameras, format, up, notes);
  const std::vector<Camera> cameras_as_views = views_of(cameras, notes);
  for (const std::string& note : notes) write_stderr(fmt::format("warning: {}: {}\n", options.cameras, note));
  for (const std::filesystem::path& file : camera_format_for(options.cameras, format).files(options.cameras))
    sources.add_file(file, "a camera file of this run");
  // Photographs and masks may be rendered themselves. Other pictures of their names may be those of an earlier run.
  for (const std::filesystem::path& file : protected_files(options.cameras, cameras))
    sources.add_file(file, "a file of the capture");
  for (const std::filesystem::path& file : captured_files_at(options.out, protected_files))
    sources.add_file(file, "a file of the capture there");
  for (const std::filesystem::path& file : capture_files(options.cameras, cameras))
    if (!is_rendered_picture(file)) sources.add_file(file, "a file of the capture");
  for (const std::filesystem::path& file : captured_files_at(options.out))
    if (!is_rendered_picture(file)) sources.add_file(file, "a file of the capture there");
  std::vector<View> views;
  std::vector<std::filesystem::path> files;
  const std::vector<std::string> names = photo_names(cameras);
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    views.push_back(
        resolve_view(scene, cameras_as_views[k], "", cameras[k].width, cameras[k].height, options.view.samples));
    files.push_back(std::filesystem::path(options.out) / (names[k] + ".png"));
    check_picture_path(files.back(), sources);
    refuse_replacing_work(files.back());
    refuse_replacing_capture(files.back(), options.cameras);
  }
  std::filesystem::create_directories(options.out);
  const Lighting lighting = lit(scene, progress_bar());
  Renderer renderer;
  const Progress progress = progress_bar();
  for (std::size_t k = 0; k < views.size(); ++k) {
    progress.at("rendering", static_cast<double>(k) / static_cast<double>(views.size()));
    refuse_replacing_capture(files[k], options.cameras);  // it may have appeared since
    render_to_file(renderer, scene, views[k], options.view.render_options(), &lighting, options.content, files[k],
                   sources);
  }
  print_message(fmt::format("rendered {} into {}", counted(views.size(), "picture"), options.out));
}

// "4x3" as columns and rows.
PixelSize cells_of(const std::string& text) {
  PixelSize cells;
  int length = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &cells.width, &cells.height, &length) != 2 ||
      static_cast<std::size_t>(length) != text.size() || cells.width < 1 || cells.height < 1 || cells.width > 1000 ||
      cells.height > 1000)
    throw FieldError("--sheet", "must be columns x rows, such as 4x3");
  return cells;
}

// Renders a picture to its file. Returns the picture, empty for passes and sheets.
Image render_picture(const Rendering& options, Renderer& renderer, const Scene& scene, const View& view,
                     const Lighting& lighting, const SourceGuard& sources) {
  const RenderOptions how = options.view.render_options();
  if (options.sheet.empty())
    return render_to_file(renderer, scene, view, how, &lighting, options.content, options.out, sources);
  if (!options.content.passes.empty() || options.content.panorama || options.content.transparent)
    throw FieldError("--sheet", "cannot be combined with --passes, --panorama or --transparent");
  write_rendered(sheet_of_views(renderer, scene, view, cells_of(options.sheet), &lighting, progress_bar(), how),
                 options.out, sources);
  return {};
}

void render(const Rendering& options) {
  if (options.film.given()) {
    if (!options.cameras.empty()) throw FieldError("--cameras", "cannot be combined with --path");
    for (const auto& [given, name] : {std::pair(options.plan, "--plan"),
                                      {options.audit, "--audit"},
                                      {options.json, "--json"},
                                      {options.time > 0, "--time"},
                                      {options.at.has_value(), "--at"},
                                      {!options.sheet.empty(), "--sheet"}})
      if (given) throw FieldError(name, "cannot be combined with --path");
    LoadedScene opened = load_scenes(options.folders, options.reading, progress_bar());
    options.view.protect_files(opened.sources);
    options.view.set_background(opened.scene);
    return options.film.render(std::move(opened), options.view, options.content, options.out);
  }
  options.film.check_unused();
  if (!options.cameras.empty()) return render_photographs(options);
  if (!options.world.empty()) throw FieldError("--world", "applies to --cameras only");
  if (options.camera_format != "auto") throw FieldError("--camera-format", "applies to --cameras only");
  if (options.out.empty() && !options.plan && !options.audit && options.time == 0)
    throw FieldError("-o", "is missing: name a picture to write, or use --plan, --audit or --time");
  const auto [width, height] = options.view.pixels();
  if (!options.out.empty()) {
    for (const std::filesystem::path& file : files_of(options.content, options.out)) check_picture_path(file, {});
    check(options.content, options.out, width, height);
  }
  auto [scene, sources] = load_scenes(options.folders, options.reading, progress_bar());
  options.view.protect_files(sources);
  if (!options.out.empty())
    for (const std::filesystem::path& file : files_of(options.content, options.out)) {
      check_picture_path(file, sources);
      refuse_replacing_work(file);
      refuse_replacing_unnamed(file, options.out);
    }
  options.view.set_background(scene);
  if (options.at) scene = scene_at(scene, *options.at);
  const View view = options.view.view(scene);
  const RenderOptions how = options.view.render_options();
  const Lighting lighting = lit(scene, progress_bar());
  json report = json::object();
  if (options.audit) report["audit"] = run_audit(scene, view, how, lighting, options.json);
  std::optional<Renderer> renderer;
  if (!options.out.empty() || options.time > 0) {
    renderer.emplace();
    if (!options.out.empty()) {
      const Image picture = render_picture(options, *renderer, scene, view, lighting, sources);
      if (const auto why = picture.rgb.empty() ? std::nullopt : blank_reason(scene, view, picture))
        write_stderr(fmt::format("note: {}\n", *why));
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
  command.option("-o,--out", options->out, "picture to write: .png or .webp without loss, .jpg, or .exr (linear light)",
                 "OUT.png");
  options->view.add_to(command);
  options->reading.add_to(command);
  command.option("--cameras", options->cameras,
                 "render every camera of a file (transforms.json, COLMAP, poses_bounds.npy, camera paths) at its own "
                 "size; -o names a folder",
                 "FILE|FOLDER");
  command
      .option("--camera-format", options->camera_format, "with --cameras: format of the file",
              fmt::format("{} [auto]", fmt::join(Codec<CameraFormatName>::type().choices, "|")))
      .one_of(Codec<CameraFormatName>::type().choices);
  command.option("--world", options->world, "with --cameras: axis that points up in the file", "y_up|z_up [by format]")
      .one_of(Codec<WorldUp>::type().choices);
  command.flag("--transparent", options->content.transparent, "no background, but alpha; not for JPEG and MP4");
  command.flag("--panorama", options->content.panorama,
               "all directions in an equirectangular picture, twice as wide as high");
  command.option("--passes", options->content.passes,
                 "channels of an OpenEXR picture, of color, alpha, depth, normal, node, position and light", "NAME...");
  command.flag("--separate", options->content.separate, "with --passes: a file for each, such as picture.depth.exr");
  command.option("--sheet", options->sheet, "contact sheet of all stored views; --size is that of each picture",
                 "COLUMNSxROWS");
  command.option("--at", options->at, "the scene as its keyframes move it at this time; default: as it stands",
                 "seconds");
  options->film.add_to(command);
  command.flag("--plan", options->plan, "print which passes run or are omitted, and why");
  command.flag("--audit", options->audit,
               "also render with all omitted effects, and fail if the picture differs by more than the bounds "
               "and estimates allow");
  command.option("--time", options->time, "measure the time of N frames", "N").between(1, 100000);
  command.flag("--json", options->json, "print plan and times as JSON");
  command.does([options] { render(*options); });
}

}  // namespace rebake
