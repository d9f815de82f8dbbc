#pragma once

#include <string>
#include <vector>

#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// A unique name per camera: that of its photograph without folders and extension if all of these differ, else with
/// folders ("left-0001"); "camera 3" for the fourth camera if it has none.
std::vector<std::string> photo_names(const std::vector<PhotoCamera>& cameras);

}  // namespace rebake
