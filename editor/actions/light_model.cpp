#include "editor/actions/light_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "editor/document/replaced_work.h"
#include "editor/edits/edit.h"
#include "editor/edits/shared_result_cache.h"
#include "editor/fields/field_info.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/light/lighting.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Applies `change` to a number, or to all numbers of a list.
template <class Change>
void for_each_number(nlohmann::json& value, Change change) {
  if (value.is_number()) value = change(value.get<double>());
  if (value.is_array())
    for (nlohmann::json& one : value)
      if (one.is_number()) one = change(one.get<double>());
}

// Scales the strength of a deformation: angles and translations by `share`, positive factors to the power of `share`.
void scale_strength(nlohmann::json& edit, double share) {
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
nlohmann::json posed(nlohmann::json edit, std::mt19937& random) {
  const auto share = [&] { return 2 * ((random() + 0.5) / 4294967296.0) - 1; };
  if (edit.contains("moves") && edit["moves"].is_array()) {
    for (nlohmann::json& move : edit["moves"]) scale_strength(move, share());
    return edit;
  }
  scale_strength(edit, share());
  return edit;
}

bool has_node_field(const nlohmann::json& edit) {
  for (const EditType* type : edit_types()) {
    if (!edit.contains("op") || edit.at("op") != type->op) continue;
    const std::vector<FieldInfo> fields = type->fields();
    return std::any_of(fields.begin(), fields.end(), [](const FieldInfo& field) { return field.name == "node"; });
  }
  return false;
}

// Drag light of a node: the start from which TransferModel learns. Throws Error if the node has none.
std::shared_ptr<const DragLight> drag_light_of(Scene scene, NodeId node, const Progress& progress) {
  // The sites and their visible sides do not depend on other light settings.
  if (!scene.light) scene.light = std::make_shared<const SceneLight>();
  LightingOptions options;
  options.rays = 16;
  options.results = result_cache().get();
  options.keep_traced = false;
  options.turning = {node};
  const Lighting lighting = lighting_of(scene, options, progress);
  const auto found = lighting.turning.find(node);
  if (found == lighting.turning.end())
    throw Error("drag light is not available for this object: it is sheared, or the effect self is off");
  return found->second;
}

// The node's object as it was read: that is what light was baked on. Throws Error for a joined object.
std::shared_ptr<const BakedObject> object_as_read(const Node& node) {
  const std::vector<BakedBody> bodies = bodies_of(*node.object);
  if (bodies.size() != 1 || !bodies.front().to_object.matrix().isIdentity(0))
    throw Error(fmt::format(
        "\"{}\" was joined from several objects: models belong to the objects before they are joined", node.name));
  return bodies.front().object;
}

// The edits, with their node, checked once at full strength.
std::vector<nlohmann::json> checked_edits(const Scene& scene, const NodePtr& node,
                                          const std::vector<std::string>& lines) {
  std::vector<nlohmann::json> edits;
  for (const std::string& text : lines) {
    nlohmann::json edit = nlohmann::json::parse(text, nullptr, false);
    if (!edit.is_object()) throw FieldError("edit", "is not a JSON object: " + text);
    if (!edit.contains("node") && has_node_field(edit)) edit["node"] = node->name;
    NodePtr after;
    try {
      after = find(apply(scene, read_edit(edit, scene)).scene, node->id);
    } catch (const Error& error) {
      throw FieldError("edit", fmt::format("{}: {}", error.what(), text));
    }
    if (!after || !after->object) throw FieldError("edit", "removes the object to be trained: " + text);
    edits.push_back(std::move(edit));
  }
  return edits;
}

ResultCache& cache() {
  const std::shared_ptr<ResultCache> results = result_cache();
  if (!results) throw Error("the model cannot be stored, because the result cache is off (REBAKE_RESULTS is empty)");
  return *results;
}

}  // namespace

NodePtr object_for_light_model(const Scene& scene, const std::string& name) {
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

TransferModel trained_light_model(const Scene& scene, const NodePtr& node, const std::vector<std::string>& lines,
                                  const TransferModelOptions& options, const Progress& progress) {
  const std::shared_ptr<const BakedObject> read = object_as_read(*node);
  const Scene start = with_changed(scene, node->id, [&](Node& changed) {
    // Selections of an object with other triangles do not fit.
    if (changed.object->triangle_count() != read->triangle_count()) {
      changed.selection = nullptr;
      changed.saved_selections.clear();
    }
    changed.object = read;
  });
  const std::vector<nlohmann::json> edits = checked_edits(start, node, lines);
  const auto turning = drag_light_of(start, node->id, progress);
  const auto pose = [&](int k) {
    std::mt19937 random(static_cast<std::uint32_t>(k));
    Scene made = start;
    for (const nlohmann::json& edit : edits) made = apply(made, read_edit(posed(edit, random), made)).scene;
    const NodePtr moved = find(made, node->id);
    if (!moved || !moved->object) throw FieldError("edit", "removes the object to be trained");
    return moved->object;
  };
  TransferModel model = trained_model(*turning, pose, options, progress);
  for (const nlohmann::json& edit : edits) model.poses_from += (model.poses_from.empty() ? "" : ", ") + edit.dump();
  return model;
}

std::vector<std::string> facts_of(const TransferModel& model) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("poses       {} of {}", model.poses, model.poses_from));
  lines.push_back(
      fmt::format("range       up to {:.3g} from the mean pose, {} dimensions; trusted up to {:.1f} times that",
                  model.learned.space.largest * model.learned.space.size, model.learned.space.dimensions(),
                  LearnedTransfer::trusted_range));
  if (model.has_network())
    lines.push_back(
        fmt::format("error       {:.1f} % of transfer, on held-out poses (rotation alone: {:.1f}; linear: {:.1f})",
                    100 * model.net_error, 100 * model.turning_error, 100 * model.learned.held_back_error));
  else
    lines.push_back(fmt::format(
        "error       {:.1f} % of transfer, on held-out poses{}", 100 * model.learned.held_back_error,
        model.turning_error > 0 ? fmt::format(" (rotation alone: {:.1f})", 100 * model.turning_error) : ""));
  if (model.net)
    lines.push_back(fmt::format("network     U-Net with {} channels on a {}² image", model.net->state().channels,
                                model.net->state().side));
  if (model.published)
    lines.push_back(fmt::format("network     DPRT as published with {} channels on a {}² image",
                                model.published->net().net().channels(), model.published->net().net().side()));
  lines.push_back(fmt::format("size        {} of {} sites, {:.1f} MB", model.keys.size(), model.sites,
                              static_cast<double>(model.memory()) / 1e6));
  lines.push_back(fmt::format("time        {:.1f} s tracing with {} rays, {:.1f} s training", model.tracing_seconds,
                              model.rays, model.training_seconds()));
  return lines;
}

bool worth_using(const TransferModel& model) { return model.error() < model.turning_error; }

void check_light_model_output(const fs::path& path, const SourceGuard& sources) {
  sources.check_file(path);
  refuse_replacing_work(path);
  if (std::error_code error;
      fs::is_regular_file(path, error) && fs::file_size(path, error) > 0 && !is_transfer_model(read_file(path)))
    throw FileError(path, "exists and is not a model, so it is not replaced; choose another name");
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder)) throw FieldError("out", "folder does not exist: " + folder.string());
}

TransferModel read_light_model(const fs::path& path) {
  const std::string bytes = read_file(path);
  try {
    return transfer_model_of(bytes);
  } catch (const Error& error) {
    throw FileError(path, error.what());
  }
}

NodePtr use_light_model(const TransferModel& model, const Scene& scene, const fs::path& file) {
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    // Drags of joined objects use no model.
    const std::vector<BakedBody> bodies = bodies_of(*placed.node->object);
    if (bodies.size() != 1 || surface_hash(*bodies.front().object) != model.body) continue;
    const std::string key = transfer_model_key(*bodies.front().object, model.sites), bytes = bytes_of(model);
    cache().keep(key, bytes);
    if (cache().find(key) != bytes)
      throw Error("the model cannot be stored in the result cache: is its disk full, write-protected or too small?");
    return find(scene, placed.node->id);
  }
  const std::string why = "was trained for another object: no object in the scene has its triangles and texels";
  if (!file.empty()) throw FileError(file, why);
  throw Error("the model " + why);
}

std::string store_light_model(const TransferModel& model, const Scene& scene, const fs::path& out,
                              const SourceGuard& sources) {
  // First, because training takes minutes and writing the file may fail.
  std::string why_not;
  if (!worth_using(model)) {
    why_not = "it is no better than rotating the transfer";
  } else {
    try {
      use_light_model(model, scene, {});
    } catch (const Error& error) {
      if (out.empty()) throw;
      why_not = error.what();
    }
  }
  if (!out.empty()) {
    check_light_model_output(out, sources);  // it may have appeared since
    write_file_atomically(out, bytes_of(model), sources);
  }
  return why_not;
}

bool forget_light_model(const Scene& scene, const NodePtr& node, const Progress& progress) {
  const std::shared_ptr<const BakedObject> read = object_as_read(*node);
  const Scene start = with_changed(scene, node->id, [&](Node& changed) { changed.object = read; });
  const std::string key = transfer_model_key(*read, drag_light_of(start, node->id, progress)->start().sites.now.size());
  const auto there = cache().find(key);
  if (!there || there->empty()) return false;
  cache().keep(key, "");  // an empty entry is no model
  return true;
}

}  // namespace rebake
