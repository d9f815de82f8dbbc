#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/document/document.h"
#include "editor/document/project.h"
#include "editor/document/replaced_work.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace {

struct Recovery {
  std::string journal, out;
  std::vector<std::string> sources;
  bool keep = false, replace = false;
};

// Position of the "=" between old and new path: the first one whose right side is an existing path, else the first one.
// Paths may contain "=" too.
std::size_t separator_of(const std::string& pair) {
  for (std::size_t at = pair.find('='); at != std::string::npos; at = pair.find('=', at + 1))
    if (std::error_code error; at + 1 < pair.size() && std::filesystem::exists(pair.substr(at + 1), error)) return at;
  return pair.find('=');
}

SourceLinks links_of(const std::vector<std::string>& pairs) {
  SourceLinks links;
  for (const std::string& pair : pairs) {
    const std::size_t equals = separator_of(pair);
    if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size())
      throw FieldError("--source", "\"" + pair + "\" must be OLD=NEW");
    links.emplace(absolute_path(pair.substr(0, equals)), pair.substr(equals + 1));
  }
  return links;
}

Document::OtherProject other_project(const Recovery& options) {
  return options.replace ? Document::OtherProject::keep_more : Document::OtherProject::keep;
}

// Saves a project with moved sources again, with their new paths.
void relink_project(const Recovery& options) {
  Document document = Document::open(options.journal, links_of(options.sources), progress_bar());
  const SavedProject saved = document.save(options.out, progress_bar(), other_project(options));
  clear_progress_bar();
  for (const std::string& warning : saved.warnings) print_message("warning: " + warning);
  const std::size_t edits = document.history().undo_count();
  fmt::print("{} {} of {} saved in {}\n", edits, edits == 1 ? "edit" : "edits", printable(options.journal),
             printable(options.out));
}

void recover(Recovery options) {
  // What a link leads to is removed at the end, not the link.
  if (std::error_code error;
      std::filesystem::is_symlink(options.journal, error) && std::filesystem::exists(options.journal, error))
    options.journal = std::filesystem::canonical(options.journal).string();
  if (!options.out.ends_with(".rebake")) throw FieldError("--out", "must end in .rebake, the extension of projects");
  std::error_code error;
  const bool is_project = is_project_file(options.journal) && !Journal::is_journal(options.journal);
  if (!is_project && std::filesystem::equivalent(options.out, options.journal, error))
    throw FieldError("--out", "is the journal itself, which would be overwritten; name another file");
  if (options.replace && std::filesystem::exists(options.out) && !holds_project(options.out))
    throw FileError(options.out, "exists and is not a project, so it is not replaced; choose another name");
  if (!options.replace && std::filesystem::exists(options.out))
    throw FileError(options.out, "already exists; choose another name, or use --replace");
  if (is_project) {
    relink_project(options);
    return;
  }
  Document::Recovered recovered = Document::recover(options.journal, links_of(options.sources), progress_bar());
  // An empty project would block the next attempt.
  const bool nothing = recovered.edits == 0;
  SavedProject saved;
  if (!nothing) saved = recovered.document.save(options.out, progress_bar(), other_project(options));
  clear_progress_bar();
  for (const std::string& warning : saved.warnings) print_message("warning: " + warning);
  const std::size_t undone = recovered.document.history().redo_count();
  if (nothing && recovered.lost.empty())
    throw FileError(options.journal,
                    undone > 0       ? "contains only undone edits, so no project is written"
                    : recovered.torn ? "contains no complete edit: the program ended while it wrote the first one"
                                     : "contains no edit, so no project is written; remove it if nothing is missing");
  fmt::print("{} {} recovered{}\n", recovered.edits, recovered.edits == 1 ? "edit" : "edits",
             nothing ? "; no project is written" : " into " + printable(options.out));
  if (std::fflush(stdout) != 0 && !nothing)
    throw FileError(options.out, "is written, but standard output is not writable; the journal stays");
  if (undone > 0)
    print_message(fmt::format("note: {} not part of the project; the journal still holds {}, so it stays",
                              counted(undone, "undone edit is", "undone edits are"), undone == 1 ? "it" : "them"));
  if (recovered.skipped_undone > 0)
    print_message(fmt::format(
        "note: {} left out, because a source is missing or has changed; the journal still holds {}, so it stays",
        counted(recovered.skipped_undone, "undone edit was", "undone edits were"),
        recovered.skipped_undone == 1 ? "it" : "them"));
  if (recovered.header_damaged)
    print_message("note: the journal's first line is damaged; all edits after it are intact");
  if (recovered.torn) print_message("note: the last edit is lost: the program ended while it was written");
  if (recovered.lost.empty()) {
    // The project is on the disk now, and can be opened unless a source changed meanwhile.
    if (!saved.opens || options.keep || undone > 0 || recovered.skipped_undone > 0) return;
    if (recovered.journal)
      recovered.journal->discard();
    else if (recovered.document.keeps_journal())
      recovered.document.discard_journal();
    else
      print_message("note: the journal may not be written, so it stays");
    return;
  }
  print_message("the journal is not removed, because these lines could not be recovered:");
  for (const std::string& lost : recovered.first_lost()) print_message("  " + lost);
  for (const SourcesUnavailable::Source& source : recovered.gone)
    print_message(
        fmt::format("if {} was moved: --source '{}=NEW'", source.path.filename().string(), source.path.string()));
  throw ExitWith{1};
}

}  // namespace

void describe_recover(SubcommandDescription& command) {
  auto options = std::make_shared<Recovery>();
  command
      .option("journal", options->journal, "journal of run --journal or of the editor, or a project with moved sources",
              "JOURNAL")
      .required();
  command.option("-o,--out", options->out, "project to write", "FILE.rebake").required();
  command.option("--source", options->sources, "new location of a moved source", "OLD=NEW...");
  command.flag("--replace", options->replace, "replace an existing project");
  command.flag("--keep", options->keep, "do not remove the journal");
  command.does([options] { recover(*options); });
}

}  // namespace rebake
