#include "render/graph/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

constexpr std::size_t most_constant_decoders = 4;
constexpr std::size_t most_constant_weights = 4096;

// Largest share of its distance that a pixel may span for its samples' rays to be taken as one. The mean of unit
// vectors spread by s differs from the unit vector of their mean position by O(s^2): at most 4e-6 here.
constexpr double widest_single_ray = 1.0 / 256;

// Width or height of a pixel over its distance along the view axis; nothing where rays are parallel.
double pixel_span(const View& view) {
  return view.camera.orthographic() ? 0 : 2 * half_height(view.camera, 1) / view.height;
}

std::size_t weight_count(const Decoder& d) {
  return static_cast<std::size_t>(d.weights0.size() + d.weights1.size() + d.weights2.size());
}

// Where a camera-space box falls in the picture: nothing when it is out of view.
std::optional<PixelRect> projected(const Box& box, const View& view) {
  const double aspect = static_cast<double>(view.width) / view.height;
  const double nearest = view.camera.near_plane, farthest = view.camera.far_plane;
  if (box.isEmpty() || -box.min().z() < nearest || -box.max().z() > farthest) return std::nullopt;
  const PixelRect whole{0, 0, view.width, view.height};
  // The box is clipped to depths [nearest, farthest] before it is divided: each edge in x and y projects largest at one
  // of the two depths.
  const double z0 = std::max(nearest, -box.max().z()), z1 = std::min(farthest, -box.min().z());
  double left = 1e300, right = -1e300, bottom = 1e300, top = -1e300;
  for (const double z : {z0, z1}) {
    const double half = half_height(view.camera, z);
    for (const double x : {box.min().x(), box.max().x()}) {
      left = std::min(left, x / (half * aspect));
      right = std::max(right, x / (half * aspect));
    }
    for (const double y : {box.min().y(), box.max().y()}) {
      bottom = std::min(bottom, y / half);
      top = std::max(top, y / half);
    }
  }
  if (left > 1 || right < -1 || bottom > 1 || top < -1) return std::nullopt;
  const auto pixel = [](double share, int size, int margin) {
    return static_cast<int>(std::clamp(std::floor(share * size) + margin, 0.0, static_cast<double>(size)));
  };
  // A pixel of margin absorbs rounding.
  return PixelRect{pixel((left + 1) / 2, whole.right, -1), pixel((1 - top) / 2, whole.bottom, -1),
                   pixel((right + 1) / 2, whole.right, 2), pixel((1 - bottom) / 2, whole.bottom, 2)};
}

PixelRect join(const PixelRect& a, const PixelRect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right), std::max(a.bottom, b.bottom)};
}

std::size_t decoder_index(FramePlan& plan, const std::shared_ptr<const Decoder>& decoder) {
  for (std::size_t k = 0; k < plan.decoders.size(); ++k)
    if (plan.decoders[k] == decoder || *plan.decoders[k] == *decoder) return k;
  plan.decoders.push_back(decoder);
  return plan.decoders.size() - 1;
}

std::size_t frame_index(FramePlan& plan, const NodeFrame& frame) {
  for (std::size_t k = 0; k < plan.frames.size(); ++k)
    if (plan.frames[k].decoder == frame.decoder && plan.frames[k].alpha_code == frame.alpha_code &&
        plan.frames[k].world_to_fed == frame.world_to_fed)
      return k;
  plan.frames.push_back(frame);
  return plan.frames.size() - 1;
}

std::string plural(std::size_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string layer_sizes(const Decoder& d) { return fmt::format("11-{}-{}-3", d.hidden0(), d.hidden1()); }

void plan_passes(FramePlan& plan, std::size_t turned_draws, std::size_t culled, std::size_t hidden) {
  const auto say = [&](const char* name, bool runs, std::string why) {
    plan.passes.push_back({name, runs, std::move(why)});
  };
  const bool any = !plan.draws.empty();
  const bool forward = plan.options.shading == RenderOptions::Shading::forward;
  const int side = plan.view.side();
  const std::string drawn = fmt::format("{}, {}", plural(plan.draws.size(), "draw", "draws"),
                                        plural(plan.triangles, "triangle", "triangles"));
  const std::string nothing = "nothing is in view";

  say("geometry", any && !forward, !any ? nothing : forward ? "forward shading decodes while drawing" : drawn);
  say("supersampling", any && plan.view.samples > 1,
      !any                     ? nothing
      : plan.view.samples == 1 ? "1 sample a pixel is asked for"
                               : fmt::format("{} samples a pixel: buffers of {}×{}", plan.view.samples,
                                             plan.view.width * side, plan.view.height * side));
  say("node frames", any && plan.frames.size() > 1,
      !any                      ? nothing
      : plan.frames.size() == 1 ? "one decoder and orientation in view"
                                : fmt::format("{} decoders or orientations in view", plan.frames.size()));
  say("turned rays", turned_draws > 0,
      !any                ? nothing
      : turned_draws == 0 ? "no triangle was turned apart from its object"
                          : plural(turned_draws, "draw has", "draws have") + " turned triangles");
  say("decoder compositing", any && plan.decoders.size() > 1 && !forward,
      !any                        ? nothing
      : plan.decoders.size() == 1 ? "one decoder in view"
      : forward                   ? "at 1 sample no pixel is mixed"
                                  : fmt::format("{} decoders in view", plan.decoders.size()));
  const double pixel = pixel_span(plan.view);
  const bool resolved_rays = any && !forward && plan.view.samples > 1;
  const bool mixed_rays = plan.frames.size() > 1 || turned_draws > 0;
  say("ray per sample", resolved_rays && (mixed_rays || pixel > widest_single_ray),
      !any             ? nothing
      : !resolved_rays ? "a pixel has one sample"
      : mixed_rays     ? "samples of a pixel may differ in orientation"
      : pixel > widest_single_ray
          ? fmt::format("a pixel spans {:.2g} of its distance", pixel)
          : fmt::format("a pixel spans {:.2g} of its distance: one ray through the middle of its "
                        "samples differs by less than {:.0e}",
                        pixel, pixel * pixel / 4));
  const bool constants = plan.options.weights == RenderOptions::Weights::constants;
  const std::string how = any ? fmt::format("decoder {}, weights as {}", layer_sizes(*plan.decoders.front()),
                                            constants ? "constants" : "a buffer")
                              : nothing;
  say("resolve", any && !forward, !any ? nothing : forward ? "forward shading decodes while drawing" : how);
  say("forward", any && forward,
      !any                    ? nothing
      : forward               ? drawn + "; " + how
      : plan.view.samples > 1 ? "features are averaged over a pixel's samples before they are decoded"
                              : "deferred shading decodes each pixel once");
  const std::string in_object = "clusters of triangles out of view are left out";
  say("culling", any || culled > 0,
      culled > 0 ? plural(culled, "object is", "objects are") + " out of view and cost no draw" +
                       (any ? "; of the others, " + in_object : "")
      : any ? in_object
            : "no object is shown");
  if (hidden > 0) say("hidden objects", false, plural(hidden, "is", "are") + " hidden by an edit");
}

void plan_guides(FramePlan& plan) {
  const bool inspects = plan.guides.inspect != Guides::Inspect::none;
  if (inspects)
    for (PlannedPass& pass : plan.passes)
      if (pass.name != "culling" && pass.runs) pass = {pass.name, false, "the triangles are inspected, not decoded"};
  plan.passes.push_back({"inspect", inspects && !plan.draws.empty(),
                         !inspects            ? "colours are asked for"
                         : plan.draws.empty() ? "nothing is in view"
                                              : "another look than colours is asked for"});
  const std::size_t selected = static_cast<std::size_t>(
      std::count_if(plan.draws.begin(), plan.draws.end(), [](const Draw& draw) { return draw.selection != nullptr; }));
  plan.passes.push_back({"selection", plan.guides.selection && selected > 0,
                         !plan.guides.selection ? "selections are not to be shown"
                         : selected == 0        ? "nothing in view is selected"
                                                : plural(selected, "draw has", "draws have") + " selected triangles"});
  plan.passes.push_back({"guides", !plan.guides.lines.empty(),
                         plan.guides.lines.empty() ? "no grid, cage or handle is shown"
                                                   : plural(plan.guides.lines.size(), "line", "lines")});
}

}  // namespace

bool FramePlan::runs(const std::string& pass) const {
  return std::any_of(passes.begin(), passes.end(), [&](const PlannedPass& p) { return p.name == pass && p.runs; });
}

FramePlan plan(const Scene& scene, const View& view, const RenderOptions& options, const Guides* guides) {
  check(view);
  if (options.shading == RenderOptions::Shading::forward && view.samples != 1)
    throw FieldError("shading",
                     "forward needs 1 sample: with more, the format averages features before it decodes them");
  FramePlan result;
  result.view = view;
  if (guides != nullptr && guides->inspect != Guides::Inspect::none) result.view.samples = 1;
  result.options = options;
  result.background = scene.background;
  const Mat3 camera_rows = world_to_camera(view.camera);
  std::size_t turned = 0, culled = 0, hidden = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
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
        const Mat3 world_to_fed = axes_matrix(object.axes) * turn.transpose();
        frame = frame_index(result, {decoder_index(result, object.decoder), world_to_fed, set.texels->alpha_code()});
      }
      any_in_view = true;
      result.covered = join(result.covered, *rect);
      result.triangles += set.soup.triangle_count();
      if (set.soup.rotations() != nullptr) ++turned;
      result.draws.push_back(
          {placed.node->id, set, *frame, to_camera, object.axes, placed.node->selection, first_triangle});
    }
    if (!any_in_view) ++culled;
  }
  if (result.options.weights == RenderOptions::Weights::automatic) {
    std::size_t weights = 0;
    for (const auto& decoder : result.decoders) weights += weight_count(*decoder);
    result.options.weights = result.decoders.size() <= most_constant_decoders && weights <= most_constant_weights
                                 ? RenderOptions::Weights::constants
                                 : RenderOptions::Weights::buffer;
  }
  if (result.options.shading == RenderOptions::Shading::automatic)
    result.options.shading = result.view.samples == 1 && result.options.weights == RenderOptions::Weights::constants
                                 ? RenderOptions::Shading::forward
                                 : RenderOptions::Shading::deferred;
  plan_passes(result, turned, culled, hidden);
  if (guides != nullptr) {
    result.guides = *guides;
    plan_guides(result);
  }
  return result;
}

std::string describe(const FramePlan& plan) {
  std::string out;
  for (const PlannedPass& pass : plan.passes)
    out += fmt::format("{:<9} {:<20} {}\n", pass.runs ? "runs" : "left out", pass.name, pass.why);
  return out;
}

}  // namespace rebake
