#include "editor/edits/nodes/match_colors.h"

#include <fmt/format.h>

#include <map>

#include "editor/edits/describe_edit.h"
#include "editor/edits/nodes/capture_pair.h"
#include "mesh_ops/registration/color_match.h"

namespace rebake {

Outcome apply(const Scene& scene, const MatchColors& edit, const Progress& progress) {
  editable_with_children(scene, edit.node.id);
  if (!(edit.distance > 0 && edit.distance <= 0.1)) throw FieldError("distance", "must be above 0 and at most 0.1");
  const CapturePair pair = capture_pair(scene, edit.node.id, edit.to);
  ColorMatchOptions options;
  options.distance = edit.distance;
  options.gain = edit.gain;
  const ColorMatch match = matched_colors(pair.changed, pair.fixed, options, progress);
  Scene result = scene;
  std::map<const BakedObject*, std::shared_ptr<const BakedObject>> made;
  std::vector<NodeId> nodes = pair.hidden;
  for (const PlacedNode& placed : pair.changed) nodes.push_back(placed.node->id);
  for (const NodeId id : nodes)
    result = with_changed(result, id, [&](Node& node) {
      auto& known = made[node.object.get()];
      if (!known) known = recolored(*node.object, match.change);
      node.object = known;
    });
  Report report;
  const auto& [gain, offset] = match.change;
  report.lines.push_back(fmt::format(
      "{} common points; logits of red, green and blue: gain {:.3f}, {:.3f}, {:.3f}, offset {:+.3f}, {:+.3f}, {:+.3f}; "
      "difference {:.1f} of 255 before, {:.1f} after (root mean square of {:.0f} % of the colours)",
      match.pairs, gain[0], gain[1], gain[2], offset[0], offset[1], offset[2], 255 * match.before, 255 * match.after,
      100 * match.used));
  if (match.after > 0.7 * match.before && match.after > 4 / 255.0)
    report.lines.emplace_back(
        "warning: most of the difference remains: the captures may not lie on each other exactly, or their light "
        "differs "
        "in more than brightness");
  return {std::move(result), std::move(report)};
}

REBAKE_DESCRIBE_EDIT(
    MatchColors,
    "Changes a capture's brightness and contrast per channel so that its colours are those of another capture where "
    "both "
    "have the same surfaces; register it first.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node whose colours change");
      visit("to", edit.to, Need::optional, "node whose colours stay; default: all other visible objects");
      visit("gain", edit.gain, Need::optional, "change the contrast, too");
      visit("distance", edit.distance, Need::optional,
            "largest distance of common points, as a share of the smaller capture's diagonal");
    })

}  // namespace rebake
