#include "editor/actions/export_action.h"

#include "editor/actions/describe_action.h"
#include "editor/actions/lit.h"
#include "editor/actions/output_state.h"
#include "editor/actions/plain_scene.h"
#include "editor/actions/views.h"
#include "editor/edits/stored_view.h"
#include "editor/edits/support.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/images/rgba_png.h"
#include "render/compare.h"
#include "render/picture.h"

namespace rebake {

namespace {

// Difference between pictures of `other` (unlit) and `scene` (with `lighting`, if not null), 400×400 pixels from four
// sides.
struct PictureLoss {
  double mean_db = 0, worst_db = 100;  ///< PSNR over all pictures and of the worst one, at most 100
  int largest = 0;                     ///< largest difference of a channel, 0 … 255
  double share_beyond = 0;             ///< share of pixels that differ by more than 2/255
};
PictureLoss picture_loss(Session& session, const Scene& scene, const Scene& other, const Lighting* lighting = nullptr) {
  const Camera front = framing_camera(scene, 1);
  PictureLoss loss;
  double squares = 0;
  constexpr int sides = 4;
  for (int side = 0; side < sides; ++side) {
    View view;
    view.width = view.height = 400;
    view.camera = front;
    view.camera.eye = front.target + Eigen::AngleAxisd(side * 2 * std::numbers::pi / sides, front.up.normalized()) *
                                         (front.eye - front.target);
    Renderer& renderer = session.renderer();
    const Difference difference = compare(renderer.render(scene, view, {}, lighting), renderer.render(other, view), 2);
    const double psnr = std::min(100.0, difference.psnr_db);
    squares += std::pow(10, -psnr / 10) / sides;
    loss.worst_db = std::min(loss.worst_db, psnr);
    loss.largest = std::max(loss.largest, difference.largest);
    loss.share_beyond += difference.share_beyond / sides;
  }
  loss.mean_db = -10 * std::log10(squares);
  return loss;
}

// Reports the loss in the words of `describe`, or why it cannot be measured without OpenGL.
template <class Describe>
void report_loss(Session& session, const Scene& scene, const Scene& other, const Describe& describe,
                 const Lighting* lighting = nullptr) {
  try {
    session.say("note: " + describe(picture_loss(session, scene, other, lighting)));
  } catch (const DeviceError& error) {
    session.say(fmt::format("note: the loss cannot be measured here: {}", error.what()));
  }
}

// Number of folders that the visible objects need if none is rotated: one for each decoder, and for each file layout
// unless all get the same.
std::size_t folders_without_rotations(const Scene& scene, bool one_layout) {
  std::vector<const BakedObject*> found;
  const auto same_folder = [&](const BakedObject& a, const BakedObject& b) {
    return *a.decoder == *b.decoder && (one_layout || a.layout == b.layout);
  };
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object && std::none_of(found.begin(), found.end(), [&](const BakedObject* one) {
          return same_folder(*one, *placed.node->object);
        }))
      found.push_back(placed.node->object.get());
  return found.size();
}

// Reports the loss by omitted light corrections, which the format cannot store.
void report_lost_light(Session& session, const Scene& scene) {
  const Lighting lighting = lit(session.scene(), session.progress);
  if (std::none_of(lighting.maps.begin(), lighting.maps.end(), [](const auto& entry) {
        return std::any_of(entry.second.begin(), entry.second.end(), [](const auto& map) { return map != nullptr; });
      }))
    return;
  report_loss(
      session, scene, scene,
      [](const PictureLoss& loss) {
        return fmt::format(
            "the folder does not contain light that follows edits: colours are as baked, {:.1f} dB PSNR from the scene "
            "over four side views, {:.1f} dB at worst; the option plain fits them",
            loss.mean_db, loss.worst_db);
      },
      &lighting);
}

// Reports differences between pictures of the scene and of the exported one.
void report_losses(Session& session, const Scene& scene, const ExportAction& action, const ExportReport& report) {
  std::vector<std::string> bent;
  const Scene flat = without_bends(scene, &bent);
  if (!bent.empty())
    report_loss(session, scene, flat, [](const PictureLoss& loss) {
      return fmt::format("the result has {:.1f} dB PSNR over four side views, {:.1f} dB at worst", loss.mean_db,
                         loss.worst_db);
    });
  // Within one decoder, samples are averaged before decoding; across decoders, after. So pixels differ at edges between
  // parts that were split because of different rotations.
  if (!report.one_folder && bent.empty() &&
      report.folders > folders_without_rotations(scene, action.layout.has_value()))
    report_loss(session, scene, read_any(action.out, Axes::y_up, session.progress), [](const PictureLoss& loss) {
      return fmt::format(
          "parts with different rotations now have separate decoders, so samples at their edges are averaged "
          "differently: over "
          "four "
          "sides, {:.2g} % of pixels differ by more than 2/255, at most by {}/255 ({:.1f} dB)",
          loss.share_beyond * 100, loss.largest, loss.mean_db);
    });
}

void export_plain(Session& session, const Scene& scene, const ExportAction& action) {
  if (!action.view.empty()) throw FieldError("view", "applies to glTF only");
  if (!action.compress.empty()) throw FieldError("compress", "applies to glTF only");
  if (action.format.name != FormatName().name) throw FieldError("plain", "is available for the MobileNeRF format only");
  const FuseOptions options = fuse_options(scene, action);
  // Reports unwritable outputs before the long computation.
  check_can_export(action.out, session.document.sources());
  const OutputState before(action.out);
  if (!action.report.empty()) {
    session.document.sources().check_file(action.report);
    const std::filesystem::path folder = absolute_path(action.report).parent_path();
    if (!std::filesystem::is_directory(folder)) throw FieldError("report", "folder does not exist: " + folder.string());
    if (std::filesystem::is_directory(action.report)) throw FieldError("report", "is a folder; name a file");
    if (const std::filesystem::path inside = absolute_path(action.report).lexically_relative(absolute_path(action.out));
        !inside.empty() && *inside.begin() != "..")
      throw FieldError("report", "lies in the output folder, which is replaced; name a file elsewhere");
    check_report_path(action.report);
  }
  PlainReport report;
  const auto start = std::chrono::steady_clock::now();
  const Lighting lighting = lit(session.scene(), session.progress);
  const Scene plain = best_plain_scene(
      scene, lighting, options, [&]() -> Renderer& { return session.renderer(); },
      [&](const DeviceError& error) {
        session.say(fmt::format("note: pictures cannot be compared here: {}", error.what()));
      },
      report, session.progress, action.picture_size);
  if (before.has_other_content())
    throw FileError(action.out,
                    "was written by something else during the computation, so it is not replaced; choose another name");
  const ExportReport written =
      export_scene(plain, action.out, {options.layout, session.document.sources(), action.page_size}, session.progress);
  session.wrote_scene(action.out, true);
  for (const std::string& note : written.notes) session.say("note: " + note);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const std::string& line : lines_of(report)) session.say(line);
  const PlainReport::NodeQuality worst = worst_object(report);
  const double reached = report.exact ? 100 : report.pictures_measured ? worst.psnr_db : report.texels.whole.psnr_db;
  if (reached < options.psnr_db) {
    session.say(fmt::format("note: {}{} has {:.1f} dB, less than the requested {:.1f} dB",
                            report.pictures_measured ? "in pictures " : "over its texels ",
                            report.pictures_measured && !worst.node.empty() ? worst.node : "the scene", reached,
                            options.psnr_db));
    session.below_requested_psnr = session.below_requested_psnr || action.psnr.has_value();
  }
  if (!action.report.empty()) {
    check_report_path(action.report);  // once more: it may have appeared since
    write_file_atomically(action.report, to_json(report).dump(2) + "\n", session.document.sources());
    session.outputs.push_back(action.report);
  }
  session.say(fmt::format("exported {} as a plain folder", action.out));
}

// Throws FieldError if a field that only plain folders have is set.
void check_not_plain(const ExportAction& action) {
  const auto refuse = [](bool given, const char* field) {
    if (given) throw FieldError(field, "is available for plain folders only: set plain too");
  };
  refuse(action.width.neurons.has_value(), "width");
  refuse(action.way.has_value(), "way");
  refuse(action.keep != "auto", "keep");
  refuse(action.psnr.has_value(), "psnr");
  refuse(action.picture_size != ExportAction().picture_size, "picture_size");
  refuse(action.seconds != 0, "seconds");
  refuse(!action.report.empty(), "report");
}

// Checks the fields that all exports have. Throws FieldError.
void check_common(const ExportAction& action) {
  if (action.out.empty()) throw FieldError("out", "is empty");
  if (action.page_size && (*action.page_size < 1 || *action.page_size > largest_png_side))
    throw FieldError("page_size", fmt::format("must lie between 1 and {}", largest_png_side));
}

}  // namespace

FuseOptions fuse_options(const Scene& scene, const ExportAction& action) {
  FuseOptions options;
  options.width = action.width.neurons;
  options.way = action.way;
  options.layout = action.layout.value_or(common_layout(scene));
  if (action.picture_size < 16 || action.picture_size > 4096)
    throw FieldError("picture_size", "must lie between 16 and 4096");
  if (action.psnr) {
    options.psnr_db = *action.psnr;
    options.until_psnr = true;
  }
  options.seconds = action.seconds;
  if (action.keep == "none") {
    options.keep = FuseOptions::Keep::none;
  } else if (action.keep != "auto") {
    const NodePtr node = find(scene, action.keep);
    if (!node)
      throw FieldError("keep", "\"" + action.keep + "\" does not exist; give the name of a node, none or auto");
    options.keep = FuseOptions::Keep::node;
    options.keep_node = node->id;
  }
  check(options);
  return options;
}

ExportReport write_export(Session& session, const ExportAction& action) {
  check_common(action);
  check_not_plain(action);
  const Format& format = format_named(action.format.name);
  std::optional<Vec3> eye;
  if (!action.view.empty()) {
    if (!action.format.name.starts_with("gltf"))
      throw FieldError("view", "applies to glTF, whose colours do not depend on the view; leave it out");
    eye = stored_view(session.scene(), action.view).eye;
  }
  const GltfCompression compression = gltf_compression(action.compress);
  if (compression.any() && !action.format.name.starts_with("gltf"))
    throw FieldError("compress", "applies to glTF only; leave it out");
  ExportReport report =
      format.write(with_only(session.scene(), action.nodes), action.out,
                   {action.layout, session.document.sources(), action.page_size, eye, compression}, session.progress);
  session.wrote_scene(action.out, true);
  return report;
}

namespace {

void export_exact(Session& session, const Scene& scene, const ExportAction& action) {
  const ExportReport report = write_export(session, action);
  for (const std::string& note : report.notes) session.say("note: " + note);
  if (!report.preserves_scene && format_named(action.format.name).has_colors) {
    report_losses(session, scene, action, report);
    report_lost_light(session, scene);
  }
  session.say(fmt::format("exported {}", action.out));
}

}  // namespace

void run(Session& session, const ExportAction& action) {
  check_common(action);
  const Scene scene = with_only(session.scene(), action.nodes);
  std::error_code error;
  const bool replaces = std::filesystem::exists(action.out, error);
  if (action.plain)
    export_plain(session, scene, action);
  else
    export_exact(session, scene, action);
  if (replaces)
    session.say(fmt::format("note: the existing {} was replaced",
                            std::filesystem::is_directory(action.out, error) ? "folder" : "file"));
}

REBAKE_DESCRIBE_ACTION(
    ExportAction,
    "Exports the scene in the MobileNeRF format (as scene.json if one folder is not exact) or another format.",
    (auto& action, auto& visit) {
      visit("out", action.out, Need::required, "folder to write, or NAME.glb for glTF");
      visit("layout", action.layout, Need::optional, "layout of the output; default: as read");
      visit("format", action.format, Need::optional, written_formats_help());
      visit("plain", action.plain, Need::optional,
            "write one folder for any scene: if no decoder represents it exactly, or light changes colours, one is "
            "fitted");
      visit("width", action.width, Need::optional,
            "plain: maximum width of the decoder's hidden layers, 4 to 256, or auto");
      visit("way", action.way, Need::optional,
            "plain: keep one decoder, fine-tune it, train a new one, or put all side by side; default: the best");
      visit("keep", action.keep, Need::optional,
            "plain: the node that stays bit for bit, none, or auto (the largest, if that is best overall)");
      visit("psnr", action.psnr, Need::optional,
            "plain: target PSNR in dB; fitting stops there. Default: 40, and all texels are fitted");
      visit("seconds", action.seconds, Need::optional, "plain: time limit of fitting in seconds; 0: none");
      visit("report", action.report, Need::optional, "plain: JSON file for the measured errors");
      visit("page_size", action.page_size, Need::optional,
            "maximum side of repacked textures in texels, 1 to 16384; larger textures are repacked too. Default: 4096, "
            "or that of the largest source texture");
      visit("picture_size", action.picture_size, Need::optional,
            "plain: side of the pictures for measuring, in pixels, 16 to 4096");
      visit("view", action.view, Need::optional,
            "gltf: colours as seen from this stored view; default: means over the directions that see them");
      visit("compress", action.compress, Need::optional,
            "gltf: quantized (16 bits), meshopt and webp, for readers that know these extensions; default: none");
      visit("nodes", action.nodes, Need::optional, "only these nodes and their children; default: all");
    })

}  // namespace rebake
