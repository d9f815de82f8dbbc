#include "editor/cli/options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "editor/actions/views.h"
#include "editor/cli/terminal.h"
#include "editor/document/document.h"
#include "editor/document/project.h"
#include "editor/edits/nodes/import.h"
#include "editor/edits/support.h"
#include "editor/fields/codec.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/cameras/camera_json.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace {

template <class T>
std::vector<T> split_numbers(const std::string& text, char separator) {
  std::vector<T> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at <= end) {
    T value{};
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc() || (stop != end && *stop != separator)) return {};
    values.push_back(value);
    if (stop == end) break;
    at = stop + 1;
  }
  return values;
}

double positive(double value, const char* option) {
  if (!(value > 0) || !std::isfinite(value)) throw FieldError(option, "must be greater than 0");
  return value;
}

}  // namespace

Vec3 parse_vec3(const std::string& text, const char* option) {
  const auto values = split_numbers<double>(text, ',');
  if (values.size() != 3 || !std::isfinite(values[0] + values[1] + values[2]))
    throw FieldError(option, fmt::format("\"{}\" must be three numbers such as 0,1,2.5", text));
  return {values[0], values[1], values[2]};
}

void FolderOptions::add_to(SubcommandDescription& command) {
  std::vector<FieldInfo> fields = edit_type<Import>().fields();
  std::erase_if(fields, [](const FieldInfo& field) { return !describes_folder(field); });
  fields_.add_to(command, fields, {});
}

ReadOptions FolderOptions::read() const {
  nlohmann::json edit = fields_.object();
  edit["op"] = Import::op;
  edit["path"] = "";
  const Edit read = read_edit(edit, {});
  return {read.as<Import>()->axes, read.as<Import>()->dialect()};
}

LoadedScene load_scenes(const std::vector<std::string>& folders, const FolderOptions& how, const Progress& progress) {
  LoadedScene opened;
  Scene& scene = opened.scene;
  for (const std::string& folder : folders) {
    Scene read;
    if (is_project_file(folder)) {
      const Document document = Document::open(folder, {}, progress);
      read = document.scene();
      add_sources(opened.sources, document.history().edits());
      opened.sources.add_file(folder, "the project that is open");
    } else {
      read = read_any(folder, how.read(), progress);
      protect_input(opened.sources, folder);
    }
    add_sources(opened.sources, read);
    for (const std::string& assumption : assumptions_of(read))
      print_message(fmt::format("warning: {}: {}", folder, assumption));
    if (folders.size() == 1) {
      scene = std::move(read);
      return opened;
    }
    // As for imports: the first scene also gives the background, the ground and the light.
    if (scene.roots.empty()) {
      scene.background = read.background;
      scene.ground = read.ground;
      scene.light = read.light;
    } else if (read.light != nullptr ||
               (read.background != Scene{}.background && read.background != scene.background) ||
               (read.ground != Ground{} && read.ground != scene.ground)) {
      print_message(
          fmt::format("note: {}: its background, ground and light are not used, but those of the first scene", folder));
    }
    for (const NodePtr& root : read.roots)
      scene = with_added(scene, without_ids(*root), NodeId::none, scene.roots.size());
    for (const auto& [name, camera] : read.views) scene.views.try_emplace(name, camera);
    if (scene.camera_keys.empty()) scene.camera_keys = read.camera_keys;
  }
  return opened;
}

void ViewOptions::add_to(SubcommandDescription& command) {
  command.option("--size", size, "picture size in pixels", "WxH [800x800]");
  command.option("--eye", eye, "camera position", "x,y,z");
  command.option("--target", target, "point that the camera looks at", "x,y,z");
  command.option("--up", up, "up direction", "x,y,z [0,1,0]");
  command.option("--fov", fov, "vertical field of view", "degrees [39]");
  command.option("--near", near_plane, "near plane", "n");
  command.option("--far", far_plane, "far plane", "f");
  command.option("--camera", camera_file,
                 "JSON file with eye, target, up, fov, ortho_height, near and far; or the name of a stored view",
                 "FILE|VIEW");
  command.option("--samples", samples, "samples per pixel", "1|4|16 [4]").one_of(std::vector<int>{1, 4, 16});
  command.option("--background", background, "background in display colours, 0 to 1", "r,g,b [1,1,1]");
  command.option("--weights", weights, "decoder weights in the shader", "automatic|constants|buffer")
      .one_of(std::vector<std::string>{"automatic", "constants", "buffer"});
  command
      .option("--shading", shading, "forward shading decodes while drawing, at 1 sample only",
              "automatic|deferred|forward")
      .one_of(std::vector<std::string>{"automatic", "deferred", "forward"});
  command.option("--occlusion", occlusion, "occlusion culling", "automatic|on|off")
      .one_of(std::vector<std::string>{"automatic", "on", "off"});
  command
      .option("--texels", texels, "texels on the GPU: 8 bytes each, or coded losslessly in about half",
              "automatic|plain|coded")
      .one_of(std::vector<std::string>{"automatic", "plain", "coded"});
  command.option("--precision", precision, "decoder weights as 32-bit (full) or 16-bit (half) floats", "full|half")
      .one_of(std::vector<std::string>{"full", "half"});
}

std::pair<int, int> ViewOptions::pixels() const {
  const auto sides = split_numbers<int>(size, 'x');
  if (sides.size() != 2)
    throw FieldError("--size", fmt::format("\"{}\" must be width and height such as 800x600", size));
  if (sides[0] < 1 || sides[1] < 1) throw FieldError("--size", "must be at least 1x1");
  return {sides[0], sides[1]};
}

View ViewOptions::view(const Scene& scene) const {
  View view;
  std::tie(view.width, view.height) = pixels();
  view.samples = samples;
  const double aspect = static_cast<double>(view.width) / view.height;
  view.camera = framing_camera(scene, aspect, fov.value_or(Camera{}.fov_degrees));
  if (!camera_file.empty()) {
    if (const auto found = scene.views.find(camera_file); found != scene.views.end()) {
      view.camera = found->second;
    } else {
      try {
        view.camera = read_camera_json(nlohmann::json::parse(read_file(camera_file)));
      } catch (const nlohmann::json::exception& error) {
        throw FileError(camera_file, std::string("is not valid JSON: ") + error.what());
      } catch (const FieldError& error) {
        throw FileError(camera_file, error.what());
      }
    }
  }
  if (!target.empty()) view.camera.target = parse_vec3(target, "--target");
  if (!up.empty()) view.camera.up = parse_vec3(up, "--up");
  if (fov) {
    view.camera.fov_degrees = *fov;
    view.camera.ortho_height = 0;  // a field of view implies a perspective camera
  }
  if (!eye.empty()) {
    view.camera.eye = parse_vec3(eye, "--eye");
    // The framing's near and far planes do not fit another eye position.
    if (camera_file.empty()) view.camera.near_plane = view.camera.far_plane = 0;
  }
  if (near_plane || far_plane) {
    // If only one plane is given, the other comes from the camera file or is fitted to the scene.
    if (camera_file.empty()) view.camera.near_plane = view.camera.far_plane = 0;
    if (near_plane) view.camera.near_plane = positive(*near_plane, "--near");
    if (far_plane) view.camera.far_plane = positive(*far_plane, "--far");
  }
  view.camera = fitted(scene, view.camera, aspect);
  check(view);
  return view;
}

void ViewOptions::protect_files(SourceGuard& sources) const {
  if (std::filesystem::is_regular_file(camera_file)) sources.add_file(camera_file, "the camera file of this run");
}

RenderOptions ViewOptions::render_options() const {
  RenderOptions options;
  options.weights = weights == "constants" ? RenderOptions::Weights::constants
                    : weights == "buffer"  ? RenderOptions::Weights::buffer
                                           : RenderOptions::Weights::automatic;
  options.shading = shading == "forward"    ? RenderOptions::Shading::forward
                    : shading == "deferred" ? RenderOptions::Shading::deferred
                                            : RenderOptions::Shading::automatic;
  options.occlusion = occlusion == "on"    ? RenderOptions::Occlusion::on
                      : occlusion == "off" ? RenderOptions::Occlusion::off
                                           : RenderOptions::Occlusion::automatic;
  options.texels = texels == "plain"   ? RenderOptions::Texels::plain
                   : texels == "coded" ? RenderOptions::Texels::coded
                                       : RenderOptions::Texels::automatic;
  options.precision = precision == "half" ? RenderOptions::Precision::half : RenderOptions::Precision::full;
  return options;
}

void ViewOptions::set_background(Scene& scene) const {
  if (background.empty()) return;
  const Vec3 color = parse_vec3(background, "--background");
  if ((color.array() < 0).any() || (color.array() > 1).any())
    throw FieldError("--background", "must lie between 0 and 1");
  scene.background = color;
}

}  // namespace rebake
