#include <fmt/format.h>

#include <optional>

#include "editor/studies/dprt/dprt_gloss.h"
#include "editor/studies/dprt/dprt_measure.h"
#include "editor/studies/dprt/dprt_pictures.h"
#include "editor/studies/dprt/shape_space.h"
#include "editor/studies/dprt/transfer_methods.h"
#include "editor/studies/study.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr int published_side = 256, published_side_of_fish = 512, published_channels = 32, published_epochs = 500;

AnimatedObject object_named(const std::string& name, const StudyInput& input) {
  if (!input.dprt.meshes.empty()) return animated_files(input.dprt.meshes);
  if (name == "head") return animated_head();
  if (name == "fish") return animated_fish();
  if (name == "cloth") return cached_cloth(dprt_frames, own_folder(input, "dprt") / "cloth.frames", input.progress);
  throw FieldError("object", fmt::format("\"{}\" is not known (known: head, fish, cloth, space, all)", name));
}

// Held-out frames of which the deviations from the mean frame are 1.5 times as large.
std::vector<TestFrame> frames_beyond(const TracedFrames& traced, const Progress& progress) {
  constexpr double beyond = 1.5;
  constexpr std::size_t count = 10;
  std::vector<Vec3> mean(traced.rest.vertices.size(), Vec3::Zero());
  for (const std::vector<Vec3>& frame : traced.frames)
    for (std::size_t t = 0; t < mean.size(); ++t) mean[t] += frame[t] / static_cast<double>(traced.frames.size());
  std::vector<TestFrame> tests;
  const std::size_t step = std::max<std::size_t>(1, traced.frames.size() / 10 / count) * 10;
  for (std::size_t k = 5; k < traced.frames.size() && tests.size() < count; k += step) {
    progress.at("frames beyond the range", static_cast<double>(tests.size()) / count);
    std::vector<Vec3> places = traced.frames[k];
    for (std::size_t t = 0; t < mean.size(); ++t) places[t] = mean[t] + beyond * (places[t] - mean[t]);
    tests.push_back(test_frame(traced, std::move(places)));
  }
  return tests;
}

// The sizes of a run: those of the options where given, else the published or the usual ones.
DprtOptions sizes_of(const DprtOptions& wanted, const std::string& object) {
  DprtOptions options = wanted;
  const auto choose = [&](int& size, int published, int usual) {
    if (size == 0) size = wanted.paper ? published : usual;
  };
  choose(options.side, object == "fish" ? published_side_of_fish : published_side, 64);
  choose(options.channels, published_channels, 16);
  choose(options.epochs, published_epochs, 60);
  return options;
}

// Frames, coefficients, and the images and targets of both networks' training sets, which exist one after the other.
double gigabytes_of(const DprtOptions& options, std::size_t frames) {
  constexpr double of_texel = sizeof(Vec3) + sizeof(float) * (sh::count + unet_inputs + unet_outputs) +
                              sizeof(float) * sh::count;  // what the second training set keeps besides
  return static_cast<double>(frames) * of_texel * options.side * options.side / 1e9;
}

void say_sizes(const StudyInput& input, const std::string& name, const DprtOptions& sizes, std::size_t frames) {
  input.say(fmt::format("{}: {}² texels, {} channels, {} epochs; about {:.1f} GB of memory", name, sizes.side,
                        sizes.channels, sizes.epochs, gigabytes_of(sizes, frames)));
}

void study_object(const StudyInput& input, const std::string& name, StudyTable& table) {
  const DprtOptions options = sizes_of(input.dprt, name);
  const AnimatedObject object = object_named(name, input);
  say_sizes(input, object.name, options, object.frames.size());
  const fs::path own = own_folder(input, "dprt");
  const TracedFrames traced = traced_frames(object, options.side, training_rays,
                                            own / (object.name + fmt::format("-{}", options.side)), input.progress);
  say_layout(input, object.name, traced);
  const std::vector<TestFrame> tests = held_out_frames(traced), beyond = frames_beyond(traced, input.progress);
  std::vector<DprtMethod> methods = rest_methods(traced, truth_rays_per_ray * training_rays);
  std::optional<DprtMethod> published = add_learned_methods(input, options, object.name, traced, methods);
  const GlossyTest glossy(traced, tests);
  for (const int rays : {16, 64, 256, 1024}) methods.push_back(traced_method(traced, rays));
  const double every_frame = static_cast<double>(traced.frames.size() - tests.size()) *
                             static_cast<double>(traced.rest.vertices.size()) * sh::count * sizeof(float);
  for (const DprtMethod& method : methods) {
    const double milliseconds = milliseconds_of(method, traced, tests.front(), input.frames);
    table.rows.push_back(
        {object.name + ": " + method.name,
         {milliseconds, percent_off(method, tests, input.progress), percent_off(method, beyond, input.progress),
          glossy.percent_off(method), method.loss, method.held_out_loss, method.parameters / 1e6, method.bytes / 1e6,
          method.bytes > 0 ? every_frame / method.bytes : 0, method.minutes}});
  }
  if (published) {
    const TestFrame& shown = tests[tests.size() / 2];
    const std::vector<float> found = published->predict(shown.sites, shown.places);
    write_dprt_picture(input, traced, shown.places, shown.truth, found, own / fmt::format("{}.png", object.name));
    write_glossy_picture(input, traced, shown.places, shown.sites.sites, shown.truth, found,
                         own / fmt::format("{}-glossy.png", object.name));
  }
}

}  // namespace

StudyTable study_dprt(const StudyInput& input) {
  StudyTable table{{"milliseconds", "error % on held-out frames", "error % at 1.5 times the deformation",
                    "error % of glossy reflections", "L1 loss", "held-out L1 loss", "million parameters", "megabytes",
                    "compression of the training frames", "minutes of training"},
                   {},
                   0,
                   1,
                   true,
                   true};
  const DprtOptions& options = input.dprt;
  if (const int step = unet_side_step(UnetForm::added); options.side % step != 0)
    throw FieldError("--side", fmt::format("must be a multiple of {}", step));
  if (options.channels % 8 != 0) throw FieldError("--channels", "must be a multiple of 8");
  input.say(
      "published: 256² texels (fish: 512²), 32 channels, 500 to 1000 epochs (--paper); about 20 minutes per object "
      "with "
      "the default sizes on two cores");
  if (options.object == "space") {
    const DprtOptions sizes = sizes_of(options, "space");
    say_sizes(input, "space", sizes, dprt_frames);
    study_shape_space(input, sizes, table);
    return table;
  }
  if (options.object == "all" && options.meshes.empty())
    for (const char* name : {"head", "fish", "cloth"}) study_object(input, name, table);
  else
    study_object(input, options.object, table);
  return table;
}

}  // namespace rebake
