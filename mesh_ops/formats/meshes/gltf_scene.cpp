#include "mesh_ops/formats/meshes/gltf_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/meshes/beside.h"
#include "mesh_ops/formats/meshes/gltf_document.h"
#include "mesh_ops/formats/meshes/textured_mesh.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);
constexpr int deepest_node = 64;

// Finite numbers of a list of known length; `otherwise` if the key is absent.
template <std::size_t N>
std::array<double, N> list_of(const GltfDocument& document, const json& element, const char* key,
                              const std::array<double, N>& otherwise) {
  const auto found = element.find(key);
  if (found == element.end()) return otherwise;
  std::array<double, N> values{};
  if (!found->is_array() || found->size() != N) document.fail(fmt::format("\"{}\" must have {} numbers", key, N));
  for (std::size_t k = 0; k < N; ++k) {
    values[k] = found->at(k).is_number() ? found->at(k).get<double>() : std::nan("");
    if (!std::isfinite(values[k])) document.fail(fmt::format("\"{}\"[{}] is not a finite number", key, k));
  }
  return values;
}

// A finite number; `otherwise` if the key is absent.
double number_of(const GltfDocument& document, const json& element, const char* key, double otherwise) {
  const auto found = element.find(key);
  if (found == element.end()) return otherwise;
  const double value = found->is_number() ? found->get<double>() : std::nan("");
  if (!std::isfinite(value)) document.fail(fmt::format("\"{}\" is not a finite number", key));
  return value;
}

Affine transform_of(const GltfDocument& document, const json& node) {
  Affine result = Affine::Identity();
  if (node.contains("matrix")) {
    const auto columns = list_of<16>(document, node, "matrix", {});
    result.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix4d>(columns.data()).topRows<3>();
    return result;
  }
  const auto move = list_of<3>(document, node, "translation", {0, 0, 0}),
             size = list_of<3>(document, node, "scale", {1, 1, 1});
  const auto turn = list_of<4>(document, node, "rotation", {0, 0, 0, 1});
  const Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
  if (rotation.squaredNorm() == 0) document.fail("a node's \"rotation\" is zero");
  return Affine(Eigen::Translation3d(move[0], move[1], move[2]) * rotation.normalized() *
                Eigen::Scaling(size[0], size[1], size[2]));
}

// The texture of a material's base colour.
struct TextureUse {
  std::size_t uv_set = 0;
  Eigen::Affine2d uv = Eigen::Affine2d::Identity();  // KHR_texture_transform, v down
};

class GltfReader {
 public:
  explicit GltfReader(const fs::path& file) : document_(file) {}

  std::shared_ptr<const BakedObject> run() {
    const std::size_t scene = document_.number(document_.root(), "scene", 0);
    if (document_.elements("scenes").empty()) {
      for (std::size_t k = 0; k < document_.elements("nodes").size(); ++k) add_node(k, Affine::Identity(), 0);
    } else {
      const json& made = document_.element("scenes", scene);
      for (const json& node : made.value("nodes", json::array())) add_node(index(node), Affine::Identity(), 0);
    }
    note_other_content();
    std::vector<std::string> assumptions;
    for (const std::string& one : skipped_) assumptions.push_back(one);
    assumptions.emplace_back("colours are drawn as they are, without light, and with nearest filtering");
    const auto object = object_of_meshes(std::move(meshes_), document_.file(), assumptions);
    object->origin = origin_of_file(document_.file(), "gltf", std::move(assumptions));
    return object;
  }

 private:
  std::size_t index(const json& value) const {
    if (!value.is_number_unsigned()) document_.fail("an index is not a whole number");
    return value.get<std::size_t>();
  }

  void note_other_content() {
    for (const char* kind : {"animations", "cameras"})
      if (!document_.elements(kind).empty()) skipped_.insert(fmt::format("{} are skipped", kind));
    const json extensions = document_.root().value("extensions", json::object());
    if (extensions.is_object() && extensions.contains("KHR_lights_punctual")) skipped_.insert("lights are skipped");
    if (document_.elements("scenes").size() > 1) skipped_.insert("only the file's main scene is read");
    if (nodes_with_mesh_ > 1) skipped_.insert("the nodes become one object, without their names and groups");
  }

  void add_node(std::size_t number, const Affine& parent, int depth) {
    if (depth > deepest_node) document_.fail(fmt::format("nodes are nested deeper than {}", deepest_node));
    if (++visited_ > max_nodes) document_.fail(fmt::format("has more than {} nodes", max_nodes));
    const json& node = document_.element("nodes", number);
    const Affine to_world = parent * transform_of(document_, node);
    if (node.contains("skin")) skipped_.insert("skins are skipped: meshes stay in their rest pose");
    nodes_with_mesh_ += node.contains("mesh") ? 1 : 0;
    if (node.contains("mesh"))
      for (const json& primitive :
           document_.element("meshes", document_.number(node, "mesh")).value("primitives", json::array()))
        add_primitive(primitive, to_world);
    for (const json& child : node.value("children", json::array())) add_node(index(child), to_world, depth + 1);
  }

  void add_primitive(const json& primitive, const Affine& to_world) {
    if (!primitive.is_object() || !primitive.contains("attributes")) document_.fail("a primitive has no attributes");
    const json& attributes = primitive.at("attributes");
    if (primitive.contains("targets")) skipped_.insert("morph targets are skipped");
    if (attributes.is_object() && attributes.contains("COLOR_0")) skipped_.insert("vertex colours are skipped");
    TexturedMesh mesh;
    TextureUse use;
    mesh.material = material_of(document_.number(primitive, "material", none), use);
    vertices_ += document_.number(document_.element("accessors", document_.number(attributes, "POSITION")), "count");
    if (vertices_ > max_vertices) document_.fail(fmt::format("has more than {} vertices", max_vertices));
    const std::vector<double> places = document_.numbers(document_.number(attributes, "POSITION"), 3);
    for (std::size_t k = 0; k < places.size(); k += 3)
      mesh.positions.push_back(to_world * Vec3(places[k], places[k + 1], places[k + 2]));
    const std::string key = fmt::format("TEXCOORD_{}", use.uv_set);
    if (mesh.material.image && !attributes.contains(key)) document_.fail(key + " is missing for a textured material");
    std::vector<double> uvs(2 * mesh.positions.size());
    if (mesh.material.image) uvs = document_.numbers(document_.number(attributes, key.c_str()), 2);
    if (uvs.size() != 2 * mesh.positions.size()) document_.fail(key + " and POSITION have different lengths");
    for (std::size_t k = 0; k < uvs.size(); k += 2) {
      const Vec2 uv = use.uv * Vec2(uvs[k], uvs[k + 1]);
      mesh.uvs.emplace_back(uv.x(), 1 - uv.y());
    }
    std::vector<std::uint32_t> corners(mesh.positions.size());
    for (std::uint32_t k = 0; k < corners.size(); ++k) corners[k] = k;
    if (primitive.contains("indices")) corners = document_.indices(document_.number(primitive, "indices"));
    for (const std::uint32_t corner : corners)
      if (corner >= mesh.positions.size()) document_.fail(fmt::format("index {} is out of range", corner));
    mesh.faces = faces_of(corners, document_.number(primitive, "mode", 4), to_world.linear().determinant() < 0);
    add_mesh(document_.number(primitive, "material", none), use.uv_set, std::move(mesh));
  }

  // Joins meshes of one material, which share its texture.
  void add_mesh(std::size_t material, std::size_t uv_set, TexturedMesh mesh) {
    const auto [it, fresh] = mesh_of_.try_emplace({material, uv_set}, meshes_.size());
    if (fresh) {
      meshes_.push_back(std::move(mesh));
      return;
    }
    TexturedMesh& all = meshes_[it->second];
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    all.uvs.insert(all.uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
    for (const Face& face : mesh.faces) all.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
  }

  // `mirrored`: the transform turns triangles inside out.
  std::vector<Face> faces_of(const std::vector<std::uint32_t>& corners, std::size_t mode, bool mirrored) {
    std::vector<Face> faces;
    constexpr std::size_t triangles = 4, strip = 5, fan = 6;
    if (mode < triangles) skipped_.insert("points and lines are skipped");
    if (mode > fan) document_.fail("a primitive has an unknown \"mode\"");
    for (std::size_t k = 0; mode >= triangles && k + 2 < corners.size(); k += mode == triangles ? 3 : 1) {
      Face face{corners[mode == fan ? 0 : k], corners[k + 1], corners[k + 2]};
      if (mode == strip && k % 2 == 1) std::swap(face[1], face[2]);
      if (mirrored) std::swap(face[1], face[2]);
      faces.push_back(face);
    }
    return faces;
  }

  MeshMaterial material_of(std::size_t number, TextureUse& use) {
    MeshMaterial material;
    if (number == none) return material;
    const json& made = document_.element("materials", number);
    material.name = made.value("name", json("")).is_string() ? made.value("name", std::string()) : "";
    if (made.contains("emissiveTexture") || made.contains("emissiveFactor")) skipped_.insert("emission is skipped");
    if (!made.contains("pbrMetallicRoughness") && made.contains("extensions"))
      skipped_.insert(fmt::format("material \"{}\" has no metallic-roughness colours: it is white", material.name));
    const json surface = made.value("pbrMetallicRoughness", json::object());
    if (!surface.is_object()) document_.fail("\"pbrMetallicRoughness\" is not an object");
    material.factor = list_of<4>(document_, surface, "baseColorFactor", {1, 1, 1, 1});
    const json mode = made.value("alphaMode", json("OPAQUE"));
    if (mode == "MASK") material.cutoff = number_of(document_, made, "alphaCutoff", 0.5);
    if (mode == "BLEND") {
      material.cutoff = 0.5;
      skipped_.insert("blended transparency is drawn as a cut-out: alpha below 0.5 is a hole");
    }
    if (!surface.contains("baseColorTexture")) return material;
    const json& reference = surface.at("baseColorTexture");
    if (!reference.is_object()) document_.fail("\"baseColorTexture\" is not an object");
    const json& texture = document_.element("textures", document_.number(reference, "index"));
    use.uv_set = document_.number(reference, "texCoord", 0);
    read_texture_transform(reference, use);
    if (texture.contains("sampler"))
      read_sampler(document_.element("samplers", document_.number(texture, "sampler")), material);
    const json extensions = texture.value("extensions", json::object());
    const bool webp = extensions.is_object() && extensions.contains("EXT_texture_webp");
    material.image = image_at(document_.number(webp ? extensions.at("EXT_texture_webp") : texture, "source"));
    return material;
  }

  void read_sampler(const json& sampler, MeshMaterial& material) {
    constexpr std::size_t repeat = 10497, clamp_to_edge = 33071;
    for (const auto& [key, axis] : {std::pair("wrapS", 0U), {"wrapT", 1U}}) {
      const std::size_t mode = document_.number(sampler, key, repeat);
      material.repeats[axis] = mode != clamp_to_edge;
      if (mode != repeat && mode != clamp_to_edge) skipped_.insert("mirrored repeats of textures are drawn as repeats");
    }
  }

  void read_texture_transform(const json& reference, TextureUse& use) const {
    const json extensions = reference.value("extensions", json::object());
    if (!extensions.is_object() || !extensions.contains("KHR_texture_transform")) return;
    const json& made = extensions.at("KHR_texture_transform");
    if (!made.is_object()) document_.fail("\"KHR_texture_transform\" is not an object");
    const auto move = list_of<2>(document_, made, "offset", {0, 0}),
               size = list_of<2>(document_, made, "scale", {1, 1});
    const double turn = number_of(document_, made, "rotation", 0);
    // Angles are counter-clockwise for v down, as the extension defines them.
    use.uv = Eigen::Translation2d(move[0], move[1]) * Eigen::Rotation2Dd(-turn) * Eigen::Scaling(size[0], size[1]);
    use.uv_set = document_.number(made, "texCoord", use.uv_set);
  }

  std::shared_ptr<const ColorImage> image_at(std::size_t number) {
    auto& known = images_[number];
    if (known) return known;
    const json& made = document_.element("images", number);
    std::string fetched;
    std::string_view bytes;
    fs::path name = document_.file();
    if (made.contains("uri") && made.at("uri").is_string()) {
      const auto uri = made.at("uri").get<std::string>();
      if (!uri.starts_with("data:")) name = document_.file().parent_path() / uri;
      fetched = document_.fetched(uri);
      bytes = fetched;
    } else {
      bytes = document_.view(document_.number(made, "bufferView"));
    }
    known = std::make_shared<const ColorImage>(decode_color_image(bytes, name));
    return known;
  }

  // Bounds for nodes and meshes that are used many times.
  static constexpr std::size_t max_nodes = 1'000'000, max_vertices = 20'000'000;
  GltfDocument document_;
  std::size_t visited_ = 0, vertices_ = 0;
  std::vector<TexturedMesh> meshes_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> mesh_of_;  // by material and UV set
  std::set<std::string> skipped_;
  std::size_t nodes_with_mesh_ = 0;
  std::map<std::size_t, std::shared_ptr<const ColorImage>> images_;
};

}  // namespace

std::shared_ptr<const BakedObject> read_gltf_object(const fs::path& file) {
  try {
    return GltfReader(file).run();
  } catch (const json::exception& error) {
    throw FileError(file, fmt::format("has an element of the wrong type: {}", error.what()));
  }
}

std::vector<fs::path> gltf_files(const fs::path& file) { return GltfDocument(file).files(); }

}  // namespace rebake
