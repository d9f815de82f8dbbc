#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "editor/cli/commands.h"
#include "editor/cli/terminal.h"
#include "editor/document/document.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace {

struct Options {
  std::string journal, out;
  std::vector<std::string> sources;
  bool keep = false, replace = false;
};

Relinked links_of(const std::vector<std::string>& pairs) {
  Relinked links;
  for (const std::string& pair : pairs) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size())
      throw FieldError("--source", "\"" + pair + "\" must be OLD=NEW");
    links[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return links;
}

// Also a damaged one.
bool holds_project(const std::filesystem::path& path) {
  return read_file(path).find("\"rebake_project\"") != std::string::npos;
}

void execute(const Options& options) {
  if (!options.out.ends_with(".rebake")) throw FieldError("--out", "must end in .rebake, by which projects are known");
  std::error_code error;
  if (std::filesystem::equivalent(options.out, options.journal, error))
    throw FieldError("--out", "is the journal itself, which would be lost with it; name another file");
  if (options.replace && std::filesystem::exists(options.out) && !holds_project(options.out))
    throw FileError(options.out, "is no project, so it is not replaced; choose another name");
  if (!options.replace && std::filesystem::exists(options.out))
    throw FileError(options.out, "is there already; choose another name, or --replace it");
  Document::Recovered recovered = Document::recover(options.journal, links_of(options.sources), progress_bar());
  recovered.document.save(options.out, progress_bar());
  clear_progress_bar();
  fmt::print("{} edits recovered into {}\n", recovered.edits, printable(options.out));
  if (recovered.torn) say_line("note: one more edit was being written when the program ended; it is lost");
  if (recovered.lost.empty()) {
    // The project is on the disk now.
    if (options.keep) return;
    if (recovered.journal)
      recovered.journal->discard();
    else
      recovered.document.discard_journal();
    return;
  }
  say_line("the journal stays where it is, since this could not be got back:");
  for (const std::string& lost : recovered.lost) say_line("  " + lost);
  for (const SourcesGone::Source& source : recovered.gone)
    say_line(fmt::format("if it lies elsewhere now: --source '{}=NEW'", source.path.string()));
  throw ExitWith{1};
}

}  // namespace

void describe_recover(CommandDescription& command) {
  auto options = std::make_shared<Options>();
  command.option("journal", options->journal, "journal that run --journal or the editor kept", "JOURNAL").required();
  command.option("-o,--out", options->out, "project to write", "FILE.rebake").required();
  command.option("--source", options->sources, "where a source lies now that was moved", "OLD=NEW...");
  command.flag("--replace", options->replace, "replace a project that is there already");
  command.flag("--keep", options->keep, "leave the journal where it is");
  command.does([options] { execute(*options); });
}

}  // namespace rebake
