#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/learned/proxy_mesh.h"

namespace rebake {

/// A surface with one boundary that deforms smoothly: the objects of deep precomputed radiance transfer.
struct AnimatedObject {
  std::string name;
  ProxyMesh rest;
  std::vector<std::vector<Vec3>> frames;  ///< positions of all vertices per frame
};

/// Number of frames, as published: 450 to train on and 50 held out.
inline constexpr int dprt_frames = 500;

/// A stylised head, open behind the ears: eight linear blendshapes whose weights are smooth functions of time.
AnimatedObject animated_head(int frames = dprt_frames);
/// A fish, cut open along its belly: linear blendshapes of a wave that travels along the body, of turns and of fins.
AnimatedObject animated_fish(int frames = dprt_frames);
/// A cloth (mesh_ops/simulation) that hangs at two moving corners, in the wind. It does not collide with
/// itself.
AnimatedObject animated_cloth(int frames = dprt_frames, const Progress& progress = {});
/// The same, cached in a file: simulated only if the file does not hold it.
AnimatedObject cached_cloth(int frames, const std::filesystem::path& file, const Progress& progress = {});
/// Meshes of equal connectivity (OBJ, OFF, PLY), one per frame; `pattern`: a path whose file name may have the
/// wildcards * and ?. Throws FileError if they differ in their triangles, and Error if no file fits.
AnimatedObject animated_files(const std::string& pattern);

/// Number of the head's blendshapes; 0 opens the jaw.
inline constexpr std::size_t head_shapes = 8;
/// The head with these weights of its blendshapes, about −0.3 to 1.
std::vector<Vec3> head_pose(const std::array<double, head_shapes>& weights);
/// A disk with the triangles of the head, for the space of shapes between both.
ProxyMesh plane_like_head();

}  // namespace rebake
