#include "editor/studies/study.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "editor/cli/commands.h"
#include "editor/cli/options.h"
#include "editor/cli/terminal.h"
#include "editor/studies/default_scene.h"
#include "mesh_ops/error.h"

namespace rebake {

void add_study(CLI::App& program) {
  struct Options {
    std::string name, out;
    std::vector<std::string> scenes;
    int frames = 9;
    Axes axes = Axes::y_up;
    ViewOptions view;
  };
  auto options = std::make_shared<Options>();
  std::string names;
  for (const Study& study : study_table) names += fmt::format("\n  {:<10} {}", study.name, study.help);
  CLI::App* command =
      program.add_subcommand("study", "measures accuracy against time: a table (CSV) and a plot (SVG, PNG)");
  command->footer("Studies:" + names);
  command->add_option("name", options->name, "which study")->required()->option_text("NAME");
  command->add_option("-o,--out", options->out, "folder to write to")->required()->option_text("FOLDER");
  command->add_option("--scene", options->scenes, "what to study it on")
      ->option_text("FOLDER|SCENE... [the sample ficus]");
  command->add_option("--frames", options->frames, "frames timed for each choice")
      ->check(CLI::Range(1, 1000))
      ->option_text("N [9]");
  options->view.add_to(*command);
  add_axes_option(*command, options->axes);
  command->callback([options] {
    for (const Study& study : study_table) {
      if (options->name != study.name) continue;
      if (options->scenes.empty()) options->scenes.push_back(default_study_scene().string());
      Scene scene = read_all(options->scenes, options->axes, progress_bar());
      options->view.set_background(scene);
      std::unique_ptr<Renderer> renderer;
      const auto on_demand = [&]() -> Renderer& {
        if (!renderer) renderer = std::make_unique<Renderer>();
        return *renderer;
      };
      const StudyTable table =
          study.run({on_demand, scene, options->view.view(scene), options->frames, progress_bar()});
      clear_progress_bar();
      std::size_t width = 6;
      for (const StudyTable::Row& row : table.rows) width = std::max(width, row.choice.size());
      fmt::print("{:<{}}", "choice", width);
      for (const std::string& column : table.columns) fmt::print("  {}", column);
      fmt::print("\n");
      for (const StudyTable::Row& row : table.rows) {
        fmt::print("{:<{}}", row.choice, width);
        for (std::size_t k = 0; k < row.values.size(); ++k)
          fmt::print("  {:>{}.4g}", row.values[k], table.columns[k].size());
        fmt::print("\n");
      }
      write_study(study, table, options->out);
      return;
    }
    throw FieldError("name", fmt::format("there is no study \"{}\"; rebake study --help lists them", options->name));
  });
}

}  // namespace rebake
