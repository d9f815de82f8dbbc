#include <fmt/format.h>
#include <getopt.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/export.h"
#include "render/compare.h"
#include "render/picture.h"
#include "samples/bakery/bake.h"

namespace {

using namespace rebake;
using namespace rebake::bakery;

constexpr int held_out_views = 20;

// Bakes a model, writes it, and renders it from memory. Returns the mean PSNR of the held-out views in dB.
double make(const Model& model, const std::filesystem::path& out, const BakeOptions& options,
            const std::filesystem::path& pictures) {
  const auto start = std::chrono::steady_clock::now();
  const RadianceField field(model);
  const auto object = bake(model, field, options, {});
  Node node;
  node.name = model.name;
  node.object = object;
  const Scene scene = with_added({}, std::move(node), NodeId::none, 0);
  export_scene(scene, out / model.name, {});
  const double bake_seconds = seconds_since(start);

  Renderer renderer;
  double sum = 0, least = 1e9;
  for (int k = 0; k < held_out_views; ++k) {
    View view;
    // Low-discrepancy cameras that differ from those of the fit.
    view.camera = model.camera((k + 0.5) / held_out_views, std::fmod(0.5 + k * 0.6180339887498949, 1.0));
    view.width = view.height = model.picture;
    const Image truth = field.trace(view.camera, view.width, view.height), drawn = renderer.render(scene, view);
    const double psnr = compare(drawn, truth, 2).psnr_db;
    sum += psnr;
    least = std::min(least, psnr);
    if (!pictures.empty() && k % 7 == 0) {
      write_picture(truth, pictures / fmt::format("{}-{}-truth.png", model.name, k), {});
      write_picture(drawn, pictures / fmt::format("{}-{}-baked.png", model.name, k), {});
    }
  }
  fmt::print(
      "{:<10} {:>7} triangles {:>8} texels  baked in {:5.1f} s  held-out views: mean {:.2f} dB, worst {:.2f} dB\n",
      model.name, object->triangle_count(), object->opaque_texel_count(), bake_seconds, sum / held_out_views, least);
  std::fflush(stdout);
  return sum / held_out_views;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr const char* usage =
      "Bakes the sample scenes and compares 20 held-out views of each with ray-traced ground truth.\n"
      "Usage: rebake_bakery -o FOLDER [--epochs N] [--pictures FOLDER] [ficus] [kettle] [courtyard] [shelf] "
      "[shelf_without_vase]\n"
      "  -o, --out FOLDER    folder for the baked scenes\n"
      "  --epochs N          training epochs (default 40)\n"
      "  --pictures FOLDER   also write some held-out views there: ground truth and baked\n"
      "Without names, all scenes are baked.\n";
  const option long_options[] = {{"out", required_argument, nullptr, 'o'},
                                 {"epochs", required_argument, nullptr, 'e'},
                                 {"pictures", required_argument, nullptr, 'p'},
                                 {"help", no_argument, nullptr, 'h'},
                                 {nullptr, 0, nullptr, 0}};
  const auto refuse = [&](const std::string& why) {
    fmt::print(stderr, "error: {}\n{}", why, usage);
    return 2;
  };
  std::string out, pictures;
  BakeOptions options;
  for (int letter; (letter = getopt_long(argc, argv, "o:h", long_options, nullptr)) != -1;) {
    if (letter == 'o') {
      out = optarg;
    } else if (letter == 'p') {
      pictures = optarg;
    } else if (letter == 'e') {
      const std::string_view text = optarg;
      const auto [end, error] = std::from_chars(text.begin(), text.end(), options.epochs);
      if (error != std::errc() || end != text.end() || options.epochs < 1)
        return refuse("--epochs must be a whole number of at least 1");
    } else if (letter == 'h') {
      fmt::print("{}", usage);
      return 0;
    } else {
      return refuse("invalid option (see above)");
    }
  }
  const std::vector<std::string> names(argv + optind, argv + argc);
  if (out.empty()) return refuse("--out FOLDER is required");
  try {
    const std::vector<Model> models{ficus(), kettle(), courtyard(), shelf(), shelf(false)};
    for (const std::string& name : names)
      if (std::none_of(models.begin(), models.end(), [&](const Model& model) { return model.name == name; }))
        return refuse("\"" + name + "\" is not a sample (ficus, kettle, courtyard, shelf, shelf_without_vase)");
    if (!pictures.empty()) std::filesystem::create_directories(pictures);
    double sum = 0;
    int count = 0;
    for (const Model& model : models) {
      if (!names.empty() && std::find(names.begin(), names.end(), model.name) == names.end()) continue;
      sum += make(model, out, options, pictures);
      ++count;
    }
    fmt::print("mean over {} sample{}: {:.2f} dB\n", count, count == 1 ? "" : "s", sum / count);
    return 0;
  } catch (const rebake::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
