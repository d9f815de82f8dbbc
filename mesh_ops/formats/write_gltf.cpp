#include "mesh_ops/formats/write_gltf.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/features/atlas/atlas.h"
#include "mesh_ops/features/distill/mean_colors.h"
#include "mesh_ops/formats/gltf_features.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/meshes/meshopt_codec.h"
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

constexpr const char* generator = "Rebake";
constexpr std::size_t directions = 128;  // over which colours are averaged
constexpr int largest_texture = 8192;    // side that current devices support
constexpr int png_level = 6;

// Constants of the format.
constexpr int float_type = 5126, unsigned_int_type = 5125, short_type = 5122, unsigned_short_type = 5123,
              vertex_target = 34962, index_target = 34963, nearest = 9728, clamp_to_edge = 33071;

template <class Matrix>
json column_major(const Matrix& m) {
  json values = json::array();
  for (Eigen::Index column = 0; column < m.cols(); ++column)
    for (Eigen::Index row = 0; row < m.rows(); ++row) values.push_back(m(row, column));
  return values;
}

// The document while it is made.
class GltfWriter {
 public:
  // `features`: also carries everything in an extension (gltf_features.h).
  GltfWriter(const Scene& scene, bool features, const ExportOptions& options, const Progress& progress)
      : progress_(progress), features_(features), eye_(options.colors_from), compression_(options.compression) {
    for (const PlacedNode& placed : placed_nodes(scene))
      if (placed.visible && placed.node->object) visible_.push_back(placed);
    if (visible_.empty()) throw EditError("there is nothing to export: no visible node has triangles");
    const Box box = world_bounds(scene);
    size_ = box.isEmpty() ? 0 : box.diagonal().norm();
    bounds_ = box;
    rays_.emplace(rays_through(visible_));
    for (const char* list : {"nodes", "meshes", "materials", "textures", "images", "accessors", "bufferViews"})
      root_[list] = json::array();
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
    root_["scenes"] = {{{"nodes", roots}}};
    root_["scene"] = 0;
    root_["asset"] = {{"version", "2.0"}, {"generator", generator}};
    root_["extensionsUsed"] = {"KHR_materials_unlit"};
    for (const auto& [used, name] : {std::pair(compression_.quantized, "KHR_mesh_quantization"),
                                     {compression_.meshopt, meshopt_extension},
                                     {compression_.webp, "EXT_texture_webp"}})
      if (used) {
        root_["extensionsUsed"].push_back(name);
        root_["extensionsRequired"].push_back(name);
      }
    if (features_) add_features(scene);
    root_["samplers"] = json::array(
        {{{"magFilter", nearest}, {"minFilter", nearest}, {"wrapS", clamp_to_edge}, {"wrapT", clamp_to_edge}}});
    if (!channels_.empty())
      root_["animations"] = json::array({{{"name", "keyframes"}, {"channels", channels_}, {"samplers", samplers_}}});
    root_["buffers"] = json::array({{{"byteLength", bytes_.size()}}});
    // Stands for the decompressed bytes.
    if (compression_.meshopt)
      root_["buffers"].push_back(
          {{"byteLength", decompressed_}, {"extensions", {{meshopt_extension, {{"fallback", true}}}}}});
  }

  // The bytes of a .glb file.
  std::string glb() const {
    std::string text = root_.dump(-1, ' ', false, json::error_handler_t::replace), bytes = bytes_;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    std::string file = "glTF";
    const auto add = [&](std::size_t value) {
      for (int shift = 0; shift < 32; shift += 8) file += static_cast<char>(value >> shift & 255U);
    };
    add(2);
    add(12 + 8 + text.size() + 8 + bytes.size());
    add(text.size());
    file += "JSON" + text;
    add(bytes.size());
    file += std::string("BIN\0", 4) + bytes;
    return file;
  }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::size_t add_to(const char* list, json value) {
    root_[list].push_back(std::move(value));
    return root_[list].size() - 1;
  }

  std::size_t add_view(const void* data, std::size_t size, int target) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
    json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
    if (target != 0) view["target"] = target;
    bytes_.append(static_cast<const char*>(data), size);
    return add_to("bufferViews", view);
  }

  // Vertex data of `stride` bytes per vertex, or indices of triangles (stride 0), compressed if asked for.
  std::size_t add_geometry(const void* data, std::size_t count, std::size_t stride) {
    const std::size_t element = stride > 0 ? stride : sizeof(std::uint32_t);
    const std::string_view bytes(static_cast<const char*>(data), count * element);
    const int target = stride > 0 ? vertex_target : index_target;
    std::size_t view = 0;
    if (!compression_.meshopt) {
      view = add_view(data, bytes.size(), target);
    } else {
      const std::string packed = stride > 0 ? meshopt_attributes(bytes, count, stride) : meshopt_triangles(bytes);
      view = add_view(packed.data(), packed.size(), target);
      json& made = root_["bufferViews"][view];
      const json compressed = {{"buffer", 0},
                               {"byteOffset", made.at("byteOffset")},
                               {"byteLength", packed.size()},
                               {"byteStride", element},
                               {"count", count},
                               {"mode", stride > 0 ? "ATTRIBUTES" : "TRIANGLES"}};
      decompressed_ = (decompressed_ + 3) / 4 * 4;
      made = {{"buffer", 1},
              {"byteOffset", decompressed_},
              {"byteLength", bytes.size()},
              {"target", target},
              {"extensions", {{meshopt_extension, compressed}}}};
      decompressed_ += bytes.size();
    }
    if (stride > 0) root_["bufferViews"][view]["byteStride"] = stride;
    return view;
  }

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
    const std::size_t number = add_to("nodes", made);
    if (moves) {
      const PlaceSamples samples = place_samples(node.motion->place);
      animate(number, samples, true);
      if (samples.sheared)
        notes_.push_back(fmt::format("\"{}\" has keyframes with a shear, which glTF cannot animate", node.name));
    }
    return number;
  }

  std::size_t add_floats(const std::vector<float>& values, std::size_t count, const char* shape) {
    const std::size_t view = add_view(values.data(), values.size() * sizeof(float), 0);
    return add_to("accessors",
                  {{"bufferView", view}, {"componentType", float_type}, {"count", count}, {"type", shape}});
  }
  // An accessor of increasing times, with their range.
  std::size_t add_times(const std::vector<double>& seconds) {
    // Times of jumps are so close that they may be the same float.
    std::vector<float> times;
    for (const double time : seconds)
      times.push_back(times.empty() ? static_cast<float>(time)
                                    : std::max(static_cast<float>(time),
                                               std::nextafter(times.back(), std::numeric_limits<float>::infinity())));
    const std::size_t accessor = add_floats(times, times.size(), "SCALAR");
    root_["accessors"][accessor]["min"] = {times.front()};
    root_["accessors"][accessor]["max"] = {times.back()};
    return accessor;
  }
  void add_channel(std::size_t node, const char* path, std::size_t times, std::size_t values, bool step) {
    channels_.push_back({{"sampler", samplers_.size()}, {"target", {{"node", node}, {"path", path}}}});
    samplers_.push_back({{"input", times}, {"output", values}, {"interpolation", step ? "STEP" : "LINEAR"}});
  }

  // Animated nodes have a translation, rotation and scale in place of a matrix.
  void animate(std::size_t node, const PlaceSamples& samples, bool scales) {
    const std::size_t count = samples.seconds.size(), times = add_times(samples.seconds);
    std::vector<float> translations, rotations, factors;
    for (std::size_t k = 0; k < count; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        translations.push_back(static_cast<float>(samples.translations[k][axis]));
        factors.push_back(static_cast<float>(samples.scales[k][axis]));
      }
      for (int part = 0; part < 4; ++part) rotations.push_back(static_cast<float>(samples.rotations[k].coeffs()[part]));
    }
    json& made = root_["nodes"][node];
    made.erase("matrix");
    made["translation"] = {translations[0], translations[1], translations[2]};
    made["rotation"] = {rotations[0], rotations[1], rotations[2], rotations[3]};
    add_channel(node, "translation", times, add_floats(translations, count, "VEC3"), samples.step);
    add_channel(node, "rotation", times, add_floats(rotations, count, "VEC4"), samples.step);
    if (!scales) return;
    made["scale"] = {factors[0], factors[1], factors[2]};
    add_channel(node, "scale", times, add_floats(factors, count, "VEC3"), samples.step);
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
      const std::size_t mesh = add_to(
          "meshes", {{"name", node.name}, {"primitives", json::array({primitive(set, centre, material, scale)})}});
      if (features_) add_set(*node.object, s, mesh);
      json part = {{"name", node.name + " triangles"}, {"mesh", mesh}};
      if (!centre.isZero(0)) part["translation"] = {centre.x(), centre.y(), centre.z()};
      if (scale != 1) part["scale"] = {scale, scale, scale};
      nodes.push_back(add_to("nodes", part));
      if (bends) add_poses(nodes.back(), mesh, set, s, scale, poses, bends->seconds);
    }
    if (bends)
      notes_.push_back(
          fmt::format("the bends of \"{}\" are {} poses; between them its vertices are at most {:.2g} of its "
                      "size from their places",
                      node.name, bends->poses.size(), bends->deviation / bends->rest->bounds().diagonal().norm()));
    notes_.push_back(
        fmt::format("\"{}\" loses its view dependence: {:.1f} dB PSNR between its colours and {}, over "
                    "{} directions where they are visible",
                    node.name, loss.psnr_db(), eye_ ? "those from the given view" : "their means", directions));
    if (loss.hidden > 0 && !eye_)
      notes_.push_back(
          fmt::format("{} triangles of \"{}\" are visible from no direction: their colours are means over all",
                      loss.hidden, node.name));
    return nodes;
  }

  // A feature image as a texture, with its bytes as in the format's own files.
  std::size_t add_feature_texture(const FeatureTexture& texels, int image) {
    const std::string png = write_feature_png(texels, image);
    const std::size_t view = add_view(png.data(), png.size(), 0);
    return add_to("textures",
                  {{"sampler", 0}, {"source", add_to("images", {{"bufferView", view}, {"mimeType", "image/png"}})}});
  }

  // The features of an object's texture set, on its mesh: on materials they would stand beside KHR_materials_unlit,
  // which validators warn of. Sets that share textures share them here too.
  void add_set(const BakedObject& object, std::size_t number, std::size_t mesh) {
    const TextureSet& set = object.sets[number];
    auto& textures = feature_textures_[set.texels.get()];
    if (textures.empty())
      for (const int image : {0, 1}) textures.push_back(add_feature_texture(*set.texels, image));
    root_["meshes"][mesh]["extensions"][gltf_features_extension] = {
        {"features", {{{"index", textures[0]}}, {{"index", textures[1]}}}},
        {"alphaCode", set.texels->alpha_code() == AlphaCode::halved ? "halved" : "plain"}};
    if (!object_sets_.contains(&object)) object_order_.push_back(&object);
    json& sets = object_sets_[&object];
    if (sets.size() <= number)  // nodes can share an object
      while (sets.size() <= number) sets.push_back(nullptr);
    if (!sets[number].is_null()) return;
    const Soup& soup = set.soup;
    const auto view = [&](const auto& values) { return add_view(values.data(), values.size() * sizeof(values[0]), 0); };
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
        made["rotations"] = add_view(rotations.data(), rotations.size(), 0);
      }
      objects.push_back(made);
    }
    root_["extensionsUsed"].push_back(gltf_features_extension);
    root_["extensions"][gltf_features_extension] = {{"version", gltf_features_version},
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
      const std::size_t accessor = add_floats(moves, soup.positions().size(), "VEC3");
      root_["accessors"][accessor]["min"] = {box.min().x(), box.min().y(), box.min().z()};
      root_["accessors"][accessor]["max"] = {box.max().x(), box.max().y(), box.max().z()};
      targets.push_back({{"POSITION", accessor}});
      for (std::size_t other = 0; other < poses.size(); ++other) weights.push_back(other == k ? 1.0F : 0.0F);
    }
    root_["meshes"][mesh]["primitives"][0]["targets"] = targets;
    root_["meshes"][mesh]["weights"] = std::vector<int>(poses.size(), 0);
    add_channel(node, "weights", add_times(seconds), add_floats(weights, weights.size(), "SCALAR"), false);
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
    if (compression_.webp) {
      std::string error;
      if (!picture_codecs("colours.webp")
               .encode("webp", colors.width, colors.height, 4, colors.rgba.data(), bytes, error))
        throw Error("the colours of " + name + " cannot be encoded as WebP: " + error);
    } else {
      bytes = encode_png(colors.width, colors.height, 4, colors.rgba, png_level);
    }
    const std::size_t view = add_view(bytes.data(), bytes.size(), 0);
    const std::size_t image = add_to(
        "images", {{"bufferView", view}, {"mimeType", compression_.webp ? "image/webp" : "image/png"}, {"name", name}});
    json texture = {{"sampler", 0}};
    if (compression_.webp)
      texture["extensions"]["EXT_texture_webp"]["source"] = image;
    else
      texture["source"] = image;
    return add_to("textures", texture);
  }

  std::size_t add_material(const std::string& name, const MeanColors& colors) {
    return add_to("materials", {{"name", name},
                                {"pbrMetallicRoughness",
                                 {{"baseColorTexture", {{"index", add_color_texture(name, colors)}}},
                                  {"metallicFactor", 0},
                                  {"roughnessFactor", 1}}},
                                {"alphaMode", "MASK"},
                                {"alphaCutoff", 0.5},
                                {"doubleSided", true},
                                {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  }

  std::size_t add_accessor(std::size_t view, int type, std::size_t count, const char* shape) {
    return add_to("accessors", {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
  }

  // Positions relative to a centre. `scale`: of the node, by which quantised positions are multiplied.
  std::size_t add_positions(const Soup& soup, const Vec3& centre, double& scale) {
    std::vector<Vec3> places;
    for (const Vec3& p : soup.positions()) places.push_back(p - centre);
    if (compression_.quantized) {
      const QuantizedPositions quantized = quantized_positions(places);
      scale = quantized.scale;
      const std::size_t made =
          add_accessor(add_geometry(quantized.values.data(), places.size(), sizeof(quantized.values[0])), short_type,
                       places.size(), "VEC3");
      root_["accessors"][made]["normalized"] = true;
      root_["accessors"][made]["min"] = quantized.least;
      root_["accessors"][made]["max"] = quantized.most;
      return made;
    }
    std::vector<Eigen::Vector3f> floats;
    Eigen::AlignedBox3f box;
    for (const Vec3& p : places) box.extend(floats.emplace_back(p.cast<float>()));
    const std::size_t made =
        add_accessor(add_geometry(floats.data(), floats.size(), sizeof(floats[0])), float_type, floats.size(), "VEC3");
    root_["accessors"][made]["min"] = {box.min().x(), box.min().y(), box.min().z()};
    root_["accessors"][made]["max"] = {box.max().x(), box.max().y(), box.max().z()};
    return made;
  }

  std::size_t add_uvs(const Soup& soup) {
    if (compression_.quantized)
      if (const auto quantized = quantized_uvs(soup.uvs()); !quantized.empty()) {
        const std::size_t made = add_accessor(add_geometry(quantized.data(), quantized.size(), sizeof(quantized[0])),
                                              unsigned_short_type, quantized.size(), "VEC2");
        root_["accessors"][made]["normalized"] = true;
        return made;
      }
    std::vector<Eigen::Vector2f> floats;
    for (const Vec2& uv : soup.uvs()) floats.emplace_back(static_cast<float>(uv.x()), static_cast<float>(1 - uv.y()));
    return add_accessor(add_geometry(floats.data(), floats.size(), sizeof(floats[0])), float_type, floats.size(),
                        "VEC2");
  }

  json primitive(const TextureSet& set, const Vec3& centre, std::size_t material, double& scale) {
    const std::size_t position = add_positions(set.soup, centre, scale), uv = add_uvs(set.soup);
    const std::vector<Face>& faces = set.soup.faces();
    const std::size_t indices =
        add_accessor(add_geometry(faces.data(), 3 * faces.size(), 0), unsigned_int_type, 3 * faces.size(), "SCALAR");
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
    if (!root_.contains("cameras")) root_["cameras"] = json::array();
    return add_to("nodes",
                  {{"name", name}, {"camera", add_to("cameras", lens)}, {"matrix", column_major(to_world.matrix())}});
  }

  const Progress& progress_;
  std::vector<PlacedNode> visible_;
  std::optional<SceneRays> rays_;
  double size_ = 0;
  Box bounds_;
  json root_;
  std::string bytes_;
  std::vector<std::string> notes_;
  json channels_ = json::array(), samplers_ = json::array();  ///< of the animation
  bool features_;
  const std::optional<Vec3>& eye_;  ///< whose colours are taken; nothing: means
  GltfCompression compression_;
  std::size_t decompressed_ = 0;  ///< bytes of compressed buffer views
  std::map<const FeatureTexture*, std::vector<std::size_t>> feature_textures_;
  std::vector<const BakedObject*> object_order_;    ///< in which they were met
  std::map<const BakedObject*, json> object_sets_;  ///< the sets of each object in the extension
};

// Whether a file is one that write_gltf() made.
bool is_own(const fs::path& file) {
  const std::string bytes = read_file(file);
  if (!bytes.starts_with("glTF") || bytes.size() < 20) return false;
  std::size_t length = 0;
  for (std::size_t k = 0; k < 4; ++k)
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[12 + k])) << (8 * k);
  const json root = json::parse(bytes.substr(20, length), nullptr, false);
  return root.is_object() && root.value("/asset/generator"_json_pointer, "") == generator;
}

}  // namespace

namespace {

ExportReport write_glb(const Scene& scene, const fs::path& file, const ExportOptions& options, const Progress& progress,
                       bool features) {
  if (options.layout) throw FieldError("layout", "does not apply to glTF files; leave it out");
  if (options.page_side) throw FieldError("page_size", "does not apply to glTF files; leave it out");
  if (file.extension() != ".glb") throw FieldError("out", "must end in .glb, the extension of binary glTF files");
  options.sources.check_file(file);
  const auto refuse_foreign = [&] {
    if (std::error_code error; fs::exists(file, error) && fs::file_size(file, error) > 0 && !is_own(file))
      throw FileError(file, "exists and is not a glTF file of Rebake, so it is not replaced; choose another name");
  };
  refuse_foreign();
  const GltfWriter document(scene, features, options, progress);
  refuse_foreign();  // once more: it may have appeared since
  write_file_atomically(file, document.glb(), options.sources);
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
