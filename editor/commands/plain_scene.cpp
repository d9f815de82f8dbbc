#include "editor/commands/plain_scene.h"

#include <fmt/format.h>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/write_baked_folder.h"

namespace rebake {

namespace {

Scene with_one_object(Scene scene, std::shared_ptr<const BakedObject> object) {
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object)
      scene = with_changed(scene, placed.node->id, [](Node& node) { node.object = nullptr; });
  // What light does is in the colours.
  scene.light = nullptr;
  Node node;
  node.name = "scene";
  node.object = std::move(object);
  return with_added(scene, node, NodeId::none, scene.roots.size());
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

PlainParts::PlainParts(const Scene& scene, const Lighting& lighting, Layout layout, const Progress& progress)
    : composition(composed(scene, largest_texture_side(layout), progress, &lighting)) {
  if (layout == Layout::unsplit && composition.pages.size() > 1)
    throw Error(
        fmt::format("the texels do not fit into one texture of {}²: use --layout split", largest_texture_side(layout)));
  if (!composition.exact()) sightlines.emplace(scene);
}

const FusePlan& PlainParts::make_plan(const FuseOptions& options, const Progress& progress) {
  return plan.emplace(plan_fuse(composition, *sightlines, options, progress));
}

Scene PlainParts::scene(const Scene& original, std::size_t candidate, const FuseOptions& options,
                        const Progress& progress) {
  plan->chosen = candidate;
  return with_one_object(original, fuse(composition, *sightlines, *plan, options, progress).object);
}

Scene plain_scene(const Scene& scene, const Lighting& lighting, const FuseOptions& options, PlainReport& report,
                  const Progress& progress) {
  check(options);
  PlainParts parts(scene, lighting, options.layout, progress);
  if (parts.composition.exact()) {
    report.exact = true;
    const std::vector<Node> merged = merged_for_export(without_bends(scene), options.layout);
    if (merged.size() != 1) throw Error("what one decoder shows could not be put together");
    report.hidden0 = merged.front().object->decoder->hidden0();
    report.hidden1 = merged.front().object->decoder->hidden1();
    return with_one_object(scene, merged.front().object);
  }
  const FusePlan& plan = parts.make_plan(options, progress);
  Fused fused = fuse(parts.composition, *parts.sightlines, plan, options, progress);
  report.texels = std::move(fused.report);
  report.hidden0 = fused.object->decoder->hidden0();
  report.hidden1 = fused.object->decoder->hidden1();
  return with_one_object(scene, std::move(fused.object));
}

}  // namespace rebake
