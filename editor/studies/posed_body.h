#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "mesh_ops/light/learned/geometry_image.h"
#include "mesh_ops/light/transport/transfer.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Test body for the study of radiance transfer: a smooth mesh in a lattice cage with 44 vertices.
struct PosedBody {
  std::string name;
  ProxyMesh rest;
  Cage cage;
  std::shared_ptr<const Coordinates> coordinates;
  DiskChart chart;  ///< parametrisation over the unit square

  /// Random pose: each cage vertex moves by a normal deviate along each axis. The standard deviation is `amplitude`
  /// times the cage's longest side. Deterministic per seed.
  ProxyMesh random_pose(std::uint32_t seed, double amplitude) const;
  /// The body bent along its longest axis.
  ProxyMesh bent(double degrees) const;
};

/// A height field with Gaussian bumps: `side`² vertices in row-major order.
PosedBody bumpy_sheet(int side);
/// Largest connected component of a wrap around the opaque triangles in a part of a scene. `shares`: the part, in
/// shares of the scene's box, 0 … 1; `coarseness`: see wrap(). Throws Error if the part is empty.
PosedBody wrapped_part(const Scene& scene, const Box& shares, double coarseness);

/// A pose with its traced radiance transfer, per vertex.
struct TracedPose {
  std::vector<LightSite> sites;
  std::vector<Mat3> turns;  ///< local rotation from the rest pose
  Transfer transfer;
};
/// Traces the transfer with `rays` rays per vertex.
TracedPose traced_pose(const ProxyMesh& rest, const ProxyMesh& posed, int rays, const Progress& progress = {});

}  // namespace rebake
