#include <fmt/format.h>
#include <sys/prctl.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "editor/actions/export_action.h"
#include "editor/actions/output_state.h"
#include "editor/actions/session.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/document/replaced_work.h"
#include "editor/document/sources.h"
#include "editor/edits/nodes/import.h"
#include "editor/script/script.h"
#include "editor/script/script_inputs.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace {

using nlohmann::json;

// A line of --list-files; `what`: "read" or "wrote".
std::string line_of(const char* what, const std::filesystem::path& path, std::uint64_t content) {
  json line{{what, absolute_path(path).string()}, {"content", hash_text(content)}};
  if (what == std::string_view("wrote")) line["bytes"] = true;
  return line.dump(-1, ' ', false, json::error_handler_t::replace) + '\n';
}

// Content hashes by path.
using Contents = std::map<std::filesystem::path, std::uint64_t>;

// The inputs of a script that exist, with their contents.
Contents contents_of(const std::string& script, const std::map<std::string, std::string>& variables) {
  Contents contents;
  for (const ScriptInput& input : script_inputs(script, variables)) {
    try {
      if (std::filesystem::exists(input.path)) contents[absolute_path(input.path)] = content_hash_at(input.path);
    } catch (const std::exception&) {
      continue;  // reading it reports the error
    }
  }
  return contents;
}

// One JSON line per input of the script and per file or folder that it wrote, with content hashes. Inputs that changed
// since the start have their content of then, so that a batch that resumes notices, unless the script wrote them.
std::string file_list(const Session& session, const std::string& script,
                      const std::map<std::string, std::string>& variables, const Contents& at_start) {
  std::set<std::filesystem::path> read;
  for (const Edit& edit : session.document.history().edits())
    if (const auto source = source_of(edit)) read.insert(absolute_path(source->path));
  for (const ScriptInput& input : script_inputs(script, variables)) read.insert(absolute_path(input.path));
  std::string lines;
  std::set<std::filesystem::path> wrote;
  for (const std::vector<std::string>* const written : {&session.exports, &session.outputs})
    for (const std::string& path : *written) wrote.insert(absolute_path(path));
  for (const std::filesystem::path& path : read) {
    const auto before = at_start.find(path);
    const bool is_own = before == at_start.end() || wrote.contains(path);
    lines += line_of("read", path, is_own ? content_hash_at(path) : before->second);
  }
  // Pipes and devices have no content to hash.
  for (const std::filesystem::path& path : wrote)
    if (std::filesystem::is_directory(path) || std::filesystem::is_regular_file(path))
      lines += line_of("wrote", path, output_hash_at(path));
  return lines;
}

// Throws FileError if a file exists that is not an earlier list.
void check_list(const std::filesystem::path& list) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(list, error) || std::filesystem::file_size(list, error) == 0) return;
  refuse_replacing_work(list);
  const std::string text = read_file(list);
  const json first = json::parse(text.substr(0, text.find('\n')), nullptr, false);
  if (!first.is_object() || !first.contains("content") || !(first.contains("read") || first.contains("wrote")))
    throw FileError(list, "exists and is not a list of files; name another file with --list-files, or remove this one");
}

// Throws FileError if the journal would lie in a source folder of the script, where it would count as one of its files.
void check_journal(const std::filesystem::path& journal, const std::string& scene, const std::string& script,
                   const std::map<std::string, std::string>& variables) {
  SourceGuard guard;
  if (!scene.empty()) protect_scene(guard, scene);
  for (const ScriptInput& input : script_inputs(script, variables)) protect_input(guard, input.path);
  guard.check_file(journal);
}

// Protects the paths in a list for --protect, except those that this scene's own script reads: protect_input_files()
// protects them.
void protect_listed(Document& document, const std::filesystem::path& list, const std::string& scene) {
  const std::string text = read_file(list);
  std::istringstream words{text};
  for (std::string reader, path; std::getline(words, reader, '\0') && std::getline(words, path, '\0');) {
    if (!reader.empty() && reader == scene) continue;
    const std::string role = "a file that another scene's script reads, or the report of the batch";
    if (std::filesystem::exists(path))
      document.protect_input(path, role);
    else
      document.protect_file(path, role);
  }
  document.protect_file(list, "a file of the running batch");
}

struct RunOptions {
  std::string script, journal, scene, out, files, sources, content;
  std::vector<std::string> variables;
  bool fields = false;
  int threads = 0, parent = 0;
};

// The values of --var. Throws FieldError.
std::map<std::string, std::string> variables_of(const RunOptions& options) {
  std::map<std::string, std::string> variables;
  for (const std::string& pair : options.variables) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) throw FieldError("--var", "\"" + pair + "\" must be name=value");
    variables[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return variables;
}

// Lists each output as soon as it is complete, for a batch that ends before this run does.
class WrittenList {
 public:
  WrittenList(const Session& session, const RunOptions& options) : session_(session), options_(options) {}
  // Lists the outputs that were added since. Throws FileError.
  void update() {
    if (options_.files.empty()) return;
    const std::size_t before = exports_ + outputs_;
    add(session_.exports, exports_);
    add(session_.outputs, outputs_);
    if (exports_ + outputs_ == before) return;
    std::string text;
    for (const auto& [path, line] : lines_) text += line;
    check_list(options_.files);
    write_file_atomically(options_.files, text, session_.document.sources());
  }

 private:
  void add(const std::vector<std::string>& written, std::size_t& count) {
    for (; count < written.size(); ++count)
      if (const std::filesystem::path path = absolute_path(written[count]);
          std::filesystem::is_directory(path) || std::filesystem::is_regular_file(path))
        lines_[path] = line_of("wrote", path, output_hash_at(path));
  }

  const Session& session_;
  const RunOptions& options_;
  std::size_t exports_ = 0, outputs_ = 0;               // that are listed
  std::map<std::filesystem::path, std::string> lines_;  // of the newest content
};

// Writes the list of --list-files.
void write_list(const Session& session, const RunOptions& options, const std::string& script,
                const std::map<std::string, std::string>& variables, const Contents& at_start) {
  if (options.files.empty()) return;
  check_list(options.files);  // once more: the script may have written this file
  write_file_atomically(options.files, file_list(session, script, variables, at_start), session.document.sources());
}

// Whether a script wrote something to this path, or inside it.
bool wrote(const Session& session, const std::filesystem::path& path) {
  const std::filesystem::path all = absolute_path(path);
  return std::any_of(session.outputs.begin(), session.outputs.end(), [&](const std::string& file) {
    const std::filesystem::path one = absolute_path(file);
    return std::mismatch(all.begin(), all.end(), one.begin(), one.end()).first == all.end();
  });
}

// Runs the script, exports and lists files as the options say.
void run_lines(Session& session, const RunOptions& options, const std::string& script,
               const std::map<std::string, std::string>& variables) {
  WrittenList list(session, options);
  std::optional<OutputState> before;
  const Contents at_start = options.files.empty() ? Contents() : contents_of(script, variables);
  try {
    if (!options.out.empty()) before.emplace(options.out);
    session.after_line = [&list] { list.update(); };
    run_script(session, script, options.script, variables);
    session.after_line = nullptr;
    if (!options.out.empty() && !session.exports.empty())
      session.say(fmt::format("note: {} is not written, because the script exports", options.out));
    if (!options.out.empty() && session.exports.empty()) {
      if (before->has_other_content() && !wrote(session, options.out))
        throw FileError(options.out, "was written by something else during the run, so it is not replaced");
      ExportAction action;
      action.out = options.out;
      run(session, action);
    }
    write_list(session, options, script, variables, at_start);
  } catch (const Error&) {
    if (!options.journal.empty())
      session.say(fmt::format("the edits so far are in {0}; to recover them: rebake recover {0} -o FILE.rebake",
                              options.journal));
    throw;
  }
}

void run_with(const RunOptions& options) {
  if (options.script.empty()) throw FieldError("script", "is missing: name a script to run");
  if (options.parent != 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != options.parent) throw Error("the process that started this one has ended");
  }
  std::optional<tbb::global_control> threads;
  if (options.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));
  std::map<std::string, std::string> variables = variables_of(options);
  Session session;
  session.progress = progress_bar();
  session.say = print_message;
  if (!options.sources.empty())
    protect_listed(session.document, options.sources, options.scene.empty() ? "" : scene_title(options.scene));
  if (!options.files.empty()) check_list(options.files);
  const std::string script = read_input(options.script);
  if (!options.content.empty() && hash_text(content_hash(script)) != options.content)
    throw FileError(options.script, "has changed since the batch began; run the batch again");
  session.document.protect_file(options.script, "the script of this run");
  if (!options.scene.empty()) {
    variables["name"] = scene_title(options.scene);
    variables["path"] = options.scene;
  }
  protect_input_files(session.document, script, variables);
  if (!options.journal.empty()) {
    check_journal(options.journal, options.scene, script, variables);
    session.document.keep_journal(options.journal);
  }
  if (!options.scene.empty()) {
    Import import;
    import.path = options.scene;
    import.as = "scene";
    session.edit(import);
  }
  run_lines(session, options, script, variables);
  session.document.discard_journal();
  if (session.below_requested_psnr) throw ExitWith{4};
}

}  // namespace

void describe_run(SubcommandDescription& command) {
  auto options = std::make_shared<RunOptions>();
  command.option("script", options->script, "script file; its relative paths start at the current folder",
                 "SCRIPT.jsonl");
  command.option("--var", options->variables, "replaces {name} in the script's strings", "name=value...");
  command
      .option("--journal", options->journal,
              "journal of all edits for crash recovery; removed when the script succeeds", "FILE")
      .not_empty();
  command.option("--scene", options->scene, "folder to import first, as the node \"scene\"; defines {name} and {path}",
                 "FOLDER");
  command.option("--out", options->out, "folder to export to at the end, unless the script exports", "FOLDER");
  command.option("--list-files", options->files, "file for one JSON line per input and per output, with content hashes",
                 "FILE");
  command.option(
      "--protect", options->sources,
      "list of folders and files that must not be overwritten: pairs of the scene that reads it (empty: all) "
      "and its path, each ended by a zero byte",
      "FILE");
  command.option("--script-content", options->content, "expected hash of the script", "HASH");
  command.option("--threads", options->threads, "maximum number of threads", "N [one per core]").between(1, 4096);
  command.option("--parent", options->parent, "end when the process with this id ends", "PID");
  command.flag("--fields", options->fields, "print every command, field, unit and default as Markdown");
  command.does([options] {
    if (options->fields) {
      fmt::print("{}", command_reference());
      return;
    }
    run_with(*options);
  });
}

}  // namespace rebake
