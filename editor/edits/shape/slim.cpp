#include "editor/edits/shape/slim.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "editor/edits/describe_edit.h"
#include "editor/edits/scene_change.h"
#include "editor/edits/select/selecting.h"
#include "editor/edits/stored_view.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/features/atlas/atlas.h"
#include "mesh_ops/features/atlas/near_duplicates.h"
#include "mesh_ops/features/atlas/slimming.h"
#include "mesh_ops/select/duplicates.h"

namespace rebake {

namespace {

constexpr int largest_side = 4096;

EyeRegion eyes_for(const PlacedNode& placed, const std::vector<Camera>& cameras, const Slim& edit) {
  EyeRegion eyes;
  eyes.world_to_object = placed.to_world.inverse();
  if (edit.eyes) eyes.box = Box(edit.eyes->min, edit.eyes->max);
  for (const Camera& camera : cameras) eyes.viewpoints.push_back(viewpoint_of(camera, eyes.world_to_object));
  return eyes;
}

std::uint64_t texel_area(const BakedObject& object) {
  std::uint64_t area = 0;
  for (const TextureSet& set : object.sets)
    area += static_cast<std::uint64_t>(set.texels->width()) * static_cast<std::uint64_t>(set.texels->height());
  return area;
}

std::uint64_t opaque_texels(const BakedObject& object) {
  std::uint64_t opaque = 0;
  for (const TextureSet& set : object.sets) opaque += set.texels->opaque_count();
  return opaque;
}

// The repacked texture sets; nothing if texels cannot be moved or less than 5 % of the texel area would be saved.
std::optional<std::vector<TextureSet>> packed(const BakedObject& object,
                                              const PatchRepresentatives& representative_of) {
  if (!std::all_of(object.sets.begin(), object.sets.end(), can_pack)) return std::nullopt;
  int side = largest_side;
  for (const TextureSet& set : object.sets) side = std::max({side, set.texels->width(), set.texels->height()});
  BakedObject made;
  made.sets = pack(object.sets, side, object.sets.front().texels->alpha_code(), representative_of).sets;
  // Reordered patches compress slightly worse, so small savings are not worth it.
  constexpr double worth_it = 0.95;
  if (static_cast<double>(texel_area(made)) > worth_it * static_cast<double>(texel_area(object))) return std::nullopt;
  return made.sets;
}

// PSNR in dB of a mean squared error of colours 0 … 1, and back.
double db_of(double squared_loss) { return -10 * std::log10(squared_loss); }
double squared_loss_of(double db) { return std::pow(10.0, -db / 10); }

// Lossy compression of texel colours: merged near-duplicate patches, and fewer bits per feature.
struct Loss {
  DuplicatePatches alike;
  BitsFound bits;
};

int sum_of(const FeatureBits& bits) { return std::accumulate(bits.begin(), bits.end(), 0); }

// Splits the error budget of `psnr` dB between merging near-duplicate patches (none, a tenth or half of it) and
// removing feature bits. Takes the split with the fewest bits in total.
Loss best_loss(const BakedObject& object, double psnr, const Progress& progress) {
  const double may_lose = squared_loss_of(psnr);
  const auto opaque = static_cast<double>(opaque_texels(object));
  Loss best{{}, fewest_bits(object, psnr, progress)};
  double least = opaque * sum_of(best.bits.bits);
  for (const double share : {0.5, 0.1}) {
    Loss loss{near_duplicate_patches(object, share * may_lose, progress), {}};
    if (loss.alike.merged == 0) break;
    loss.bits = fewest_bits(object, db_of(may_lose - loss.alike.squared_loss), progress);
    const double left = (opaque - static_cast<double>(loss.alike.texels)) * sum_of(loss.bits.bits);
    if (left >= least) continue;
    least = left;
    best = std::move(loss);
  }
  return best;
}

std::string loss_words(const Loss& loss) {
  const DuplicatePatches& alike = loss.alike;
  const BitsFound& found = loss.bits;
  std::string words;
  if (alike.merged > 0)
    words = fmt::format("{} of {} texel patches use those of near-duplicates, ", alike.merged, alike.patches);
  if (found.bits == FeatureBits{8, 8, 8, 8, 8, 8, 8, 8}) {
    words += "all features keep their 8 bits";
  } else {
    words +=
        fmt::format("features keep {} bits ({:.1f} on average)", fmt::join(found.bits, ", "), sum_of(found.bits) / 8.0);
  }
  const double lost = alike.squared_loss + squared_loss_of(found.psnr_db);
  return lost > 0 ? fmt::format("{}: colours of texels at {:.1f} dB PSNR", words, db_of(lost)) : words;
}

// Whether keyframes bend a part of the node that a stored selection names.
bool needs_stored_selection(const PlacedNode& placed) {
  if (!placed.node->motion) return false;
  const auto& bends = placed.node->motion->bends;
  return std::any_of(bends.begin(), bends.end(), [](const auto& bend) { return !bend.second.selection.empty(); });
}

// How sure it is that removed triangles show nowhere.
std::string visibility_words(const TriangleSet& removed, const TriangleSet& opaque, std::uint64_t rays, int rays_each,
                             double smallest_opening, std::size_t seen_once) {
  std::size_t tested = 0;
  for (std::size_t f = 0; f < removed.size(); ++f) tested += removed[f] != 0 && opaque[f] != 0 ? 1 : 0;
  if (tested == 0) return "the removed triangles have no opaque texels";
  return fmt::format(
      "{} rays, {} from each removed triangle with opaque texels: at most {:.2g} % of the lines of sight to any of "
      "them are unoccluded (95 % confidence); smallest visible share found {:.3g} %; {} reached by one ray only",
      rays, rays_each, 100 * missed_share_bound(tested, rays_each), 100 * smallest_opening,
      counted(seen_once, "triangle was", "triangles were"));
}

struct Slimmed {
  std::shared_ptr<const BakedObject> object;  ///< null if no triangle is visible
  TriangleSet dropped;                        ///< flags of the removed triangles
  bool fully_transparent = false, reordered = false;
  std::vector<std::string> lines;
};

Slimmed slimmed_object(const BakedObject& before, const std::vector<PlacedNode>& placements,
                       const std::vector<Camera>& cameras, const Slim& edit, const Progress& progress) {
  Slimmed result;
  result.dropped = duplicate_triangles(before);
  const std::size_t duplicates = count(result.dropped), all = result.dropped.size();
  const std::shared_ptr<const BakedObject> single =
      duplicates == 0 ? std::make_shared<const BakedObject>(before) : triangles_of(before, result.dropped, false);
  // Eyes all around the object do not depend on its placement.
  const bool around = !edit.eyes && cameras.empty();
  TriangleSet unseen(single->triangle_count(), 1), seen_more(single->triangle_count(), 0), opaque;
  std::uint64_t rays = 0;
  int rays_each = std::numeric_limits<int>::max();  // of the placement with the fewest: its bound is the widest
  double opening = 1;
  for (const PlacedNode& placed : placements) {
    const VisibilityReport seen = traced_visibility(*single, eyes_for(placed, cameras, edit), edit.rays, progress);
    for (std::size_t f = 0; f < unseen.size(); ++f) {
      // Rays of two placements are more than one.
      seen_more[f] |= seen.unseen[f] == 0 && (seen.seen_once[f] == 0 || unseen[f] == 0) ? 1 : 0;
      unseen[f] &= seen.unseen[f];
    }
    opaque = seen.opaque;  // the same for all placements
    rays += seen.rays;
    rays_each = std::min(rays_each, seen.rays_each);
    opening = std::min(opening, seen.smallest_opening);
    if (around) break;
  }
  const std::size_t once = unseen.size() - count(unseen) - count(seen_more);
  if (count(unseen) == unseen.size()) {
    result.fully_transparent = opaque_texels(before) == 0;
    return result;
  }
  std::size_t number = 0;
  for (std::uint8_t& dropped : result.dropped)
    if (dropped == 0) dropped = unseen[number++];
  auto made = std::make_shared<BakedObject>(count(unseen) == 0 ? *single : *triangles_of(*single, unseen, false));
  // The slimmed object keeps the bodies: it counts as baked without the unseen triangles.
  made->bodies = before.bodies;
  Loss loss;
  if (edit.psnr > 0) loss = best_loss(*made, edit.psnr, progress);
  const bool keeps_order = std::any_of(placements.begin(), placements.end(), needs_stored_selection);
  auto smaller = keeps_order ? std::nullopt : packed(*made, loss.alike.representative_of);
  if (keeps_order)
    result.lines.emplace_back(
        "texels stay where they are, because keyframes of a bend need a stored selection, which the order of triangles "
        "belongs to");
  if (smaller) {
    made->sets = std::move(*smaller);
    result.reordered = true;
  } else if (loss.alike.merged > 0) {
    loss = {{}, fewest_bits(*made, edit.psnr, progress)};
  }
  bool changed = result.reordered || count(result.dropped) > 0;
  for (TextureSet& set : made->sets) {
    const auto was = set.texels;
    set.texels = without_unused_texels(set);
    if (edit.psnr > 0) set.texels = with_bits(set.texels, loss.bits.bits);
    changed = changed || set.texels != was;
  }
  const std::size_t removed = count(unseen);
  if (removed > 0 && std::any_of(placements.begin(), placements.end(), [](const PlacedNode& placed) {
        return placed.node->motion && !placed.node->motion->bends.empty();
      }))
    result.lines.emplace_back(
        "note: visibility was computed at rest; keyframed bends may show triangles that were removed");
  result.lines.push_back(
      fmt::format("{} of {} removed{} ({} unseen, {}), opaque texels {} → {}, {} → "
                  "{} texels in total",
                  removed + duplicates, triangles_text(all), placements.size() > 1 ? " in each" : "", removed,
                  counted(duplicates, "duplicate"), opaque_texels(before), opaque_texels(*made), texel_area(before),
                  texel_area(*made)));
  if (removed > 0) result.lines.push_back(visibility_words(unseen, opaque, rays, rays_each, opening, once));
  if (edit.psnr > 0) result.lines.push_back(loss_words(loss));
  // If nothing changed, the object stays shared.
  result.object = changed ? made : placements.front().node->object;
  return result;
}

}  // namespace

Outcome apply(const Scene& scene, const Slim& edit, const Progress& progress) {
  if (edit.rays < 16 || edit.rays > 1 << 20) throw FieldError("rays", "must lie between 16 and 1048576");
  if (edit.psnr != 0 && !(edit.psnr >= 20 && edit.psnr <= 80))
    throw FieldError("psnr", "must lie between 20 and 80 dB, or be 0 (lossless)");
  if (edit.eyes && !edit.views.empty()) throw FieldError("eyes", "cannot be combined with views");
  if (edit.eyes && !((edit.eyes->max - edit.eyes->min).minCoeff() >= 0))
    throw FieldError("eyes", "min must not be above max");
  std::vector<Camera> cameras;
  for (const std::string& name : edit.views) cameras.push_back(stored_view(scene, name, "views"));
  // Nodes that share an object continue to share it: a triangle that is visible in any of them stays.
  std::vector<std::vector<PlacedNode>> groups;
  for (const PlacedNode& placed : selectable(scene, edit.node)) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& other) {
      return other.front().node->object == placed.node->object;
    });
    if (group == groups.end())
      groups.push_back({placed});
    else
      group->push_back(placed);
  }
  Scene result = scene;
  std::vector<std::string> lines;
  for (const std::vector<PlacedNode>& group : groups) {
    const BakedObject& before = *group.front().node->object;
    const Slimmed slimmed = slimmed_object(before, group, cameras, edit, progress);
    const std::string& first = group.front().node->name;
    const std::string name = group.size() == 1
                                 ? fmt::format("\"{}\"", first)
                                 : fmt::format("\"{}\" and {} its object", first,
                                               counted(group.size() - 1, "node that shares", "nodes that share"));
    if (!slimmed.object) {
      const std::string why =
          slimmed.fully_transparent ? "has no opaque texel, so it can be removed" : "is not visible from there";
      if (groups.size() == 1) throw EditError(fmt::format("{} {}; nothing was changed", name, why));
      lines.push_back(fmt::format("{} {}; it was not changed", name, why));
      continue;
    }
    for (const std::string& line : slimmed.lines) lines.push_back(fmt::format("{}: {}", name, line));
    if (slimmed.object.get() == &before) continue;
    bool lost = false, deselected = false;
    for (const PlacedNode& placed : group)
      result = with_changed(result, placed.node->id, [&](Node& node) {
        deselected = deselected || node.selection != nullptr;
        // Stored selections remain valid if the order of triangles does not change.
        if (count(slimmed.dropped) > 0) keep_triangles(node, slimmed.dropped, false);
        lost = lost || (slimmed.reordered && !node.saved_selections.empty());
        if (slimmed.reordered) node.saved_selections.clear();
        node.object = slimmed.object;
        node.selection = nullptr;
      });
    if (lost)
      lines.push_back(
          fmt::format("note: {}: stored selections were removed, because the order of triangles changed", name));
    if (deselected) lines.push_back(fmt::format("{}: the selection was cleared", name));
    if (count(slimmed.dropped) > 0 && (scene.light || !before.bodies.empty()))
      lines.push_back(fmt::format(
          "{}: light that follows edits treats slimmed triangles as removed; slim the scene before light is set",
          name));
  }
  return {std::move(result), {std::move(lines)}};
}

std::string change_title(const Slim&, const SceneChange& change, const Slim*) {
  if (change.names.empty()) return "Slimmed nothing";
  return "Slimmed " + listed(change.names) + " by " + triangles_text(change.triangles_before - change.triangles_after);
}

REBAKE_DESCRIBE_EDIT(
    Slim,
    "Removes unseen and duplicate triangles, repacks the remaining texels, and, if psnr is given, "
    "merges near-duplicate patches and removes feature bits: smaller folders, faster rendering.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible objects. Objects do not occlude each other");
      visit("views", edit.views, Need::optional,
            "names of stored views: triangles not visible from any of them are removed; the report states the "
            "confidence");
      visit("eyes", edit.eyes, Need::optional,
            "world box: triangles not visible from inside it are removed; default: those not visible from outside the "
            "object");
      visit(
          "rays", edit.rays, Need::optional,
          "maximum number of rays per unseen triangle, 16 to 1048576: starts with 1024, doubled until a doubling finds "
          "nothing "
          "more");
      visit("psnr", edit.psnr, Need::optional,
            "PSNR of texel colours in dB, 20 to 80, relative to the present ones; near-duplicate patches become "
            "one (so erasing in one erases in all) and features lose bits; 0: lossless, the remaining texels stay as "
            "they are");
    })

}  // namespace rebake
