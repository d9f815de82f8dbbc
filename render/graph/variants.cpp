#include "render/graph/variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "render/graph/effects.h"

namespace rebake {

namespace {

// Maximum number of representatives whose combinations are all enumerated: 31 for 5.
constexpr std::size_t max_combined_nodes = 5;
constexpr std::size_t max_node_kinds = 12;  // maximum number of kinds that are represented
// Pixels per side. Not a power of two, like most windows: llvmpipe recompiles programs for power-of-two textures.
constexpr int side = 24;

// Number of the preamble that a light map needs: 0 without, 1 or 2 without or with offset, plus 2 with gloss.
int light_variant(const LightMap* light) {
  return light == nullptr ? 0 : (light->offset.empty() ? 1 : 2) + (light->gloss ? 2 : 0);
}

// Properties of a node that determine the programs that draw it.
struct Kind {
  std::shared_ptr<const Decoder> decoder;
  bool turned = false;
  std::set<int> lights;
  bool operator==(const Kind& other) const {
    return (decoder == other.decoder || *decoder == *other.decoder) && turned == other.turned && lights == other.lights;
  }
};

Kind kind_of(const PlacedNode& placed, const Lighting* lighting) {
  const BakedObject& object = *placed.node->object;
  Kind kind{object.decoder, object.any_rotations(), {}};
  for (std::size_t s = 0; s < object.sets.size(); ++s)
    kind.lights.insert(lighting != nullptr ? light_variant(lighting->map_of(placed.node->id, s, object.sets[s]).get())
                                           : 0);
  return kind;
}

// Representatives of all visible nodes: per kind one node, and a second one with another rotation if there is one.
std::vector<PlacedNode> representatives(const Scene& scene, const Lighting* lighting) {
  struct Held {
    Kind kind;
    Mat3 turn;
    bool both = false;
  };
  std::vector<Held> held;
  std::vector<PlacedNode> result;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object || placed.node->object->triangle_count() == 0) continue;
    const Kind kind = kind_of(placed, lighting);
    const auto known = std::find_if(held.begin(), held.end(), [&](const Held& one) { return one.kind == kind; });
    if (known == held.end() ? held.size() >= max_node_kinds : known->both) continue;
    Mat3 turn;
    try {
      turn = orthogonal_factor(placed.to_world.linear());
    } catch (const std::invalid_argument&) {
      continue;  // draw() reports the error
    }
    if (known == held.end())
      held.push_back({kind, turn});
    else if (known->turn == turn)
      continue;
    else
      known->both = true;
    result.push_back(placed);
  }
  return result;
}

// The scene of the nodes whose bit is set in `which`.
Scene of_nodes(const Scene& scene, const std::vector<PlacedNode>& nodes, std::uint64_t which) {
  Scene some;
  some.background = scene.background;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if ((which >> k & 1) == 0) continue;
    Node node = *nodes[k].node;
    node.to_parent = nodes[k].to_world;
    node.selection = nullptr;
    node.children.clear();
    some.roots.push_back(std::make_shared<const Node>(std::move(node)));
  }
  return some;
}

// A small view of the whole scene in the direction of `like`. Pixels have the same angular size, so a perspective
// camera is far away.
View small_view(const Scene& scene, const View& like, int samples) {
  View view{like.camera, side, side, samples};
  const Box box = world_bounds(scene);
  const double radius = std::max(box.diagonal().norm() / 2, 1e-300);
  const Vec3 back = world_to_camera(like.camera).row(2);
  double distance = 2 * radius;
  if (like.camera.orthographic()) {
    view.camera.ortho_height = 2 * radius;
  } else {
    const double half = std::min(half_height(like.camera, 1) * side / like.height, 0.5);
    view.camera.fov_degrees = 2 * std::atan(half) * 180 / std::numbers::pi;
    distance = std::max(distance, radius / half);
  }
  view.camera.target = box.center();
  view.camera.eye = box.center() + distance * back;
  view.camera.near_plane = (distance - radius) / 2;
  view.camera.far_plane = 2 * (distance + radius);
  return view;
}

}  // namespace

ProgramVariant variant_of(const FramePlan& plan) {
  ProgramVariant variant;
  if (plan.options.weights == RenderOptions::Weights::constants) variant.decoders = plan.decoders;
  std::uint64_t draws = 0;  // bit per combination of rotation and light map
  for (const Draw& draw : plan.draws)
    draws |= std::uint64_t{1} << (5 * (draw.set.soup.rotations() != nullptr ? 1 : 0) + light_variant(draw.light.get()));
  variant.flags = fmt::format("{}/{}/{}/{}:", static_cast<int>(plan.options.weights),
                              static_cast<int>(plan.options.shading), plan.view.samples, draws);
  for (const Effect* effect :
       {&effects::geometry, &effects::node_frames, &effects::rotated_rays, &effects::light, &effects::light_offset,
        &effects::highlights, &effects::ray_per_sample, &effects::resolve, &effects::forward})
    variant.flags += plan.runs(*effect) ? '1' : '0';
  return variant;
}

std::vector<PrecompileFrame> precompile_frames(const Scene& scene, const View& view, const RenderOptions& options,
                                               const Lighting* lighting) {
  const std::vector<PlacedNode> nodes = representatives(scene, lighting);
  const std::uint64_t all = (std::uint64_t{1} << nodes.size()) - 1;
  std::vector<std::uint64_t> some{all};
  if (nodes.size() <= max_combined_nodes) {
    for (std::uint64_t which = 1; which < all; ++which) some.push_back(which);
  } else {
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) some.push_back(std::uint64_t{1} << a | std::uint64_t{1} << b);
  }
  // Most likely combinations first: all nodes, then each alone.
  std::stable_sort(some.begin() + 1, some.end(),
                   [](std::uint64_t a, std::uint64_t b) { return std::popcount(a) < std::popcount(b); });
  std::vector<PrecompileFrame> result;
  std::vector<ProgramVariant> known;
  for (const std::uint64_t which : some) {
    const Scene part = of_nodes(scene, nodes, which);
    if (part.roots.empty() || world_bounds(part).isEmpty()) continue;
    for (const int samples : std::set<int>{1, view.samples}) {
      PrecompileFrame frame{part, small_view(part, view, samples)};
      ProgramVariant variant = variant_of(plan(part, frame.view, options, nullptr, lighting));
      if (std::find(known.begin(), known.end(), variant) != known.end()) continue;
      known.push_back(std::move(variant));
      result.push_back(std::move(frame));
    }
  }
  return result;
}

}  // namespace rebake
