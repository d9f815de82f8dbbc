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
      Renderer renderer;
      const auto rows = study.run({renderer, scene, options->view.view(scene), options->frames});
      fmt::print("{:<22} {:>10} {:>10} {:>8}\n", "choice", "ms", "PSNR, dB", "largest");
      for (const StudyRow& row : rows)
        fmt::print("{:<22} {:>10.2f} {:>10.2f} {:>8}\n", row.choice, row.milliseconds, row.psnr_db, row.largest);
      write_study(study, rows, options->out);
      return;
    }
    throw FieldError("name", fmt::format("there is no study \"{}\"; rebake study --help lists them", options->name));
  });
}

}  // namespace rebake
