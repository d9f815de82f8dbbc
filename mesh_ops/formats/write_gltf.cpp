#include "mesh_ops/formats/write_gltf.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/features/atlas/atlas.h"
#include "mesh_ops/features/distill/mean_colors.h"
#include "mesh_ops/formats/images/png_writer.h"
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
constexpr int float_type = 5126, unsigned_int_type = 5125, vertex_target = 34962, index_target = 34963, nearest = 9728,
              clamp_to_edge = 33071;

template <class Matrix>
json column_major(const Matrix& m) {
  json values = json::array();
  for (Eigen::Index column = 0; column < m.cols(); ++column)
    for (Eigen::Index row = 0; row < m.rows(); ++row) values.push_back(m(row, column));
  return values;
}

// The document while it is made.
class GltfDocument {
 public:
  GltfDocument(const Scene& scene, const Progress& progress) : progress_(progress) {
    for (const PlacedNode& placed : placed_nodes(scene))
      if (placed.visible && placed.node->object) visible_.push_back(placed);
    if (visible_.empty()) throw EditError("there is nothing to export: no visible node has triangles");
    const Box box = world_bounds(scene);
    size_ = box.isEmpty() ? 0 : box.diagonal().norm();
    rays_.emplace(rays_through(visible_));
    for (const char* list : {"nodes", "meshes", "materials", "textures", "images", "accessors", "bufferViews"})
      root_[list] = json::array();
    json roots = json::array();
    for (const NodePtr& node : scene.roots)
      if (node->visible) roots.push_back(add_node(*node));
    for (const auto& [name, camera] : scene.views) roots.push_back(add_camera(name, camera));
    root_["scenes"] = {{{"nodes", roots}}};
    root_["scene"] = 0;
    root_["asset"] = {{"version", "2.0"}, {"generator", generator}};
    root_["extensionsUsed"] = {"KHR_materials_unlit"};
    root_["samplers"] = json::array(
        {{{"magFilter", nearest}, {"minFilter", nearest}, {"wrapS", clamp_to_edge}, {"wrapT", clamp_to_edge}}});
    root_["buffers"] = json::array({{{"byteLength", bytes_.size()}}});
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

  std::size_t add_node(const Node& node) {
    json made = {{"name", node.name}};
    if (!node.to_parent.matrix().isIdentity(0)) made["matrix"] = column_major(node.to_parent.matrix());
    json children = json::array();
    if (node.object)
      for (std::size_t child : add_object(node)) children.push_back(child);
    for (const NodePtr& child : node.children)
      if (child->visible) children.push_back(add_node(*child));
    if (!children.empty()) made["children"] = children;
    return add_to("nodes", made);
  }

  // A node per texture set, whose positions are relative to its centre, so that they fit into floats.
  std::vector<std::size_t> add_object(const Node& node) {
    const auto placed =
        std::find_if(visible_.begin(), visible_.end(), [&](const PlacedNode& one) { return one.node->id == node.id; });
    MeanColorLoss loss;
    std::vector<std::size_t> nodes;
    for (const TextureSet& set : packed(*node.object)) {
      progress_.at("averaging colours of " + node.name,
                   static_cast<double>(nodes.size()) / static_cast<double>(node.object->sets.size()));
      if (set.soup.triangle_count() == 0) continue;
      const MeanColors colors = mean_colors(set, *placed, *rays_, size_, directions, loss);
      const Vec3 centre = set.soup.bounds().center();
      const std::size_t mesh =
          add_to("meshes", {{"name", node.name},
                            {"primitives", json::array({primitive(set, centre, add_material(node.name, colors))})}});
      json part = {{"name", node.name + " triangles"}, {"mesh", mesh}};
      if (!centre.isZero(0)) part["translation"] = {centre.x(), centre.y(), centre.z()};
      nodes.push_back(add_to("nodes", part));
    }
    notes_.push_back(
        fmt::format("\"{}\" loses its view dependence: {:.1f} dB PSNR between its colours and their means, over "
                    "{} directions where they are visible",
                    node.name, loss.psnr_db(), directions));
    if (loss.hidden > 0)
      notes_.push_back(
          fmt::format("{} triangles of \"{}\" are visible from no direction: their colours are means over all",
                      loss.hidden, node.name));
    return nodes;
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

  std::size_t add_material(const std::string& name, const MeanColors& colors) {
    const std::string png = encode_png(colors.width, colors.height, 4, colors.rgba, png_level);
    const std::size_t view = add_view(png.data(), png.size(), 0);
    const std::size_t image = add_to("images", {{"bufferView", view}, {"mimeType", "image/png"}, {"name", name}});
    const std::size_t texture = add_to("textures", {{"sampler", 0}, {"source", image}});
    return add_to("materials",
                  {{"name", name},
                   {"pbrMetallicRoughness",
                    {{"baseColorTexture", {{"index", texture}}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
                   {"alphaMode", "MASK"},
                   {"alphaCutoff", 0.5},
                   {"doubleSided", true},
                   {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  }

  json primitive(const TextureSet& set, const Vec3& centre, std::size_t material) {
    const Soup& soup = set.soup;
    std::vector<float> positions, uvs;
    Eigen::AlignedBox3f box;
    for (std::size_t v = 0; v < soup.positions().size(); ++v) {
      const Eigen::Vector3f p = (soup.positions()[v] - centre).cast<float>();
      box.extend(p);
      positions.insert(positions.end(), {p.x(), p.y(), p.z()});
      uvs.insert(uvs.end(), {static_cast<float>(soup.uvs()[v].x()), static_cast<float>(1 - soup.uvs()[v].y())});
    }
    const std::size_t vertices = soup.positions().size();
    const auto accessor = [&](std::size_t view, int type, std::size_t count, const char* shape) {
      return add_to("accessors", {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
    };
    const std::size_t position = accessor(add_view(positions.data(), positions.size() * sizeof(float), vertex_target),
                                          float_type, vertices, "VEC3");
    root_["accessors"][position]["min"] = {box.min().x(), box.min().y(), box.min().z()};
    root_["accessors"][position]["max"] = {box.max().x(), box.max().y(), box.max().z()};
    const std::size_t uv =
        accessor(add_view(uvs.data(), uvs.size() * sizeof(float), vertex_target), float_type, vertices, "VEC2");
    const std::vector<Face>& faces = soup.faces();
    const std::size_t indices = accessor(add_view(faces.data(), faces.size() * sizeof(Face), index_target),
                                         unsigned_int_type, 3 * faces.size(), "SCALAR");
    return {{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}}, {"indices", indices}, {"material", material}};
  }

  std::size_t add_camera(const std::string& name, const Camera& camera) {
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
  json root_;
  std::string bytes_;
  std::vector<std::string> notes_;
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

ExportReport write_gltf(const Scene& scene, const fs::path& file, const ExportOptions& options,
                        const Progress& progress) {
  if (options.layout) throw FieldError("layout", "does not apply to glTF files; leave it out");
  if (options.page_side) throw FieldError("page_size", "does not apply to glTF files; leave it out");
  if (file.extension() != ".glb") throw FieldError("out", "must end in .glb, the extension of binary glTF files");
  options.sources.check_file(file);
  if (std::error_code error; fs::exists(file, error) && fs::file_size(file, error) > 0 && !is_own(file))
    throw FileError(file, "exists and is not a glTF file of Rebake, so it is not replaced; choose another name");
  const GltfDocument document(scene, progress);
  write_file_atomically(file, document.glb(), options.sources);
  ExportReport report;
  report.notes = document.notes();
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object && !placed.visible)
      report.notes.push_back(fmt::format("the hidden node \"{}\" is not exported; save keeps it", placed.node->name));
  if (scene.light) report.notes.emplace_back("light that follows edits is not part of the colours, which are as baked");
  return report;
}

}  // namespace rebake
