#include "editor/studies/study.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/studies/default_scene.h"
#include "editor/training/capture.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace {

struct StudyOptions {
  std::string name, out, photographs;
  std::vector<std::string> scenes;
  int frames = 9;
  DprtOptions dprt;
  RepresentationsOptions representations;
  bool quick = false;
  FolderOptions reading;
  ViewOptions view;
};

void print_table(const StudyTable& table) {
  std::size_t width = 6;
  for (const StudyTable::Row& row : table.rows) width = std::max(width, row.choice.size());
  fmt::print("{:<{}}", "choice", width);
  for (const std::string& column : table.columns) fmt::print("  {}", column);
  fmt::print("\n");
  for (const StudyTable::Row& row : table.rows) {
    fmt::print("{:<{}}", row.choice, width);
    for (std::size_t k = 0; k < row.values.size(); ++k)
      fmt::print("  {:>{}}", std::isnan(row.values[k]) ? "-" : fmt::format("{:.4g}", row.values[k]),
                 table.columns[k].size());
    fmt::print("\n");
  }
}

void run_study(StudyOptions& options) {
  for (const Study& study : study_table) {
    if (options.name != study.name) continue;
    if (options.scenes.empty()) options.scenes.push_back(default_study_scene().string());
    auto [scene, sources] = load_scenes(options.scenes, options.reading, progress_bar());
    options.view.set_background(scene);
    options.view.protect_files(sources);
    if (!options.photographs.empty())
      for (const auto& file : files_of_capture({options.photographs}, {}))
        sources.add_file(file, "a file of the capture");
    for (const std::string& input : {options.representations.snerg, options.representations.plenoctree})
      if (!input.empty()) protect_input(sources, input);
    prepare_study_folder(study, options.out, sources);
    std::unique_ptr<Renderer> renderer;
    const auto on_demand = [&]() -> Renderer& {
      if (!renderer) renderer = std::make_unique<Renderer>();
      return *renderer;
    };
    const StudyTable table = study.run({on_demand, scene, options.view.view(scene), options.frames, progress_bar(),
                                        options.photographs, options.out,
                                        [](const std::string& line) {
                                          fmt::print("{}\n", line);
                                          std::fflush(stdout);
                                        },
                                        options.dprt, options.representations, options.quick, sources});
    clear_progress_bar();
    print_table(table);
    write_study(study, table, options.out, sources);
    return;
  }
  throw FieldError("name", fmt::format("there is no study \"{}\"; rebake study --help lists them", options.name));
}

}  // namespace

void describe_study(SubcommandDescription& command) {
  auto options = std::make_shared<StudyOptions>();
  std::string names;
  for (const Study& study : study_table) names += fmt::format("\n  {:<10} {}", study.name, study.help);
  command.footer("Studies:" + names);
  command.option("name", options->name, "name of the study", "NAME").required();
  command.option("-o,--out", options->out, "folder to write to", "FOLDER").required();
  command.option("--scene", options->scenes, "scenes to measure", "FOLDER|SCENE|PROJECT... [the sample ficus]");
  command.option("--frames", options->frames, "timed frames per variant", "N [9]").between(1, 1000);
  command.option("--photos", options->photographs,
                 "training: photographs of the scene, as for train; default: pictures of it", "CAMERAS");
  command.option("--object", options->dprt.object,
                 "dprt: head, fish, cloth, space (shapes between head and plane) or all", "NAME [cloth]");
  command.option("--meshes", options->dprt.meshes, "dprt: files with one mesh per frame instead (OBJ, OFF, PLY)",
                 "'PATTERN'");
  command.option("--side", options->dprt.side, "dprt: texels per side", "N [64]").between(64, 1024);
  command
      .option("--channels", options->dprt.channels, "dprt: channels of the network's finest level; published: 32",
              "N [16]")
      .between(8, 128);
  command.option("--epochs", options->dprt.epochs, "dprt: passes over the frames; published: 500 to 1000", "N [60]")
      .between(1, 100000);
  command.flag("--cuda", options->dprt.cuda, "dprt: train on the graphics card");
  command.flag("--paper", options->dprt.paper,
               "dprt: the published sizes where no others are given: side 256 (fish 512), 32 channels, 500 epochs");
  command.flag("--quick", options->quick, "representations, limits: small sizes, to try it");
  command.option("--snerg", options->representations.snerg, "representations: a SNeRG scene to measure too", "FOLDER");
  command.option("--plenoctree", options->representations.plenoctree, "representations: a PlenOctree to measure too",
                 "NPZ");
  options->view.add_to(command);
  options->reading.add_to(command);
  command.does([options] { run_study(*options); });
}

}  // namespace rebake
