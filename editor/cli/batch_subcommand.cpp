#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/batch/batch.h"
#include "editor/batch/batch_scenes.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace {

// Parses "i/n". Throws FieldError unless 1 ≤ i ≤ n.
void parse_shard(const std::string& text, BatchOptions& options) {
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, options.shard);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == '/') {
    const auto second = std::from_chars(first.ptr + 1, end, options.shards);
    if (second.ec == std::errc() && second.ptr == end && options.shard >= 1 && options.shard <= options.shards) return;
  }
  throw FieldError("--shard", fmt::format("\"{}\" must be i/n with 1 ≤ i ≤ n", text));
}

nlohmann::json to_json(const BatchResult& result) {
  nlohmann::json line = {{"scene", result.name},
                         {"path", result.scene.string()},
                         {"status", to_string(result.status)},
                         {"seconds", result.seconds}};
  if (!result.message.empty()) line["message"] = result.message;
  return line;
}

std::string on_one_line(const std::string& text) {
  std::string line;
  for (const char c : printable(text))
    if (c == '\n')
      line += "\\n";
    else
      line += c;
  return line;
}

void print_table(const std::vector<BatchResult>& results) {
  std::size_t width = 5;
  for (const BatchResult& result : results) width = std::max(width, on_one_line(result.name).size());
  fmt::print("{:<{}}  {:<8} {:>8}  message\n", "scene", width, "status", "seconds");
  std::size_t failed = 0;
  for (const BatchResult& result : results) {
    failed += result.status == BatchResult::Status::failed ? 1 : 0;
    fmt::print("{:<{}}  {:<8} {:>8.2f}  {}\n", on_one_line(result.name), width, to_string(result.status),
               result.seconds, on_one_line(result.message));
  }
  fmt::print("{}, {} failed\n", counted(results.size(), "scene"), failed);
}

// Whether a text is that of a report. A killed batch leaves an incomplete last line.
bool is_report(const std::string& text) {
  const auto is_result = [](const std::string& line) {
    const auto result = nlohmann::json::parse(line, nullptr, false);
    if (!result.is_object() || !result.contains("scene") || !result.contains("status") || !result.contains("seconds"))
      return false;
    constexpr std::string_view keys[] = {"scene", "path", "status", "seconds", "message"};
    for (const auto& [key, value] : result.items())
      if (std::ranges::find(keys, key) == std::end(keys)) return false;
    return true;
  };
  std::size_t at = 0;
  for (std::size_t end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    if (!is_result(text.substr(at, end - at))) return false;
  return at == text.size() || text.substr(at).starts_with('{');
}

// Throws FileError if a file exists that is not an earlier report.
void check_report(const std::filesystem::path& report) {
  std::error_code error;
  refuse_dangling_link(report);
  if (!std::filesystem::is_regular_file(report, error)) return;
  refuse_write_protected(report);
  if (!is_report(read_file(report)))
    throw FileError(report, "is not a batch report; name another file with --report, or remove this one");
}

}  // namespace

void describe_batch(SubcommandDescription& command) {
  struct Options {
    BatchOptions batch;
    std::string script, out, report, shard = "1/1";
  };
  auto options = std::make_shared<Options>();
  command
      .option("script", options->script,
              "script file; {name} and {path} in its strings are replaced by those of the scene", "SCRIPT.jsonl")
      .required();
  command.option("--scenes", options->batch.scenes, "scene folders, or glob patterns", "GLOB...").required();
  command
      .option("-o,--out", options->out, "output folder; results go to FOLDER/{name} unless the script exports",
              "FOLDER")
      .required();
  command.option("--var", options->batch.variables, "replaces {name} in the script's strings", "name=value...");
  command.option("--jobs", options->batch.jobs, "number of scenes to process in parallel", "N [1]").between(1, 1024);
  command.flag("--resume", options->batch.resume,
               "skip scenes whose results of the same program, script and scene exist and are complete");
  command.option("--shard", options->shard,
                 "process only the i-th of n parts of the scenes, sorted by name; for schedulers on a shared file "
                 "system",
                 "i/n");
  command.option("--report", options->report, "report file, with one line of JSON per scene",
                 "FILE [FOLDER/report.jsonl]");
  command.does([options] {
    BatchOptions& batch = options->batch;
    parse_shard(options->shard, batch);
    batch.script = options->script;
    batch.out = options->out;
    batch.program = "/proc/self/exe";
    std::error_code error;
    if (const auto self = std::filesystem::read_symlink(batch.program, error); !error) batch.program = self;
    for (const std::string& variable : batch.variables)
      if (variable.find('=') == std::string::npos || variable.front() == '=')
        throw FieldError("--var", fmt::format("\"{}\" must be name=value", variable));
    // Reports a faulty script or pattern before anything is written.
    read_file(batch.script);
    const std::filesystem::path report =
        !options->report.empty() ? std::filesystem::path(options->report)
        : batch.shards > 1       ? batch.out / fmt::format("report-{}-of-{}.jsonl", batch.shard, batch.shards)
                                 : batch.out / "report.jsonl";
    batch.report = report;
    batch_scenes(batch);
    std::filesystem::create_directories(batch.out, error);
    refuse_dangling_link(report);  // before the lock creates a missing file
    const FileLock lock(report);
    if (!lock.held())
      throw FieldError("--report", report.string() + " is being written by another batch; name another file");
    check_report(report);
    // Replaces an earlier report only when there is a result.
    std::ofstream lines;
    const auto open = [&] {
      if (lines.is_open()) return;
      check_report(report);  // once more: it may have appeared since
      // Other hard links keep their content.
      if (std::filesystem::hard_link_count(report, error) > 1)
        std::filesystem::remove(std::filesystem::canonical(report, error), error);
      lines.open(report);
      if (!lines) throw FileError(report, "cannot be written");
    };
    const std::vector<BatchResult> results = run_batch(batch, progress_bar(), [&](const BatchResult& result) {
      open();
      // Names and messages may contain invalid UTF-8.
      lines << to_json(result).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
      if (!lines) throw FileError(report, "cannot be written");
    });
    clear_progress_bar();
    open();
    print_table(results);
    for (const BatchResult& result : results)
      if (result.status == BatchResult::Status::failed) throw ExitWith{1};
    for (const BatchResult& result : results)
      if (result.below_requested_psnr) throw ExitWith{4};
  });
}

}  // namespace rebake
