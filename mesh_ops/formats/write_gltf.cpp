#include "mesh_ops/formats/write_gltf.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/features/atlas/atlas.h"
#include "mesh_ops/features/distill/mean_colors.h"
#include "mesh_ops/formats/glb_file.h"
#include "mesh_ops/formats/gltf_features.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/rotations_file.h"
#include "mesh_ops/formats/motion_samples.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/index/opacity.h"

namespace rebake {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t directions = 128;  // over which colours are averaged
constexpr int largest_texture = 8192;    // side that current devices support
constexpr int png_level = 6;

template <class Matrix>
json column_major(const Matrix& m) {
  json values = json::array();
  for (Eigen::Index column = 0; column < m.cols(); ++column)
    for (Eigen::Index row = 0; row < m.rows(); ++row) values.push_back(m(row, column));
  return values;
}

// Puts a scene into a document.
class GltfWriter {
 public:
  // `features`: also carries everything in an extension (gltf_features.h).
  GltfWriter(const Scene& scene, bool features, const ExportOptions& options, const Progress& progress)
      : progress_(progress), features_(features), eye_(options.colors_from), gltf_(options.compression) {
    for (const PlacedNode& placed : placed_nodes(scene))
      if (placed.visible && placed.node->object) visible_.push_back(placed);
    if (visible_.empty()) throw EditError("there is nothing to export: no visible node has triangles");
    const Box box = world_bounds(scene);
    size_ = box.isEmpty() ? 0 : box.diagonal().norm();
    bounds_ = box;
    rays_.emplace(rays_through(visible_));
    json roots = json::array();
    for (const NodePtr& node : scene.roots)
      if (node->visible) roots.push_back(add_node(*node));
    for (const auto& [name, camera] : scene.views) roots.push_back(add_camera(name, camera));
    if (!scene.camera_keys.empty()) {
      roots.push_back(add_camera("film camera", value_at(scene.camera_keys, scene.camera_keys.front().seconds)));
      animate(roots.back(), camera_samples(scene.camera_keys), false);
      const Camera& first = scene.camera_keys.front().value;
      if (std::any_of(scene.camera_keys.begin(), scene.camera_keys.end(), [&](const Keyframe<Camera>& key) {
            return key.value.fov_degrees != first.fov_degrees || key.value.ortho_height != first.ortho_height;
          }))
        notes_.emplace_back("the film camera keeps the field of view of its first keyframe: glTF cannot animate it");
    }
    if (features_) add_features(scene);
    gltf_.finish(std::move(roots));
  }

  std::string bytes() const { return gltf_.bytes(); }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::size_t add_node(const Node& node) {
    json made = {{"name", node.name}};
    const bool moves = node.motion && !node.motion->place.empty();
    if (!moves && !node.to_parent.matrix().isIdentity(0)) made["matrix"] = column_major(node.to_parent.matrix());
    json children = json::array();
    if (node.object)
      for (std::size_t child : add_object(node)) children.push_back(child);
    for (const NodePtr& child : node.children)
      if (child->visible) children.push_back(add_node(*child));
    if (!children.empty()) made["children"] = children;
    const std::size_t number = gltf_.add("nodes", made);
    if (moves) {
      const PlaceSamples samples = place_samples(node.motion->place);
      animate(number, samples, true);
      if (samples.sheared)
        notes_.push_back(fmt::format("\"{}\" has keyframes with a shear, which glTF cannot animate", node.name));
    }
    return number;
  }

  // Animated nodes have a translation, rotation and scale in place of a matrix.
  void animate(std::size_t node, const PlaceSamples& samples, bool scales) {
    const std::size_t count = samples.seconds.size(), times = gltf_.add_times(samples.seconds);
    std::vector<float> translations, rotations, factors;
    for (std::size_t k = 0; k < count; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        translations.push_back(static_cast<float>(samples.translations[k][axis]));
        factors.push_back(static_cast<float>(samples.scales[k][axis]));
      }
      for (int part = 0; part < 4; ++part) rotations.push_back(static_cast<float>(samples.rotations[k].coeffs()[part]));
    }
    json& made = gltf_.at("nodes", node);
    made.erase("matrix");
    made["translation"] = {translations[0], translations[1], translations[2]};
    made["rotation"] = {rotations[0], rotations[1], rotations[2], rotations[3]};
    gltf_.add_channel(node, "translation", times, gltf_.add_floats(translations, count, "VEC3"), samples.step);
    gltf_.add_channel(node, "rotation", times, gltf_.add_floats(rotations, count, "VEC4"), samples.step);
    if (!scales) return;
    made["scale"] = {factors[0], factors[1], factors[2]};
    gltf_.add_channel(node, "scale", times, gltf_.add_floats(factors, count, "VEC3"), samples.step);
  }

  // A node per texture set, whose positions are relative to its centre, so that they fit into floats.
  std::vector<std::size_t> add_object(const Node& node) {
    const auto placed =
        std::find_if(visible_.begin(), visible_.end(), [&](const PlacedNode& one) { return one.node->id == node.id; });
    MeanColorLoss loss;
    std::vector<std::size_t> nodes;
    std::optional<BendPoses> bends;
    if (node.motion && !node.motion->bends.empty()) bends = bend_poses(node);
    std::vector<std::vector<TextureSet>> poses;
    if (bends)
      for (const auto& pose : bends->poses) poses.push_back(features_ ? pose->sets : packed(*pose));
    const BakedObject& rest = bends ? *bends->rest : *node.object;
    // The meshes of an object with features are its own sets.
    const std::vector<TextureSet> sets = features_ ? rest.sets : packed(rest);
    for (std::size_t s = 0; s < sets.size(); ++s) {
      const TextureSet& set = sets[s];
      progress_.at("averaging colours of " + node.name,
                   static_cast<double>(nodes.size()) / static_cast<double>(node.object->sets.size()));
      if (set.soup.triangle_count() == 0) continue;
      const MeanColors colors = mean_colors(set, *placed, *rays_, size_, directions, loss, eye_);
      const Vec3 centre = set.soup.bounds().center();
      const std::size_t material = add_material(node.name, colors);
      double scale = 1;
      const std::size_t mesh = gltf_.add(
          "meshes", {{"name", node.name}, {"primitives", json::array({primitive(set, centre, material, scale)})}});
      if (features_) add_set(*node.object, s, mesh);
      json part = {{"name", node.name + " triangles"}, {"mesh", mesh}};
      if (!centre.isZero(0)) part["translation"] = {centre.x(), centre.y(), centre.z()};
      if (scale != 1) part["scale"] = {scale, scale, scale};
      nodes.push_back(gltf_.add("nodes", part));
      if (bends) add_poses(nodes.back(), mesh, set, s, scale, poses, bends->seconds);
    }
    if (bends)
      notes_.push_back(fmt::format(
          "the bends of \"{}\" are {}; between them its vertices are at most {:.2g} of its "
          "size from their places",
          node.name, counted(bends->poses.size(), "pose"), bends->deviation / bends->rest->bounds().diagonal().norm()));
    notes_.push_back(
        fmt::format("\"{}\" loses its view dependence: {:.1f} dB PSNR between its colours and {}, over "
                    "{} directions where they are visible",
                    node.name, loss.psnr_db(), eye_ ? "those from the given view" : "their means", directions));
    if (loss.hidden > 0 && !eye_)
      notes_.push_back(fmt::format("{} of \"{}\" {} visible from no direction: {} colours are means over all",
                                   counted(loss.hidden, "triangle"), node.name, loss.hidden == 1 ? "is" : "are",
                                   loss.hidden == 1 ? "its" : "their"));
    return nodes;
  }

  // A feature image as a texture, with its bytes as in the format's own files.
  std::size_t add_feature_texture(const FeatureTexture& texels, int image) {
    const std::string png = write_feature_png(texels, image);
    const std::size_t view = gltf_.add_view(png.data(), png.size());
    return gltf_.add("textures", {{"sampler", 0},
                                  {"source", gltf_.add("images", {{"bufferView", view}, {"mimeType", "image/png"}})}});
  }

  // The features of an object's texture set, on its mesh: on materials they would stand beside KHR_materials_unlit,
  // which validators warn of. Sets that share textures share them here too.
  void add_set(const BakedObject& object, std::size_t number, std::size_t mesh) {
    const TextureSet& set = object.sets[number];
    auto& textures = feature_textures_[set.texels.get()];
    if (textures.empty())
      for (const int image : {0, 1}) textures.push_back(add_feature_texture(*set.texels, image));
    gltf_.at("meshes", mesh)["extensions"][gltf_features_extension] = {
        {"features", {{{"index", textures[0]}}, {{"index", textures[1]}}}},
        {"alphaCode", set.texels->alpha_code() == AlphaCode::halved ? "halved" : "plain"}};
    if (!object_sets_.contains(&object)) object_order_.push_back(&object);
    json& sets = object_sets_[&object];
    if (sets.size() <= number)  // nodes can share an object
      while (sets.size() <= number) sets.push_back(nullptr);
    if (!sets[number].is_null()) return;
    const Soup& soup = set.soup;
    const auto view = [&](const auto& values) {
      return gltf_.add_view(values.data(), values.size() * sizeof(values[0]));
    };
    sets[number] = {{"mesh", mesh},
                    {"positions", view(soup.positions())},
                    {"uvs", view(soup.uvs())},
                    {"faces", view(soup.faces())}};
  }

  // The part of the extension that belongs to the file: objects with their decoders, and the scene.
  void add_features(const Scene& scene) {
    std::map<const BakedObject*, std::string> names;
    json objects = json::array();
    for (const BakedObject* object : object_order_) {
      const json& sets = object_sets_.at(object);
      names[object] = std::to_string(objects.size());
      json stored = json::array();
      for (const json& set : sets)
        if (!set.is_null()) stored.push_back(set);
      json made = object_json(*object, stored);
      if (object->any_rotations()) {
        const std::string rotations = write_rotations(object->sets);
        made["rotations"] = gltf_.add_view(rotations.data(), rotations.size());
      }
      objects.push_back(made);
    }
    gltf_.root()["extensionsUsed"].push_back(gltf_features_extension);
    gltf_.root()["extensions"][gltf_features_extension] = {{"version", gltf_features_version},
                                                           {"objects", objects},
                                                           {"scene", json::parse(write_scene_json(scene, names))}};
  }

  // Morph targets of a mesh, of which one after the other gets the weight 1.
  // `scale`: of the node, see primitive().
  void add_poses(std::size_t node, std::size_t mesh, const TextureSet& rest, std::size_t number, double scale,
                 const std::vector<std::vector<TextureSet>>& poses, const std::vector<double>& seconds) {
    json targets = json::array();
    std::vector<float> weights;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const Soup& soup = poses[k][number].soup;
      if (soup.faces() != rest.soup.faces() || soup.uvs() != rest.soup.uvs())
        throw std::logic_error("a pose of a bend is packed in another way than the object");
      std::vector<float> moves;
      Eigen::AlignedBox3f box;
      for (std::size_t v = 0; v < soup.positions().size(); ++v) {
        const Eigen::Vector3f move = ((soup.positions()[v] - rest.soup.positions()[v]) / scale).cast<float>();
        box.extend(move);
        moves.insert(moves.end(), {move.x(), move.y(), move.z()});
      }
      const std::size_t accessor = gltf_.add_floats(moves, soup.positions().size(), "VEC3");
      gltf_.at("accessors", accessor)["min"] = {box.min().x(), box.min().y(), box.min().z()};
      gltf_.at("accessors", accessor)["max"] = {box.max().x(), box.max().y(), box.max().z()};
      targets.push_back({{"POSITION", accessor}});
      for (std::size_t other = 0; other < poses.size(); ++other) weights.push_back(other == k ? 1.0F : 0.0F);
    }
    gltf_.at("meshes", mesh)["primitives"][0]["targets"] = targets;
    gltf_.at("meshes", mesh)["weights"] = std::vector<int>(poses.size(), 0);
    gltf_.add_channel(node, "weights", gltf_.add_times(seconds), gltf_.add_floats(weights, weights.size(), "SCALAR"),
                      false);
  }

  // The object's sets without the triangles and texels that nothing shows.
  static std::vector<TextureSet> packed(const BakedObject& object) {
    std::vector<TextureSet> shown;
    for (const TextureSet& set : object.sets) {
      const Soup soup = subset(set.soup, faces_with_opaque_texels(set), 0, true);
      if (soup.triangle_count() > 0) shown.push_back({soup, set.texels});
    }
    if (shown.empty() || !std::all_of(shown.begin(), shown.end(), can_pack)) return shown;
    return pack(shown, std::max(largest_texture, largest_side_of(shown)), shown.front().texels->alpha_code()).sets;
  }
  static int largest_side_of(const std::vector<TextureSet>& sets) {
    int side = 0;
    for (const TextureSet& set : sets) side = std::max({side, set.texels->width(), set.texels->height()});
    return side;
  }

  std::size_t add_color_texture(const std::string& name, const MeanColors& colors) {
    std::string bytes;
    if (gltf_.compression().webp) {
      std::string error;
      if (!picture_codecs("colours.webp")
               .encode("webp", colors.width, colors.height, 4, colors.rgba.data(), bytes, error))
        throw Error("the colours of " + name + " cannot be encoded as WebP: " + error);
    } else {
      bytes = encode_png(colors.width, colors.height, 4, colors.rgba, png_level);
    }
    const std::size_t view = gltf_.add_view(bytes.data(), bytes.size());
    const std::size_t image = gltf_.add(
        "images",
        {{"bufferView", view}, {"mimeType", gltf_.compression().webp ? "image/webp" : "image/png"}, {"name", name}});
    json texture = {{"sampler", 0}};
    if (gltf_.compression().webp)
      texture["extensions"]["EXT_texture_webp"]["source"] = image;
    else
      texture["source"] = image;
    return gltf_.add("textures", texture);
  }

  std::size_t add_material(const std::string& name, const MeanColors& colors) {
    return gltf_.add("materials", {{"name", name},
                                   {"pbrMetallicRoughness",
                                    {{"baseColorTexture", {{"index", add_color_texture(name, colors)}}},
                                     {"metallicFactor", 0},
                                     {"roughnessFactor", 1}}},
                                   {"alphaMode", "MASK"},
                                   {"alphaCutoff", 0.5},
                                   {"doubleSided", true},
                                   {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  }

  // Positions relative to a centre. `scale`: of the node, by which quantised positions are multiplied.
  std::size_t add_positions(const Soup& soup, const Vec3& centre, double& scale) {
    std::vector<Vec3> places;
    for (const Vec3& p : soup.positions()) places.push_back(p - centre);
    if (gltf_.compression().quantized) {
      const QuantizedPositions quantized = quantized_positions(places);
      scale = quantized.scale;
      const std::size_t made =
          gltf_.add_accessor(gltf_.add_geometry(quantized.values.data(), places.size(), sizeof(quantized.values[0])),
                             GlbFile::short_type, places.size(), "VEC3");
      gltf_.at("accessors", made)["normalized"] = true;
      gltf_.at("accessors", made)["min"] = quantized.least;
      gltf_.at("accessors", made)["max"] = quantized.most;
      return made;
    }
    std::vector<Eigen::Vector3f> floats;
    Eigen::AlignedBox3f box;
    for (const Vec3& p : places) box.extend(floats.emplace_back(p.cast<float>()));
    const std::size_t made = gltf_.add_accessor(gltf_.add_geometry(floats.data(), floats.size(), sizeof(floats[0])),
                                                GlbFile::float_type, floats.size(), "VEC3");
    gltf_.at("accessors", made)["min"] = {box.min().x(), box.min().y(), box.min().z()};
    gltf_.at("accessors", made)["max"] = {box.max().x(), box.max().y(), box.max().z()};
    return made;
  }

  std::size_t add_uvs(const Soup& soup) {
    if (gltf_.compression().quantized)
      if (const auto quantized = quantized_uvs(soup.uvs()); !quantized.empty()) {
        const std::size_t made =
            gltf_.add_accessor(gltf_.add_geometry(quantized.data(), quantized.size(), sizeof(quantized[0])),
                               GlbFile::unsigned_short_type, quantized.size(), "VEC2");
        gltf_.at("accessors", made)["normalized"] = true;
        return made;
      }
    std::vector<Eigen::Vector2f> floats;
    for (const Vec2& uv : soup.uvs()) floats.emplace_back(static_cast<float>(uv.x()), static_cast<float>(1 - uv.y()));
    return gltf_.add_accessor(gltf_.add_geometry(floats.data(), floats.size(), sizeof(floats[0])), GlbFile::float_type,
                              floats.size(), "VEC2");
  }

  json primitive(const TextureSet& set, const Vec3& centre, std::size_t material, double& scale) {
    const std::size_t position = add_positions(set.soup, centre, scale), uv = add_uvs(set.soup);
    const std::vector<Face>& faces = set.soup.faces();
    const std::size_t indices = gltf_.add_accessor(gltf_.add_geometry(faces.data(), 3 * faces.size(), 0),
                                                   GlbFile::unsigned_int_type, 3 * faces.size(), "SCALAR");
    return {{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}}, {"indices", indices}, {"material", material}};
  }

  std::size_t add_camera(const std::string& name, const Camera& stored) {
    // Absent planes are fitted to the scene.
    const Camera camera = with_planes(stored, bounds_, 1);
    json lens;
    if (camera.orthographic())
      lens = {{"type", "orthographic"},
              {"orthographic",
               {{"xmag", camera.ortho_height / 2},
                {"ymag", camera.ortho_height / 2},
                {"znear", camera.near_plane},
                {"zfar", camera.far_plane}}}};
    else
      lens = {{"type", "perspective"},
              {"perspective",
               {{"yfov", camera.fov_degrees * std::numbers::pi / 180},
                {"znear", camera.near_plane},
                {"zfar", camera.far_plane}}}};
    lens["name"] = name;
    Affine to_world = Affine::Identity();
    to_world.linear() = world_to_camera(camera).transpose();
    to_world.translation() = camera.eye;
    if (!gltf_.root().contains("cameras")) gltf_.root()["cameras"] = json::array();
    return gltf_.add(
        "nodes", {{"name", name}, {"camera", gltf_.add("cameras", lens)}, {"matrix", column_major(to_world.matrix())}});
  }

  const Progress& progress_;
  std::vector<PlacedNode> visible_;
  std::optional<SceneRays> rays_;
  double size_ = 0;
  Box bounds_;
  std::vector<std::string> notes_;
  bool features_;
  const std::optional<Vec3>& eye_;  ///< whose colours are taken; nothing: means
  GlbFile gltf_;
  std::map<const FeatureTexture*, std::vector<std::size_t>> feature_textures_;
  std::vector<const BakedObject*> object_order_;    ///< in which they were met
  std::map<const BakedObject*, json> object_sets_;  ///< the sets of each object in the extension
};

ExportReport write_glb(const Scene& scene, const fs::path& file, const ExportOptions& options, const Progress& progress,
                       bool features) {
  if (options.layout) throw FieldError("layout", "does not apply to glTF files; leave it out");
  if (options.page_side) throw FieldError("page_size", "does not apply to glTF files; leave it out");
  if (file.extension() != ".glb") throw FieldError("out", "must end in .glb, the extension of binary glTF files");
  options.sources.check_file(file);
  const auto refuse_foreign = [&] {
    if (std::error_code error;
        fs::exists(file, error) && fs::file_size(file, error) > 0 && !GlbFile::is_own(read_file(file)))
      throw FileError(file, "exists and is not a glTF file of Rebake, so it is not replaced; choose another name");
  };
  refuse_foreign();
  const GltfWriter document(scene, features, options, progress);
  refuse_foreign();  // once more: it may have appeared since
  write_file_atomically(file, document.bytes(), options.sources);
  ExportReport report;
  report.notes = document.notes();
  if (!features) {
    add_notes_of_nodes(scene, report.notes);
    if (!scene.background.isOnes(0)) report.notes.emplace_back("the background is not exported; save keeps it");
    if (scene.ground != Ground{}) report.notes.emplace_back("the ground is not exported; save keeps it");
  }
  if (scene.light) report.notes.emplace_back("light that follows edits is not part of the colours, which are as baked");
  return report;
}

}  // namespace

ExportReport write_gltf(const Scene& scene, const fs::path& file, const ExportOptions& options,
                        const Progress& progress) {
  return write_glb(scene, file, options, progress, false);
}

ExportReport write_gltf_features(const Scene& scene, const fs::path& file, const ExportOptions& options,
                                 const Progress& progress) {
  const Scene visible = visible_part(scene);
  ExportReport report = write_glb(visible, file, options, progress, true);
  const std::vector<std::string> lost = unsaved_parts(scene);
  report.preserves_scene = lost.empty() && placed_nodes(visible).size() == placed_nodes(scene).size();
  report.notes.insert(report.notes.end(), lost.begin(), lost.end());
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (placed.node->object && !placed.visible) {
      report.notes.push_back(fmt::format("the hidden node \"{}\" is not exported; save keeps it", placed.node->name));
    }
    if (placed.node->object && !placed.node->object->bodies.empty() && scene.light) {
      report.preserves_scene = false;
      report.notes.push_back(fmt::format(
          "the unedited shape of \"{}\", which light needs, is not exported; save keeps it", placed.node->name));
    }
  }
  return report;
}

}  // namespace rebake
