#include "mesh_ops/formats/cameras/camera_json.h"

#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

using nlohmann::json;

json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Vec3 vector(const json& value, const std::string& key) {
  if (!value.is_array() || value.size() != 3 || !value[0].is_number() || !value[1].is_number() || !value[2].is_number())
    throw FieldError(key, "must be a list of three numbers");
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

double number(const json& value, const std::string& key) {
  if (!value.is_number()) throw FieldError(key, "must be a number");
  return value.get<double>();
}

double plane(const json& value, const std::string& key) {
  const double distance = number(value, key);
  if (!(distance > 0)) throw FieldError(key, "must be greater than 0; leave it out to fit it to the scene");
  return distance;
}

}  // namespace

nlohmann::json camera_json(const Camera& camera) {
  json result = {
      {"eye", list(camera.eye)}, {"target", list(camera.target)}, {"up", list(camera.up)}, {"fov", camera.fov_degrees}};
  if (camera.near_plane > 0) result["near"] = camera.near_plane;
  if (camera.far_plane > 0) result["far"] = camera.far_plane;
  if (camera.orthographic()) result["ortho_height"] = camera.ortho_height;
  return result;
}

Camera read_camera_json(const nlohmann::json& value) {
  if (!value.is_object())
    throw FieldError("camera", "must be an object with eye, target, up, fov, ortho_height, near, far");
  Camera camera;
  camera.near_plane = camera.far_plane = 0;
  for (const auto& [key, field] : value.items()) {
    if (key == "eye")
      camera.eye = vector(field, key);
    else if (key == "target")
      camera.target = vector(field, key);
    else if (key == "up")
      camera.up = vector(field, key);
    else if (key == "fov")
      camera.fov_degrees = number(field, key);
    else if (key == "ortho_height")
      camera.ortho_height = number(field, key);
    else if (key == "near")
      camera.near_plane = plane(field, key);
    else if (key == "far")
      camera.far_plane = plane(field, key);
    else
      throw FieldError(key, "is not a field of a camera (eye, target, up, fov, ortho_height, near, far)");
  }
  check(camera);
  return camera;
}

}  // namespace rebake
