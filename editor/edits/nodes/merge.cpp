#include "editor/edits/nodes/merge.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/features/atlas/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace rebake {

namespace {

// The texture sets of a node, transformed to the object space of `frame`.
std::vector<TextureSet> sets_in_frame(const PlacedNode& placed, const PlacedNode& frame) {
  std::vector<TextureSet> sets = placed.node->object->sets;
  if (placed.to_world.matrix() == frame.to_world.matrix()) return sets;
  const Affine motion = frame.to_world.inverse() * placed.to_world;
  check_invertible(motion);
  const Mat3 turn =
      orthogonal_factor(frame.to_world.linear()).transpose() * orthogonal_factor(placed.to_world.linear());
  const Eigen::Matrix3f linear = motion.linear().cast<float>();
  for (TextureSet& set : sets) {
    const Attributes::Shared displaced = set.soup.vertex_attributes().shared(Soup::displacement);
    set.soup = move_faces(set.soup, std::vector<std::uint8_t>(set.soup.triangle_count(), 1), 0, motion, turn);
    // Only the frame changes: move_faces() must not count as a displacement from the baked position.
    if (displaced) {
      std::vector<Eigen::Vector3f> turned = dynamic_cast<const Values<Eigen::Vector3f>&>(*displaced).get();
      for (Eigen::Vector3f& d : turned) d = linear * d;
      set.soup = set.soup.with_displacement(Values<Eigen::Vector3f>::of(std::move(turned)));
    } else {
      set.soup = set.soup.with_displacement(nullptr);
    }
  }
  return sets;
}

// Adds a node's baked bodies to `bodies`, in the object space of `frame`, and updates the body number of each face.
void join_bodies(std::vector<BakedBody>& bodies, const PlacedNode& placed, const PlacedNode& frame,
                 std::vector<TextureSet>& sets) {
  const bool moves = placed.to_world.matrix() != frame.to_world.matrix();
  std::vector<std::uint16_t> numbers;
  for (BakedBody body : bodies_of(*placed.node->object)) {
    if (moves) body.to_object = frame.to_world.inverse() * placed.to_world * body.to_object;
    auto found = std::find_if(bodies.begin(), bodies.end(), [&](const BakedBody& b) { return same_body(b, body); });
    if (found == bodies.end()) found = bodies.insert(found, body);
    numbers.push_back(static_cast<std::uint16_t>(found - bodies.begin()));
  }
  if (bodies.size() > std::numeric_limits<std::uint16_t>::max())
    throw EditError("more than 65535 objects cannot be merged; group them instead");
  for (TextureSet& set : sets) {
    const auto* own = set.soup.face_attributes().find<std::uint16_t>(BakedObject::body);
    std::vector<std::uint16_t> joined(set.soup.triangle_count());
    for (std::size_t f = 0; f < joined.size(); ++f) joined[f] = numbers[own != nullptr ? (*own)[f] : 0];
    const Attributes attributes =
        set.soup.face_attributes().with(BakedObject::body, Values<std::uint16_t>::of(std::move(joined)));
    if (attributes != set.soup.face_attributes()) set.soup = set.soup.with_face_attributes(attributes);
  }
}

// Index of a set's texture among those that the object was read with; behind all of them for a new texture.
std::size_t place_in_origin(const BakedObject& object, const TextureSet& set) {
  if (!object.origin) return 0;
  const auto& sources = object.origin->sets;
  return static_cast<std::size_t>(
      std::find_if(sources.begin(), sources.end(),
                   [&](const Origin::Set& source) { return source.texels.lock() == set.texels; }) -
      sources.begin());
}

// Names of all stored selections of the parts, after an empty name for the present selection.
std::vector<std::string> selection_names(const std::vector<PlacedNode>& parts) {
  std::set<std::string> stored;
  for (const PlacedNode& part : parts)
    for (const auto& [name, flags] : part.node->saved_selections) stored.insert(name);
  std::vector<std::string> names{""};
  names.insert(names.end(), stored.begin(), stored.end());
  return names;
}

// A texture set, and per selection name a flag for each of its triangles.
struct SelectedSet {
  TextureSet set;
  std::vector<TriangleSet> selections;
};

std::vector<SelectedSet> with_selections(std::vector<TextureSet> sets, const Node& node,
                                         const std::vector<std::string>& names) {
  std::vector<SelectedSet> result;
  std::ptrdiff_t first = 0;
  for (TextureSet& set : sets) {
    const auto count = static_cast<std::ptrdiff_t>(set.soup.triangle_count());
    SelectedSet one{std::move(set), {}};
    for (const std::string& name : names) {
      const auto stored = node.saved_selections.find(name);
      const TriangleSet* flags = name.empty()                            ? node.selection.get()
                                 : stored != node.saved_selections.end() ? stored->second.get()
                                                                         : nullptr;
      one.selections.push_back(flags == nullptr ? TriangleSet(static_cast<std::size_t>(count), 0)
                                                : TriangleSet(flags->begin() + first, flags->begin() + first + count));
    }
    first += count;
    result.push_back(std::move(one));
  }
  return result;
}

// Joins two parts of one texture, see united() of soups.
SelectedSet united(const SelectedSet& a, const SelectedSet& b) {
  SelectedSet result{{united(a.set.soup, b.set.soup), a.set.texels}, {}};
  const std::vector<std::uint32_t> order = faces_of_united(a.set.soup, b.set.soup);
  for (std::size_t n = 0; n < a.selections.size(); ++n) {
    TriangleSet flags;
    for (const std::uint32_t face : order)
      flags.push_back(face < a.selections[n].size() ? a.selections[n][face]
                                                    : b.selections[n][face - a.selections[n].size()]);
    result.selections.push_back(std::move(flags));
  }
  return result;
}

void give_selections(Node& node, const std::vector<SelectedSet>& sets, const std::vector<std::string>& names) {
  node.saved_selections.clear();
  for (std::size_t n = 0; n < names.size(); ++n) {
    TriangleSet flags;
    for (const SelectedSet& one : sets) flags.insert(flags.end(), one.selections[n].begin(), one.selections[n].end());
    const bool any = count(flags) > 0;
    auto shared = std::make_shared<const TriangleSet>(std::move(flags));
    if (names[n].empty())
      node.selection = any ? std::move(shared) : nullptr;
    else
      node.saved_selections[names[n]] = std::move(shared);
  }
}

// The groups that move a node by keyframes.
std::set<NodeId> moving_groups(const Scene& scene, NodeId node) {
  std::set<NodeId> groups;
  for (NodeId up = parent_of(scene, node); up != NodeId::none; up = parent_of(scene, up))
    if (find(scene, up)->motion) groups.insert(up);
  return groups;
}

// Throws EditError if the nodes have different keyframes. Notes if films move them differently nevertheless, since
// keyframes are relative to a node's parent and its space.
void check_motions(const Scene& scene, const PlacedNode& first, const PlacedNode& part, Report& report) {
  const NodeMotion still;
  const auto motion = [&](const PlacedNode& one) { return one.node->motion ? *one.node->motion : still; };
  if (!(motion(part) == motion(first)))
    throw EditError(
        fmt::format("\"{}\" and \"{}\" have different keyframes, so they cannot become one object: remove "
                    "the keyframes, or group the nodes instead",
                    first.node->name, part.node->name));
  const bool same_space = parent_of(scene, first.node->id) == parent_of(scene, part.node->id) &&
                          first.to_world.matrix() == part.to_world.matrix();
  if ((!motion(part).empty() && !same_space) ||
      moving_groups(scene, first.node->id) != moving_groups(scene, part.node->id))
    report.lines.push_back(fmt::format("note: films move \"{}\" as \"{}\" from now on, and no longer in its own place",
                                       part.node->name, first.node->name));
}

// Adds the members of a part's mlp.json that Rebake does not know. Reports those of which another value stays.
void join_members(BakedObject& merged, const Node& part, Report& report) {
  for (const auto& [key, value] : part.object->other_members)
    if (const auto [known, added] = merged.other_members.emplace(key, value); !added && known->second != value)
      report.lines.push_back(
          fmt::format("note: \"{}\" has another value of \"{}\" in its mlp.json, which is lost", part.name, key));
}

}  // namespace

Outcome apply(const Scene& scene, const Merge& edit) {
  if (edit.nodes.size() < 2) throw FieldError("nodes", "must name at least two nodes");
  std::vector<PlacedNode> parts;
  Report report;
  for (const NodeRef& node : edit.nodes) {
    parts.push_back(editable(scene, node.id));
    const PlacedNode& part = parts.back();
    if (!part.node->object) throw EditError(fmt::format("\"{}\" is a group; merge its objects", part.node->name));
    if (!part.node->children.empty())
      throw EditError(fmt::format("\"{}\" has children; move them out first", part.node->name));
    const BakedObject &first = *parts.front().node->object, &other = *part.node->object;
    if (!(*other.decoder == *first.decoder) || other.axes != first.axes)
      throw EditError(
          fmt::format("\"{}\" and \"{}\" have different decoders or axes, so they cannot become one object: "
                      "group them instead",
                      parts.front().node->name, part.node->name));
    check_motions(scene, parts.front(), part, report);
    for (std::size_t k = 0; k + 1 < parts.size(); ++k)
      if (parts[k].node->id == part.node->id)
        throw FieldError("nodes", fmt::format("\"{}\" is named twice", part.node->name));
  }
  const PlacedNode& first = parts.front();
  if (!edit.as.empty() && edit.as != first.node->name && find(scene, edit.as) != nullptr)
    throw FieldError("as", "\"" + edit.as + "\" is already the name of another node; choose another name");
  // An object has one alpha code for features 3 and 7. If parts differ, `plain` is used, which represents all values
  // exactly.
  const bool any_plain = std::any_of(parts.begin(), parts.end(), [](const PlacedNode& part) {
    const auto& sets = part.node->object->sets;
    return std::any_of(sets.begin(), sets.end(),
                       [](const TextureSet& set) { return set.texels->alpha_code() == AlphaCode::plain; });
  });
  std::map<const FeatureTexture*, std::shared_ptr<const FeatureTexture>> converted;
  auto merged = std::make_shared<BakedObject>(*first.node->object);
  merged->sets.clear();
  merged->bodies.clear();
  const std::vector<std::string> selections = selection_names(parts);
  std::vector<SelectedSet> whole;
  for (const PlacedNode& part : parts) {
    join_members(*merged, *part.node, report);
    if (part.visible != first.visible)
      report.lines.push_back(fmt::format(
          "note: \"{}\" was {}; as a part of \"{}\" it is {}", part.node->name, part.visible ? "visible" : "hidden",
          edit.as.empty() ? first.node->name : edit.as, first.visible ? "visible" : "hidden"));
    if (part.node->object->origin != merged->origin) merged->origin = nullptr;
    std::vector<TextureSet> sets = sets_in_frame(part, first);
    join_bodies(merged->bodies, part, first, sets);
    for (SelectedSet& one : with_selections(std::move(sets), *part.node, selections)) {
      if (any_plain && one.set.texels->alpha_code() != AlphaCode::plain) {
        auto& plain = converted[one.set.texels.get()];
        if (!plain) plain = with_alpha_code(one.set.texels, AlphaCode::plain);
        one.set.texels = plain;
      }
      const auto same = std::find_if(whole.begin(), whole.end(),
                                     [&](const SelectedSet& s) { return s.set.texels == one.set.texels; });
      if (same == whole.end())
        whole.push_back(std::move(one));
      else
        *same = united(*same, one);
    }
  }
  std::stable_sort(whole.begin(), whole.end(), [&](const SelectedSet& a, const SelectedSet& b) {
    return place_in_origin(*merged, a.set) < place_in_origin(*merged, b.set);
  });
  for (const SelectedSet& one : whole) merged->sets.push_back(one.set);
  Scene result = with_changed(scene, first.node->id, [&](Node& node) {
    if (!edit.as.empty()) node.name = edit.as;
    node.object = merged;
    give_selections(node, whole, selections);
  });
  for (std::size_t k = 1; k < parts.size(); ++k) result = without(result, parts[k].node->id);
  return {std::move(result), std::move(report)};
}

REBAKE_DESCRIBE_EDIT(
    Merge,
    "Merges objects with the same decoder into one node, in place of the first; separated parts fit together "
    "again "
    "as they were.",
    (auto& edit, auto& visit) {
      visit("nodes", edit.nodes, Need::required, "nodes to merge, in drawing order");
      visit("as", edit.as, Need::optional, "name of the result; empty: that of the first node");
    })

}  // namespace rebake
