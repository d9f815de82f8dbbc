#include "editor/edits/nodes/align.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <span>

#include "editor/edits/describe_edit.h"
#include "editor/edits/nodes/transform.h"

namespace rebake {

namespace {

constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};
constexpr std::array<const char*, 4> align_names = {"least", "middle", "greatest", "spread"};

// Index of a word in `words`. Throws Error, which lists them, for another value.
std::size_t read_word(const nlohmann::json& value, std::span<const char* const> words) {
  std::string expected;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (value.is_string() && value.get<std::string>() == words[k]) return k;
    expected += (k == 0 ? "" : k + 1 == words.size() ? " or " : ", ") + std::string(words[k]);
  }
  throw Error("must be " + expected);
}

}  // namespace

FieldType Codec<WorldAxis>::type() { return choice_type({axis_names.begin(), axis_names.end()}); }
WorldAxis Codec<WorldAxis>::read(const nlohmann::json& value, const Scene&) {
  return static_cast<WorldAxis>(read_word(value, axis_names));
}
nlohmann::json Codec<WorldAxis>::write(const WorldAxis& value) { return axis_names[static_cast<std::size_t>(value)]; }

FieldType Codec<AlignTo>::type() { return choice_type({align_names.begin(), align_names.end()}); }
AlignTo Codec<AlignTo>::read(const nlohmann::json& value, const Scene&) {
  return static_cast<AlignTo>(read_word(value, align_names));
}
nlohmann::json Codec<AlignTo>::write(const AlignTo& value) { return align_names[static_cast<std::size_t>(value)]; }

Scene apply(const Scene& scene, const Align& edit) {
  if (edit.nodes.size() < 2) throw FieldError("nodes", "must name at least two nodes");
  const int axis = static_cast<int>(edit.axis);
  struct Placed {
    NodeRef node;
    double low, high;
  };
  std::vector<Placed> list;
  for (const NodeRef& node : edit.nodes) {
    // One that is named twice counts once.
    if (std::any_of(list.begin(), list.end(), [&](const Placed& other) { return other.node.id == node.id; })) continue;
    for (NodeId above = parent_of(scene, node.id); above != NodeId::none; above = parent_of(scene, above))
      if (std::any_of(edit.nodes.begin(), edit.nodes.end(), [&](const NodeRef& other) { return other.id == above; }))
        throw FieldError("nodes", "must not contain a node and a group above it");
    const Box box = triangle_bounds(scene, editable_with_children(scene, node.id).node->id);
    if (box.isEmpty()) throw FieldError("nodes", "must name nodes with triangles");
    list.push_back({node, box.min()[axis], box.max()[axis]});
  }
  std::vector<double> ways(list.size(), 0);
  if (edit.to == AlignTo::spread) {
    // The outermost boxes stay; the gaps between neighbours become equal.
    std::vector<std::size_t> order(list.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return list[a].low + list[a].high < list[b].low + list[b].high;
    });
    double sizes = 0;
    for (const Placed& one : list) sizes += one.high - one.low;
    const double whole = list[order.back()].high - list[order.front()].low;
    const double gap = (whole - sizes) / static_cast<double>(list.size() - 1);
    double at = list[order.front()].low;
    for (const std::size_t k : order) {
      ways[k] = at - list[k].low;
      at += list[k].high - list[k].low + gap;
    }
    ways[order.front()] = ways[order.back()] = 0;
  } else {
    const auto mark = [&](const Placed& one) {
      return edit.to == AlignTo::least ? one.low : edit.to == AlignTo::greatest ? one.high : one.low / 2 + one.high / 2;
    };
    for (std::size_t k = 1; k < list.size(); ++k) ways[k] = mark(list[0]) - mark(list[k]);
  }
  Scene result = scene;
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (ways[k] == 0) continue;
    Transform move;
    move.node = list[k].node;
    move.translate[axis] = ways[k];
    result = apply(result, move);
  }
  return result;
}

REBAKE_DESCRIBE_EDIT(
    Align,
    "Aligns the boxes of nodes along an axis with that of the first node, or distributes them with equal gaps "
    "between neighbours.",
    (auto& edit, auto& visit) {
      visit("nodes", edit.nodes, Need::required, "two or more; the first one stays, or with spread the outermost ones");
      visit("axis", edit.axis, Need::optional, "axis of the world");
      visit("to", edit.to, Need::optional, "lower ends, centres or upper ends of the boxes; spread: equal gaps");
    })

}  // namespace rebake
