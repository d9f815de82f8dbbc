#include "render/compare.h"

#include <fmt/format.h>
#include <algorithm>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/actions/compare_photographs.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_formats.h"

namespace rebake {

namespace {

struct Comparison {
  std::string a, b;
  int tolerance = 2;
  double min_psnr = 0;
  bool json = false;
  ComparePhotographsAction photographs;
  std::string world;  // empty: as usual for the format
  FolderOptions reading;
};

bool see_through(const Image& picture) {
  return std::any_of(picture.alpha.begin(), picture.alpha.end(), [](std::uint8_t alpha) { return alpha < 255; });
}

void compare_pictures(const Comparison& options) {
  if (!options.photographs.out.empty()) throw FieldError("-o", "applies to --photos only");
  if (options.b.empty()) throw FieldError("b", "is missing: name a second picture, or photographs with --photos");
  const Image a = read_image(options.a, AlphaChannel::keep), b = read_image(options.b, AlphaChannel::keep);
  if (see_through(a) || see_through(b)) write_stderr("note: only colours are compared, not opacity\n");
  const Difference d = compare(a, b, options.tolerance);
  if (options.json) {
    nlohmann::json out = {{"ssim", d.ssim},
                          {"largest", d.largest},
                          {"largest_at", {d.x, d.y}},
                          {"share_beyond", d.share_beyond},
                          {"tolerance", options.tolerance}};
    out["psnr_db"] = std::isinf(d.psnr_db) ? nlohmann::json() : nlohmann::json(d.psnr_db);
    fmt::print("{}\n", out.dump(1));
  } else {
    fmt::print("PSNR     {}\n", std::isinf(d.psnr_db) ? "equal" : fmt::format("{:.2f} dB", d.psnr_db));
    fmt::print("SSIM     {:.5f}\nlargest  {}/255{}\nbeyond   {:.4f} % of pixels differ by more than {}/255\n", d.ssim,
               d.largest, d.largest > 0 ? fmt::format(" at pixel {}, {}", d.x, d.y) : "", d.share_beyond * 100,
               options.tolerance);
  }
  if (d.psnr_db < options.min_psnr) throw ExitWith{3};
}

void compare_with_photographs(const Comparison& options) {
  if (!options.b.empty()) throw FieldError("b", "cannot be combined with --photos");
  if (options.json) throw FieldError("--json", "cannot be combined with --photos; -o writes a table");
  Session session;
  session.progress = progress_bar();
  session.say = print_message;
  LoadedScene opened = load_scenes({options.a}, options.reading, session.progress);
  session.document = Document(std::move(opened.scene));
  session.document.protect_all(opened.sources);
  ComparePhotographsAction action = options.photographs;
  if (!options.world.empty()) action.world = options.world == "y_up" ? WorldUp::y : WorldUp::z;
  if (options.min_psnr != 0) action.min_psnr = options.min_psnr;
  run(session, action);
  if (session.below_requested_psnr) throw ExitWith{3};
}

}  // namespace

void describe_compare(SubcommandDescription& command) {
  auto options = std::make_shared<Comparison>();
  command.option("a", options->a, "picture; with --photos a scene", "A.png|SCENE").required();
  command.option("b", options->b, "picture of the same size", "B.png");
  command
      .option("--tolerance", options->tolerance, "largest difference per channel that counts as equal, in 1/255",
              "N [2]")
      .between(0, 255);
  command.option("--min-psnr", options->min_psnr, "minimum PSNR; exit code 3 below it", "dB");
  command.flag("--json", options->json, "print JSON, for two pictures; psnr_db is null for equal ones");
  command.option("--photos", options->photographs.cameras,
                 "compare the scene with the photographs of this camera file or capture", "CAMERAS");
  command.option("-o,--out", options->photographs.out,
                 "photos: folder for a table and a picture of each photograph, the scene and the error", "FOLDER");
  command.option("--scale", options->photographs.scale, "photos: factor of the cameras' positions", "FACTOR [1]");
  command.option("--world", options->world, "photos: axis that points up in the camera file", "y_up|z_up")
      .one_of(std::vector<std::string>{"y_up", "z_up"});
  command.option("--camera-format", options->photographs.format.name, "photos: format of the camera file", "FORMAT")
      .one_of(camera_format_names());
  command.option("--worst", options->photographs.worst, "photos: number of photographs on the sheet worst.png",
                 "N [8]");
  command.option("--samples", options->photographs.samples, "photos: samples per pixel", "1|4|16 [4]");
  command.flag("--gain", options->photographs.gain,
               "photos: first bring each picture to the exposure and white balance of its photograph");
  options->reading.add_to(command);
  command.does([options] {
    if (std::isnan(options->min_psnr)) throw FieldError("--min-psnr", "must be a number (dB)");
    if (options->photographs.cameras.empty())
      compare_pictures(*options);
    else
      compare_with_photographs(*options);
  });
}

}  // namespace rebake
