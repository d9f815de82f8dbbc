#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cage.h"
#include "mesh_ops/light/disk_chart.h"
#include "mesh_ops/light/light_sites.h"

namespace rebake {

/// The connected component of a cage with the most vertices.
ProxyMesh largest_piece(const Cage& whole);

/// A smooth proxy body around an object's opaque surface, cut open and parametrised as an image; and for each of its
/// vertices the site of the object that represents it.
struct BodyImage {
  ProxyMesh mesh;
  DiskChart chart;
  std::vector<std::uint32_t> sites;
};

/// Wraps the opaque triangles with this coarseness (see wrap.h), or coarser until the wrap is nearly one component.
/// Each vertex is represented by the nearest site with the same orientation; `facing` gives the visible share of each
/// side. Throws Error if nothing is opaque or the wrap cannot be parametrised.
BodyImage body_image(const BakedObject& object, const std::vector<LightSite>& sites, const std::vector<float>& facing,
                     double coarseness, const Progress& progress = {});

}  // namespace rebake
