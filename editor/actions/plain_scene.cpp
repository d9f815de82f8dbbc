#include "editor/actions/plain_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/mobilenerf/write_baked_folder.h"

namespace rebake {

namespace {

// The scene with `object` in place of all visible objects, and without light.
Scene with_one_object(Scene scene, std::shared_ptr<const BakedObject> object) {
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object)
      scene = with_changed(scene, placed.node->id, [](Node& node) { node.object = nullptr; });
  // The object's colours contain the light corrections.
  scene.light = nullptr;
  Node node;
  node.name = "scene";
  node.object = std::move(object);
  return with_added(scene, node, NodeId::none, scene.roots.size());
}

// The object with the unknown members of mlp.json of all visible objects; of several values the first.
std::shared_ptr<const BakedObject> with_members(const Scene& scene, const BakedObject& object) {
  auto result = std::make_shared<BakedObject>(object);
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object && placed.node->object->decoder->rule == ColorRule::network)
      result->other_members.insert(placed.node->object->other_members.begin(),
                                   placed.node->object->other_members.end());
  return result;
}

int page_side_of(const Scene& scene, Layout layout) {
  std::vector<const BakedObject*> objects;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) objects.push_back(placed.node->object.get());
  return largest_page_side(layout, objects);
}

}  // namespace

Layout common_layout(const Scene& scene) {
  std::optional<Layout> layout;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    if (layout && *layout != placed.node->object->layout) return Layout::split;
    layout = placed.node->object->layout;
  }
  return layout.value_or(Layout::split);
}

PlainSceneBuilder::PlainSceneBuilder(const Scene& scene, const Lighting& lighting, Layout layout,
                                     const Progress& progress)
    : composition(composed(scene, page_side_of(scene, layout), progress, &lighting)) {
  if (layout == Layout::unsplit && composition.pages.size() > 1)
    throw Error(
        fmt::format("the texels do not fit into one texture of {}²: use --layout split", page_side_of(scene, layout)));
  if (!composition.exact()) sightlines.emplace(scene);
}

const FusePlan& PlainSceneBuilder::make_plan(const FuseOptions& options, const Progress& progress) {
  return plan.emplace(plan_fuse(composition, *sightlines, options, progress));
}

Scene PlainSceneBuilder::scene(const Scene& original, std::size_t candidate, const FuseOptions& options,
                               const Progress& progress) {
  plan->chosen = candidate;
  return with_one_object(original,
                         with_members(original, *fuse(composition, *sightlines, *plan, options, progress).object));
}

namespace {

// The plain scene if one decoder represents it exactly.
Scene exact_scene(const Scene& scene, const FuseOptions& options, PlainReport& report) {
  report.exact = true;
  const std::vector<Node> merged = merged_for_export(without_bends(scene), options.layout);
  if (merged.size() != 1) throw Error("the objects with one decoder could not be merged");
  report.hidden0 = merged.front().object->decoder->hidden0();
  report.hidden1 = merged.front().object->decoder->hidden1();
  return with_one_object(scene, merged.front().object);
}

// Fills in FuseReport::Part::shares: for each node without texels of its own, the first node with the same textures.
void name_sharers(const Scene& scene, FuseReport& report) {
  const std::vector<PlacedNode> nodes = placed_nodes(scene);
  const auto shares = [](const PlacedNode& a, const PlacedNode& b) {
    return a.node->object && b.node->object &&
           std::any_of(a.node->object->sets.begin(), a.node->object->sets.end(), [&](const TextureSet& set) {
             return std::any_of(b.node->object->sets.begin(), b.node->object->sets.end(),
                                [&](const TextureSet& other) { return other.texels == set.texels; });
           });
  };
  for (FuseReport::Part& part : report.parts) {
    if (part.errors.texels > 0) continue;
    const auto own =
        std::find_if(nodes.begin(), nodes.end(), [&](const PlacedNode& n) { return n.node->name == part.node; });
    if (own == nodes.end()) continue;
    const auto first =
        std::find_if(nodes.begin(), own, [&](const PlacedNode& n) { return n.visible && shares(n, *own); });
    if (first != own) part.shares = first->node->name;
  }
}

Scene fused_scene(PlainSceneBuilder& parts, const Scene& scene, std::size_t candidate, const FuseOptions& options,
                  PlainReport& report, const Progress& progress) {
  parts.plan->chosen = candidate;
  Fused fused = fuse(parts.composition, *parts.sightlines, *parts.plan, options, progress);
  report.texels = std::move(fused.report);
  name_sharers(scene, report.texels);
  report.hidden0 = fused.object->decoder->hidden0();
  report.hidden1 = fused.object->decoder->hidden1();
  return with_one_object(scene, with_members(scene, *fused.object));
}

// Indices of candidates in the order of trials: the plan's choice, then the others by descending score.
std::vector<std::size_t> candidate_order(const FusePlan& plan) {
  std::vector<std::size_t> order(plan.candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if ((a == plan.chosen) != (b == plan.chosen)) return a == plan.chosen;
    return plan.candidates[a].trial.psnr_db > plan.candidates[b].trial.psnr_db;
  });
  return order;
}

}  // namespace

Scene plain_scene(const Scene& scene, const Lighting& lighting, const FuseOptions& options, PlainReport& report,
                  const Progress& progress) {
  check(options);
  PlainSceneBuilder parts(scene, lighting, options.layout, progress);
  if (parts.composition.exact()) return exact_scene(scene, options, report);
  const std::size_t chosen = parts.make_plan(options, progress).chosen;
  return fused_scene(parts, scene, chosen, options, report, progress);
}

Scene best_plain_scene(const Scene& scene, const Lighting& lighting, const FuseOptions& options,
                       const std::function<Renderer&()>& renderer,
                       const std::function<void(const DeviceError&)>& no_device, PlainReport& report,
                       const Progress& progress, int picture_size) {
  check(options);
  PlainSceneBuilder parts(scene, lighting, options.layout, progress);
  if (parts.composition.exact()) return exact_scene(scene, options, report);
  std::vector<std::size_t> order = candidate_order(parts.make_plan(options, progress));
  // Each trial fits all texels, so with a time limit there is only one.
  constexpr std::size_t max_tries = 3;
  order.resize(options.seconds > 0 ? 1 : std::min(order.size(), max_tries));
  std::optional<Scene> best;
  for (const std::size_t candidate : order) {
    PlainReport tried;
    Scene made = fused_scene(parts, scene, candidate, options, tried, progress);
    try {
      measure_pictures(renderer(), scene, lighting, made, tried, progress, picture_size);
    } catch (const DeviceError& error) {
      no_device(error);
      if (best) break;
      report = std::move(tried);
      return made;
    }
    if (!best || worst_object(tried).psnr_db > worst_object(report).psnr_db) {
      report = std::move(tried);
      best = std::move(made);
    }
    if (worst_object(report).psnr_db >= options.psnr_db) break;
  }
  return *best;
}

}  // namespace rebake
