#include "mesh_ops/light/train_transfer_model.h"

#include <chrono>
#include <cmath>

#include "mesh_ops/base/error.h"
#include "mesh_ops/light/learned/body_image.h"

namespace rebake {

namespace {

constexpr int image_side = 64;

// Every eighth pose is held out, as in LearnedTransfer::learned().
bool held_back(int pose) { return pose % 8 == 7; }

double relative(double squared_error, double squares) { return squares > 0 ? std::sqrt(squared_error / squares) : 0; }

// The key sites of an object in a pose, the rotations of the surface around them, and the transfer traced at them.
struct KeyPose {
  std::vector<LightSite> sites;
  std::vector<Mat3> turns;
  std::vector<sh::Coefficients> transfer;
};

KeyPose traced_keys(const DragLight& start, const std::shared_ptr<const BakedObject>& posed,
                    const TransferModel& model) {
  if (!start.fits(*posed)) throw Error("a pose has other triangles than the object: the edit may only move triangles");
  const DragLight::Start& from = start.start();
  std::vector<std::vector<Mat3>> turns;
  std::vector<Mat3> all_turns;
  for (std::size_t s = 0; s < from.charts.size(); ++s) {
    turns.push_back(node_rotations(from.object->sets[s], posed->sets[s], *from.charts[s]));
    all_turns.insert(all_turns.end(), turns.back().begin(), turns.back().end());
  }
  const std::vector<LightSite> sites = start.sites_on(*posed, turns);
  KeyPose result;
  for (const std::uint32_t key : model.keys) {
    result.sites.push_back(sites[key]);
    result.turns.push_back(all_turns[key]);
  }
  result.transfer = visible_transfer(result.sites, model.facing, rays_among({{posed, Affine::Identity()}}), model.rays);
  return result;
}

}  // namespace

TransferModel trained_model(const DragLight& start,
                            const std::function<std::shared_ptr<const BakedObject>(int k)>& pose,
                            const TransferModelOptions& options, const Progress& progress) {
  const DragLight::Start& from = start.start();
  if (!from.object->bodies.empty())
    throw Error("the object has already been edited; train on the object as it was read");
  std::vector<Vec3> places;
  for (const LightSite& site : from.sites.now) places.push_back(site.position);
  TransferModel model;
  model.body = surface_hash(*from.object);
  model.sites = places.size();
  model.poses = options.poses;
  model.rays = options.rays;
  std::optional<UnetTransfer::Training> images;
  std::optional<DprtTransfer::Training> published;
  if (options.net) {
    require_unet_training();
    BodyImage image = body_image(*from.object, from.sites.now, from.facing, options.coarseness, progress);
    model.keys = image.sites;
    GeometryImage laid_out(image.chart, image_side);
    if (options.published)
      published.emplace(std::move(laid_out));
    else
      images.emplace(std::move(image.mesh), std::move(laid_out));
  } else {
    // Farthest-point sampling; all sites if there are at most `keys`.
    model.keys = PoseSpace::probes_of(places, options.keys);
  }
  std::vector<Vec3> key_places;
  for (const std::uint32_t k : model.keys) {
    key_places.push_back(places[k]);
    model.facing.push_back(from.facing[k]);
  }
  const auto began = std::chrono::steady_clock::now();
  TransferTraining training(key_places, static_cast<std::size_t>(options.poses), TransferTraining::Frames::turned);
  struct Held {
    int pose;
    std::vector<LightSite> sites;
    std::vector<Mat3> turns;
  };
  std::vector<Held> held;
  Eigen::VectorXf at_rest;  // transfer of the keys at rest, which rotation alone would predict
  for (int k = -1; k < options.poses; ++k) {
    progress.at("tracing poses", std::max(0.0, static_cast<double>(k) / options.poses));
    const std::shared_ptr<const BakedObject> posed = k < 0 ? from.object : pose(k);
    KeyPose keys = traced_keys(start, posed, model);
    if (k < 0) {
      at_rest.resize(static_cast<Eigen::Index>(keys.transfer.size() * sh::count));
      for (std::size_t i = 0; i < keys.transfer.size(); ++i)
        at_rest.segment<sh::count>(static_cast<Eigen::Index>(i * sh::count)) = keys.transfer[i].cast<float>();
      continue;
    }
    for (std::size_t i = 0; i < key_places.size(); ++i) key_places[i] = keys.sites[i].position;
    training.set(static_cast<std::size_t>(k), key_places, keys.turns, keys.transfer);
    if (!options.net) continue;
    if (held_back(k))
      held.push_back({k, std::move(keys.sites), std::move(keys.turns)});
    else if (published)
      published->add(keys.sites, keys.transfer);
    else
      images->add(keys.sites, keys.turns, keys.transfer);
  }
  model.tracing_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const PoseSpace seen(training.rest_probes, training.posed_probes);
  constexpr double least = 1e-6;  // of the body's size; smaller displacements are rounding errors
  if (!(seen.largest > least))
    throw Error("nothing moves in the training poses: the edit must move triangles of the object");
  // Kernels would gain nothing (`rebake study transfer`).
  model.learned = LearnedTransfer::learned(training, {.way = TransferMethod::rotated_linear}, progress);
  double off = 0, turned = 0, all = 0;
  for (int k = 0; k < options.poses; ++k) {
    if (!held_back(k)) continue;
    const Eigen::VectorXf truth = training.local.row(k).transpose();
    turned += static_cast<double>((at_rest - truth).squaredNorm());
    all += static_cast<double>(truth.squaredNorm());
  }
  model.turning_error = relative(turned, all);
  if (!options.net) return model;
  if (published)
    model.published = published->learned(*options.net, progress);
  else
    model.net = images->learned(*options.net, progress);
  for (const Held& one : held) {
    const Eigen::VectorXf truth = training.local.row(one.pose).transpose();
    off += static_cast<double>((model.predict({}, one.sites, one.turns) - truth).squaredNorm());
  }
  model.learned.drop_weights();
  model.net_error = relative(off, all);
  return model;
}

}  // namespace rebake
