#include "mesh_ops/formats/cameras/keyframes_json.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/formats/cameras/camera_json.h"

namespace rebake {

using nlohmann::json;

namespace {

constexpr std::array<const char*, 3> interpolation_words{"smooth", "linear", "step"};

double finite(const json& value) {
  const double number = value.get<double>();
  if (!std::isfinite(number)) throw FieldError("keyframes", "contain a number that is not finite");
  return number;
}

json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 vec3_of(const json& value) { return {finite(value.at(0)), finite(value.at(1)), finite(value.at(2))}; }

json json_of(const Affine& affine) {
  json rows = json::array();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rows.push_back(affine.matrix()(r, c));
  return rows;
}
// An invertible transform.
Affine affine_of(const json& rows) {
  if (!rows.is_array() || rows.size() != 12)
    throw FieldError("keyframes", "have a transform without 12 numbers (3 rows of 4)");
  Affine affine = Affine::Identity();
  for (int i = 0; i < 12; ++i) affine.matrix()(i / 4, i % 4) = finite(rows.at(static_cast<std::size_t>(i)));
  try {
    orthogonal_factor(affine.linear());
  } catch (const std::invalid_argument& error) {
    throw FieldError("keyframes", fmt::format("have a transform that cannot be inverted: {}", error.what()));
  }
  return affine;
}

template <class Value, class Write>
json keys_json(const Keyframes<Value>& keys, const Write& write) {
  json list = json::array();
  for (const Keyframe<Value>& key : keys)
    list.push_back({{"seconds", key.seconds},
                    {"value", write(key.value)},
                    {"to_next", interpolation_words[static_cast<std::size_t>(key.to_next)]}});
  return list;
}

template <class Value, class Read>
Keyframes<Value> read_keys(const json& list, const Read& read) {
  Keyframes<Value> keys;
  for (const json& entry : list) {
    const double seconds = finite(entry.at("seconds"));
    if (!(seconds >= 0 && seconds <= most_seconds))
      throw FieldError("keyframes",
                       fmt::format("have a time of {:.6g} s, not between 0 and {:.0f}", seconds, most_seconds));
    const auto word = entry.at("to_next").get<std::string>();
    const auto found = std::find(interpolation_words.begin(), interpolation_words.end(), word);
    if (found == interpolation_words.end())
      throw FieldError("keyframes", "have the unknown interpolation \"" + word + "\"");
    set_key(keys, Keyframe<Value>{seconds, read(entry.at("value")),
                                  static_cast<Interpolation>(found - interpolation_words.begin())});
  }
  return keys;
}

json bend_json(const BendTrack& track) {
  json out = {{"to_space", json_of(track.to_space)},
              {"falloff", track.falloff},
              {"origin", json_of(track.origin)},
              {"axis", json_of(track.axis)},
              {"direction", json_of(track.direction)},
              {"from", track.from},
              {"to", track.to},
              {"degrees", keys_json(track.degrees, [](double degrees) { return degrees; })}};
  if (track.box)
    out["box"] = {
        {"min", json_of(track.box->min())}, {"max", json_of(track.box->max())}, {"to_box", json_of(track.to_box)}};
  if (!track.spine.empty()) {
    out["spine"] = json::array();
    for (const Vec3& point : track.spine) out["spine"].push_back(json_of(point));
  }
  return out;
}

BendTrack bend_of(const json& value) {
  BendTrack track;
  track.to_space = affine_of(value.at("to_space"));
  track.falloff = finite(value.at("falloff"));
  if (track.falloff < 0) throw FieldError("keyframes", "have a bend with a negative falloff");
  track.origin = vec3_of(value.at("origin"));
  track.axis = vec3_of(value.at("axis"));
  track.direction = vec3_of(value.at("direction"));
  track.from = finite(value.at("from"));
  track.to = finite(value.at("to"));
  track.degrees = read_keys<double>(value.at("degrees"), finite);
  if (track.degrees.empty()) throw FieldError("keyframes", "have a bend without degrees");
  if (value.contains("box")) {
    const json& box = value.at("box");
    track.box = Box(vec3_of(box.at("min")), vec3_of(box.at("max")));
    track.to_box = affine_of(box.at("to_box"));
  }
  if (value.contains("spine"))
    for (const json& point : value.at("spine")) track.spine.push_back(vec3_of(point));
  return track;
}

}  // namespace

json camera_keys_json(const Keyframes<Camera>& keys) { return keys_json(keys, camera_json); }

Keyframes<Camera> read_camera_keys_json(const json& value) {
  return read_keys<Camera>(value, [](const json& camera) {
    const Camera read = read_camera_json(camera);
    check(read);
    return read;
  });
}

json motion_json(const NodeMotion& motion) {
  json out = json::object();
  if (!motion.place.empty())
    out["place"] = keys_json(motion.place, [](const Affine& affine) { return json_of(affine); });
  for (const auto& [name, track] : motion.bends)
    if (track.selection.empty()) out["bends"][name] = bend_json(track);
  return out;
}

NodeMotion read_motion_json(const json& value) {
  if (!value.is_object()) throw FieldError("keyframes", "must be an object with place and bends");
  NodeMotion motion;
  if (value.contains("place")) motion.place = read_keys<Affine>(value.at("place"), affine_of);
  if (value.contains("bends"))
    for (const auto& [name, track] : value.at("bends").items()) motion.bends[name] = bend_of(track);
  return motion;
}

}  // namespace rebake
