#include "mesh_ops/formats/rebake_scene/scene_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/formats/cameras/camera_json.h"
#include "mesh_ops/formats/cameras/keyframes_json.h"
#include "mesh_ops/formats/mobilenerf/baked_files.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/formats/mobilenerf/baked_positions_file.h"
#include "mesh_ops/formats/mobilenerf/write_baked_folder.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int scene_version = 1;
constexpr std::size_t longest_folder_name = 200;  // file systems allow 255 bytes; a number is appended
constexpr std::size_t max_bodies = 65536;         // range of the body number of a face (16 bits)

json affine_json(const Affine& affine) {
  json rows = json::array();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rows.push_back(affine.matrix()(r, c));
  return rows;
}

const char* axes_word(Axes axes) { return axes == Axes::forward ? "forward" : "360"; }

json node_json(const Node& node, const std::map<const BakedObject*, std::string>& folder_of, bool with_bodies) {
  json out = {{"name", node.name}, {"transform", affine_json(node.to_parent)}};
  if (!node.visible) out["visible"] = false;
  if (node.locked) out["locked"] = true;
  if (node.motion)
    if (json motion = motion_json(*node.motion); !motion.empty()) out["keyframes"] = std::move(motion);
  if (node.object) {
    out["folder"] = folder_of.at(node.object.get());
    out["axes"] = axes_word(node.object->axes);
    if (with_bodies) {
      for (const BakedBody& body : node.object->bodies)
        out["bodies"].push_back({{"folder", folder_of.at(body.object.get())},
                                 {"axes", axes_word(body.object->axes)},
                                 {"transform", affine_json(body.to_object)}});
      if (any_baked_positions(node.object->sets)) out["baked_places"] = true;
    }
  }
  if (!node.children.empty()) {
    out["children"] = json::array();
    for (const NodePtr& child : node.children) out["children"].push_back(node_json(*child, folder_of, with_bodies));
  }
  return out;
}

// Names of SceneLight::Source in scene.json.
constexpr std::array<const char*, 4> source_words{"estimated", "uniform", "sky", "picture"};

json color_json(const Vec3& color) { return {color.x(), color.y(), color.z()}; }

json sun_json(const Sun& sun) {
  return {{"direction", color_json(sun.direction)}, {"radius", sun.radius}, {"irradiance", color_json(sun.irradiance)}};
}

// Stores the environment map itself, so that the scene needs no other file.
json picture_json(const LightPicture& picture, double turn) {
  json out{
      {"path", picture.path},      {"content", picture.content}, {"turn", turn}, {"side", picture.light.sky.side()},
      {"radiance", json::array()}, {"suns", json::array()}};
  for (const Eigen::Vector3f& texel : picture.light.sky.texels())
    for (const float c : texel) out["radiance"].push_back(c);
  for (const Sun& sun : picture.light.suns) out["suns"].push_back(sun_json(sun));
  return out;
}

json light_json(const SceneLight& light) {
  json out{{"self", light.self},
           {"cast", light.cast},
           {"removed", light.removed},
           {"highlights", light.highlights},
           {"match", light.match},
           {"budget", light.budget},
           {"rays", light.rays},
           {"source", source_words[static_cast<std::size_t>(light.source)]},
           {"zenith", color_json(light.zenith)},
           {"ground", color_json(light.ground)},
           {"bounce", color_json(light.bounce)},
           {"sun", sun_json(light.sun)}};
  if (light.up != Vec3::UnitY()) out["up"] = color_json(light.up);
  if (light.picture) out["picture"] = picture_json(*light.picture, light.picture_rotation);
  return out;
}

// Clamps numbers to their range: light affects only the look, so a damaged value is no reason to reject the file.
Vec3 read_color(const json& list) {
  Vec3 result;
  for (std::size_t c = 0; c < 3; ++c)
    result[static_cast<Eigen::Index>(c)] = std::clamp(list.at(c).get<double>(), 0.0, 1e6);
  return result;
}

Vec3 read_normal(const json& list) {
  Vec3 normal;
  for (std::size_t c = 0; c < 3; ++c) normal[static_cast<Eigen::Index>(c)] = list.at(c).get<double>();
  // Unit vectors keep their bits.
  if (std::abs(normal.squaredNorm() - 1) > 1e-12) normal.stableNormalize();
  if (!(normal.squaredNorm() > 0.5)) throw FieldError("normal", "must be a vector other than zero");
  return normal;
}

Ground read_ground(const json& value) {
  const Ground ground{read_normal(value.at("normal")), value.at("height").get<double>()};
  if (!std::isfinite(ground.height)) throw FieldError("ground", "has a height that is not finite");
  return ground;
}

Sun read_sun(const json& value) {
  Sun sun;
  for (std::size_t c = 0; c < 3; ++c)
    sun.direction[static_cast<Eigen::Index>(c)] = value.at("direction").at(c).get<double>();
  if (!(sun.direction.stableNorm() > 0)) throw FieldError("light", "has a sun without a direction");
  sun.radius = std::clamp(value.at("radius").get<double>(), 1e-4, 0.8);
  sun.irradiance = read_color(value.at("irradiance"));
  return sun;
}

LightPicture read_picture(const json& value) {
  LightPicture picture;
  picture.path = value.at("path").get<std::string>();
  picture.content = value.at("content").get<std::string>();
  if (!value.at("side").is_number_unsigned() || value.at("side").get<std::uint64_t>() > 1024)
    throw FieldError("light", "has an environment map of an invalid size");
  const int side = value.at("side").get<int>();
  const json& radiance = value.at("radiance");
  if (side < 1 || radiance.size() != static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 3)
    throw FieldError("light", "has an environment map with the wrong number of radiances");
  picture.light.sky = SkyMap(side, [&, at = std::size_t{0}](const Vec3&) mutable {
    at += 3;
    return read_color({radiance[at - 3], radiance[at - 2], radiance[at - 1]});
  });
  constexpr std::size_t max_suns = 16;
  if (value.at("suns").size() > max_suns)
    throw FieldError("light", fmt::format("has an environment map with more than {} suns", max_suns));
  for (const json& sun : value.at("suns")) {
    picture.light.suns.push_back(read_sun(sun));
    // Unit vectors keep their bits.
    Vec3& direction = picture.light.suns.back().direction;
    if (std::abs(direction.squaredNorm() - 1) > 1e-12) direction.stableNormalize();
  }
  return picture;
}

SceneLight read_light(const json& value) {
  SceneLight light;
  light.self = value.at("self").get<bool>();
  light.cast = value.at("cast").get<bool>();
  light.removed = value.at("removed").get<bool>();
  // Older files lack "highlights"; it is then on if all other light effects are.
  light.highlights = light.self && value.value("highlights", light.cast && light.removed);
  light.match = value.at("match").get<bool>();
  light.budget = std::clamp(value.at("budget").get<double>(), 0.0, 1.0);
  light.rays = static_cast<int>(std::clamp(value.at("rays").get<double>(), 16.0, 16384.0));
  const auto word = value.at("source").get<std::string>();
  const auto found = std::find(source_words.begin(), source_words.end(), word);
  if (found == source_words.end()) throw FieldError("light", "has the unknown source \"" + word + "\"");
  light.source = static_cast<SceneLight::Source>(found - source_words.begin());
  light.zenith = read_color(value.at("zenith"));
  light.ground = read_color(value.at("ground"));
  light.bounce = read_color(value.at("bounce"));
  if (value.contains("up")) light.up = read_normal(value.at("up"));
  light.sun = read_sun(value.at("sun"));
  if (value.contains("picture")) {
    light.picture = std::make_shared<const LightPicture>(read_picture(value.at("picture")));
    light.picture_rotation = value.at("picture").at("turn").get<double>();
  }
  if (light.source == SceneLight::Source::picture && !light.picture)
    throw FieldError("light", "has the source \"picture\", but no picture");
  return light;
}

class SceneReader {
 public:
  SceneReader(fs::path folder, const Progress& progress)
      : folder_(std::move(folder)), name_(folder_ / "scene.json"), progress_(progress) {}

  // For a scene whose objects are not in folders.
  SceneReader(fs::path name, std::function<std::shared_ptr<const BakedObject>(const std::string&)> object_of,
              const Progress& progress)
      : name_(std::move(name)), progress_(progress), object_of_(std::move(object_of)) {}

  Scene run() { return run(read_file(name_)); }

  Scene run(const std::string& text) {
    const json root = [&] {
      try {
        return json::parse(text);
      } catch (const json::exception& error) {
        throw FileError(name_, std::string("is not valid JSON: ") + error.what());
      }
    }();
    try {
      if (!root.is_object() || !root.contains("rebake_scene"))
        throw FileError(name_, "is not a Rebake scene (\"rebake_scene\" is missing)");
      if (root.at("rebake_scene") != scene_version) throw FileError(name_, "was written by a newer version of Rebake");
      Scene scene;
      if (root.contains("background"))
        for (std::size_t c = 0; c < 3; ++c)
          scene.background[static_cast<Eigen::Index>(c)] =
              std::clamp(root.at("background").at(c).get<double>(), 0.0, 1.0);
      if (root.contains("ground")) scene.ground = read_ground(root.at("ground"));
      if (root.contains("views"))
        for (const auto& [view, camera] : root.at("views").items()) scene.views[view] = read_camera_json(camera);
      if (root.contains("camera_keyframes")) scene.camera_keys = read_camera_keys_json(root.at("camera_keyframes"));
      if (root.contains("light")) scene.light = std::make_shared<const SceneLight>(read_light(root.at("light")));
      for (const json& node : root.at("nodes"))
        scene = with_added(scene, read_node(node, 0), NodeId::none, scene.roots.size());
      return scene;
    } catch (const json::exception& error) {
      throw FileError(name_, std::string("is not a valid scene: ") + error.what());
    } catch (const FieldError& error) {
      throw FileError(name_, error.what());
    }
  }

 private:
  Node read_node(const json& value, int depth) {
    if (depth >= deepest_group) throw FileError(name_, fmt::format("nests groups deeper than {}", deepest_group));
    Node node;
    node.name = value.at("name").get<std::string>();
    node.visible = value.value("visible", true);
    node.locked = value.value("locked", false);
    if (value.contains("transform")) {
      node.to_parent = read_affine(value.at("transform"), node.name);
      try {
        orthogonal_factor(node.to_parent.linear());
      } catch (const std::invalid_argument& error) {
        throw FileError(name_, fmt::format("node \"{}\": {}", node.name, error.what()));
      }
    }
    if (value.contains("keyframes")) {
      try {
        if (NodeMotion motion = read_motion_json(value.at("keyframes")); !motion.empty())
          node.motion = std::make_shared<const NodeMotion>(std::move(motion));
      } catch (const FieldError& error) {
        throw FileError(name_, fmt::format("node \"{}\": {}", node.name, error.what()));
      }
    }
    if (value.contains("folder")) node.object = read_object(value, node.name);
    if (value.contains("children"))
      for (const json& child : value.at("children"))
        node.children.push_back(std::make_shared<const Node>(read_node(child, depth + 1)));
    return node.object && !node.children.empty() ? group_of(node) : node;
  }

  // A group of an object and its children, at the same places: edits take objects for leaves.
  static Node group_of(const Node& object_with_children) {
    Node group = object_with_children, object = object_with_children;
    object.children.clear();
    object.visible = true;
    object.locked = false;
    object.to_parent = Affine::Identity();
    if (group.motion) {
      const auto part = [](const NodeMotion& motion) {
        return motion.empty() ? nullptr : std::make_shared<const NodeMotion>(motion);
      };
      NodeMotion place = *group.motion, bends = *group.motion;
      place.bends.clear();
      bends.place = {};
      group.motion = part(place);
      object.motion = part(bends);
    }
    group.name += " and children";
    group.object = nullptr;
    group.children.insert(group.children.begin(), std::make_shared<const Node>(std::move(object)));
    return group;
  }

  Affine read_affine(const json& rows, const std::string& node) const {
    if (!rows.is_array() || rows.size() != 12)
      throw FileError(name_, fmt::format("node \"{}\": \"transform\" must have 12 numbers (3 rows of 4)", node));
    Affine affine = Affine::Identity();
    for (int i = 0; i < 12; ++i) affine.matrix()(i / 4, i % 4) = rows.at(static_cast<std::size_t>(i)).get<double>();
    if (!affine.matrix().allFinite())
      throw FileError(name_, fmt::format("node \"{}\": \"transform\" is not finite", node));
    return affine;
  }

  std::shared_ptr<const BakedObject> read_object(const json& value, const std::string& node) {
    const auto folder = value.at("folder").get<std::string>();
    if (object_of_) return object_of_(folder);
    const auto read = read_folder(folder, value.value("axes", "360"));
    if (!value.contains("bodies")) return read;
    const json& bodies = value.at("bodies");
    if (!bodies.is_array() || bodies.empty() || bodies.size() > max_bodies)
      throw FileError(name_, fmt::format("node \"{}\": \"bodies\" must be a list of 1 to {}", node, max_bodies));
    const bool places = value.value("baked_places", false);
    auto& known = edited_[fmt::format("{}\n{}\n{}", folder, places, bodies.dump())];
    if (known) return known;
    auto object = std::make_shared<BakedObject>(*read);
    for (const json& body : bodies)
      object->bodies.push_back({read_folder(body.at("folder").get<std::string>(), body.value("axes", "360")),
                                read_affine(body.at("transform"), node)});
    if (places) {
      const fs::path file = folder_ / fs::path(folder).lexically_normal() / "baked.bin";
      read_baked_positions(read_file(file), file, bodies.size(), object->sets);
    }
    known = object;
    return known;
  }

  std::shared_ptr<const BakedObject> read_folder(const std::string& relative, const std::string& axes) {
    if (axes != "360" && axes != "forward")
      throw FileError(name_, fmt::format("axes \"{}\" is neither 360 nor forward", axes));
    const fs::path path = fs::path(relative).lexically_normal();
    if (path.is_absolute() || path.empty() || *path.begin() == "..")
      throw FileError(name_, fmt::format("folder \"{}\" must be inside the scene's folder", relative));
    auto& known = objects_[relative + '\n' + axes];
    if (known) return known;
    known = shared(*read_baked_folder(folder_ / path, axes == "forward" ? Axes::forward : Axes::y_up, progress_));
    return known;
  }

  // Shares arrays and textures of equal files, since lighting recognises unchanged texels by identity.
  std::shared_ptr<const BakedObject> shared(BakedObject object) {
    auto origin = std::make_shared<Origin>(*object.origin);
    const auto words = [](const SourceFile& file) { return fmt::format("{} {:016x}\n", file.size, file.hash); };
    for (std::size_t s = 0; s < object.sets.size(); ++s) {
      TextureSet& set = object.sets[s];
      Origin::Set& files = origin->sets[s];
      const std::string images = words(files.feat0) + words(files.feat1) +
                                 (set.texels->alpha_code() == AlphaCode::halved ? "halved" : "plain");
      set.texels = texels_.try_emplace(images, set.texels).first->second;
      std::string geometry;
      for (const SourceFile& file : files.geometry) geometry += words(file);
      files.texels = set.texels;
      const auto [same, fresh] = soups_.try_emplace(geometry, set.soup);
      if (fresh) continue;
      set.soup = Soup(same->second.shared_positions(), same->second.shared_uvs(), same->second.shared_faces(),
                      set.soup.vertex_attributes(), set.soup.face_attributes());
      files.positions = set.soup.shared_positions();
      files.uvs = set.soup.shared_uvs();
      files.faces = set.soup.shared_faces();
    }
    object.origin = origin;
    return std::make_shared<const BakedObject>(std::move(object));
  }

  fs::path folder_;
  fs::path name_;
  const Progress& progress_;
  std::function<std::shared_ptr<const BakedObject>(const std::string&)> object_of_;  ///< null: objects are in folders
  std::map<std::string, std::shared_ptr<const BakedObject>> objects_;  ///< unedited objects, by folder and axes
  std::map<std::string, std::shared_ptr<const BakedObject>> edited_;  ///< objects with bodies, by members of their node
  std::map<std::string, std::shared_ptr<const FeatureTexture>> texels_;  ///< textures, by size and hash of their files
  std::map<std::string, Soup> soups_;                                    ///< triangles, by size and hash of their files
};

}  // namespace

std::string folder_name(const std::string& name, const std::vector<std::string>& taken) {
  std::string base;
  for (const char c : name)
    base += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.' ? c : '_';
  while (!base.empty() && base.front() == '.') base.erase(0, 1);
  if (base.empty() || is_baked_file_name(base) || base == "scene.json") base = "object_" + base;
  base.resize(std::min(base.size(), longest_folder_name));
  // Some file systems do not distinguish capitals.
  const auto lower = [](std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
  };
  std::string result = base;
  const auto is_taken = [&](const std::string& other) { return lower(other) == lower(result); };
  for (int n = 2; std::any_of(taken.begin(), taken.end(), is_taken); ++n) result = fmt::format("{}_{}", base, n);
  return result;
}

std::string write_scene_json(const Scene& scene, const std::map<const BakedObject*, std::string>& folder_of,
                             bool with_bodies) {
  json root = {{"rebake_scene", scene_version},
               {"background", {scene.background.x(), scene.background.y(), scene.background.z()}},
               {"views", json::object()},
               {"nodes", json::array()}};
  if (scene.ground != Ground{})
    root["ground"] = {{"normal", color_json(scene.ground.normal)}, {"height", scene.ground.height}};
  if (scene.light) root["light"] = light_json(*scene.light);
  for (const auto& [name, camera] : scene.views) root["views"][name] = camera_json(camera);
  if (!scene.camera_keys.empty()) root["camera_keyframes"] = camera_keys_json(scene.camera_keys);
  for (const NodePtr& node : scene.roots) root["nodes"].push_back(node_json(*node, folder_of, with_bodies));
  return root.dump(1) + '\n';
}

Scene read_scene_json(const std::string& text, const fs::path& name,
                      const std::function<std::shared_ptr<const BakedObject>(const std::string&)>& object_of) {
  const Progress silent;
  return SceneReader(name, object_of, silent).run(text);
}

Scene read_scene_folder(const fs::path& folder, const Progress& progress) {
  return SceneReader(folder, progress).run();
}

std::vector<std::string> unsaved_shapes(const Scene& scene) {
  std::vector<std::string> notes;
  if (!scene.light)
    for (const PlacedNode& placed : placed_nodes(scene))
      if (placed.node->object && !placed.node->object->bodies.empty())
        notes.push_back(fmt::format(
            "the unedited shape of \"{}\" is not saved, because light does not follow edits: set it (light) before "
            "saving if it is to follow them later; a project keeps the shape",
            placed.node->name));
  return notes;
}

std::vector<std::string> unsaved_parts(const Scene& scene) {
  std::vector<std::string> notes;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (!placed.node->saved_selections.empty())
      notes.push_back(
          fmt::format("the stored selections of \"{}\" are not saved; a project keeps them", placed.node->name));
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->motion)
      for (const auto& [name, track] : placed.node->motion->bends)
        if (!track.selection.empty())
          notes.push_back(
              fmt::format("the bend \"{}\" of \"{}\" has keyframes for a stored selection, so it is not "
                          "saved; a project keeps it",
                          name, placed.node->name));
  return notes;
}

std::vector<std::string> save_scene_folder(const Scene& scene, AtomicFolder& out, const Progress& progress) {
  std::vector<std::string> notes = unsaved_parts(scene), taken;
  for (std::string& note : unsaved_shapes(scene)) notes.push_back(std::move(note));
  std::map<const BakedObject*, std::string> folder_of;
  std::vector<std::shared_ptr<const BakedObject>> written;
  // Bodies are of use only if light follows edits.
  const bool keeps_bodies = scene.light != nullptr;
  const auto write = [&](const std::shared_ptr<const BakedObject>& object, const std::string& name) {
    taken.push_back(folder_name(name, taken));
    folder_of[object.get()] = taken.back();
    written.push_back(object);
    write_baked_folder(out, taken.back(), published(*object), object->layout, notes, progress, keeps_bodies);
  };
  for (const PlacedNode& placed : placed_nodes(scene)) {
    const auto& object = placed.node->object;
    if (!object || folder_of.contains(object.get())) continue;
    write(object, placed.node->name);
  }
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object || !keeps_bodies) continue;
    for (const BakedBody& body : placed.node->object->bodies) {
      if (folder_of.contains(body.object.get())) continue;
      // Separated parts refer to copies of the same body, which may also be a node of the scene itself.
      const auto same = std::find_if(written.begin(), written.end(), [&](const auto& other) {
        return other->bodies.empty() && other->decoder == body.object->decoder && other->axes == body.object->axes &&
               same_body({body.object, Affine::Identity()}, {other, Affine::Identity()});
      });
      if (same != written.end())
        folder_of[body.object.get()] = folder_of.at(same->get());
      else
        write(body.object, placed.node->name + ".baked");
    }
  }
  out.write("scene.json", write_scene_json(scene, folder_of, keeps_bodies));
  return notes;
}

}  // namespace rebake
