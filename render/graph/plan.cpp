#include "render/graph/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/index/index.h"
#include "render/graph/changed_pixels.h"
#include "render/graph/effects.h"

namespace rebake {

namespace {

constexpr std::size_t max_constant_decoders = 4;
constexpr std::size_t max_constant_weights = 4096;

// Constants omit zero weights, of which decoders fused side by side have many.
std::size_t weight_count(const Decoder& d) {
  const auto count = [](const Eigen::MatrixXd& weights) {
    return static_cast<std::size_t>((weights.array() != 0).count());
  };
  return count(d.weights0) + count(d.weights1) + count(d.weights2);
}

std::size_t decoder_index(FramePlan& plan, const std::shared_ptr<const Decoder>& decoder) {
  for (std::size_t k = 0; k < plan.decoders.size(); ++k)
    if (plan.decoders[k] == decoder || *plan.decoders[k] == *decoder) return k;
  plan.decoders.push_back(decoder);
  return plan.decoders.size() - 1;
}

std::size_t frame_index(FramePlan& plan, const DecodeFrame& frame) {
  for (std::size_t k = 0; k < plan.frames.size(); ++k)
    if (plan.frames[k].decoder == frame.decoder && plan.frames[k].alpha_code == frame.alpha_code &&
        plan.frames[k].world_to_decoder == frame.world_to_decoder)
      return k;
  plan.frames.push_back(frame);
  return plan.frames.size() - 1;
}

// Total size of distinct textures.
class TextureBytes {
 public:
  void add(const BakedObject& object) {
    // Shortcut: consecutive nodes often share an object.
    if (std::exchange(last_, &object) == &object) return;
    for (const TextureSet& set : object.sets)
      if (counted_.insert(set.texels.get()).second)
        bytes_ += sizeof(Texel) * static_cast<std::uint64_t>(set.texels->width()) *
                  static_cast<std::uint64_t>(set.texels->height());
  }
  std::uint64_t bytes() const { return bytes_; }

 private:
  const BakedObject* last_ = nullptr;
  std::set<const FeatureTexture*> counted_;
  std::uint64_t bytes_ = 0;
};

RenderOptions::Texels chosen(RenderOptions::Texels texels, std::uint64_t bytes, const DeviceFacts& device) {
  using Texels = RenderOptions::Texels;
  if (!device.reads_coded_texels) return Texels::plain;
  if (texels != Texels::automatic) return texels;
  return bytes > min_coded_bytes ? Texels::coded : Texels::plain;
}

// Omits the view direction if it changes no decoder's colours by more than `unseen`.
void omit_view_direction(FramePlan& plan) {
  for (const auto& decoder : plan.decoders)
    plan.direction_change = std::max(plan.direction_change, direction_influence_of(decoder)->change);
  // A light map may amplify a change of colours by any factor.
  const bool lit = std::any_of(plan.draws.begin(), plan.draws.end(), [](const Draw& d) { return d.light != nullptr; });
  if (plan.options.everything || plan.draws.empty() || plan.direction_change > (lit ? 0 : unseen)) return;
  plan.uses_view_direction = false;
  plan.left_out += plan.direction_change;
  std::vector<std::size_t> frame_of;
  const std::vector<DecodeFrame> frames = std::exchange(plan.frames, {});
  for (const DecodeFrame& frame : frames)
    frame_of.push_back(frame_index(plan, {frame.decoder, Mat3::Identity(), frame.alpha_code}));
  for (Draw& draw : plan.draws) draw.frame = frame_of[draw.frame];
  for (auto& decoder : plan.decoders)
    if (!decoder->weights0.bottomRows(3).isZero(0)) decoder = direction_influence_of(decoder)->without;
}

// Reduces the samples to 1 per pixel if everything that a pixel may show differs by at most `unseen`, background
// included.
void reduce_samples(FramePlan& plan) {
  if (plan.options.everything || plan.options.transparent || plan.view.samples == 1 || plan.draws.empty()) return;
  // Per decoder: range of the features in all textures that a pixel may mix.
  std::vector<std::optional<FeatureRange>> features(plan.decoders.size());
  for (const Draw& draw : plan.draws) {
    if (draw.light != nullptr) return;
    const std::optional<FeatureRange>& range = *feature_range_of(draw.set.texels);
    if (!range) return;
    if (!range->any) continue;
    std::optional<FeatureRange>& of = features[plan.frames[draw.frame].decoder];
    if (!of) of = range;
    for (std::size_t k = 0; k < 8; ++k) {
      of->low[k] = std::min(of->low[k], range->low[k]);
      of->high[k] = std::max(of->high[k], range->high[k]);
    }
  }
  ColorRange colors{plan.background, plan.background};
  for (std::size_t k = 0; k < features.size(); ++k)
    for (int covered = 1; features[k] && covered <= plan.view.samples; ++covered)
      colors.join(color_range(*plan.decoders[k], *features[k], static_cast<double>(covered) / plan.view.samples));
  if (colors.widest() > unseen) return;
  plan.left_out += colors.widest();
  plan.why_reduced_samples =
      fmt::format("everything in view and the background differ by at most {:.2g} of 255", colors.widest() * 255);
  plan.view.samples = 1;
}

// Chooses what the options leave open.
void choose_shading(FramePlan& plan) {
  if (plan.options.weights == RenderOptions::Weights::automatic) {
    std::size_t weights = 0;
    for (const auto& decoder : plan.decoders) weights += weight_count(*decoder);
    plan.options.weights = plan.decoders.size() <= max_constant_decoders && weights <= max_constant_weights
                               ? RenderOptions::Weights::constants
                               : RenderOptions::Weights::buffer;
  }
  if (plan.options.shading == RenderOptions::Shading::automatic)
    plan.options.shading = plan.view.samples == 1 && plan.options.weights == RenderOptions::Weights::constants
                               ? RenderOptions::Shading::forward
                               : RenderOptions::Shading::deferred;
}

void plan_passes(FramePlan& plan, const FrameFacts& facts, bool overlays) {
  const bool inspects = overlays && plan.guides.inspect != Guides::Inspect::none;
  for (const Effect* effect : effect_table()) {
    if (effect->kind == Effect::Kind::overlay && !overlays) continue;
    std::optional<Decision> decision = effect->decide(facts);
    if (!decision) continue;
    if (inspects && decision->runs && effect->kind == Effect::Kind::colors)
      decision = Decision{false, "the triangles are inspected, not decoded"};
    plan.passes.push_back({effect, effect->name, decision->runs, std::move(decision->why)});
  }
}

}  // namespace

bool uses_coded_texels(const Scene& scene, RenderOptions::Texels texels, const DeviceFacts& device) {
  TextureBytes textures;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object) textures.add(*placed.node->object);
  return chosen(texels, textures.bytes(), device) == RenderOptions::Texels::coded;
}

bool FramePlan::runs(const Effect& effect) const {
  return std::any_of(passes.begin(), passes.end(), [&](const PlannedPass& p) { return p.effect == &effect && p.runs; });
}

FramePlan plan(const Scene& scene, const View& view, const RenderOptions& options, const Guides* guides,
               const Lighting* lighting, const DeviceFacts& device) {
  check(view);
  if (options.shading == RenderOptions::Shading::forward && view.samples != 1)
    throw FieldError("shading",
                     "forward shading needs 1 sample per pixel, because features are averaged before decoding; set "
                     "samples to 1, or shading to deferred");
  FramePlan result;
  result.view = view;
  if (guides != nullptr && guides->inspect != Guides::Inspect::none) result.view.samples = 1;
  result.options = options;
  result.background = options.transparent ? Color(0, 0, 0) : scene.background;
  const Mat3 camera_rows = world_to_camera(view.camera);
  std::size_t turned = 0, culled = 0, hidden = 0;
  TextureBytes textures;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    textures.add(*placed.node->object);
    if (!placed.visible) {
      ++hidden;
      continue;
    }
    const BakedObject& object = *placed.node->object;
    Affine to_camera = Affine::Identity();
    to_camera.linear() = camera_rows * placed.to_world.linear();
    to_camera.translation() = camera_rows * (placed.to_world.translation() - view.camera.eye);
    bool any_in_view = false;
    std::optional<std::size_t> frame;
    std::size_t next_triangle = 0;
    for (const TextureSet& set : object.sets) {
      const std::size_t first_triangle = std::exchange(next_triangle, next_triangle + set.soup.triangle_count());
      const auto rect = projected(transformed(set.soup.bounds(), to_camera), view);
      if (!rect) continue;
      if (!frame) {
        Mat3 turn;
        try {
          turn = orthogonal_factor(placed.to_world.linear());
        } catch (const std::invalid_argument& error) {
          throw EditError(fmt::format("node \"{}\": {}", placed.node->name, error.what()));
        }
        const Mat3 world_to_decoder = axes_matrix(object.axes) * turn.transpose();
        frame =
            frame_index(result, {decoder_index(result, object.decoder), world_to_decoder, set.texels->alpha_code()});
      }
      any_in_view = true;
      result.covered = join(result.covered, *rect);
      result.triangles += set.soup.triangle_count();
      if (set.soup.rotations() != nullptr) ++turned;
      result.draws.push_back(
          {placed.node->id, set, *frame, to_camera, object.axes, placed.node->selection, first_triangle,
           lighting != nullptr
               ? lighting->map_of(placed.node->id, static_cast<std::size_t>(&set - &object.sets[0]), set)
               : nullptr});
    }
    if (!any_in_view) ++culled;
  }
  omit_view_direction(result);
  reduce_samples(result);
  choose_shading(result);
  result.texture_bytes = textures.bytes();
  result.options.texels = chosen(options.texels, result.texture_bytes, device);
  result.overlays = guides != nullptr;
  if (guides != nullptr) result.guides = *guides;
  const ChangedPixels changed = changed_pixels(device.shown, result);
  result.kept = changed.pixels.has_value();
  if (result.kept) result.covered = *changed.pixels;
  plan_passes(result, {result, device, turned, culled, hidden, changed.why}, guides != nullptr);
  if (lighting != nullptr)
    for (const LightDecision& decision : lighting->summary)
      result.passes.push_back({nullptr, decision.name, decision.runs, decision.words()});
  return result;
}

std::string describe(const std::vector<PlannedPass>& passes) {
  std::string out;
  for (const PlannedPass& pass : passes)
    out += fmt::format("{:<9} {:<20} {}\n", pass.runs ? "runs" : "skipped", pass.name, pass.why);
  return out;
}

}  // namespace rebake
