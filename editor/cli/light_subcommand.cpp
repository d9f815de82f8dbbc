#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/actions/light_model.h"
#include "editor/actions/train_light.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/edits/shared_result_cache.h"
#include "editor/script/script_inputs.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace {

using nlohmann::json;

struct Options {
  std::string action;
  std::vector<std::string> paths;
  std::vector<std::string> edits;
  std::string node;
  std::string way = "linear";
  TrainLightAction training;  // without node and edits
  FolderOptions reading;
};

void say(const TransferModel& model) {
  for (const std::string& fact : facts_of(model)) fmt::print("{}\n", fact);
}

void say_stored() { fmt::print("stored: drags of this object now use the model\n"); }

void train(const Options& options) {
  for (const std::string& path : options.paths)
    if (!std::filesystem::exists(path)) throw FileError(path, "does not exist");
  const TransferModelOptions learning = training_options(options.training);
  const std::string& out = options.training.out;
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
  if (!out.empty()) {
    check_light_model_output(out, sources);
  } else if (!result_cache()) {
    throw FieldError("out", "is missing: name a file, because the result cache is off (REBAKE_RESULTS is empty)");
  }
  const NodePtr node = object_for_light_model(scene, options.node);
  const TransferModel model = trained_light_model(scene, node, options.edits, learning, progress_bar());
  clear_progress_bar();
  say(model);
  const std::string why_not = store_light_model(model, scene, out, sources);
  if (why_not.empty())
    say_stored();
  else if (out.empty())
    throw Error("the model is not stored: " + why_not);
  else
    fmt::print("not stored: {}\n", why_not);
}

void keep_model(const Options& options) {
  if (options.paths.size() < 2) throw FieldError("paths", "must be the model file, then its scene");
  if (std::filesystem::is_directory(options.paths.front()))
    throw FieldError("paths", options.paths.front() + " is a folder: give the model file first, then the scene");
  const TransferModel model = read_light_model(options.paths.front());
  auto [scene, sources] =
      load_scenes({options.paths.begin() + 1, options.paths.end()}, options.reading, progress_bar());
  clear_progress_bar();
  use_light_model(model, scene, options.paths.front());
  say_stored();
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
  command.option("--poses", options->training.poses, "train: number of poses, 8 to 2000", "N [200]").between(8, 2000);
  command.option("--rays", options->training.rays, "train: rays per site, 16 to 16384", "N [128]").between(16, 16384);
  command
      .option("--way", options->way,
              "train: model; linear in the pose; net: a U-Net on a geometry image of a proxy body; published: that of "
              "deep precomputed radiance transfer",
              "linear|net|published")
      .one_of(Codec<LightModelWay>::type().choices);
  command
      .option("--channels", options->training.channels,
              "train, networks: channels of the first layer, a multiple of 8 up to 64", "N [8]")
      .between(8, 64);
  command.option("--coarseness", options->training.coarseness,
                 "train, networks: coarseness of the proxy body relative to the object's diagonal; coarser if the body "
                 "would split into parts",
                 "SHARE [0.03]");
  command.option("-o,--out", options->training.out, "train: also write the model to this file", "FILE");
  options->reading.add_to(command);
  command.footer(
      "A model improves the shading during drags near the trained poses, compared with rotating the transfer. It is "
      "cached by the object's content; a later model replaces it. A model that is no better "
      "than rotation alone is not stored.");
  command.does([options] {
    options->training.way = Codec<LightModelWay>::read(json(options->way), {});
    if (options->action == "train") return train(*options);
    if (options->action == "keep") return keep_model(*options);
    if (options->paths.size() > 1) throw FieldError("paths", "info takes one model");
    say(read_light_model(options->paths.front()));
  });
}

}  // namespace rebake
