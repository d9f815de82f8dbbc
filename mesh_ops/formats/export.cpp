#include "mesh_ops/formats/export.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/features/atlas/rotation_groups.h"
#include "mesh_ops/features/distill/diffuse_network.h"
#include "mesh_ops/formats/mobilenerf/write_baked_folder.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/motion/scene_at.h"

namespace rebake {

namespace {

bool has_rotation(const Soup& soup, std::size_t face, const PackedRotation& turn) {
  return soup.rotations() == nullptr ? turn.is_identity() : (*soup.rotations())[soup.faces()[face][0]] == turn;
}

// The distinct rotations of the faces of an object without bent faces.
std::vector<PackedRotation> distinct_rotations(const BakedObject& object) {
  std::vector<PackedRotation> turns;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces()) {
      const PackedRotation turn = set.soup.rotations() == nullptr ? PackedRotation() : (*set.soup.rotations())[face[0]];
      if (turns.empty() || turns.back() != turn)
        if (std::find(turns.begin(), turns.end(), turn) == turns.end()) turns.push_back(turn);
      if (set.soup.rotations() == nullptr) break;
    }
  return turns;
}

// Rotation for bent faces: the most common rotation of the other faces, or the mean of the bent ones.
Mat3 bent_rotation(const BakedObject& object, const RotationGroups& groups) {
  const RotationGroups::Group* commonest = nullptr;
  for (std::uint32_t g = 0; g < groups.groups.size(); ++g)
    if (std::find(groups.group_of.begin(), groups.group_of.end(), g) != groups.group_of.end() &&
        (commonest == nullptr || groups.groups[g].faces > commonest->faces))
      commonest = &groups.groups[g];
  if (commonest != nullptr) return commonest->turn;
  Mat3 sum = Mat3::Zero();
  for (const TextureSet& set : object.sets)
    if (set.soup.rotations() != nullptr)
      for (const PackedRotation& turn : *set.soup.rotations()) sum += turn.matrix();
  return local_rotation(sum).rotation;
}

// The object's triangles with rotation `turn` (or all), in world space and without rotations. Unchanged arrays are
// shared.
std::vector<TextureSet> world_sets(const BakedObject& object, const PackedRotation& turn, bool all,
                                   const Affine& to_world) {
  std::vector<TextureSet> sets;
  for (const TextureSet& set : object.sets) {
    Soup soup = set.soup;
    if (!all) {
      TriangleSet flags(soup.triangle_count());
      for (std::size_t f = 0; f < flags.size(); ++f) flags[f] = has_rotation(soup, f, turn) ? 1 : 0;
      soup = subset(soup, flags, 0, true);
      if (soup.triangle_count() == 0) continue;
    }
    Soup::Positions positions = soup.shared_positions();
    if (!to_world.matrix().isIdentity(0)) {
      std::vector<Vec3> moved(positions->size());
      std::transform(positions->begin(), positions->end(), moved.begin(), [&](const Vec3& p) { return to_world * p; });
      positions = std::make_shared<const std::vector<Vec3>>(std::move(moved));
    }
    sets.push_back({Soup(positions, soup.shared_uvs(), soup.shared_faces()), set.texels});
  }
  return sets;
}

}  // namespace

Scene without_bends(const Scene& scene, std::vector<std::string>* bent) {
  Scene result = scene;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object || !placed.node->object->any_rotations()) continue;
    const RotationGroups groups = rotation_groups(*placed.node->object);
    if (groups.any_bent && bent != nullptr) bent->push_back(placed.node->name);
    const Mat3 other = groups.any_bent ? bent_rotation(*placed.node->object, groups) : Mat3(Mat3::Identity());
    auto object = std::make_shared<BakedObject>(*placed.node->object);
    std::size_t first = 0;
    for (TextureSet& set : object->sets) {
      const auto give = [&](std::uint32_t group, const Mat3& turn) {
        TriangleSet flags(groups.group_of.size());
        for (std::size_t f = 0; f < flags.size(); ++f) flags[f] = groups.group_of[f] == group ? 1 : 0;
        set.soup = change_vertices(set.soup, flags, first, [&](std::uint32_t, Vec3&, Mat3& old) { old = turn; });
      };
      const std::size_t last = first + set.soup.triangle_count();
      std::set<std::uint32_t> present(groups.group_of.begin() + static_cast<std::ptrdiff_t>(first),
                                      groups.group_of.begin() + static_cast<std::ptrdiff_t>(last));
      for (const std::uint32_t group : present)
        give(group, group == RotationGroups::bent ? other : groups.groups[group].turn);
      first = last;
    }
    result = with_changed(result, placed.node->id, [&](Node& node) { node.object = object; });
  }
  return result;
}

std::vector<Node> merged_for_export(const Scene& scene, std::optional<Layout> layout, bool* reordered,
                                    std::vector<std::string>* lost_members) {
  if (reordered != nullptr) *reordered = false;
  struct Group {
    std::string name;
    BakedObject object;
  };
  std::vector<Group> groups;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object || placed.node->object->triangle_count() == 0) continue;
    const BakedObject& object = *placed.node->object;
    if (!placed.visible) continue;
    Mat3 node_turn;
    try {
      node_turn = orthogonal_factor(placed.to_world.linear());
    } catch (const std::invalid_argument& error) {
      throw EditError(fmt::format("node \"{}\": {}", placed.node->name, error.what()));
    }
    const std::vector<PackedRotation> turns = distinct_rotations(object);
    for (const PackedRotation& turn : turns) {
      std::vector<TextureSet> sets = world_sets(object, turn, turns.size() == 1, placed.to_world);
      const Mat3 whole = node_turn * turn.matrix();
      // Folds into the axes of an existing group, whose weights then may be equal.
      const auto folded_into = [&](Axes axes) {
        if (whole.isIdentity(0) && axes == object.axes) return object.decoder;
        return std::make_shared<const Decoder>(fold_rotation(*object.decoder, whole, object.axes, axes));
      };
      Group* found = nullptr;
      for (Group& group : groups)
        if ((layout || group.object.layout == object.layout) &&
            nearly_equal(*folded_into(group.object.axes), *group.object.decoder))
          found = &group;
      if (found == nullptr) {
        Group group{placed.node->name, {}};
        group.object.axes = object.axes;
        group.object.layout = layout.value_or(object.layout);
        group.object.dialect = object.dialect;
        group.object.decoder = folded_into(object.axes);
        group.object.origin = object.origin;
        group.object.other_members = object.other_members;
        groups.push_back(std::move(group));
        found = &groups.back();
      } else {
        for (const auto& [key, value] : object.other_members)
          if (const auto [known, added] = found->object.other_members.emplace(key, value);
              !added && known->second != value && lost_members != nullptr)
            lost_members->push_back(fmt::format("\"{}\" of \"{}\"", key, placed.node->name));
        if (found->object.origin != object.origin) found->object.origin = nullptr;
        if (found->object.dialect != object.dialect) found->object.dialect = {};
        if (reordered != nullptr && found != &groups.back()) *reordered = true;
      }
      for (TextureSet& set : sets) {
        const auto same = std::find_if(found->object.sets.begin(), found->object.sets.end(),
                                       [&](const TextureSet& s) { return s.texels == set.texels; });
        if (same == found->object.sets.end())
          found->object.sets.push_back(std::move(set));
        else
          same->soup = united(same->soup, set.soup);
      }
    }
  }
  std::vector<Node> nodes;
  for (Group& group : groups) {
    Node node;
    node.name = group.name;
    node.object = std::make_shared<const BakedObject>(std::move(group.object));
    nodes.push_back(std::move(node));
  }
  return nodes;
}

void add_notes_of_merging(bool reordered, const std::vector<std::string>& lost_members,
                          std::vector<std::string>& notes) {
  if (reordered)
    notes.emplace_back(
        "objects with the same decoder are now drawn together: where surfaces of two objects coincide exactly, the "
        "other of them may show");
  if (!lost_members.empty())
    notes.push_back(
        fmt::format("mlp.json holds one value of each member; these are lost: {}", fmt::join(lost_members, ", ")));
}

void add_notes_of_nodes(const Scene& scene, std::vector<std::string>& notes) {
  bool locked = false, stored = false;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (placed.node->object && !placed.visible)
      notes.push_back(fmt::format("the hidden node \"{}\" is not exported; save keeps it", placed.node->name));
    locked = locked || placed.node->locked;
    stored = stored || !placed.node->saved_selections.empty();
  }
  if (locked) notes.emplace_back("locks of nodes are not exported; save keeps them");
  if (stored) notes.emplace_back("stored selections are not exported; a project keeps them");
}

void add_notes_of_left_out(const Scene& scene, bool one_folder, std::vector<std::string>& notes) {
  add_notes_of_nodes(scene, notes);
  if (has_keyframes(scene))
    notes.emplace_back("keyframes are not exported; save keeps them, and glTF has them as animations");
  if (!one_folder) {
    if (scene.light) notes.emplace_back("light settings are not exported, which need all nodes; save keeps them");
    return;
  }
  if (!scene.background.isOnes(0)) notes.emplace_back("the format has no background: viewers show white");
  if (!scene.views.empty()) notes.emplace_back("the format has no named views: they are not exported");
  if (scene.ground != Ground{}) notes.emplace_back("the format has no ground: it is not exported");
  if (scene.light) notes.emplace_back("the format has no light settings: they are not exported");
}

namespace {

// What the nodes, of a folder each, do not have in common.
std::string what_separates(const std::vector<Node>& nodes) {
  const BakedObject& first = *nodes.front().object;
  std::vector<std::string> common;
  if (std::any_of(nodes.begin(), nodes.end(), [&](const Node& node) {
        const BakedObject& object = *node.object;
        return !nearly_equal(fold_rotation(*object.decoder, Mat3::Identity(), object.axes, first.axes), *first.decoder);
      }))
    common.emplace_back("one decoder in one orientation");
  if (std::any_of(nodes.begin(), nodes.end(), [&](const Node& node) { return node.object->layout != first.layout; }))
    common.emplace_back("one file layout (option layout)");
  return fmt::format("{}", fmt::join(common, ", "));
}

}  // namespace

ExportReport export_scene(const Scene& scene, const std::filesystem::path& folder, const ExportOptions& options,
                          const Progress& progress) {
  bool reordered = false;
  std::vector<std::string> bent;
  std::vector<std::string> coded;
  std::vector<std::string> lost_members;
  const std::vector<Node> nodes =
      merged_for_export(without_bends(with_networks(scene, &coded), &bent), options.layout, &reordered, &lost_members);
  if (nodes.empty()) throw EditError("there is nothing to export: no visible node has triangles");
  for (const Node& node : nodes)
    if (node.object->decoder->rule != ColorRule::network)
      throw EditError(
          fmt::format("\"{}\" has no MobileNeRF decoder: export with plain, which fits one, or save a "
                      "Rebake scene",
                      node.name));
  ExportReport report;
  report.folders = nodes.size();
  report.one_folder = nodes.size() == 1;
  if (!bent.empty())
    report.notes.push_back(
        fmt::format("the format cannot store how bends rotate colours: {} keeps the colours from before the bend; save "
                    "keeps the rotations",
                    fmt::join(bent, ", ")));
  add_notes_of_merging(reordered, lost_members, report.notes);
  if (!coded.empty())
    report.notes.push_back(fmt::format(
        "plain colours are stored as logits: up to 1/255 off, and more at outlines and where a pixel mixes colours: {}",
        fmt::join(coded, ", ")));
  add_notes_of_left_out(scene, report.one_folder, report.notes);
  AtomicFolder out(folder, options.sources, refuse_foreign_content);
  if (report.one_folder) {
    const BakedObject& object = *nodes.front().object;
    if (object.axes == Axes::forward)
      report.notes.emplace_back(
          "the format does not record that this is a forward-facing scene: open it with --axes forward");
    write_baked_folder(out, {}, object, object.layout, report.notes, progress, false, options.page_side);
  } else {
    report.notes.push_back(
        fmt::format("one folder holds {}: wrote scene.json with {} folders", what_separates(nodes), nodes.size()));
    Scene merged;
    merged.background = scene.background;
    merged.ground = scene.ground;
    merged.views = scene.views;
    std::vector<std::string> taken;
    std::map<const BakedObject*, std::string> folder_of;
    for (const Node& node : nodes) {
      taken.push_back(folder_name(node.name, taken));
      folder_of[node.object.get()] = taken.back();
      write_baked_folder(out, taken.back(), published(*node.object), node.object->layout, report.notes, progress, false,
                         options.page_side);
      merged = with_added(merged, node, NodeId::none, merged.roots.size());
    }
    out.write("scene.json", write_scene_json(merged, folder_of));
  }
  out.commit();
  return report;
}

void check_can_export(const std::filesystem::path& folder, const SourceGuard& sources) {
  const AtomicFolder never_written(folder, sources, refuse_foreign_content);
}

}  // namespace rebake
