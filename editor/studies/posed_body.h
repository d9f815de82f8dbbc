#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "mesh_ops/deform/coordinates.h"
#include "mesh_ops/light/geometry_image.h"
#include "mesh_ops/light/transfer.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A body that transfer is studied on: a smooth mesh in a lattice cage of 44 points.
struct PosedBody {
  std::string name;
  ProxyMesh rest;
  Cage cage;
  std::shared_ptr<const Coordinates> coordinates;
  DiskChart chart;  ///< laid out on a square

  /// Each cage point moved by a normal deviate along each axis, `amplitude` of the cage's longest side as its standard
  /// deviation; the same for the same seed.
  ProxyMesh caged(std::uint32_t seed, double amplitude) const;
  /// Bent along its longest axis.
  ProxyMesh bent(double degrees) const;
};

/// A sheet of `side`² vertices with bumps; row by row.
PosedBody bumpy_sheet(int side);
/// A wrap around part of a scene: what shows something in the box, in shares of the scene's, and hangs together most.
PosedBody wrapped_part(const Scene& scene, const Box& shares, double coarseness);

/// A pose as it is traced: its points, how they turned, and what they see of the sky.
struct TracedPose {
  std::vector<LightSite> sites;
  std::vector<Mat3> turns;
  Transfer transfer;
};
TracedPose traced_pose(const ProxyMesh& rest, const ProxyMesh& posed, int rays, const Progress& progress = {});

}  // namespace rebake
