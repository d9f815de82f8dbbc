#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>

#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/document/replaced_work.h"
#include "editor/edits/edit.h"
#include "editor/edits/shared_result_cache.h"
#include "editor/fields/field_info.h"
#include "editor/script/script_inputs.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/light/train_transfer_model.h"

namespace rebake {

namespace {

using nlohmann::json;

// Applies `change` to a number, or to all numbers of a list.
template <class Change>
void for_each_number(json& value, Change change) {
  if (value.is_number()) value = change(value.get<double>());
  if (value.is_array())
    for (json& one : value)
      if (one.is_number()) one = change(one.get<double>());
}

// Scales the strength of a deformation: angles and translations by `share`, positive factors to the power of `share`.
void scale_strength(json& edit, double share) {
  for (const char* field : {"degrees", "translate"}) {
    if (!edit.contains(field)) continue;
    for_each_number(edit[field], [&](double number) { return number * share; });
  }
  for (const char* field : {"factor", "scale"})
    if (edit.contains(field))
      for_each_number(edit[field], [&](double number) { return number > 0 ? std::pow(number, share) : number; });
  if (edit.contains("rotate") && edit["rotate"].is_object()) scale_strength(edit["rotate"], share);
}

// The edit of a random pose: its strength is scaled by a random share in −1 … 1, each move of a cage by its own.
json posed(json edit, std::mt19937& random) {
  const auto share = [&] { return 2 * ((random() + 0.5) / 4294967296.0) - 1; };
  if (edit.contains("moves") && edit["moves"].is_array()) {
    for (json& move : edit["moves"]) scale_strength(move, share());
    return edit;
  }
  scale_strength(edit, share());
  return edit;
}

struct Options {
  std::string action;
  std::vector<std::string> paths;
  std::vector<std::string> edits;
  std::string node, out, way = "linear";
  FolderOptions reading;
  int poses = 200, rays = 128, channels = 8;
  double coarseness = TransferModelOptions{}.coarseness;
};

std::string read_model_bytes(const std::string& path) {
  const std::string bytes = read_file(path);
  try {
    transfer_model_of(bytes);
  } catch (const Error& error) {
    throw FileError(path, error.what());
  }
  return bytes;
}

void say(const TransferModel& model) {
  fmt::print("poses       {} of {}\n", model.poses, model.poses_from);
  fmt::print("range       up to {:.3g} from the mean pose, {} dimensions; trusted up to {:.1f} times that\n",
             model.learned.space.largest * model.learned.space.size, model.learned.space.dimensions(),
             LearnedTransfer::trusted_range);
  if (model.net)
    fmt::print(
        "error       {:.1f} % of transfer, on held-out poses (rotation alone: {:.1f}; linear: "
        "{:.1f})\n",
        100 * model.net_error, 100 * model.turning_error, 100 * model.learned.held_back_error);
  else
    fmt::print("error       {:.1f} % of transfer, on held-out poses{}\n", 100 * model.learned.held_back_error,
               model.turning_error > 0 ? fmt::format(" (rotation alone: {:.1f})", 100 * model.turning_error) : "");
  if (model.net)
    fmt::print("network     U-Net with {} channels on a {}² image\n", model.net->state().channels,
               model.net->state().side);
  fmt::print("size        {} of {} sites, {:.1f} MB\n", model.keys.size(), model.sites,
             static_cast<double>(model.learned.memory() + (model.net ? model.net->memory() : 0)) / 1e6);
  fmt::print("time        {:.1f} s tracing with {} rays, {:.1f} s training\n", model.tracing_seconds, model.rays,
             model.learned.seconds + (model.net ? model.net->seconds() : 0));
}

// Drag light of a node: the start from which TransferModel learns. Throws Error if the node has none.
std::shared_ptr<const DragLight> drag_light_of(Scene scene, NodeId node) {
  // The sites and their visible sides do not depend on other light settings.
  if (!scene.light) scene.light = std::make_shared<const SceneLight>();
  LightingOptions options;
  options.rays = 16;
  options.results = result_cache().get();
  options.keep_traced = false;
  options.turning = {node};
  const Lighting lighting = lighting_of(scene, options, progress_bar());
  const auto found = lighting.turning.find(node);
  if (found == lighting.turning.end())
    throw Error("drag light is not available for this object: it is sheared, or the effect self is off");
  return found->second;
}

bool has_node_field(const json& edit) {
  for (const EditType* type : edit_types()) {
    if (!edit.contains("op") || edit.at("op") != type->op) continue;
    const std::vector<FieldInfo> fields = type->fields();
    return std::any_of(fields.begin(), fields.end(), [](const FieldInfo& field) { return field.name == "node"; });
  }
  return false;
}

NodePtr chosen_node(const Scene& scene, const std::string& name) {
  NodePtr chosen;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object || (!name.empty() && placed.node->name != name)) continue;
    if (chosen && name.empty()) throw FieldError("node", "is missing: the scene has several objects; name one");
    chosen = find(scene, placed.node->id);
  }
  if (!chosen)
    throw FieldError("node", name.empty() ? "the scene has no object" : "there is no object \"" + name + "\"");
  return chosen;
}

void keep(const std::string& bytes, const BakedObject& body, std::size_t sites) {
  const std::shared_ptr<ResultCache> results = result_cache();
  if (!results) throw Error("the model cannot be stored, because the result cache is off (REBAKE_RESULTS is empty)");
  results->keep(transfer_model_key(body, sites), bytes);
  fmt::print("stored: drags of this object now use the model\n");
}

void train(const Options& options) {
  for (const std::string& path : options.paths)
    if (!std::filesystem::exists(path)) throw FileError(path, "does not exist");
  if (options.channels % 8 != 0) throw FieldError("channels", "must be a multiple of 8");
  if (!(options.coarseness >= 0.005 && options.coarseness <= 0.5))
    throw FieldError("coarseness", "must lie between 0.005 and 0.5");
  if (options.edits.empty())
    throw FieldError("edit",
                     "is missing: give an edit that moves the object, such as '{\"op\": \"bend\", \"degrees\": 60, "
                     "\"axis\": [0, 1, 0]}'");
  auto [scene, sources] = load_scenes(options.paths, options.reading, progress_bar());
  for (const std::string& text : options.edits) {
    const json edit = json::parse(text, nullptr, false);  // invalid JSON is reported below
    for (const ScriptInput& input : edit.is_object() ? script_inputs(edit.dump(), {}) : std::vector<ScriptInput>())
      protect_input(sources, input.path, "a file that this run reads");
  }
  if (!options.out.empty()) {
    sources.check_file(options.out);
    refuse_replacing_work(options.out);
    if (std::error_code error; std::filesystem::is_regular_file(options.out, error) &&
                               std::filesystem::file_size(options.out, error) > 0 &&
                               !is_transfer_model(read_file(options.out)))
      throw FileError(options.out, "exists and is not a model, so it is not replaced; choose another name");
    const std::filesystem::path folder = std::filesystem::absolute(options.out).parent_path();
    if (!std::filesystem::is_directory(folder)) throw FieldError("out", "folder does not exist: " + folder.string());
  } else if (!result_cache()) {
    throw FieldError("out", "is missing: name a file, because the result cache is off (REBAKE_RESULTS is empty)");
  }
  const NodePtr node = chosen_node(scene, options.node);
  std::vector<json> edits;
  for (const std::string& text : options.edits) {
    json edit = json::parse(text, nullptr, false);
    if (!edit.is_object()) throw FieldError("edit", "is not a JSON object: " + text);
    if (!edit.contains("node") && has_node_field(edit)) edit["node"] = node->name;
    // Reports a faulty edit before anything is traced.
    NodePtr after;
    try {
      after = find(apply(scene, read_edit(edit, scene)).scene, node->id);
    } catch (const Error& error) {
      throw FieldError("edit", fmt::format("{}: {}", error.what(), text));
    }
    if (!after || !after->object) throw FieldError("edit", "removes the object to be trained: " + text);
    edits.push_back(edit);
  }
  const auto turning = drag_light_of(scene, node->id);
  const auto pose = [&, &from = scene](int k) {
    std::mt19937 random(static_cast<std::uint32_t>(k));
    Scene made = from;
    for (const json& edit : edits) made = apply(made, read_edit(posed(edit, random), made)).scene;
    const NodePtr moved = find(made, node->id);
    if (!moved || !moved->object) throw FieldError("edit", "removes the object to be trained");
    return moved->object;
  };
  TransferModelOptions learning;
  learning.poses = options.poses;
  learning.rays = options.rays;
  learning.coarseness = options.coarseness;
  if (options.way == "net") {
    learning.net.emplace();
    learning.net->channels = options.channels;
  }
  TransferModel model = trained_model(*turning, pose, learning, progress_bar());
  for (const json& edit : edits) model.poses_from += (model.poses_from.empty() ? "" : ", ") + edit.dump();
  clear_progress_bar();
  say(model);
  const std::string bytes = bytes_of(model);
  if (!options.out.empty()) write_file_atomically(options.out, bytes, sources);
  if (model.error() >= model.turning_error) {
    const std::string why = "it is no better than rotating the transfer, which drags use without a model";
    if (options.out.empty()) throw Error("the model is not stored: " + why);
    fmt::print("not stored: {}\n", why);
  } else if (options.out.empty() || result_cache()) {
    keep(bytes, *node->object, model.sites);
  }
}

void keep_model(const Options& options) {
  if (options.paths.size() < 2) throw FieldError("paths", "must be the model file, then its scene");
  if (std::filesystem::is_directory(options.paths.front()))
    throw FieldError("paths", options.paths.front() + " is a folder: give the model file first, then the scene");
  const std::string bytes = read_model_bytes(options.paths.front());
  const TransferModel model = transfer_model_of(bytes);
  auto [scene, sources] =
      load_scenes({options.paths.begin() + 1, options.paths.end()}, options.reading, progress_bar());
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    for (const BakedBody& body : bodies_of(*placed.node->object))
      if (surface_hash(*body.object) == model.body) {
        clear_progress_bar();
        return keep(bytes, *body.object, model.sites);
      }
  }
  throw FileError(options.paths.front(),
                  "was trained for another object: no object in the scene has its triangles and texels");
}

}  // namespace

void describe_light(SubcommandDescription& command) {
  auto options = std::make_shared<Options>();
  command.option("action", options->action, "train, keep or info", "train|keep|info")
      .required()
      .one_of(std::vector<std::string>{"train", "keep", "info"});
  command.option("paths", options->paths, "train: a scene; keep: a model and its scene; info: a model", "PATH...")
      .required();
  command.option("--edit", options->edits,
                 "train, required: edits that move the object, as JSON (the default node is the object); poses "
                 "scale their strength by -1 to 1",
                 "JSON...");
  command.option("--node", options->node, "train: the object; default: the only one", "NAME");
  command.option("--poses", options->poses, "train: number of poses, 8 to 2000", "N [200]").between(8, 2000);
  command.option("--rays", options->rays, "train: rays per site, 16 to 16384", "N [128]").between(16, 16384);
  command
      .option("--way", options->way,
              "train: model; linear in the pose, or net: a U-Net on a geometry image of a proxy body", "linear|net")
      .one_of(std::vector<std::string>{"linear", "net"});
  command
      .option("--channels", options->channels, "train, net: channels of the first layer, a multiple of 8 up to 64",
              "N [8]")
      .between(8, 64);
  command.option("--coarseness", options->coarseness,
                 "train, net: coarseness of the proxy body relative to the object's diagonal; coarser if the body "
                 "would split into parts",
                 "SHARE [0.03]");
  command.option("-o,--out", options->out, "train: also write the model to this file", "FILE");
  options->reading.add_to(command);
  command.footer(
      "A model improves the shading during drags near the trained poses, compared with rotating the transfer. It is "
      "cached by the object's content; a later model replaces it. A model that is no better "
      "than rotation alone is not stored.");
  command.does([options] {
    if (options->action == "train") return train(*options);
    if (options->action == "keep") return keep_model(*options);
    if (options->paths.size() > 1) throw FieldError("paths", "info takes one model");
    say(transfer_model_of(read_model_bytes(options->paths.front())));
  });
}

}  // namespace rebake
