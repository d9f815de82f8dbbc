#include "editor/edits/nodes/merge.h"

#include "editor/edits/describe.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/features/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

namespace rebake {

namespace {

// All triangles of a node in the frame of another, which they are to join.
std::vector<TextureSet> sets_in_frame(const PlacedNode& placed, const PlacedNode& frame) {
  std::vector<TextureSet> sets = placed.node->object->sets;
  if (placed.to_world.matrix() == frame.to_world.matrix()) return sets;
  const Affine motion = frame.to_world.inverse() * placed.to_world;
  checked_turn(motion);
  const Mat3 turn =
      orthogonal_factor(frame.to_world.linear()).transpose() * orthogonal_factor(placed.to_world.linear());
  const Eigen::Matrix3f linear = motion.linear().cast<float>();
  for (TextureSet& set : sets) {
    const Attributes::Shared displaced = set.soup.vertex_attributes().shared(Soup::displacement);
    set.soup = move_faces(set.soup, std::vector<std::uint8_t>(set.soup.triangle_count(), 1), 0, motion, turn);
    // The frame is another one; nothing went away from where it was baked.
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

// Adds a node's bodies, in the frame of another, to those of what it joins; faces tell theirs by number where there are
// several.
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
    throw EditError("more than 65535 objects would become one; group them instead");
  for (TextureSet& set : sets) {
    const auto* own = set.soup.face_attributes().find<std::uint16_t>(BakedObject::body);
    std::vector<std::uint16_t> joined(set.soup.triangle_count());
    for (std::size_t f = 0; f < joined.size(); ++f) joined[f] = numbers[own != nullptr ? (*own)[f] : 0];
    const Attributes attributes =
        set.soup.face_attributes().with(BakedObject::body, Values<std::uint16_t>::of(std::move(joined)));
    if (attributes != set.soup.face_attributes()) set.soup = set.soup.with_face_attributes(attributes);
  }
}

// Where a set's texels come among those that the object was read with.
std::size_t place_in_origin(const BakedObject& object, const TextureSet& set) {
  if (!object.origin) return 0;
  const auto& sources = object.origin->sets;
  return static_cast<std::size_t>(
      std::find_if(sources.begin(), sources.end(),
                   [&](const Origin::Set& source) { return source.texels.lock() == set.texels; }) -
      sources.begin());
}

}  // namespace

Scene apply(const Scene& scene, const Merge& edit) {
  if (edit.nodes.size() < 2) throw FieldError("nodes", "must name at least two nodes");
  std::vector<PlacedNode> parts;
  for (const NodeRef& node : edit.nodes) {
    parts.push_back(editable(scene, node.id));
    const PlacedNode& part = parts.back();
    if (!part.node->object) throw EditError(fmt::format("\"{}\" is a group; merge its objects", part.node->name));
    if (!part.node->children.empty())
      throw EditError(fmt::format("\"{}\" groups other nodes; move them out first", part.node->name));
    const BakedObject &first = *parts.front().node->object, &other = *part.node->object;
    if (!(*other.decoder == *first.decoder) || other.axes != first.axes)
      throw EditError(
          fmt::format("\"{}\" and \"{}\" have different decoders or axes; one object can have only one: "
                      "group them instead",
                      parts.front().node->name, part.node->name));
    for (std::size_t k = 0; k + 1 < parts.size(); ++k)
      if (parts[k].node->id == part.node->id)
        throw FieldError("nodes", fmt::format("\"{}\" is named twice", part.node->name));
  }
  const PlacedNode& first = parts.front();
  if (!edit.as.empty() && edit.as != first.node->name && find(scene, edit.as) != nullptr)
    throw FieldError("as", "\"" + edit.as + "\" is the name of another node already");
  // One object has one way to store features 3 and 7: where parts differ, the one that holds the others' values
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
  for (const PlacedNode& part : parts) {
    if (part.node->object->origin != merged->origin) merged->origin = nullptr;
    std::vector<TextureSet> sets = sets_in_frame(part, first);
    join_bodies(merged->bodies, part, first, sets);
    for (TextureSet& set : sets) {
      if (any_plain && set.texels->alpha_code() != AlphaCode::plain) {
        auto& plain = converted[set.texels.get()];
        if (!plain) plain = with_alpha_code(set.texels, AlphaCode::plain);
        set.texels = plain;
      }
      const auto same = std::find_if(merged->sets.begin(), merged->sets.end(),
                                     [&](const TextureSet& s) { return s.texels == set.texels; });
      if (same == merged->sets.end())
        merged->sets.push_back(std::move(set));
      else
        same->soup = united(same->soup, set.soup);
    }
  }
  std::stable_sort(merged->sets.begin(), merged->sets.end(), [&](const TextureSet& a, const TextureSet& b) {
    return place_in_origin(*merged, a) < place_in_origin(*merged, b);
  });
  Scene result = with_changed(scene, first.node->id, [&](Node& node) {
    if (!edit.as.empty()) node.name = edit.as;
    node.object = merged;
    node.selection = nullptr;
    node.saved_selections.clear();
  });
  for (std::size_t k = 1; k < parts.size(); ++k) result = without(result, parts[k].node->id);
  return result;
}

REBAKE_DESCRIBE_EDIT(
    Merge,
    "Makes objects of one decoder one node, in place of the first; parts that were separated before fit together "
    "again "
    "as they were.",
    (auto& edit, auto& visit) {
      visit("nodes", edit.nodes, Need::required, "nodes to merge, in drawing order");
      visit("as", edit.as, Need::optional, "name of the result; empty: the first one's");
    })

}  // namespace rebake
