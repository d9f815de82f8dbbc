#include "mesh_ops/formats/gltf_features.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/meshes/gltf_document.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/mlp_json.h"
#include "mesh_ops/formats/mobilenerf/rotations_file.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr std::array<const char*, 3> rule_words{"network", "diffuse_and_network", "diffuse"},
    layout_words{"split", "chunked", "unsplit"};

template <std::size_t N>
std::size_t word(const GltfDocument& document, const json& value, const std::array<const char*, N>& words) {
  const auto text = value.get<std::string>();
  const auto found = std::find(words.begin(), words.end(), text);
  if (found == words.end()) document.fail(fmt::format("{} has the unknown word \"{}\"", gltf_features_extension, text));
  return static_cast<std::size_t>(found - words.begin());
}

class FeatureReader {
 public:
  explicit FeatureReader(const GltfDocument& document) : document_(document) {}

  std::shared_ptr<const BakedObject> object(const json& value) {
    auto made = std::make_shared<BakedObject>();
    MlpFile file = read_mlp_json(value.at("decoder").dump(), document_.file());
    file.decoder.rule = static_cast<ColorRule>(word(document_, value.at("rule"), rule_words));
    made->decoder = std::make_shared<const Decoder>(std::move(file.decoder));
    // Earlier versions wrote them among those of the decoder.
    made->other_members = value.contains("members") ? value.at("members").get<std::map<std::string, std::string>>()
                                                    : std::move(file.others);
    for (const auto& [key, text] : made->other_members)
      if (!json::accept(text))
        document_.fail(fmt::format("{} has the member \"{}\", which is not JSON", gltf_features_extension, key));
    made->axes = word(document_, value.at("axes"), std::array{"360", "forward"}) == 1 ? Axes::forward : Axes::y_up;
    made->layout = static_cast<Layout>(word(document_, value.at("layout"), layout_words));
    made->dialect.half_direction = value.value("halfDirection", false);
    made->dialect.direction_first = value.value("directionFirst", false);
    made->dialect.bgr = value.value("bgr", false);
    made->dialect.no_holes = value.value("noHoles", false);
    made->dialect.linear = value.value("linear", 0);
    if (const int linear = made->dialect.linear; linear != 0 && (linear < 3 || linear > 9 || linear % 2 == 0))
      document_.fail(fmt::format("{} has \"linear\": {}, which is not 3, 5, 7 or 9", gltf_features_extension, linear));
    if (value.contains("alphaCode"))
      made->dialect.alpha = value.at("alphaCode") == "plain" ? AlphaCode::plain : AlphaCode::halved;
    for (const json& set : value.at("sets")) made->sets.push_back(texture_set(set));
    if (made->sets.empty())
      document_.fail(fmt::format("{} has an object without texture sets", gltf_features_extension));
    if (value.contains("rotations"))
      read_rotations(document_.view(document_.number(value, "rotations")), document_.file(), made->sets);
    return made;
  }

 private:
  template <class Value>
  std::vector<Value> values(const json& set, const char* key) const {
    const std::string_view bytes = document_.view(document_.number(set, key));
    if (bytes.size() % sizeof(Value) != 0)
      document_.fail(fmt::format("\"{}\" of {} has an incomplete last element", key, gltf_features_extension));
    std::vector<Value> result(bytes.size() / sizeof(Value));
    std::memcpy(static_cast<void*>(result.data()), bytes.data(), bytes.size());
    return result;
  }

  TextureSet texture_set(const json& set) {
    std::vector<Vec3> positions = values<Vec3>(set, "positions");
    std::vector<Vec2> uvs = values<Vec2>(set, "uvs");
    std::vector<Face> faces = values<Face>(set, "faces");
    if (uvs.size() != positions.size())
      document_.fail(
          fmt::format("{} has {} positions, but {} UVs", gltf_features_extension, positions.size(), uvs.size()));
    const auto finite = [](const auto& v) { return v.allFinite(); };
    if (!std::all_of(positions.begin(), positions.end(), finite) || !std::all_of(uvs.begin(), uvs.end(), finite))
      document_.fail(fmt::format("{} has a position or UV that is not finite", gltf_features_extension));
    for (const Face& face : faces)
      for (const std::uint32_t vertex : face)
        if (vertex >= positions.size())
          document_.fail(
              fmt::format("{} has a face with vertex {} of {}", gltf_features_extension, vertex, positions.size()));
    const json& mesh = document_.element("meshes", document_.number(set, "mesh"));
    return {Soup(std::move(positions), std::move(uvs), std::move(faces)),
            texels(mesh.at("extensions").at(gltf_features_extension))};
  }

  std::shared_ptr<const FeatureTexture> texels(const json& features) {
    auto& known = known_[features.dump()];
    if (known) return known;
    const auto image = [&](std::size_t k) {
      const json& texture = document_.element("textures", document_.number(features.at("features").at(k), "index"));
      return document_.view(
          document_.number(document_.element("images", document_.number(texture, "source")), "bufferView"));
    };
    const AlphaCode code = features.at("alphaCode") == "plain" ? AlphaCode::plain : AlphaCode::halved;
    known = std::make_shared<const FeatureTexture>(
        read_feature_images(image(0), document_.file(), image(1), document_.file(), code).texels);
    return known;
  }

  const GltfDocument& document_;
  std::map<std::string, std::shared_ptr<const FeatureTexture>> known_;
};

}  // namespace

json object_json(const BakedObject& object, const json& sets) {
  const Dialect& dialect = object.dialect;
  json made = {{"decoder", json::parse(write_mlp_json({*object.decoder, std::nullopt, {}}))},
               {"rule", rule_words[static_cast<std::size_t>(object.decoder->rule)]},
               {"axes", object.axes == Axes::forward ? "forward" : "360"},
               {"layout", layout_words[static_cast<std::size_t>(object.layout)]},
               {"sets", sets}};
  for (const auto& [set, key] : {std::pair(dialect.half_direction, "halfDirection"),
                                 {dialect.direction_first, "directionFirst"},
                                 {dialect.bgr, "bgr"},
                                 {dialect.no_holes, "noHoles"}})
    if (set) made[key] = true;
  // As text, which keeps the spelling of numbers.
  if (!object.other_members.empty()) made["members"] = object.other_members;
  if (dialect.linear != 0) made["linear"] = dialect.linear;
  if (dialect.alpha) made["alphaCode"] = *dialect.alpha == AlphaCode::plain ? "plain" : "halved";
  return made;
}

std::optional<Scene> read_gltf_features(const fs::path& file, const Progress& progress) {
  progress.at("reading " + file.filename().string(), 0);
  const GltfDocument document(file);
  const auto extensions = document.root().find("extensions");
  if (extensions == document.root().end() || !extensions->is_object() || !extensions->contains(gltf_features_extension))
    return std::nullopt;
  const json& extension = extensions->at(gltf_features_extension);
  try {
    if (extension.at("version") != gltf_features_version)
      document.fail(fmt::format("{} was written by a newer version of Rebake", gltf_features_extension));
    FeatureReader reader(document);
    std::vector<std::shared_ptr<const BakedObject>> objects;
    for (const json& object : extension.at("objects")) objects.push_back(reader.object(object));
    return read_scene_json(extension.at("scene").dump(), file, [&](const std::string& name) {
      for (std::size_t k = 0; k < objects.size(); ++k)
        if (name == std::to_string(k)) return objects[k];
      document.fail(fmt::format("{} has no object \"{}\"", gltf_features_extension, name));
    });
  } catch (const json::exception& error) {
    document.fail(fmt::format("{} is damaged: {}", gltf_features_extension, error.what()));
  } catch (const FieldError& error) {
    document.fail(fmt::format("{} is damaged: {}", gltf_features_extension, error.what()));
  }
}

Scene visible_part(const Scene& scene) {
  Scene result = scene;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (!placed.visible && find(result, placed.node->id) != nullptr) result = without(result, placed.node->id);
  return result;
}

}  // namespace rebake
