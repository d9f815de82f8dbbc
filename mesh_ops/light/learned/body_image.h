#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cages/cage_mesh.h"
#include "mesh_ops/light/learned/disk_chart.h"
#include "mesh_ops/light/transport/light_sites.h"

namespace rebake {

/// The connected component of a cage with the most vertices.
ProxyMesh largest_component(const Cage& whole);

/// A smooth proxy body around an object's opaque surface, cut open and parametrised as an image.
struct BodyImage {
  ProxyMesh mesh;
  DiskChart chart;
  std::vector<std::uint32_t> sites;  ///< per vertex of `mesh`: index of the object's site that represents it
};

/// Wraps the opaque triangles with this coarseness (see wrap.h), or coarser until the wrap is nearly one component.
/// Each vertex is represented by the nearest site; sites of opposite orientation count as twice as far away. `facing`:
/// per site, facing_of(). Throws Error if nothing is opaque or the wrap cannot be parametrised.
BodyImage body_image(const BakedObject& object, const std::vector<LightSite>& sites, const std::vector<float>& facing,
                     double coarseness, const Progress& progress = {});

}  // namespace rebake
