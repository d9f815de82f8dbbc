#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cage.h"
#include "mesh_ops/light/disk_chart.h"
#include "mesh_ops/light/light_sites.h"

namespace rebake {

/// The piece of a cage with the most vertices.
ProxyMesh largest_piece(const Cage& whole);

/// A smooth body around what an object shows, cut open and laid out as an image, and for each of its vertices the
/// object's site that stands for it.
struct BodyImage {
  ProxyMesh mesh;
  DiskChart chart;
  std::vector<std::uint32_t> sites;
};

/// A wrap around the opaque triangles, of this coarseness (as in wrap.h) or coarser until it is nearly one piece; of
/// the sites the nearest one that faces the same way, as `facing` says what of each shows. Throws Error where there is
/// nothing to wrap, and where the wrap cannot be laid out.
BodyImage body_image(const BakedObject& object, const std::vector<LightSite>& sites, const std::vector<float>& facing,
                     double coarseness, const Progress& progress = {});

}  // namespace rebake
