#pragma once

#include <vector>

#include "mesh_ops/scene/camera.h"

namespace rebake {

// Camera navigation. Pure functions; from a valid camera they return a valid one. Drags are in pixels, x right and y
// down, of a viewport that is `height` pixels high.

/// Orbits around the target: `height` pixels are 180°. Stops 0.01 rad before the poles of the up axis.
Camera orbited(const Camera& camera, double right_pixels, double down_pixels, int height);
/// Pans: moves eye and target so that points at the target's depth follow the pointer.
Camera panned(const Camera& camera, double right_pixels, double down_pixels, int height);
/// Zooms to a world point: scales the distances of eye and target from it (and the orthographic height) by `factor`.
/// The point keeps its place in the picture. Returns `camera` if double precision does not suffice for the result.
Camera zoomed(const Camera& camera, const Vec3& towards, double factor);
/// Frames a box without changing the view direction. `aspect`: width / height of the viewport. An empty box changes
/// nothing; a box of size 0 only moves the camera.
Camera framed(const Camera& camera, const Box& box, double aspect);
/// Makes a point the target, for orbiting around it. The camera moves sideways only, so the picture is shifted but not
/// scaled. A point behind the eye changes nothing.
Camera with_orbit_center(const Camera& camera, const Vec3& point);
/// Translates eye and target along the camera's axes, in scene units.
Camera flown(const Camera& camera, double right, double up, double forward);
/// Rotates the view direction around the eye (first-person look): `height` pixels are 90°.
Camera looked_around(const Camera& camera, double right_pixels, double down_pixels, int height);
/// Looks at the target along a world axis, from the same distance. `axis` points from the target to the eye.
Camera along_axis(const Camera& camera, const Vec3& axis);
/// Toggles between perspective and orthographic projection; objects at the target keep their size in the picture.
Camera toggled_projection(const Camera& camera);
/// `count` cameras that orbit once around the target.
std::vector<Camera> turntable(const Camera& camera, int count);
/// Sets near and far planes that enclose the box. Moves an orthographic camera along its view direction to a place in
/// front of the box, which does not change the picture.
Camera with_clip_planes_for(const Camera& camera, const Box& box);

}  // namespace rebake
