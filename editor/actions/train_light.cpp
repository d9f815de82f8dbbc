#include "editor/actions/train_light.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "editor/actions/describe_action.h"
#include "editor/actions/light_model.h"
#include "editor/document/sources.h"
#include "editor/edits/edit.h"
#include "editor/edits/shared_result_cache.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace {

constexpr std::array<const char*, 3> way_names = {"linear", "net", "published"};

// The edits of the history that deform this node.
std::vector<std::string> deformations_of(const Document& document, NodeId node) {
  std::vector<std::string> lines;
  for (const Edit& edit : document.history().edits()) {
    if (!edit.type().deforms) continue;
    const nlohmann::json line = to_json(edit);
    if (!line.contains("node") || line.at("node") != static_cast<std::uint64_t>(node)) continue;
    if (line.value("selection", false))
      throw FieldError("edits", fmt::format("is missing: a \"{}\" of the history moves the triangles that were "
                                            "selected then; give edits that move it",
                                            edit.type().op));
    lines.push_back(line.dump());
  }
  return lines;
}

}  // namespace

FieldType Codec<LightModelWay>::type() { return choice_type({way_names.begin(), way_names.end()}); }
LightModelWay Codec<LightModelWay>::read(const nlohmann::json& value, const Scene&) {
  for (std::size_t k = 0; k < way_names.size(); ++k)
    if (value.is_string() && value.get<std::string>() == way_names[k]) return static_cast<LightModelWay>(k);
  throw Error("must be linear, net or published");
}
nlohmann::json Codec<LightModelWay>::write(const LightModelWay& value) {
  return way_names[static_cast<std::size_t>(value)];
}

TransferModelOptions training_options(const TrainLightAction& action) {
  const auto within = [](const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high)) throw FieldError(field, fmt::format("must lie between {} and {}", low, high));
  };
  within("poses", action.poses, 8, 2000);
  within("rays", action.rays, 16, 16384);
  within("channels", action.channels, 8, 64);
  within("coarseness", action.coarseness, 0.005, 0.5);
  if (action.channels % 8 != 0) throw FieldError("channels", "must be a multiple of 8");
  TransferModelOptions options;
  options.poses = action.poses;
  options.rays = action.rays;
  options.coarseness = action.coarseness;
  if (action.way == LightModelWay::linear) return options;
  options.net.emplace();
  options.net->channels = action.channels;
  options.published = action.way == LightModelWay::published;
  // As published; the number of epochs is not, as poses are simpler than its animations.
  if (options.published) options.net->batch = 5, options.net->rate = 1e-3;
  return options;
}

std::vector<std::filesystem::path> TrainLightAction::input_files(const nlohmann::json& object) {
  std::vector<std::filesystem::path> files;
  const auto edits = object.find("edits");
  if (edits == object.end() || !edits->is_array()) return files;
  for (nlohmann::json edit : *edits) {
    if (!edit.is_object()) continue;
    if (const nlohmann::json* source = source_field(edit); source != nullptr && source->is_string())
      files.emplace_back(source->get<std::string>());
    for (std::filesystem::path& file : input_files_of(edit)) files.push_back(std::move(file));
  }
  return files;
}

void run(Session& session, const TrainLightAction& action) {
  const TransferModelOptions options = training_options(action);
  const Scene& scene = session.scene();
  const NodePtr node = action.node ? find(scene, action.node->id) : object_for_light_model(scene, "");
  if (!node || !node->object) throw FieldError("node", "has no object");
  const std::vector<std::string> edits =
      action.edits ? action.edits->lines : deformations_of(session.document, node->id);
  if (edits.empty())
    throw FieldError("edits",
                     fmt::format("is missing, and no deformation of \"{}\" is in the history: bend it first, or "
                                 "give edits that move it",
                                 node->name));
  SourceGuard sources = session.document.sources();
  for (const std::string& line : edits)
    for (const auto& file :
         TrainLightAction::input_files({{"edits", nlohmann::json::array({nlohmann::json::parse(line)})}}))
      sources.add_file(file, "a file that an edit reads");
  if (!action.out.empty())
    check_light_model_output(action.out, sources);
  else if (!result_cache())
    throw FieldError("out", "is missing: name a file, because the result cache is off (REBAKE_RESULTS is empty)");
  const TransferModel model = trained_light_model(scene, node, edits, options, session.progress);
  for (const std::string& fact : facts_of(model)) session.say(fact);
  const std::string why_not = store_light_model(model, scene, action.out, sources);
  if (!action.out.empty()) session.outputs.push_back(action.out);
  session.say(why_not.empty() ? fmt::format("drags of \"{}\" now use the model", node->name)
                              : fmt::format("drags of \"{}\" do not use the model: {}", node->name, why_not));
}

REBAKE_DESCRIBE_ACTION(
    TrainLightAction, "Trains a model of an object's light transfer, for shading while it is dragged.",
    (auto& action, auto& visit) {
      visit("node", action.node, Need::optional, "the object; default: the only one");
      visit("edits", action.edits, Need::optional,
            "edits that move the object; poses scale their strength by -1 to 1; default: its "
            "deformations in the history");
      visit("poses", action.poses, Need::optional, "number of poses, 8 to 2000");
      visit("rays", action.rays, Need::optional, "rays per site, 16 to 16384");
      visit("way", action.way, Need::optional,
            "linear in the pose; net: a U-Net on a geometry image; published: that of deep precomputed radiance "
            "transfer (both need LibTorch)");
      visit("channels", action.channels, Need::optional,
            "networks: channels of the first layer, a multiple of 8 up to 64");
      visit("coarseness", action.coarseness, Need::optional,
            "networks: coarseness of the proxy body relative to the object's diagonal");
      visit("out", action.out, Need::optional, "also write the model to this file");
    })

}  // namespace rebake
