#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "editor/cli/commands.h"
#include "editor/document/document.h"
#include "mesh_ops/error.h"

namespace rebake {

void add_recover(CLI::App& program) {
  struct Options {
    std::string journal, out;
    bool keep = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("recover", "gets the work of a run that was killed back from its journal, as a project");
  command->add_option("journal", options->journal, "journal that run --journal kept")
      ->required()
      ->option_text("JOURNAL");
  command->add_option("-o,--out", options->out, "project to write")->required()->option_text("FILE.rebake");
  command->add_flag("--keep", options->keep, "leave the journal where it is");
  command->callback([options] {
    if (!options->out.ends_with(".rebake"))
      throw FieldError("--out", "must end in .rebake, by which projects are known");
    Document::Recovered recovered = Document::recover(options->journal);
    recovered.document.save(options->out);
    if (!options->keep) recovered.document.discard_journal();
    fmt::print("{} edits recovered into {}\n", recovered.edits, options->out);
    if (recovered.torn)
      fmt::print(stderr, "note: one more edit was being written when the program ended; it is lost\n");
  });
}

}  // namespace rebake
