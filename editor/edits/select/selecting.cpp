#include "editor/edits/select/selecting.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "editor/edits/stored_view.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/index/traits.h"
#include "mesh_ops/mesh/point_triangle.h"

namespace rebake {

namespace {

Picture picture_of(const Scene& scene, const PictureFields& fields, const std::vector<PlacedNode>& targets) {
  if (fields.camera.has_value() == !fields.view.empty())
    throw FieldError("camera", "exactly one of view and camera must be given");
  Picture picture{fields.camera.value_or(Camera{}), fields.size.width, fields.size.height};
  if (!fields.view.empty()) picture.camera = stored_view(scene, fields.view);
  Box bounds;
  for (const std::vector<PlacedNode>& placed_objects : {visible_objects(scene), targets})
    for (const PlacedNode& placed : placed_objects)
      if (placed.node->object) bounds.extend(transformed(placed.node->object->bounds(), placed.to_world));
  picture.camera =
      with_planes(picture.camera, bounds, static_cast<double>(picture.width) / std::max(1, picture.height));
  return picture;
}

PixelMask mask_of(const PictureFields& fields) {
  if (fields.polygon && fields.brush) throw FieldError("brush", "cannot be combined with polygon");
  if (!fields.polygon && !fields.brush && !fields.depth)
    throw FieldError("polygon", "at least one of polygon, brush and depth must be given");
  const auto [width, height] = fields.size;
  if (fields.polygon) return polygon_mask(fields.polygon->corners, width, height);
  if (fields.brush) return brush_mask(fields.brush->points, fields.brush->radius, width, height);
  return full_mask(width, height);
}

}  // namespace

std::vector<PlacedNode> selectable(const Scene& scene, const std::optional<NodeRef>& node) {
  std::vector<NodeId> inside;
  if (node) inside.push_back(editable(scene, node->id).node->id);
  std::vector<PlacedNode> result;
  for (PlacedNode& placed : placed_nodes(scene)) {
    if (node) {
      if (std::find(inside.begin(), inside.end(), placed.node->id) == inside.end()) continue;
      for (const NodePtr& child : placed.node->children) inside.push_back(child->id);
    }
    // A hidden object counts only if it is named itself.
    const bool named = node && placed.node->id == node->id;
    if (placed.node->object && !placed.locked && (placed.visible || named)) result.push_back(std::move(placed));
  }
  if (result.empty())
    throw EditError(
        node ? fmt::format("\"{}\" contains no visible, unlocked object", present(scene, node->id).node->name)
             : "there is no visible, unlocked object");
  return result;
}

std::vector<PlacedNode> visible_objects(const Scene& scene) {
  std::vector<PlacedNode> result;
  for (PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object && placed.visible) result.push_back(std::move(placed));
  return result;
}

TriangleSet selection_of(const PlacedNode& placed) {
  return placed.node->selection ? *placed.node->selection : TriangleSet(placed.node->object->triangle_count(), 0);
}

Scene with_selected(const Scene& scene, const std::vector<PlacedNode>& targets, SelectMode mode,
                    const std::function<TriangleSet(const PlacedNode&)>& found) {
  Scene result = scene;
  for (const PlacedNode& placed : targets) {
    TriangleSet flags = found(placed);
    if (mode != SelectMode::set) {
      const TriangleSet before = selection_of(placed);
      for (std::size_t f = 0; f < flags.size(); ++f) {
        const bool was = before[f] != 0, is = flags[f] != 0;
        flags[f] = mode == SelectMode::add ? was || is : mode == SelectMode::remove ? was && !is : was && is;
      }
    }
    result = with_changed(result, placed.node->id, [&](Node& node) {
      node.selection = count(flags) == 0 ? nullptr : std::make_shared<const TriangleSet>(std::move(flags));
    });
  }
  return result;
}

namespace {

struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  NearestTriangle triangle{0, 0};
  // Order with ties broken by number, so that the result does not depend on the order of evaluation.
  bool before(const Nearest& other) const {
    return std::tie(distance, triangle.target, triangle.triangle) <
           std::tie(other.distance, other.triangle.target, other.triangle.triangle);
  }
};

double distance_to(const Box& box, const Vec3& point) {
  return (box.min() - point).cwiseMax(point - box.max()).cwiseMax(0).stableNorm();
}

struct SetOfTarget {
  double distance;  // from the point to the set's bounding box
  const TextureSet* set;
  std::size_t target, first;  // index of the target; number of the set's first triangle in it
};

// The nearer of `best` and the nearest triangle of a set. A distance is never below that of the bounding boxes, not
// even by rounding, so the result does not depend on which triangles are skipped.
Nearest nearest_of_set(const SetOfTarget& part, const Affine& to_world, const Vec3& world, bool opaque,
                       const Nearest& best) {
  const TextureSet& set = *part.set;
  const std::vector<Vec3>& p = set.soup.positions();
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, set.soup.triangle_count(), 4096), best,
      [&](const tbb::blocked_range<std::size_t>& range, Nearest least) {
        for (std::size_t f = range.begin(); f < range.end(); ++f) {
          const Face& face = set.soup.faces()[f];
          const Vec3 corners[] = {to_world * p[face[0]], to_world * p[face[1]], to_world * p[face[2]]};
          Box box(corners[0]);
          box.extend(corners[1]).extend(corners[2]);
          const double bound = std::max(part.distance, distance_to(box, world));
          if (bound > least.distance) continue;
          const double distance = distance_to_triangle(corners[0], corners[1], corners[2], world);
          const Nearest found{std::max(bound, distance), {part.target, part.first + f}};
          if (found.before(least) && (!opaque || shows_opaque(set, f))) least = found;
        }
        return least;
      },
      [](const Nearest& a, const Nearest& b) { return b.before(a) ? b : a; });
}

}  // namespace

NearestTriangle nearest_triangle(const std::vector<PlacedNode>& targets, const Vec3& world, bool opaque) {
  std::vector<SetOfTarget> parts;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    std::size_t first = 0;
    for (const TextureSet& set : targets[k].node->object->sets) {
      if (set.soup.triangle_count() > 0)
        parts.push_back({distance_to(transformed(set.soup.bounds(), targets[k].to_world), world), &set, k, first});
      first += set.soup.triangle_count();
    }
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const SetOfTarget& a, const SetOfTarget& b) { return a.distance < b.distance; });
  Nearest nearest;
  for (const SetOfTarget& part : parts) {
    if (part.distance > nearest.distance) break;
    nearest = nearest_of_set(part, targets[part.target].to_world, world, opaque, nearest);
  }
  if (!std::isfinite(nearest.distance))
    throw EditError("all objects are completely transparent, so there is no nearest triangle");
  return nearest.triangle;
}

void WeldingField::check() const {
  if (tolerance < 0) throw FieldError("tolerance", "must not be negative");
}

Connectivity ConnectivityFields::checked() const {
  welding.check();
  if (gap < 0) throw FieldError("gap", "must not be negative");
  return {welding.tolerance, gap};
}

Scene with_repeated_morphology(const Scene& scene, const std::optional<NodeRef>& node, int steps,
                               const WeldingField& welding,
                               TriangleSet (*change)(const WeldedCorners&, const TriangleSet&)) {
  if (steps < 1) throw FieldError("steps", "must be at least 1");
  welding.check();
  const std::vector<PlacedNode> targets = selectable(scene, node);
  objects_with_selection(scene, node);
  return with_selected(scene, targets, SelectMode::set, [&](const PlacedNode& placed) {
    const auto corners = corners_of(*placed.node->object, welding.tolerance);
    TriangleSet flags = selection_of(placed);
    for (int step = 0; step < steps; ++step) {
      TriangleSet next = change(*corners, flags);
      if (next == flags) break;
      flags = std::move(next);
    }
    return flags;
  });
}

PictureRegion::PictureRegion(const Scene& scene, const PictureFields& fields, const std::vector<PlacedNode>& targets)
    : projector_(picture_of(scene, fields, targets)),
      mask_(mask_of(fields)),
      depth_(fields.depth.value_or(Interval{0, std::numeric_limits<double>::infinity()})) {
  for (int y = 0; y < mask_.height; ++y)
    for (int x = 0; x < mask_.width; ++x)
      if (mask_.at(x, y)) flagged_.extend(Eigen::Vector2i(x, y));
}

bool PictureRegion::contains(const Vec3& world) const {
  Projector::At at;
  return projector_(world, at) && at.depth >= depth_.min && at.depth <= depth_.max && mask_.at(at.x, at.y);
}

bool PictureRegion::may_touch(const std::array<Vec3, 3>& world) const {
  Eigen::AlignedBox2i covered;
  for (const Vec3& corner : world) {
    Projector::At at;
    // A triangle that crosses the near plane may cover pixels outside the box of its projected corners.
    if (!projector_(corner, at)) return true;
    covered.extend(Eigen::Vector2i(at.x, at.y));
  }
  return flagged_.intersects(covered);
}

}  // namespace rebake
