#include "editor/studies/dprt/dprt_measure.h"

#include <fmt/format.h>

#include <cmath>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/light/learned/unet_trainer.h"

namespace rebake {

namespace fs = std::filesystem;

std::vector<TestFrame> held_out_frames(const TracedFrames& traced) {
  std::vector<TestFrame> tests;
  for (std::size_t k = 0; k < traced.frames.size(); ++k)
    if (is_held_out(k))
      tests.push_back({traced.frames[k], sites_of(traced.rest, traced.frames[k]), traced.transfer[k]});
  return tests;
}

TestFrame test_frame(const TracedFrames& traced, std::vector<Vec3> places) {
  TestFrame test;
  test.sites = sites_of(traced.rest, places);
  test.truth = traced_planes(traced.rest, places, truth_rays_per_ray * training_rays);
  test.places = std::move(places);
  return test;
}

double milliseconds_of(const DprtMethod& method, const TracedFrames& traced, const TestFrame& test, int repeats) {
  using Needs = DprtMethod::Needs;
  const std::vector<Mat3> none(test.places.size(), Mat3::Identity());
  return median_milliseconds(repeats, [&] {
    if (method.needs == Needs::positions)
      method.predict(test.sites, test.places);
    else if (method.needs == Needs::normals)
      method.predict({none, vertex_sites(traced.rest, {test.places, traced.rest.faces}, none)}, test.places);
    else
      method.predict(sites_of(traced.rest, test.places), test.places);
  });
}

double percent_off(const DprtMethod& method, const std::vector<TestFrame>& tests, const Progress& progress) {
  double off = 0, all = 0;
  for (const TestFrame& test : tests) {
    progress.at(method.name, 0.95);
    const std::vector<float> found = method.predict(test.sites, test.places);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const double difference = static_cast<double>(found[k]) - static_cast<double>(test.truth[k]);
      off += difference * difference;
      all += static_cast<double>(test.truth[k]) * static_cast<double>(test.truth[k]);
    }
  }
  return 100 * std::sqrt(off / all);
}

void say_layout(const StudyInput& input, const std::string& name, const TracedFrames& traced) {
  input.say(fmt::format("{}: {} frames of {}² texels, laid out by {} weights, {:.0f} % of the surface undersampled",
                        name, traced.frames.size(), traced.side, traced.mean_value ? "mean value" : "harmonic",
                        100 * traced.undersampled));
}

std::optional<DprtMethod> add_learned_methods(const StudyInput& input, const DprtOptions& options,
                                              const std::string& name, const TracedFrames& traced,
                                              std::vector<DprtMethod>& methods) {
  for (DprtMethod& method : linear_methods(traced, input.progress)) methods.push_back(std::move(method));
  if (!can_train_unet()) {
    input.say("warning: LibTorch is missing, so there are no networks in the table");
    return {};
  }
  // Checkpoints of other data have other names.
  const std::string base =
      (own_folder(input, "dprt") / fmt::format("{}-{}-{}-{}-{:08x}", name, options.side, options.channels,
                                               options.epochs, traced.hash & 0xFFFFFFFFU))
          .string();
  DprtCurve curve;
  const DprtMethod published = published_network(traced, options, base, curve, input.progress);
  methods.push_back(published);
  methods.push_back(rotated_network(traced, options, base, input.progress));
  PlottedLine training{"training frames", {}}, held_out{"held-out frames", {}};
  for (const auto& [epoch, loss, held_out_loss, minutes] : curve) {
    training.points.push_back({epoch, loss});
    held_out.points.push_back({epoch, held_out_loss});
  }
  if (curve.size() > 1) try {
      write_line_plot(name + fmt::format(", {}² texels, {} channels", options.side, options.channels), "epoch",
                      "L1 loss", true, {training, held_out}, (own_folder(input, "dprt") / (name + "-curve")).string());
    } catch (const Error& error) {
      input.say(fmt::format("warning: the learning curve was not plotted: {}", error.what()));
    }
  return published;
}

}  // namespace rebake
