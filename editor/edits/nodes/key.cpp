#include "editor/edits/nodes/key.h"

#include <fmt/format.h>

#include <cmath>

#include "editor/edits/describe_edit.h"
#include "editor/edits/nodes/place.h"
#include "editor/edits/select/selecting.h"
#include "editor/edits/stored_view.h"
#include "mesh_ops/motion/scene_at.h"

namespace rebake {

namespace {

// Whether the edit states where to bend; otherwise it takes over what the track has.
bool states_region(const Key& edit) {
  const Key none;
  return !edit.selection.empty() || edit.box || edit.falloff != 0 || edit.axis.axis != none.axis.axis ||
         edit.axis.origin || edit.axis.from || edit.axis.to || !edit.axis.spine.points.empty() ||
         edit.direction != none.direction;
}

enum class Target { camera, place, bend };

// What the edit sets a keyframe of. Throws FieldError for contradictory fields.
Target target_of(const Key& edit) {
  if (!(edit.time >= 0 && edit.time <= most_seconds))
    throw FieldError("time", fmt::format("must lie between 0 and {:.0f} s, a day", most_seconds));
  const bool camera = edit.camera.has_value() || !edit.view.empty(),
             place = edit.position.has_value() || edit.rotation.has_value() || edit.scale.has_value();
  if (edit.camera && !edit.view.empty()) throw FieldError("view", "cannot be combined with camera");
  if (camera && edit.node) throw FieldError("node", "cannot be combined with a camera; use one key edit for each");
  if (edit.degrees && place) throw FieldError("degrees", "cannot be combined with a place; use one key edit for each");
  if (edit.degrees && !edit.node) throw FieldError("node", "is missing: name the node that bends");
  if (!edit.node && place) throw FieldError("node", "is missing: name the node to place");
  if (!camera && !edit.node && !edit.remove)
    throw FieldError("node", "is missing: give a node, or a camera or view for a keyframe of the camera");
  if (!edit.degrees && (states_region(edit) || edit.track != Key().track))
    throw FieldError("degrees", "is missing: the other fields describe a bend");
  return edit.degrees ? Target::bend : edit.node ? Target::place : Target::camera;
}

void report_count(Report& report, std::size_t keys, const std::string& what) {
  report.lines.push_back(fmt::format("{} {} of {}", keys, keys == 1 ? "keyframe" : "keyframes", what));
}

Affine placed_by(const Key& edit, const Node& node) {
  if (!edit.position && !edit.rotation && !edit.scale) return node.to_parent;
  // As the edit `place` does it, on a scene of this node alone.
  Scene alone;
  Node copy = node;
  copy.locked = false;
  copy.children.clear();
  alone.roots.push_back(std::make_shared<const Node>(std::move(copy)));
  Place place;
  place.node.id = node.id;
  place.position = edit.position;
  place.rotation = edit.rotation;
  place.scale = edit.scale;
  return apply(alone, place).scene.roots.front()->to_parent;
}

// The region and the axis of a bend, from the fields of the edit.
BendTrack track_of(const Scene& scene, const PlacedNode& placed, const Key& edit) {
  if (!placed.node->object) throw FieldError("node", "is a group; name an object to bend");
  if (!(edit.falloff >= 0)) throw FieldError("falloff", "must not be negative");
  BendTrack track;
  track.selection = edit.selection;
  if (edit.box) {
    const auto [to_box, box] = box_region_of(FrameTransform(edit.frame, placed), *edit.box);
    track.to_box = to_box;
    track.box = box;
  }
  track.falloff = edit.falloff;
  track.to_space = placed.to_world;
  const TriangleSet flags = bent_triangles(*placed.node, track);
  if (count(flags) == 0) throw EditError("no triangle is inside the region of the bend");
  const DeformSet set{{placed}, {flags}};
  // An automatic axis follows the selected triangles.
  const Scene selected = with_changed(scene, placed.node->id,
                                      [&](Node& node) { node.selection = std::make_shared<const TriangleSet>(flags); });
  DeformTarget target;
  target.node = NodeRef{placed.node->id};
  target.selection = true;
  ClosedForm form;
  form.kind = ClosedForm::Kind::bend;
  form.direction = edit.direction;
  const AxisForm made = axis_form(selected, set, target, edit.axis, form);
  track.origin = made.form.origin;
  track.axis = made.form.axis;
  track.direction = made.form.direction;
  track.from = made.form.from;
  track.to = made.form.to;
  track.spine = made.spine;
  return track;
}

Outcome with_camera_key(const Scene& scene, const Key& edit) {
  Scene result = scene;
  if (edit.remove) {
    if (!remove_key(result.camera_keys, edit.time))
      throw FieldError("time", fmt::format("the camera has no keyframe at {:.6g} s", edit.time));
  } else {
    const Camera camera = edit.camera ? *edit.camera : stored_view(scene, edit.view);
    check(camera);
    set_key(result.camera_keys, {edit.time, camera, edit.interpolation});
  }
  Report report;
  report_count(report, result.camera_keys.size(), "the camera");
  return {std::move(result), std::move(report)};
}

}  // namespace

Outcome apply(const Scene& scene, const Key& edit) {
  const Target target = target_of(edit);
  if (target == Target::camera) return with_camera_key(scene, edit);
  const PlacedNode placed = editable(scene, edit.node->id);
  NodeMotion motion = placed.node->motion ? *placed.node->motion : NodeMotion{};
  Report report;
  const auto refuse_missing = [&](bool removed) {
    if (!removed)
      throw FieldError("time", fmt::format("\"{}\" has no such keyframe at {:.6g} s", placed.node->name, edit.time));
  };
  if (target == Target::place) {
    if (edit.remove)
      refuse_missing(remove_key(motion.place, edit.time));
    else
      set_key(motion.place, {edit.time, placed_by(edit, *placed.node), edit.interpolation});
    if (!edit.remove) report.lines = locked_inside(scene, edit.node->id);
    report_count(report, motion.place.size(), fmt::format("the place of \"{}\"", placed.node->name));
  } else {
    if (!std::isfinite(*edit.degrees)) throw FieldError("degrees", "must be finite");
    const auto known = motion.bends.find(edit.track);
    if (edit.remove) {
      refuse_missing(known != motion.bends.end() && remove_key(known->second.degrees, edit.time));
    } else {
      BendTrack track =
          known != motion.bends.end() && !states_region(edit) ? known->second : track_of(scene, placed, edit);
      if (known != motion.bends.end()) {
        track.degrees = known->second.degrees;
        if (states_region(edit))
          report.lines.push_back(
              fmt::format("the bend \"{}\" has the region and axis of this edit for all its keyframes", edit.track));
      }
      set_key(track.degrees, {edit.time, *edit.degrees, edit.interpolation});
      motion.bends[edit.track] = std::move(track);
    }
    report_count(report, motion.bends[edit.track].degrees.size(),
                 fmt::format("the bend \"{}\" of \"{}\"", edit.track, placed.node->name));
    if (motion.bends[edit.track].degrees.empty()) motion.bends.erase(edit.track);
  }
  Scene result = with_changed(scene, edit.node->id, [&](Node& node) {
    node.motion = motion.empty() ? nullptr : std::make_shared<const NodeMotion>(std::move(motion));
  });
  if (!edit.remove) scene_at(result, edit.time);  // throws if the keyframe cannot be shown
  return {std::move(result), std::move(report)};
}

std::string whole_title(const Key& edit) {
  return fmt::format("{} a keyframe at {:.6g} s", edit.remove ? "Removed" : "Set", edit.time);
}

REBAKE_DESCRIBE_EDIT(
    Key,
    "Sets a keyframe of the camera, of a node's place, or of the angle of a bend. Films, published pages and glTF "
    "files "
    "move by keyframes.",
    (auto& edit, auto& visit) {
      visit("time", edit.time, Need::required, "time in seconds");
      visit("node", edit.node, Need::optional, "node to place or to bend; without one, the keyframe is the camera's");
      visit("position", edit.position, Need::optional, "position relative to the parent; default: the present place",
            Unit::length);
      visit("rotation", edit.rotation, Need::optional, "rotation relative to the parent; default: the present one");
      visit("scale", edit.scale, Need::optional, "factors along the node's axes; default: the present ones");
      visit("camera", edit.camera, Need::optional, "the camera");
      visit("view", edit.view, Need::optional, "name of the stored view that the camera takes");
      visit("degrees", edit.degrees, Need::optional, "bends the node by this angle at that time", Unit::degrees);
      visit("track", edit.track, Need::optional, "name of the bend; a node can have several");
      visit(
          "selection", edit.selection, Need::optional,
          "bend: only triangles of this stored selection; a bend keeps its region and axis from keyframe to keyframe, "
          "until one of selection, box, falloff, axis, origin, spine, from, to and direction is given other than its "
          "default: then all of them are taken from that edit, for all keyframes of the bend");
      visit("box", edit.box, Need::optional, "bend: only triangles whose centre is inside");
      visit("frame", edit.frame, Need::optional,
            "coordinates of the box: world; node: object space; bounds: relative to the object's box, 0 to 1");
      visit("falloff", edit.falloff, Need::optional, "bend: width of the soft border; 0: hard", Unit::length);
      DeformAxis::fields(edit.axis, visit);
      visit("direction", edit.direction, Need::optional, "bend: its direction");
      visit("interpolation", edit.interpolation, Need::optional, "how the value moves to the next keyframe");
      visit("remove", edit.remove, Need::optional, "remove the keyframe at this time; for a bend, with any degrees");
    })

}  // namespace rebake
