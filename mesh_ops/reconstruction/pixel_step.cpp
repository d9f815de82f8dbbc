// Stage 2: pixels of several rays, whose features are averaged before they are decoded, as in rendering.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "mesh_ops/reconstruction/pixel_mean.h"
#include "mesh_ops/reconstruction/reconstruction.h"

namespace rebake {

namespace {

constexpr std::size_t pixels_per_task = 16;

template <class Body>
void for_pixels(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, pixels_per_task), [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p) body(p);
  });
}

// Rays per pixel, and where they meet it.
std::size_t rays_each(const TrainingPlan& plan) { return plan.four_rays ? 4 : 1; }
void add_rays(const TrainingPlan& plan, const TrainingViews& views, const TrainingViews::Pixel& pixel,
              RayBatch& batch) {
  const double apart = plan.four_rays ? 0.25 : 0;
  for (std::size_t k = 0; k < rays_each(plan); ++k)
    batch.rays.push_back(views.ray(pixel.photograph, pixel.x + 0.5 + (k % 2 == 0 ? -apart : apart),
                                   pixel.y + 0.5 + (k / 2 == 0 ? -apart : apart)));
}

WeightedHits weighted(const RayBatch& batch, double (*opacity_of)(double)) {
  WeightedHits result;
  result.opacities.resize(batch.hits.size());
  result.weights.resize(batch.rays.size());
  for_pixels(batch.rays.size(), [&](std::size_t r) {
    for (std::size_t h = batch.first[r]; h < batch.first[r + 1]; ++h)
      result.opacities[h] = opacity_of(double{batch.opacities[h]});
    set_weights({result.opacities.data() + batch.first[r], batch.first[r + 1] - batch.first[r]}, result.weights[r]);
  });
  return result;
}

double as_trained(double opacity) { return opacity; }
double as_drawn(double opacity) { return opacity > 0.5 ? 1 : 0; }

ShownHits shown_hits(const RayBatch& batch, const std::vector<const WeightedHits*>& kinds, bool only_drawn,
                     const SceneField& field) {
  ShownHits shown;
  shown.index.assign(batch.hits.size(), -1);
  for (std::size_t r = 0; r < batch.rays.size(); ++r)
    for (std::size_t h = batch.first[r]; h < batch.first[r + 1]; ++h) {
      const bool counts = std::any_of(kinds.begin(), kinds.end(), [&](const WeightedHits* kind) {
        const RayWeights& weights = kind->weights[r];
        return only_drawn ? weights.weights[h - batch.first[r]] > 0 : weights.before[h - batch.first[r]] > least_light;
      });
      if (!counts) continue;
      shown.index[h] = static_cast<std::int32_t>(shown.hits.size());
      shown.hits.push_back(static_cast<std::uint32_t>(h));
      shown.points.push_back(batch.points[h]);
    }
  field.evaluate(shown.points, shown.features);
  return shown;
}

// Decoder inputs: features and direction are those of the covered part of the pixel, as in rendering.
std::vector<float> inputs_of(const std::vector<PixelMean>& means) {
  std::vector<float> inputs(means.size() * decoder_inputs);
  for (std::size_t p = 0; p < means.size(); ++p) {
    for (std::size_t f = 0; f < texel_features; ++f)
      inputs[p * decoder_inputs + f] = static_cast<float>(means[p].features[f]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      inputs[p * decoder_inputs + texel_features + axis] =
          static_cast<float>(means[p].opacity * means[p].fed[static_cast<Eigen::Index>(axis)]);
  }
  return inputs;
}

Vec3 color_of(const PixelMean& mean, const float* decoded, const Vec3& background) {
  return mean.opacity * Vec3(double{decoded[0]}, double{decoded[1]}, double{decoded[2]}) +
         (1 - mean.opacity) * background;
}

// The largest weight of each hit.
std::vector<double> largest_shares(const RayBatch& batch, const std::vector<WeightedHits>& kinds) {
  std::vector<double> shares(batch.hits.size());
  for_pixels(batch.rays.size(), [&](std::size_t r) {
    for (std::size_t h = batch.first[r]; h < batch.first[r + 1]; ++h)
      for (const WeightedHits& kind : kinds)
        shares[h] = std::max(shares[h], kind.weights[r].weights[h - batch.first[r]]);
  });
  return shares;
}

}  // namespace

double Reconstruction::pixel_step(bool features_only) {
  const std::size_t count = plan_.pixels, each = rays_each(plan_);
  SplitMix64 dice(plan_.seed * 0x9e3779b97f4a7c15U + steps_done_);
  RayBatch batch;
  std::vector<Vec3> wanted(count);
  std::vector<TrainingViews::Pixel> pixels;
  for (Vec3& color : wanted) {
    const TrainingViews::Pixel& pixel = pixels.emplace_back(views_.pick(dice));
    add_rays(plan_, views_, pixel, batch);
    color = views_.color(pixel);
  }
  const Vec3 background = step_background(dice);
  batch.find_hits(grid_, active_, plan_.pixel_hits);
  fields_.opacity->evaluate(batch.points, batch.opacities);

  // The share of the binary loss grows from 0 to 1.
  const double binary_share =
      features_only ? 1 : static_cast<double>(steps_done_ - plan_.soft_steps) / static_cast<double>(plan_.binary_steps);
  std::vector<WeightedHits> kinds;
  std::vector<double> kind_shares;
  kinds.push_back(weighted(batch, features_only ? as_drawn : binary_opacity));
  kind_shares.push_back(binary_share);
  if (!features_only) {
    kinds.push_back(weighted(batch, as_trained));
    kind_shares.push_back(1 - binary_share);
  }
  std::vector<const WeightedHits*> all;
  for (const WeightedHits& kind : kinds) all.push_back(&kind);
  const ShownHits shown = shown_hits(batch, all, features_only, *fields_.features);

  std::vector<PixelMean> means(count * kinds.size());
  for_pixels(means.size(), [&](std::size_t m) { means[m] = mean_of(batch, m % count, each, kinds[m / count], shown); });
  const std::vector<float> inputs = inputs_of(means);
  std::vector<float> decoded, decoded_slopes(3 * means.size()), input_slopes;
  decoder_.evaluate(inputs, decoded);
  std::vector<double> errors(count);
  std::vector<Vec3> slopes(means.size());
  for_pixels(means.size(), [&](std::size_t m) {
    const Vec3 off = off_by(color_of(means[m], &decoded[3 * m], background), wanted[m % count], pixels[m % count]);
    if (m < count) errors[m] = off.squaredNorm() / 3;
    slopes[m] = kind_shares[m / count] * 2 * off / (3 * static_cast<double>(count));
    for (std::size_t c = 0; c < 3; ++c)
      decoded_slopes[3 * m + c] = static_cast<float>(means[m].opacity * slopes[m][static_cast<Eigen::Index>(c)]);
  });
  decoder_.backpropagate(inputs, decoded_slopes, &input_slopes);
  std::vector<float> feature_slopes(shown.features.size()), alpha_slopes(batch.hits.size());
  for_pixels(count, [&](std::size_t p) {
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const std::size_t m = k * count + p;
      for (std::size_t f = 0; f < texel_features; ++f)
        means[m].feature_slopes[f] = double{input_slopes[m * decoder_inputs + f]};
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = static_cast<Eigen::Index>(c);
        means[m].opacity_slope += slopes[m][at] * (double{decoded[3 * m + c]} - background[at]) +
                                  double{input_slopes[m * decoder_inputs + texel_features + c]} * means[m].fed[at];
      }
      add_hit_slopes(batch, p, each, kinds[k], shown, means[m], feature_slopes,
                     features_only ? nullptr : &alpha_slopes);
    }
    if (plan_.distortion > 0 && !features_only)
      for (std::size_t r = p * each; r < (p + 1) * each; ++r) add_distortion(batch, r, kinds[1], alpha_slopes);
  });

  const double now = rate();
  std::vector<FieldPoint> feature_points;
  fields_.features->backpropagate(shown.points, feature_slopes, features_only ? nullptr : &feature_points);
  if (!features_only) {
    const std::vector<double> shares = largest_shares(batch, kinds);
    update_geometry(batch, alpha_slopes, feature_points, shown.hits, shares,
                    static_cast<double>(count * each * plan_.pixel_hits), now);
  }
  fields_.features->step(now);
  decoder_.step(now);
  double error = 0;
  for (const double one : errors) error += one / static_cast<double>(count);
  return error;
}

double Reconstruction::error_of(const TrainingViews& views, std::size_t photograph, std::vector<float>* image,
                                int every, const Progress& progress) const {
  const FitPhotograph& one = views.photographs()[photograph];
  const std::size_t each = rays_each(plan_);
  double error = 0;
  std::size_t counted = 0;
  if (image != nullptr) image->resize(one.rgb.size());
  for (int y = every / 2; y < one.height; y += every) {
    progress.at("drawing", static_cast<double>(y) / one.height);
    RayBatch batch;
    std::vector<int> columns;
    for (int x = every / 2; x < one.width; x += every) {
      columns.push_back(x);
      add_rays(plan_, views, {photograph, x, y}, batch);
    }
    batch.find_hits(grid_, active_, plan_.pixel_hits);
    fields_.opacity->evaluate(batch.points, batch.opacities);
    const WeightedHits drawn = weighted(batch, as_drawn);
    const ShownHits shown = shown_hits(batch, {&drawn}, true, *fields_.features);
    std::vector<PixelMean> means(columns.size());
    for_pixels(means.size(), [&](std::size_t p) { means[p] = mean_of(batch, p, each, drawn, shown); });
    std::vector<float> decoded;
    decoder_.evaluate(inputs_of(means), decoded);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(one.width) + static_cast<std::size_t>(columns[k]);
      const Vec3 color = color_of(means[k], &decoded[3 * k], background_);
      if (image != nullptr)
        for (std::size_t c = 0; c < 3; ++c)
          (*image)[3 * pixel + c] = static_cast<float>(color[static_cast<Eigen::Index>(c)]);
      if (one.valid[pixel] == 0) continue;
      ++counted;
      error += (color - views.color({photograph, columns[k], y})).squaredNorm() / 3;
    }
  }
  return counted == 0 ? 0 : error / static_cast<double>(counted);
}

}  // namespace rebake
