#include <fmt/format.h>
#include <sys/prctl.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <memory>
#include <optional>

#include "editor/cli/commands.h"
#include "editor/cli/terminal.h"
#include "editor/script/script.h"
#include "mesh_ops/formats/files.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

void add_run(CLI::App& program) {
  struct Options {
    std::string script, journal, scene, out, exports;
    std::vector<std::string> variables;
    bool fields = false;
    int threads = 0, parent = 0;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("run", "runs a script of edits and actions, one JSON object a line");
  command->add_option("script", options->script, "script; relative paths in it start at the current folder")
      ->option_text("SCRIPT.jsonl");
  command->add_option("--var", options->variables, "gives {name} in the script's texts a value")
      ->option_text("name=value...");
  command->add_option("--journal", options->journal, "keep every edit safe in this file until the script is done")
      ->option_text("FILE");
  command->add_option("--scene", options->scene, "import this first as the node \"scene\"; gives {name} and {path}")
      ->option_text("FOLDER");
  command->add_option("--out", options->out, "export there at the end, unless the script exports itself")
      ->option_text("FOLDER");
  command->add_option("--list-exports", options->exports, "write the folders that were exported there, one a line")
      ->option_text("FILE");
  command->add_option("--threads", options->threads, "use at most so many threads")
      ->check(CLI::Range(1, 4096))
      ->option_text("N [one a core]");
  command->add_option("--parent", options->parent, "end when the process with this number does")->option_text("PID");
  command->add_flag("--fields", options->fields, "print every command, field, unit and default as Markdown");
  command->callback([options] {
    if (options->fields) {
      fmt::print("{}", command_reference());
      return;
    }
    if (options->script.empty()) throw CLI::RequiredError("script");
    if (options->parent != 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGTERM);
      if (::getppid() != options->parent) throw Error("the process that started this one has ended");
    }
    std::optional<tbb::global_control> threads;
    if (options->threads > 0)
      threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options->threads));
    std::map<std::string, std::string> variables;
    for (const std::string& pair : options->variables) {
      const std::size_t equals = pair.find('=');
      if (equals == std::string::npos || equals == 0)
        throw CLI::ValidationError("--var", "\"" + pair + "\" must be name=value");
      variables[pair.substr(0, equals)] = pair.substr(equals + 1);
    }
    Session session;
    session.progress = progress_bar();
    session.say = [](const std::string& line) {
      clear_progress_bar();
      fmt::print(stderr, "{}\n", line);
    };
    const std::string script = read_file(options->script);
    if (!options->journal.empty()) session.document.keep_journal(options->journal);
    if (!options->scene.empty()) {
      variables["name"] = folder_title(options->scene);
      variables["path"] = options->scene;
      Import import;
      import.path = options->scene;
      import.as = "scene";
      session.edit(import);
    }
    try {
      run_script(session, script, options->script, variables);
      if (!options->out.empty() && session.exports.empty()) {
        ExportAction action;
        action.out = options->out;
        run(session, action);
      }
      if (!options->exports.empty()) {
        std::string lines;
        for (const std::string& folder : session.exports)
          lines += std::filesystem::absolute(folder).lexically_normal().string() + '\n';
        write_file_atomically(options->exports, lines);
      }
    } catch (const Error&) {
      if (!options->journal.empty())
        session.say(fmt::format("what was done is kept in {0}: rebake recover {0} -o FILE.rebake", options->journal));
      throw;
    }
    session.document.discard_journal();
  });
}

}  // namespace rebake
