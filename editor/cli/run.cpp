#include <fmt/format.h>
#include <sys/prctl.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "editor/cli/commands.h"
#include "editor/cli/terminal.h"
#include "editor/commands/export.h"
#include "editor/commands/session.h"
#include "editor/document/sources.h"
#include "editor/edits/nodes/import.h"
#include "editor/script/script.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace {

using nlohmann::json;

std::string line_of(const char* what, const std::filesystem::path& path, std::uint64_t content) {
  return json{{what, absolute_path(path).string()}, {"content", hash_text(content)}}.dump(
             -1, ' ', false, json::error_handler_t::replace) +
         '\n';
}

// What the result of a script rests on beside the script itself (imports, pictures of light, files of cages), and what
// it exported.
std::string file_list(const Session& session, const std::string& script,
                      const std::map<std::string, std::string>& variables) {
  std::string lines;
  for (const Edit& edit : session.document.history().edits())
    if (const auto source = source_of(edit)) lines += line_of("read", source->path, content_at(source->path));
  for (std::size_t begin = 0; begin < script.size();) {
    const std::size_t end = std::min(script.find('\n', begin), script.size());
    const json line = json::parse(script.begin() + static_cast<std::ptrdiff_t>(begin),
                                  script.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false, true);
    if (line.is_object() && line.contains("mesh") && line.at("mesh").is_string()) {
      const std::string mesh = with_variables(line.at("mesh"), variables);
      lines += line_of("read", mesh, content_hash(read_file(mesh)));
    }
    begin = end + 1;
  }
  for (const std::string& folder : session.exports) lines += line_of("wrote", folder, folder_hash(folder));
  return lines;
}

}  // namespace

void describe_run(CommandDescription& command) {
  struct Options {
    std::string script, journal, scene, out, files, sources;
    std::vector<std::string> variables;
    bool fields = false;
    int threads = 0, parent = 0;
  };
  auto options = std::make_shared<Options>();
  command.option("script", options->script, "script; relative paths in it start at the current folder", "SCRIPT.jsonl");
  command.option("--var", options->variables, "gives {name} in the script's texts a value", "name=value...");
  command.option("--journal", options->journal, "keep every edit safe in this file until the script is done", "FILE")
      .not_empty();
  command.option("--scene", options->scene, "import this first as the node \"scene\"; gives {name} and {path}",
                 "FOLDER");
  command.option("--out", options->out, "export there at the end, unless the script exports itself", "FOLDER");
  command.option("--list-files", options->files,
                 "write there, one JSON object a line, what was read and exported, with hashes of the contents",
                 "FILE");
  command.option("--protect", options->sources,
                 "write over none of the folders in this list, each ended by a zero byte", "FILE");
  command.option("--threads", options->threads, "use at most so many threads", "N [one a core]").between(1, 4096);
  command.option("--parent", options->parent, "end when the process with this number does", "PID");
  command.flag("--fields", options->fields, "print every command, field, unit and default as Markdown");
  command.does([options] {
    if (options->fields) {
      fmt::print("{}", command_reference());
      return;
    }
    if (options->script.empty()) throw FieldError("script", "is missing: name a script to run");
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
      if (equals == std::string::npos || equals == 0) throw FieldError("--var", "\"" + pair + "\" must be name=value");
      variables[pair.substr(0, equals)] = pair.substr(equals + 1);
    }
    Session session;
    session.progress = progress_bar();
    session.say = say_line;
    if (!options->sources.empty()) {
      const std::string folders = read_file(options->sources);
      for (std::size_t begin = 0; begin < folders.size();) {
        const std::size_t end = std::min(folders.find('\0', begin), folders.size());
        session.document.protect(folders.substr(begin, end - begin));
        begin = end + 1;
      }
    }
    const std::string script = read_input(options->script);
    session.document.protect_file(options->script, "the script of this run");
    if (!options->sources.empty()) session.document.protect_file(options->sources, "the list of what is protected");
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
      if (!options->files.empty())
        write_file_atomically(options->files, file_list(session, script, variables), session.document.sources());
    } catch (const Error&) {
      if (!options->journal.empty())
        session.say(fmt::format("what was done is kept in {0}: rebake recover {0} -o FILE.rebake", options->journal));
      throw;
    }
    session.document.discard_journal();
    if (session.below_asked) throw ExitWith{4};
  });
}

}  // namespace rebake
