#include "mesh_ops/reconstruction/reconstruction.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh_ops/reconstruction/grid_losses.h"
#include "mesh_ops/reconstruction/hash_field.h"
#include "mesh_ops/reconstruction/mlp_field.h"

namespace rebake {

namespace {

constexpr float least_opacity = 0.1F;     // cells below this in the acceleration grid are empty
constexpr std::size_t cells_update = 10;  // steps between updates of the flags of empty cells
constexpr std::size_t rays_per_task = 32;
constexpr double vertex_rate = 1e-3, cell_rate = 1e-2;

template <class Body>
void for_rays(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, rays_per_task), [&](const auto& range) {
    for (std::size_t r = range.begin(); r < range.end(); ++r) body(r);
  });
}

FeatureNetwork start_decoder(std::uint64_t seed) {
  FeatureNetwork decoder(decoder_inputs, 16, 16, 3);
  randomise(decoder, seed);
  return decoder;
}

}  // namespace

namespace {

SceneFields mlp_fields(const TrainingPlan& plan) {
  MlpFieldSizes opacity{1, plan.width, plan.octaves, plan.layers, plan.boxes > 0 ? 2.0F : 1.0F, -8, 4 * plan.seed + 1};
  MlpFieldSizes features = opacity;
  features.outputs = texel_features;
  features.bias = 0;
  ++features.seed;
  return {std::make_unique<MlpField>(opacity), std::make_unique<MlpField>(features)};
}

}  // namespace

SceneFields fields_of(const TrainingPlan& plan) {
  if (plan.mlp) return mlp_fields(plan);
  HashFieldOptions opacity;
  opacity.levels = plan.levels;
  opacity.log2_entries = plan.log2_entries;
  opacity.hidden = plan.hidden;
  opacity.finest = (plan.boxes > 0 ? 8 : 4) * plan.side;
  opacity.bias = -8;
  HashFieldOptions features = opacity;
  features.bias = 0;
  return {std::make_unique<HashField>(1, opacity, 4 * plan.seed + 1),
          std::make_unique<HashField>(texel_features, features, 4 * plan.seed + 2)};
}

Reconstruction::Reconstruction(const TrainingPlan& plan, TrainingViews views, const Vec3& background,
                               SceneFields fields)
    : plan_(plan),
      views_(std::move(views)),
      background_(background),
      fields_(std::move(fields)),
      grid_(GridSpace(plan.kind, plan.side, plan.boxes, plan.frustum)),
      decoder_(start_decoder(4 * plan.seed + 3)),
      cells_(grid_.space().cell_count()),
      inner_(cells_.size()),
      cell_gradient_(cells_.size()),
      offset_gradient_(grid_.offsets.size()),
      position_slopes_(cells_.size(), Vec3::Zero()),
      cell_steps_(cells_.size(), 0.999),
      offset_steps_(grid_.offsets.size(), 0.999),
      exposures_(views_.photographs().size()),
      gains_(views_.photographs().size(), Vec3::Ones()) {
  for (std::uint32_t cell = 0; cell < inner_.size(); ++cell) {
    const auto at = grid_.space().cell_of_number(cell);
    inner_[cell] = std::all_of(at.begin(), at.end(), [&](int i) { return i >= 1 && i <= plan.side - 2; }) ? 1 : 0;
  }
  active_ = inner_;
  mean_brightness_ = views_.mean_brightness();
}

TrainingStage Reconstruction::stage() const {
  if (steps_done_ < plan_.soft_steps) return TrainingStage::soft;
  if (steps_done_ < plan_.soft_steps + plan_.binary_steps) return TrainingStage::binary;
  return steps_done_ < plan_.steps() ? TrainingStage::features : TrainingStage::done;
}

double Reconstruction::rate() const {
  const auto share = [](std::size_t done, std::size_t of) {
    return static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(of, 1));
  };
  if (stage() == TrainingStage::soft) {
    const double done = share(steps_done_, plan_.soft_steps),
                 warm = std::sin(std::numbers::pi / 2 * std::min(1.0, 10 * done));
    return plan_.rate * std::pow(0.01, done) * (0.1 + 0.9 * warm);
  }
  if (stage() == TrainingStage::binary)
    return plan_.binary_rate * std::pow(0.1, share(steps_done_ - plan_.soft_steps, plan_.binary_steps));
  return plan_.binary_rate *
         std::pow(0.1, share(steps_done_ - plan_.soft_steps - plan_.binary_steps, plan_.feature_steps));
}

double Reconstruction::step() {
  const TrainingStage now = stage();
  if (now == TrainingStage::done) return 0;
  if (steps_done_ == plan_.soft_steps || steps_done_ == plan_.soft_steps + plan_.binary_steps) {
    fields_.opacity->reset_optimiser();
    fields_.features->reset_optimiser();
    decoder_.reset_optimiser();
    cell_steps_.reset();
    offset_steps_.reset();
  }
  const double error = now == TrainingStage::soft ? soft_step() : pixel_step(now == TrainingStage::features);
  ++steps_done_;
  if (stage() == TrainingStage::soft) update_exposures();
  if (stage() != TrainingStage::features && steps_done_ % cells_update == 0) set_active();
  return error;
}

void Reconstruction::set_active() {
  if (steps_done_ < plan_.open_steps) return;
  for (std::size_t cell = 0; cell < cells_.size(); ++cell)
    active_[cell] = inner_[cell] != 0 && cells_[cell] >= least_opacity ? 1 : 0;
}

// Hits that enough light reaches, with their colours.
struct Reconstruction::SoftHits {
  std::vector<std::uint32_t> hits;  // indices in the batch
  std::vector<std::size_t> first;   // per ray, and once more: the first of its hits in this list
  std::vector<FieldPoint> points;
  std::vector<float> features, inputs, colors;  // [hit][8], [hit][11], [hit][3]
};

void Reconstruction::shade(const RayBatch& batch, const std::vector<RayWeights>& weights, SoftHits& shown) const {
  shown.first.assign(1, 0);
  for (std::size_t r = 0; r < batch.rays.size(); ++r) {
    for (std::size_t h = batch.first[r]; h < batch.first[r + 1]; ++h)
      if (weights[r].before[h - batch.first[r]] > least_light) {
        shown.hits.push_back(static_cast<std::uint32_t>(h));
        shown.points.push_back(batch.points[h]);
      }
    shown.first.push_back(shown.hits.size());
  }
  fields_.features->evaluate(shown.points, shown.features);
  shown.inputs.resize(shown.hits.size() * decoder_inputs);
  for_rays(batch.rays.size(), [&](std::size_t r) {
    for (std::size_t k = shown.first[r]; k < shown.first[r + 1]; ++k) {
      std::copy_n(&shown.features[k * texel_features], texel_features, &shown.inputs[k * decoder_inputs]);
      std::copy_n(batch.rays[r].fed.data(), 3, &shown.inputs[k * decoder_inputs + texel_features]);
    }
  });
  decoder_.evaluate(shown.inputs, shown.colors);
}

double Reconstruction::soft_step() {
  const bool open = steps_done_ < plan_.open_steps;
  const std::size_t count = open ? plan_.open_rays : plan_.soft_rays, most = open ? plan_.open_hits : plan_.soft_hits;
  SplitMix64 dice(plan_.seed * 0x9e3779b97f4a7c15U + steps_done_);
  RayBatch batch;
  std::vector<Vec3> wanted(count), shown_colors(count);
  std::vector<TrainingViews::Pixel> pixels;
  for (Vec3& color : wanted) {
    const TrainingViews::Pixel& pixel = pixels.emplace_back(views_.pick(dice));
    batch.rays.push_back(views_.ray(pixel.photograph, pixel.x + 0.5, pixel.y + 0.5));
    color = views_.color(pixel);
  }
  const Vec3 background = step_background(dice);
  batch.find_hits(grid_, active_, most);
  fields_.opacity->evaluate(batch.points, batch.opacities);
  WeightedHits kind{{batch.opacities.begin(), batch.opacities.end()}, std::vector<RayWeights>(count)};
  for_rays(count, [&](std::size_t r) {
    set_weights({kind.opacities.data() + batch.first[r], batch.first[r + 1] - batch.first[r]}, kind.weights[r]);
  });
  SoftHits shown;
  shade(batch, kind.weights, shown);

  std::vector<float> color_slopes(shown.colors.size()), alpha_slopes(batch.hits.size());
  std::vector<double> errors(count), shares(batch.hits.size());
  for_rays(count, [&](std::size_t r) {
    const std::size_t first = batch.first[r], hits = batch.first[r + 1] - first;
    std::vector<Vec3> colors(hits, Vec3::Zero()), by_color(hits);
    for (std::size_t k = shown.first[r]; k < shown.first[r + 1]; ++k)
      colors[shown.hits[k] - first] = Eigen::Vector3f::Map(&shown.colors[3 * k]).cast<double>();
    const RayWeights& weights = kind.weights[r];
    shown_colors[r] = ray_color(weights, colors, background);
    const Vec3 off = off_by(shown_colors[r], wanted[r], pixels[r]);
    errors[r] = off.squaredNorm() / 3;
    std::vector<double> slopes(hits);
    ray_color_slopes({kind.opacities.data() + first, hits}, weights, colors, background,
                     2 * off / (3 * static_cast<double>(count)), by_color, slopes);
    for (std::size_t k = shown.first[r]; k < shown.first[r + 1]; ++k)
      Eigen::Vector3f::Map(&color_slopes[3 * k]) = by_color[shown.hits[k] - first].cast<float>();
    for (std::size_t h = 0; h < hits; ++h) {
      alpha_slopes[first + h] = static_cast<float>(slopes[h]);
      shares[first + h] = weights.weights[h];
    }
    if (plan_.distortion > 0 && !open) add_distortion(batch, r, kind, alpha_slopes);
  });

  std::vector<float> input_slopes, feature_slopes(shown.features.size());
  decoder_.backpropagate(shown.inputs, color_slopes, &input_slopes);
  for (std::size_t k = 0; k < shown.hits.size(); ++k)
    std::copy_n(&input_slopes[k * decoder_inputs], texel_features, &feature_slopes[k * texel_features]);
  std::vector<FieldPoint> feature_points;
  fields_.features->backpropagate(shown.points, feature_slopes, &feature_points);
  const double now = rate();
  update_geometry(batch, alpha_slopes, feature_points, shown.hits, shares, static_cast<double>(count * most), now);
  fields_.features->step(now);
  decoder_.step(now);
  if (!open)
    for (std::size_t r = 0; r < count; ++r)
      exposures_.add(pixels[r].photograph, views_.raw_color(pixels[r]), shown_colors[r]);
  double error = 0;
  for (const double one : errors) error += one / static_cast<double>(count);
  return error;
}

// Gains follow the scene from the middle of stage 1 on, if there are differences.
void Reconstruction::update_exposures() {
  constexpr std::size_t updates = 16;
  const std::size_t middle = (plan_.open_steps + plan_.soft_steps) / 2,
                    period = std::max<std::size_t>(1, (plan_.soft_steps - middle) / updates);
  if (!plan_.gains || steps_done_ < middle || (steps_done_ - middle) % period != 0) return;
  if (steps_done_ == middle) {
    exposure_spread_ = exposures_.spread();
    has_gains_ = has_gains_ || exposures_.differ();
  }
  if (has_gains_) set_gains(exposures_.gains());
  exposures_.fade();
}

void Reconstruction::start_with_gains(const std::vector<Vec3>& gains) {
  has_gains_ = true;
  set_gains(gains);
  Vec3 logs = Vec3::Zero();
  for (const Vec3& gain : gains) logs += gain.array().log().matrix() / static_cast<double>(gains.size());
  exposures_.mean = logs.array().exp().matrix();
}

// The error of a pixel's colour. Clipped channels may have been brighter, which gains would make darker.
Vec3 Reconstruction::off_by(const Vec3& shown, const Vec3& wanted, const TrainingViews::Pixel& pixel) const {
  Vec3 off = shown - wanted;
  if (!has_gains_) return off;
  constexpr double bright = 0.98;
  const Vec3 raw = views_.raw_color(pixel);
  for (int c = 0; c < 3; ++c)
    if (raw[c] >= bright && off[c] > 0) off[c] = 0;
  return off;
}

void Reconstruction::set_gains(const std::vector<Vec3>& gains) {
  gains_ = gains;
  for (std::size_t k = 0; k < gains.size(); ++k) views_.set_gain(k, gains[k]);
}

// Adds the derivatives of the distortion loss of a ray by its opacities.
void Reconstruction::add_distortion(const RayBatch& batch, std::size_t ray, const WeightedHits& kind,
                                    std::vector<float>& alpha_slopes) const {
  const std::size_t first = batch.first[ray], hits = batch.first[ray + 1] - first;
  std::vector<double> by_weight(hits), by_opacity(hits);
  distortion(kind.weights[ray].weights, {batch.lengths.data() + first, hits},
             plan_.distortion / static_cast<double>(batch.rays.size()), by_weight);
  opacity_slopes({kind.opacities.data() + first, hits}, kind.weights[ray], by_weight, 0, by_opacity);
  for (std::size_t h = 0; h < hits; ++h) alpha_slopes[first + h] += static_cast<float>(by_opacity[h]);
}

// The colour behind everything. Real scenes have none: it changes between black and white from step to step, so that
// surfaces become opaque.
Vec3 Reconstruction::step_background(SplitMix64& dice) const {
  if (plan_.kind == CaptureKind::object) return background_;
  const double full = static_cast<double>(plan_.soft_steps) / 4,
               share = std::min(1.0, static_cast<double>(steps_done_) / full), random = dice.below(2) == 0 ? 0 : 1;
  return Vec3::Constant((1 - share) * mean_brightness_ + share * random);
}

// Steps of the opacity field, the vertices and the acceleration grid.
void Reconstruction::update_geometry(const RayBatch& batch, const std::vector<float>& opacity_slopes,
                                     const std::vector<FieldPoint>& feature_points,
                                     const std::vector<std::uint32_t>& shown, const std::vector<double>& shares,
                                     double slots, double rate) {
  std::vector<FieldPoint> point_slopes;
  fields_.opacity->backpropagate(batch.points, opacity_slopes, &point_slopes);
  for (std::size_t k = 0; k < shown.size(); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) point_slopes[shown[k]][axis] += feature_points[k][axis];
  std::fill(position_slopes_.begin(), position_slopes_.end(), Vec3::Zero());
  batch.add_position_slopes(point_slopes, position_slopes_);
  grid_.offset_slopes(position_slopes_, offset_gradient_);
  add_vertex_slopes(grid_, batch.hits, slots, offset_gradient_);
  add_cell_slopes(cells_, plan_.side, batch.hits, shares, slots, cell_gradient_);
  const double relative = rate / plan_.rate;
  offset_steps_.step(grid_.offsets, offset_gradient_, vertex_rate * relative, true);
  cell_steps_.step(cells_, cell_gradient_, cell_rate * relative, true);
  fields_.opacity->step(rate);
  grid_.place_vertices();
}

std::string Reconstruction::save() const {
  std::string bytes;
  const std::vector<std::uint64_t> done{steps_done_};
  put_numbers(bytes, done);
  put_numbers(bytes, grid_.offsets);
  put_numbers(bytes, cells_);
  put_numbers(bytes, active_);
  put_numbers(bytes, std::vector<double>{exposure_spread_, has_gains_ ? 1.0 : 0.0});
  put_numbers(bytes, gains_);
  exposures_.save(bytes);
  offset_steps_.save(bytes);
  cell_steps_.save(bytes);
  decoder_.save(bytes);
  fields_.opacity->save(bytes);
  fields_.features->save(bytes);
  return bytes;
}

void Reconstruction::load(std::string_view bytes) {
  std::vector<std::uint64_t> done{0};
  take_numbers(bytes, done);
  take_numbers(bytes, grid_.offsets);
  take_numbers(bytes, cells_);
  take_numbers(bytes, active_);
  std::vector<double> spread(2);
  take_numbers(bytes, spread);
  std::vector<Vec3> gains = gains_;
  take_numbers(bytes, gains);
  exposures_.load(bytes);
  offset_steps_.load(bytes);
  cell_steps_.load(bytes);
  decoder_.load(bytes);
  fields_.opacity->load(bytes);
  fields_.features->load(bytes);
  if (!bytes.empty()) throw Error("is longer than the state of this training");
  steps_done_ = done[0];
  exposure_spread_ = spread[0];
  has_gains_ = spread[1] != 0;
  if (has_gains_) set_gains(gains);
  grid_.place_vertices();
}

}  // namespace rebake
