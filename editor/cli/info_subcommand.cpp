#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/fields/codec.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

namespace {

using nlohmann::json;

json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// Geometry files of the sets that an object was read from, whatever edits left of it; 0 if it was made from other
// objects, or read from a single file.
std::size_t chunk_count(const BakedObject& object) {
  if (!object.origin) return 0;
  std::size_t total = 0;
  for (const Origin::Set& set : object.origin->sets)
    total += static_cast<std::size_t>(std::count_if(set.geometry.begin(), set.geometry.end(), [](const auto& file) {
      return !file.name.ends_with(".mtl");  // of nerf2mesh
    }));
  return total;
}

// The color rule as JSON writes it.
const char* rule_name(ColorRule rule) {
  return rule == ColorRule::network ? "network" : rule == ColorRule::diffuse ? "diffuse" : "diffuse_and_network";
}

json object_info(const PlacedNode& placed) {
  const BakedObject& object = *placed.node->object;
  json sizes = json::array();
  for (const TextureSet& set : object.sets) sizes.push_back({set.texels->width(), set.texels->height()});
  const Box box = world_bounds(placed);
  return {{"name", placed.node->name},
          {"visible", placed.visible},
          {"locked", placed.locked},
          {"format", object.origin ? json(object.origin->format) : json()},
          {"layout", Codec<Layout>::write(object.layout)},
          {"texture_sets", object.sets.size()},
          {"texture_sizes", sizes},
          {"chunks", chunk_count(object)},
          {"vertices", object.vertex_count()},
          {"triangles", object.triangle_count()},
          {"opaque_texels", object.opaque_texel_count()},
          {"bounds", {{"min", list(box.min())}, {"max", list(box.max())}}},
          {"axes", Codec<Axes>::write(object.axes)},
          {"decoder", {Decoder::inputs, object.decoder->hidden0(), object.decoder->hidden1(), 3}},
          {"color_rule", rule_name(object.decoder->rule)},
          {"turned", object.any_rotations()},
          {"assumptions", object.origin ? object.origin->assumptions : std::vector<std::string>()},
          {"memory", object.memory()}};
}

json scene_info(const Scene& scene) {
  json objects = json::array();
  std::set<const void*> seen;  // objects and their files
  SharedTotals shared;
  std::uint64_t sets = 0, chunks = 0, vertices = 0, triangles = 0;
  Box box;
  json axes, decoder;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    const BakedObject& object = *placed.node->object;
    objects.push_back(object_info(placed));
    box.extend(world_bounds(placed));
    triangles += object.triangle_count();
    vertices += object.vertex_count();
    // An object that several nodes share counts once.
    if (seen.insert(&object).second) {
      sets += object.sets.size();
      if (!object.origin || seen.insert(object.origin.get()).second) chunks += chunk_count(object);
    }
    shared.add(object);
    const json own_axes = Codec<Axes>::write(object.axes), own_decoder = objects.back().at("decoder");
    axes = axes.is_null() || axes == own_axes ? own_axes : json("mixed");
    decoder = decoder.is_null() || decoder == own_decoder ? own_decoder : json("mixed");
  }
  json out = {{"texture_sets", sets},
              {"chunks", chunks},
              {"vertices", vertices},
              {"triangles", triangles},
              {"opaque_texels", shared.opaque_texels()},
              {"axes", axes},
              {"decoder", decoder},
              {"memory", shared.memory()},
              {"objects", objects},
              {"views", json::array()},
              {"background", list(scene.background)}};
  out["bounds"] = box.isEmpty() ? json() : json{{"min", list(box.min())}, {"max", list(box.max())}};
  for (const auto& [name, camera] : scene.views) out["views"].push_back(name);
  return out;
}

// What the files of an object are: format, or layout of a MobileNeRF folder.
std::string format_words(const json& object) {
  const json& format = object.at("format");
  if (format.is_null() || format == "mobilenerf") return object.at("layout").get<std::string>();
  for (const Format& known : formats())
    if (format == known.name) return known.title;
  return format.get<std::string>() + " file";
}

// How colours follow from texels.
std::string decoder_words(const json& object) {
  const json& d = object.at("decoder");
  if (object.at("color_rule") == "diffuse") return "none: texels hold colours";
  if (object.at("color_rule") == "diffuse_and_network")
    return fmt::format("6-{}-3, added to a diffuse colour", d[2].get<int>());
  return fmt::format("{}-{}-{}-{}", d[0].get<int>(), d[1].get<int>(), d[2].get<int>(), d[3].get<int>());
}

std::string megabytes(double bytes) { return fmt::format("{:.1f} MB", bytes / 1e6); }

void print(const json& info) {
  for (const json& o : info.at("objects")) {
    const json &low = o.at("bounds").at("min"), &high = o.at("bounds").at("max");
    fmt::print("{}{}\n", printable(o.at("name").get<std::string>()), o.at("visible").get<bool>() ? "" : "  (hidden)");
    const auto files = o.at("chunks").get<std::size_t>();
    fmt::print("  layout         {}, {}{}\n", format_words(o),
               counted(o.at("texture_sets").get<std::size_t>(), "texture set"),
               files > 0 ? ", read from " + counted(files, "geometry file") : "");
    fmt::print("  geometry       {} vertices, {}\n", o.at("vertices").get<std::size_t>(),
               counted(o.at("triangles").get<std::size_t>(), "triangle"));
    std::string sizes;
    for (const json& size : o.at("texture_sizes"))
      sizes += fmt::format("{}{}×{}", sizes.empty() ? "" : ", ", size[0].get<int>(), size[1].get<int>());
    fmt::print("  texels         {} opaque, in {}\n", o.at("opaque_texels").get<std::uint64_t>(), sizes);
    fmt::print("  bounds         ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})\n", low[0].get<double>(),
               low[1].get<double>(), low[2].get<double>(), high[0].get<double>(), high[1].get<double>(),
               high[2].get<double>());
    fmt::print("  axes           {}\n", o.at("axes").get<std::string>());
    fmt::print("  decoder        {}\n", decoder_words(o));
    fmt::print("  memory         {}\n", megabytes(o.at("memory").get<double>()));
  }
  if (info.at("objects").size() > 1)
    fmt::print("total            {}, {}, {}\n", counted(info.at("triangles").get<std::size_t>(), "triangle"),
               counted(info.at("opaque_texels").get<std::uint64_t>(), "opaque texel"),
               megabytes(info.at("memory").get<double>()));
}

}  // namespace

void describe_info(SubcommandDescription& command) {
  struct Options {
    std::string folder;
    FolderOptions reading;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  command.option("folder", options->folder, "scene: a folder, a mesh or a project", "FOLDER|SCENE|PROJECT").required();
  command.flag("--json", options->json, "print JSON; memory in bytes");
  options->reading.add_to(command);
  command.does([options] {
    const nlohmann::json info = scene_info(load_scenes({options->folder}, options->reading, progress_bar()).scene);
    if (options->json)
      fmt::print("{}\n", info.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
    else
      print(info);
  });
}

}  // namespace rebake
