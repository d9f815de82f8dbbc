#pragma once

#include <string_view>

namespace rebake::fuzz {

/// Each feeds bytes to one reader; anything but a rebake::Error or success is a defect.
void read_obj_bytes(std::string_view bytes);
void read_json_bytes(std::string_view bytes);    ///< mlp.json, rotations, baked geometry, cameras
void read_camera_bytes(std::string_view bytes);  ///< every format of camera files
void read_mesh_bytes(std::string_view bytes);    ///< glTF, PLY, OBJ with materials, mlp.json of nerf2mesh
void read_script_bytes(std::string_view bytes);  ///< scripts without access to files

void read_volume_bytes(std::string_view bytes);  ///< .npz of a PlenOctree, scene_params.json of a SNeRG scene

}  // namespace rebake::fuzz
