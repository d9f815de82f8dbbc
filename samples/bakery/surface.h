#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mesh_ops/scene/camera.h"
#include "mesh_ops/scene/object.h"

namespace rebake::bakery {

/// A procedural surface over (u, v) in the unit square. Its normal is ∂P/∂u × ∂P/∂v and should point outwards.
struct Patch {
  std::string name;
  std::function<Vec3(double u, double v)> point;
  int columns = 1, rows = 1;                                          ///< numbers of baked quads along u and v
  std::function<Vec3(double u, double v, const Vec3& point)> albedo;  ///< linear albedo
  std::function<bool(double u, double v)> opaque = [](double, double) { return true; };
  double reflectance = 0;  ///< reflectance at normal incidence; 0: matte
  double sharpness = 20;   ///< Phong exponent
  bool two_sided = false;  ///< rendered and lit from both sides, such as a leaf
  double ray_offset =
      0;  ///< offset of shadow-ray origins along the normal, in scene units; 0: RadianceField::clearance()
};

/// A procedural model that a sample scene is baked from.
struct Model {
  std::string name;
  std::vector<Patch> patches;
  Axes axes = Axes::y_up;
  Layout layout = Layout::split;
  Vec3 sun{0.5, 0.8, 0.45};                          ///< direction towards the light, any length
  std::function<Camera(double s, double t)> camera;  ///< training and held-out cameras for s and t in [0, 1)
  int picture = 400;                                 ///< side of the held-out views in pixels
};

/// A surface of revolution about a vertical axis through `centre`: `profile(v)` is (radius, height) from bottom to top.
std::function<Vec3(double, double)> revolved(std::function<Vec2(double)> profile, const Vec3& centre = Vec3::Zero());

/// A tube around a curve, with a radius along it.
std::function<Vec3(double, double)> tube(std::function<Vec3(double)> curve, std::function<double(double)> radius);

/// A flat parallelogram.
std::function<Vec3(double, double)> plane(const Vec3& corner, const Vec3& along_u, const Vec3& along_v);

/// Smooth deterministic value noise in [0, 1].
double noise(const Vec3& p);

/// Cameras at `distance` from `target`: s is the azimuth, t the elevation between `lowest` and `highest`, in degrees.
std::function<Camera(double, double)> orbit_cameras(const Vec3& target, double distance, double lowest, double highest);

/// The model with its surfaces moved by `warp(patch, point)`; albedos move with them.
Model warped(const Model& model, const std::function<Vec3(std::size_t patch, const Vec3& point)>& warp);

Model ficus();
Model kettle();
Model courtyard();
/// The shelf with or without its vase, as "shelf" or "shelf_without_vase": the truth for its removal.
Model shelf(bool with_vase = true);

}  // namespace rebake::bakery
