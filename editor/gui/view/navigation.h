#pragma once

#include <vector>

#include "mesh_ops/scene/camera.h"

namespace rebake {

// How a viewport's camera moves. Pure; all keep the camera sound. Pixels are of a viewport `height` pixels high, y
// down.

/// Turns about the target; a viewport's height of pixels is half a turn. Never over the poles.
Camera orbited(const Camera& camera, double right_pixels, double down_pixels, int height);
/// Moves eye and target so that what lies at the target's depth follows the pointer.
Camera panned(const Camera& camera, double right_pixels, double down_pixels, int height);
/// Moves towards a world point (away from it for factors above 1), which stays where it is in the picture.
Camera zoomed(const Camera& camera, const Vec3& towards, double factor);
/// Looks at all of a box, from where it looks now.
Camera framed(const Camera& camera, const Box& box, double aspect);
/// Turns about a point from now on; what is seen stays where it is but for a shift that brings the point to the middle.
Camera centred(const Camera& camera, const Vec3& point);
/// Moves eye and target together, along the camera's own axes, in scene units.
Camera flown(const Camera& camera, double right, double up, double forward);
/// Turns the line of sight about the eye.
Camera looked(const Camera& camera, double right_pixels, double down_pixels, int height);
/// Looks along an axis of the world at the target, from the same distance. `axis` points from the target to the eye.
Camera along_axis(const Camera& camera, const Vec3& axis);
/// Orthographic where it was perspective and the reverse, with the target as large as before.
Camera projected_otherwise(const Camera& camera);
/// So many cameras on a smooth way through the given ones, from the first to the last: each is passed, and what lies
/// between turns about what is looked at. Of one camera, all are that.
std::vector<Camera> camera_path(const std::vector<Camera>& through, int count);
/// So many cameras once around the target.
std::vector<Camera> turntable(const Camera& camera, int count);
/// Near and far planes that hold the box, whatever lies around it; an orthographic camera stands before the box.
Camera with_depth_for(const Camera& camera, const Box& box);

}  // namespace rebake
