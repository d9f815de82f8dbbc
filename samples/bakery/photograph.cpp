#include <fmt/format.h>
#include <getopt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/cameras/transforms_json.h"
#include "mesh_ops/scene/photo_camera.h"
#include "mesh_ops/scene/scene_light.h"
#include "samples/bakery/field.h"

namespace {

namespace fs = std::filesystem;
using namespace rebake;
using namespace rebake::bakery;

struct Options {
  std::string model, out;
  int views = 100, held_out = 20, side = 128;
  double exposure = 0;  // stops, standard deviation
  unsigned seed = 1;
};

// The photograph in linear light times 2^stops.
Image exposed(Image image, double stops) {
  for (std::uint8_t& value : image.rgb)
    value = static_cast<std::uint8_t>(
        std::lround(255 * to_display(std::min(1.0, std::exp2(stops) * to_linear(value / 255.0)))));
  return image;
}

// Cameras of a low-discrepancy sequence; those that are held out lie between the others.
Camera camera_of(const Model& model, int k, int count, bool held_out) {
  constexpr double golden = 0.6180339887498949;
  return model.camera((k + (held_out ? 0.25 : 0.5)) / count, std::fmod((held_out ? 0.3 : 0.5) + k * golden, 1.0));
}

void photograph(const Model& model, const Options& options) {
  const RadianceField field(model);
  std::mt19937 random(options.seed);
  std::normal_distribution<double> stops(0, 1);
  for (const bool held_out : {false, true}) {
    const int count = held_out ? options.held_out : options.views;
    const std::string part = held_out ? "test" : "train";
    fs::create_directories(fs::path(options.out) / part);
    std::vector<PhotoCamera> cameras;
    for (int k = 0; k < count; ++k) {
      const Camera camera = camera_of(model, k, count, held_out);
      Image image = field.trace(camera, options.side, options.side);
      if (options.exposure > 0 && !held_out) image = exposed(std::move(image), options.exposure * stops(random));
      const std::string name = fmt::format("{}/{:04}.png", part, k);
      write_picture(image, fs::path(options.out) / name, {});
      cameras.push_back(photo_camera(camera, name, options.side, options.side));
      fmt::print("\r{} {} of {}", part, k + 1, count);
      std::fflush(stdout);
    }
    // z points up in these files, as nerfstudio and Blender write them.
    write_file_atomically(fs::path(options.out) / fmt::format("transforms_{}.json", part),
                          transforms_text(from_y_up(std::move(cameras), WorldUp::z)), {});
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  constexpr const char* usage =
      "Photographs a procedural sample from known cameras: transforms_train.json and transforms_test.json with\n"
      "ray-traced pictures (64 rays per pixel, over white).\n"
      "Usage: rebake_photograph MODEL -o FOLDER [--views N] [--held-out N] [--side PIXELS] [--exposure STOPS]\n"
      "  MODEL               ficus, kettle, courtyard, shelf or shelf_without_vase\n"
      "  -o, --out FOLDER    new or empty folder for the photographs\n"
      "  --views N           photographs for training (default 100)\n"
      "  --held-out N        photographs for tests (default 20)\n"
      "  --side PIXELS       width and height (default 128)\n"
      "  --exposure STOPS    standard deviation of the exposures of training photographs (default 0)\n";
  const option long_options[] = {{"out", required_argument, nullptr, 'o'},
                                 {"views", required_argument, nullptr, 'v'},
                                 {"held-out", required_argument, nullptr, 't'},
                                 {"side", required_argument, nullptr, 's'},
                                 {"exposure", required_argument, nullptr, 'e'},
                                 {"help", no_argument, nullptr, 'h'},
                                 {nullptr, 0, nullptr, 0}};
  const auto refuse = [&](const std::string& why) {
    fmt::print(stderr, "error: {}\n{}", why, usage);
    return 2;
  };
  Options options;
  const auto number = [](const char* text, auto& value, auto least, auto most) {
    const std::string_view all = text;
    const auto [end, error] = std::from_chars(all.begin(), all.end(), value);
    return error == std::errc() && end == all.end() && value >= least && value <= most;
  };
  for (int letter; (letter = getopt_long(argc, argv, "o:h", long_options, nullptr)) != -1;) {
    bool valid = true;
    if (letter == 'o')
      options.out = optarg;
    else if (letter == 'v')
      valid = number(optarg, options.views, 1, 100000);
    else if (letter == 't')
      valid = number(optarg, options.held_out, 1, 100000);
    else if (letter == 's')
      valid = number(optarg, options.side, 8, 8192);
    else if (letter == 'e')
      valid = number(optarg, options.exposure, 0.0, 8.0);
    else if (letter == 'h')
      return fmt::print("{}", usage), 0;
    else
      return refuse("invalid option (see above)");
    if (!valid) return refuse(fmt::format("\"{}\" is out of range", optarg));
  }
  if (optind + 1 != argc) return refuse("one MODEL is required");
  if (options.out.empty()) return refuse("--out FOLDER is required");
  try {
    const std::vector<Model> models{ficus(), kettle(), courtyard(), shelf(), shelf(false)};
    const auto model =
        std::find_if(models.begin(), models.end(), [&](const Model& one) { return one.name == argv[optind]; });
    if (model == models.end()) return refuse(fmt::format("\"{}\" is not a sample", argv[optind]));
    std::error_code error;
    if (fs::exists(options.out) && !fs::is_empty(options.out, error))
      throw FileError(options.out, "exists and is not empty; choose another folder");
    photograph(*model, options);
    return 0;
  } catch (const rebake::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
