#pragma once

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// An object of ColorRule::diffuse as a MobileNeRF object: its texels hold the colours' logits in two features per
/// channel, coarse and fine, and a decoder of width 4 adds them. Triangles and UVs are shared. Error of the colours of
/// whole pixels: at most 0.1/255 within [1/255, 254/255]; colours outside that range become its ends, 1/255 off. Pixels
/// that show several colours average logits instead of colours, and pixels on the object's outline tend to grey: a
/// white pixel of which half is covered gets 0.94 instead of 1.
std::shared_ptr<const BakedObject> with_network(const BakedObject& object);

/// The scene with with_network() applied to all objects of ColorRule::diffuse; node ids stay. Appends the names of
/// their nodes to `changed`, if not null.
Scene with_networks(const Scene& scene, std::vector<std::string>* changed = nullptr);

}  // namespace rebake
