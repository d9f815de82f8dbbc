#include "editor/actions/compare_photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <sstream>

#include "editor/actions/describe_action.h"
#include "editor/actions/lit.h"
#include "editor/actions/views.h"
#include "editor/document/replaced_work.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/photo_names.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "render/contact_sheet.h"
#include "render/photograph_set.h"
#include "render/picture.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr const char* table_name = "photographs.csv";
constexpr const char* table_header = "photograph,pixels,PSNR dB,SSIM,FLIP\n";
constexpr const char* sheet_name = "worst.png";

struct Row {
  std::string name;  // without extension; unique
  PhotographErrors errors;
  Image triptych;  // photograph, picture, FLIP; small enough for the sheet
};

// Photograph, picture and error beside each other.
Image triptych_of(const Photograph& photograph, const Image& picture, const PhotographErrors& errors) {
  return contact_sheet({photograph.image, picture, error_colors(errors.map, picture.width, picture.height)}, 3, 0,
                       {0, 0, 0});
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

std::string table_of(const std::vector<Row>& rows) {
  std::string text = table_header;
  for (const Row& row : rows)
    text += fmt::format("{},{},{:.4f},{:.5f},{:.5f}\n", quoted(row.name), row.errors.pixels, row.errors.psnr_db,
                        row.errors.ssim, row.errors.flip);
  return text;
}

// Whether a text is such a table, to which nobody added anything.
bool is_table(const std::string& text) {
  if (!text.starts_with(table_header)) return false;
  static const std::regex row(R"(".*",\d+(,[-+.\w]+){3})");
  std::istringstream lines(text.substr(std::string_view(table_header).size()));
  for (std::string line; std::getline(lines, line);)
    if (line.size() > 5000 || !std::regex_match(line, row)) return false;
  return true;
}

// The files that are written. Throws FileError if one exists that this action did not write.
void check_output(const fs::path& folder, const std::vector<std::string>& names, const SourceGuard& sources) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) throw FileError(folder, "is not a folder");
  for (const std::string& name : names) {
    const fs::path file = folder / (name + ".png");
    sources.check_file(file);
    refuse_replacing_work(file);
    refuse_replacing_captured(file);
    if (fs::exists(fs::symlink_status(file, error)) && (fs::is_symlink(file, error) || !is_rendered_picture(file)))
      throw FileError(file,
                      "exists and was not made by Rebake, was changed since, is of an earlier build, or is a link; "
                      "choose another folder");
  }
  const fs::path table = folder / table_name;
  sources.check_file(table);
  if (fs::is_symlink(table, error) || (fs::exists(table, error) && !is_table(read_file(table))))
    throw FileError(table, "exists and is not a table of this comparison, or is a link; choose another folder");
}

Image halved(const Image& image) {
  Image half{image.width / 2, image.height / 2, {}, {}};
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x)
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int k = 0; k < 4; ++k)
          sum += image.rgb[static_cast<std::size_t>(3 * ((2 * y + k / 2) * image.width + 2 * x + k % 2) + c)];
        half.rgb.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
      }
  return half;
}

// Halved until it fits on the sheet. All photographs together would not fit into memory at full size.
Image for_sheet(Image picture) {
  constexpr int widest = 1800;
  while (picture.width > widest) picture = halved(picture);
  return picture;
}

// The worst views below each other.
Image sheet_of(std::vector<Row> rows, int count) {
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.errors.psnr_db < b.errors.psnr_db; });
  rows.resize(std::min(rows.size(), static_cast<std::size_t>(count)));
  int width = 0, height = 0;
  std::vector<Image> pictures;
  for (Row& row : rows) {
    width = std::max(width, row.triptych.width);
    height = std::max(height, row.triptych.height);
    pictures.push_back(std::move(row.triptych));
  }
  for (Image& picture : pictures) {
    Image padded{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), 255), {}};
    for (int y = 0; y < picture.height; ++y)
      std::copy_n(&picture.rgb[static_cast<std::size_t>(3 * y * picture.width)], 3 * picture.width,
                  &padded.rgb[static_cast<std::size_t>(3 * y * width)]);
    picture = std::move(padded);
  }
  return contact_sheet(pictures, 1, 8, {255, 255, 255});
}

}  // namespace

std::vector<fs::path> ComparePhotographsAction::input_files(const nlohmann::json& object) {
  const auto cameras = object.find("cameras");
  if (cameras == object.end() || !cameras->is_string()) return {};
  const auto format = object.find("format");
  return files_with_cameras(
      cameras->get<std::string>(),
      format == object.end() || !format->is_string() || *format == "auto" ? "" : format->get<std::string>());
}

void run(Session& session, const ComparePhotographsAction& action) {
  if (action.cameras.empty()) throw FieldError("cameras", "is empty");
  if (!(std::isfinite(action.scale) && action.scale > 0)) throw FieldError("scale", "must be a number above 0");
  if (action.worst < 1 || action.worst > 100) throw FieldError("worst", "must lie between 1 and 100");
  if (action.min_psnr && std::isnan(*action.min_psnr)) throw FieldError("min_psnr", "must be a number (dB)");
  const Scene& scene = session.scene();
  std::vector<std::string> notes, dropped, masked;
  const std::vector<PhotoCamera> cameras =
      read_cameras(PhotographSource{action.cameras, action.format.name, action.world, action.scale}, notes);
  const std::vector<Camera> views = views_of(cameras, dropped);
  for (const fs::path& file : files_with_cameras(action.cameras, action.format.name))
    session.document.protect_file(file, "a file of the capture");
  for (const std::string& note : notes) session.say(fmt::format("warning: {}: {}", action.cameras, note));
  std::vector<std::string> names = photo_names(cameras);
  // The sheet has this name.
  for (std::string& name : names)
    while (name == fs::path(sheet_name).stem() || std::count(names.begin(), names.end(), name) > 1)
      name += "-photograph";
  const SourceGuard sources = session.document.sources();
  if (!action.out.empty()) {
    std::vector<std::string> files = names;
    files.emplace_back(fs::path(sheet_name).stem().string());
    check_output(action.out, files, sources);
    std::error_code error;
    fs::create_directories(action.out, error);
    if (error) throw FileError(action.out, "cannot be created: " + error.message());
  }
  const Lighting lighting = lit(scene, session.progress);
  std::vector<Row> rows;
  std::size_t resampled = 0, missing = 0;
  std::string first_missing;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    session.progress.at(fmt::format("comparing photograph {} of {}", k + 1, cameras.size()),
                        static_cast<double>(k) / static_cast<double>(cameras.size()));
    const fs::path folder = capture_folder(action.cameras);
    if (photograph_at(folder, cameras[k].name).empty()) {
      if (missing++ == 0) first_missing = cameras[k].name;
      continue;
    }
    const Photograph photograph = read_photograph(cameras[k], views[k], folder, scene.background);
    if (std::find(photograph.valid.begin(), photograph.valid.end(), 1) == photograph.valid.end()) {
      masked.push_back(cameras[k].name);
      continue;
    }
    resampled += photograph.resampled ? 1 : 0;
    const View view =
        resolve_view(scene, photograph.camera, "", photograph.image.width, photograph.image.height, action.samples);
    Image picture = session.renderer().render(scene, view, {}, &lighting);
    if (action.gain) picture = with_gain(picture, exposure_gain(photograph, picture));
    Row row{names[k], errors_against(photograph, picture), {}};
    if (!action.out.empty()) {
      row.triptych = triptych_of(photograph, picture, row.errors);
      check_output(action.out, {row.name}, sources);  // it may have appeared since
      write_picture(row.triptych, fs::path(action.out) / (row.name + ".png"), sources);
      row.triptych = for_sheet(std::move(row.triptych));
    }
    row.errors.map = {};
    rows.push_back(std::move(row));
  }
  if (missing > 0)
    session.say(fmt::format("warning: {} of {} missing, the first is \"{}\"", missing,
                            counted(cameras.size(), "photograph"), first_missing));
  if (!masked.empty())
    session.say(fmt::format("warning: masks leave out all of {}, the first is \"{}\"",
                            counted(masked.size(), "photograph"), masked.front()));
  if (rows.empty()) throw FileError(action.cameras, "none of its photographs exists and shows something");
  if (resampled > 0)
    session.say(fmt::format("note: {} resampled without distortion and off-centre principal points",
                            counted(resampled, "photograph was", "photographs were")));
  double psnr = 0, ssim = 0, flip = 0;
  for (const Row& row : rows) {
    session.report(fmt::format("{}: {:.2f} dB, SSIM {:.4f}, FLIP {:.4f}", row.name, row.errors.psnr_db, row.errors.ssim,
                               row.errors.flip));
    psnr += row.errors.psnr_db / static_cast<double>(rows.size());
    ssim += row.errors.ssim / static_cast<double>(rows.size());
    flip += row.errors.flip / static_cast<double>(rows.size());
  }
  session.say(fmt::format("mean of {}{}: {:.2f} dB, SSIM {:.4f}, FLIP {:.4f}", counted(rows.size(), "photograph"),
                          action.gain ? " after a gain per channel" : "", psnr, ssim, flip));
  if (!action.out.empty()) {
    write_file_atomically(fs::path(action.out) / table_name, table_of(rows), sources);
    check_output(action.out, {fs::path(sheet_name).stem().string()}, sources);  // it may have appeared since
    write_picture(sheet_of(std::move(rows), action.worst), fs::path(action.out) / sheet_name, sources);
    session.outputs.push_back(action.out);
    session.say(fmt::format("wrote the comparison to {}; {} shows the worst", action.out, sheet_name));
  }
  if (action.min_psnr && !(psnr >= *action.min_psnr)) session.below_requested_psnr = true;
}

REBAKE_DESCRIBE_ACTION(
    ComparePhotographsAction,
    "Compares the scene with photographs: PSNR, SSIM and FLIP of each, and pictures of the errors.",
    (auto& action, auto& visit) {
      visit("cameras", action.cameras, Need::required,
            "camera file of the photographs, or the folder of a capture (transforms.json, COLMAP, poses_bounds.npy, "
            "camera_path.json)");
      visit("format", action.format, Need::optional, "format of the camera file; auto: recognised");
      visit("world", action.world, Need::optional, "axis that points up in the camera file, as for import_views");
      visit("scale", action.scale, Need::optional, "factor of the cameras' positions");
      visit("out", action.out, Need::optional,
            "folder for a table and, per photograph, a picture of it, the scene and the error; default: none");
      visit("worst", action.worst, Need::optional, "number of photographs on the sheet worst.png");
      visit("samples", action.samples, Need::optional, "samples per pixel: 1, 4 or 16");
      visit("gain", action.gain, Need::optional,
            "first bring each picture to the exposure and white balance of its photograph");
      visit("min_psnr", action.min_psnr, Need::optional, "required mean PSNR in dB; exit code 4 below it");
    })

}  // namespace rebake
