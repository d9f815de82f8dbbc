#include "editor/studies/dprt/transfer_methods.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/light/learned/dprt_ranges.h"
#include "mesh_ops/light/learned/learned_transfer.h"
#include "mesh_ops/light/learned/unet_trainer.h"
#include "mesh_ops/light/learned/unet_transfer.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

using Planes = std::vector<float>;

double minutes_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / 60;
}

std::vector<sh::Coefficients> unpacked(const Planes& planes) {
  const std::size_t texels = planes.size() / sh::count;
  std::vector<sh::Coefficients> result(texels);
  for (std::size_t t = 0; t < texels; ++t)
    for (std::size_t c = 0; c < sh::count; ++c)
      result[t][static_cast<Eigen::Index>(c)] = static_cast<double>(planes[c * texels + t]);
  return result;
}

// Planes of coefficients per texel ([texel][16]), rotated by `turns` if given.
Planes packed(const Eigen::VectorXf& values, const std::vector<Mat3>* turns) {
  const auto texels = static_cast<std::size_t>(values.size()) / sh::count;
  Planes planes(static_cast<std::size_t>(values.size()));
  tbb::parallel_for(std::size_t{0}, texels, [&](std::size_t t) {
    sh::Coefficients one = values.segment<sh::count>(static_cast<Eigen::Index>(t * sh::count)).cast<double>();
    if (turns != nullptr) one = sh::Rotation((*turns)[t]) * one;
    for (std::size_t c = 0; c < sh::count; ++c)
      planes[c * texels + t] = static_cast<float>(one[static_cast<Eigen::Index>(c)]);
  });
  return planes;
}

std::size_t texels_of(const TracedFrames& traced) { return traced.rest.vertices.size(); }

std::vector<std::size_t> frames_in_order(const TracedFrames& traced) {
  std::vector<std::size_t> order(traced.frames.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_partition(order.begin(), order.end(), [](std::size_t k) { return !is_held_out(k); });
  return order;
}

std::size_t held_out_count(const TracedFrames& traced) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < traced.frames.size(); ++k) count += is_held_out(k) ? 1 : 0;
  return count;
}

DprtNetwork::Ranges ranges_of(const TracedFrames& traced) {
  DprtRanges seen;
  for (std::size_t k = 0; k < traced.frames.size(); ++k)
    if (!is_held_out(k)) seen.add(traced.frames[k], traced.transfer[k]);
  return seen.found();
}

UnetImages images_of(const TracedFrames& traced, const DprtNetwork::Ranges& ranges, const Progress& progress) {
  const std::vector<std::size_t> order = frames_in_order(traced);
  const std::size_t texels = texels_of(traced);
  UnetImages images;
  images.side = traced.side;
  images.poses = order.size();
  images.held_out = held_out_count(traced);
  images.images.resize(order.size() * unet_inputs * texels);
  images.targets.resize(order.size() * unet_outputs * texels);
  progress.at("geometry images", 0);
  tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t i) {
    const Planes image = DprtNetwork::image_of(sites_of(traced.rest, traced.frames[order[i]]).sites, ranges);
    std::copy(image.begin(), image.end(), images.images.begin() + static_cast<std::ptrdiff_t>(i * image.size()));
    const Planes targets = dprt_targets(traced.transfer[order[i]], ranges);
    std::copy(targets.begin(), targets.end(), images.targets.begin() + static_cast<std::ptrdiff_t>(i * targets.size()));
  });
  return images;
}

constexpr const char* curve_head = "epoch,L1 loss,held-out L1 loss,minutes\n";

// The rows of a curve that an interrupted training has written.
DprtCurve read_curve(const fs::path& file) {
  DprtCurve rows;
  std::error_code gone;
  if (!fs::exists(file, gone)) return rows;
  const std::string text = read_file(file);
  for (std::size_t at = text.find('\n') + 1; at != 0 && at < text.size(); at = text.find('\n', at) + 1) {
    std::array<double, 4> row{};
    if (std::sscanf(text.c_str() + at, "%lf,%lf,%lf,%lf", &row[0], &row[1], &row[2], &row[3]) == 4) rows.push_back(row);
  }
  return rows;
}

void write_curve(const fs::path& file, const DprtCurve& rows) {
  std::string text = curve_head;
  for (const auto& [epoch, loss, held_out, minutes] : rows)
    text += fmt::format("{:.0f},{:.8f},{:.8f},{:.3f}\n", epoch, loss, held_out, minutes);
  write_file_atomically(file, text, {});
}

// Adds epochs to a curve and its file. `curve` must outlive the result.
std::function<void(int, double, double)> curve_writer(const fs::path& file, DprtCurve& curve) {
  curve = read_curve(file);
  return [file, &curve, start = std::chrono::steady_clock::now(), before = -1.0](int epoch, double loss,
                                                                                 double held_out) mutable {
    std::erase_if(curve, [&](const auto& row) { return row[0] >= epoch; });
    if (before < 0) before = curve.empty() ? 0 : curve.back()[3];
    curve.push_back({static_cast<double>(epoch), loss, held_out, before + minutes_since(start)});
    write_curve(file, curve);
  };
}

// Progress with an estimated duration. The share of an interrupted training counts from where it goes on.
Progress timed(const std::string& title, const Progress& progress, const std::function<std::string()>& more) {
  return Progress([=, start = std::chrono::steady_clock::now(), from = -1.0](std::string_view, double done) mutable {
    if (from < 0) from = done;
    const double share = (done - from) / std::max(1e-9, 1 - from);
    constexpr double known = 0.002;
    progress.at(
        title + (share > known ? about + remaining_text(60 * minutes_since(start) * (1 - share) / share) + more() : ""),
        done);
  });
}

int processor_threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

}  // namespace

std::vector<DprtMethod> rest_methods(const TracedFrames& traced, int rays) {
  const Planes rest = traced_planes(traced.rest, traced.rest.vertices, rays);
  const auto coefficients = std::make_shared<const std::vector<sh::Coefficients>>(unpacked(rest));
  DprtMethod unchanged, rotated;
  unchanged.name = "unchanged";
  unchanged.bytes = static_cast<double>(rest.size() * sizeof(float));
  unchanged.predict = [rest](const FrameSites&, const std::vector<Vec3>&) { return rest; };
  rotated.name = "rotated";
  rotated.bytes = unchanged.bytes;
  rotated.needs = DprtMethod::Needs::rotations;
  rotated.predict = [coefficients](const FrameSites& sites, const std::vector<Vec3>&) {
    const std::size_t texels = coefficients->size();
    Planes planes(sh::count * texels);
    tbb::parallel_for(std::size_t{0}, texels, [&](std::size_t t) {
      const sh::Coefficients one = sh::Rotation(sites.turns[t]) * (*coefficients)[t];
      for (std::size_t c = 0; c < sh::count; ++c)
        planes[c * texels + t] = static_cast<float>(one[static_cast<Eigen::Index>(c)]);
    });
    return planes;
  };
  return {unchanged, rotated};
}

std::vector<DprtMethod> linear_methods(const TracedFrames& traced, const Progress& progress) {
  TransferTraining training(traced.rest.vertices, traced.frames.size() - held_out_count(traced),
                            TransferTraining::Frames::both);
  std::size_t pose = 0;
  for (std::size_t k = 0; k < traced.frames.size(); ++k) {
    if (is_held_out(k)) continue;
    progress.at("poses of the linear models", static_cast<double>(k) / static_cast<double>(traced.frames.size()));
    training.set(pose++, traced.frames[k], sites_of(traced.rest, traced.frames[k]).turns, unpacked(traced.transfer[k]));
  }
  std::vector<DprtMethod> methods;
  for (const auto& [name, way] :
       {std::pair{"linear (MoMoPRT)", TransferMethod::linear}, {"rotated + linear", TransferMethod::rotated_linear}}) {
    progress.at(name, 0.5);
    const auto start = std::chrono::steady_clock::now();
    const auto model =
        std::make_shared<const LearnedTransfer>(LearnedTransfer::learned(training, {.way = way}, progress));
    DprtMethod method;
    method.name = name;
    method.minutes = minutes_since(start);
    method.bytes = static_cast<double>(model->memory());
    method.parameters = static_cast<double>(model->mean.size() + model->components.size() + model->linear.size());
    if (way != TransferMethod::linear) method.needs = DprtMethod::Needs::rotations;
    method.predict = [model, turns = way != TransferMethod::linear](const FrameSites& sites,
                                                                    const std::vector<Vec3>& frame) {
      return packed(model->predict(model->space.place(model->probes_in(frame))), turns ? &sites.turns : nullptr);
    };
    methods.push_back(std::move(method));
  }
  return methods;
}

DprtMethod published_network(const TracedFrames& traced, const DprtOptions& options, const std::string& base,
                             DprtCurve& curve, const Progress& progress) {
  const DprtNetwork::Ranges ranges = ranges_of(traced);
  UnetTraining training;
  training.form = UnetForm::concatenated;
  training.channels = options.channels;
  training.epochs = options.epochs;
  training.batch = 5;
  training.rate = 1e-3;
  training.cuda = options.cuda;
  training.threads = processor_threads();
  training.checkpoint = base + ".checkpoint";
  training.watch = curve_writer(base + "-curve.csv", curve);
  const Progress with_time = timed("published network", progress, [&] {
    return curve.empty() ? std::string()
                         : fmt::format(", held out {:.5f} after epoch {:.0f}", curve.back()[2], curve.back()[0]);
  });
  const auto net =
      std::make_shared<const DprtNetwork>(train_unet(images_of(traced, ranges, progress), training, with_time), ranges);
  const std::string bytes = net->bytes();
  write_file_atomically(base + ".dprt", bytes, {});
  DprtMethod method;
  method.needs = DprtMethod::Needs::normals;
  method.name = fmt::format("DPRT as published, {} channels, {} epochs", options.channels, options.epochs);
  method.bytes = static_cast<double>(bytes.size());
  method.parameters = static_cast<double>(unet_parameter_count(UnetForm::concatenated, options.channels));
  if (!curve.empty()) {
    method.loss = curve.back()[1];
    method.held_out_loss = curve.back()[2];
    method.minutes = curve.back()[3];
  }
  method.predict = [net](const FrameSites& sites, const std::vector<Vec3>&) { return net->predict(sites.sites); };
  return method;
}

DprtMethod rotated_network(const TracedFrames& traced, const DprtOptions& options, const std::string& base,
                           const Progress& progress) {
  UnetTransfer::Training training(traced.rest, GeometryImage(grid_chart(traced.side), traced.side));
  for (std::size_t k = 0; k < traced.frames.size(); ++k) {
    if (is_held_out(k)) continue;
    progress.at("poses of Rebake's network", static_cast<double>(k) / static_cast<double>(traced.frames.size()));
    const FrameSites there = sites_of(traced.rest, traced.frames[k]);
    training.add(there.sites, there.turns, unpacked(traced.transfer[k]));
  }
  UnetTraining how;
  how.channels = options.channels;
  how.epochs = options.epochs;
  how.cuda = options.cuda;
  how.threads = processor_threads();
  how.checkpoint = base + "-rotated.checkpoint";
  DprtCurve curve;
  how.watch = curve_writer(base + "-rotated-curve.csv", curve);
  const auto net = std::make_shared<const UnetTransfer>(
      training.learned(how, timed("Rebake's network", progress, [] { return std::string(); })));
  DprtMethod method;
  method.needs = DprtMethod::Needs::rotations;
  method.name = fmt::format("Rebake's network, {} channels, {} epochs", options.channels, options.epochs);
  if (!curve.empty()) method.minutes = curve.back()[3];
  const UnetTransfer::State& state = net->state();
  method.parameters = static_cast<double>(unet_parameter_count(UnetForm::added, options.channels)) +
                      static_cast<double>(state.mean.size());
  method.bytes =
      static_cast<double>((state.weights.size() + static_cast<std::size_t>(state.mean.size())) * sizeof(float));
  method.predict = [net](const FrameSites& sites, const std::vector<Vec3>&) {
    return packed(net->predict(sites.sites), &sites.turns);
  };
  return method;
}

DprtMethod traced_method(const TracedFrames& traced, int rays) {
  DprtMethod method;
  method.name = fmt::format("traced, {} rays", rays);
  method.predict = [rest = traced.rest, rays](const FrameSites&, const std::vector<Vec3>& frame) {
    return traced_planes(rest, frame, rays);
  };
  return method;
}

}  // namespace rebake
