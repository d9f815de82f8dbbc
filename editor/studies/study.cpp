#include "editor/studies/study.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "render/compare.h"
#include "render/image.h"
#include "render/picture_mark.h"

namespace rebake {

namespace {

// A text in a gnuplot script, without its commands and markup.
std::string plotted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "' noenhanced";
}

// Runs gnuplot on a script and returns its output. Throws Error if gnuplot fails.
std::string run_gnuplot(const std::string& script) {
  std::string name = (std::filesystem::temp_directory_path() / "rebake-plot-XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file < 0) throw FileError(name, "cannot be created for gnuplot");
  const bool written = ::write(file, script.data(), script.size()) == static_cast<ssize_t>(script.size());
  ::close(file);
  std::string output;
  FILE* pipe = written ? ::popen(("gnuplot '" + name + "'").c_str(), "r") : nullptr;
  if (pipe != nullptr) {
    char buffer[65536];
    for (std::size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, got);
  }
  const bool done = pipe != nullptr && ::pclose(pipe) == 0 && !output.empty();
  ::unlink(name.c_str());
  if (!done) throw Error("the table was written, but gnuplot failed; install gnuplot-nox for the plots");
  return output;
}

}  // namespace

StudyTable picture_table() {
  return {{"milliseconds per frame", "PSNR dB (100: equal)", "largest error of 255", "fastest ms", "slowest ms",
           "x of largest error", "y of largest error"},
          {},
          0,
          1,
          false,
          false};
}

Image enlarged(const Image& image, int width, int height) {
  Image result{width, height, {}, {}};
  const auto coordinate = [](int to, int to_size, int from_size) {
    return std::clamp((to + 0.5) * from_size / to_size - 0.5, 0.0, from_size - 1.0);
  };
  const auto at = [&](int x, int y, int c) {
    const int column = std::min(x, image.width - 1), row = std::min(y, image.height - 1);
    return static_cast<double>(image.rgb[static_cast<std::size_t>((row * image.width + column) * 3 + c)]);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = coordinate(x, width, image.width), v = coordinate(y, height, image.height);
      const int left = static_cast<int>(u), top = static_cast<int>(v);
      const double right = u - left, down = v - top;
      for (int c = 0; c < 3; ++c) {
        const double upper = std::lerp(at(left, top, c), at(left + 1, top, c), right);
        const double lower = std::lerp(at(left, top + 1, c), at(left + 1, top + 1, c), right);
        result.rgb.push_back(static_cast<std::uint8_t>(std::lround(std::lerp(upper, lower, down))));
      }
    }
  return result;
}

StudyTable::Row measured(const StudyInput& input, const std::string& choice, const View& view,
                         const RenderOptions& options, const Image& reference) {
  Renderer& renderer = input.renderer();
  const Image picture = renderer.render(input.scene, view, options);
  std::vector<double> times;
  for (int i = 0; i < input.frames; ++i)
    times.push_back(renderer.time_frame(input.scene, view, options, false).frame_ms);
  std::sort(times.begin(), times.end());
  const Difference difference = compare(picture.width == reference.width && picture.height == reference.height
                                            ? picture
                                            : enlarged(picture, reference.width, reference.height),
                                        reference, 2);
  return {
      choice,
      {times[times.size() / 2], std::min(difference.psnr_db, 100.0), static_cast<double>(difference.largest),
       times.front(), times.back(), (difference.x + 0.5) / reference.width, (difference.y + 0.5) / reference.height}};
}

double median_milliseconds(int repeats, const std::function<void()>& run) {
  std::vector<double> times;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run();
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

namespace {

// A field of a CSV file, quoted if necessary (RFC 4180).
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

// Plots the table's column y over column `x` into BASE.svg and BASE.png. Writes nothing if no row has finite values for
// both.
void write_plot(const Study& study, const StudyTable& table, std::size_t x, const std::string& base,
                const std::function<void(const std::string& path, const std::string& bytes)>& write) {
  std::string data, points;
  std::vector<StudyTable::Row> rows;
  std::copy_if(table.rows.begin(), table.rows.end(), std::back_inserter(rows), [&](const StudyTable::Row& row) {
    return std::isfinite(row.values[x]) && std::isfinite(row.values[table.y]);
  });
  if (rows.empty()) return;
  std::size_t lines = 0, longest = 0;
  for (std::size_t k = 0, next = 0; k < rows.size(); k = next) {
    // Rows of one series that follow each other are one line.
    for (next = k + 1; next < rows.size() && !rows[k].series.empty() && rows[next].series == rows[k].series;) ++next;
    // A logarithmic axis has no zero: exact values are drawn at its lower end.
    const auto drawn = [](double value, bool log) { return log ? std::max(value, 1e-17) : value; };
    for (std::size_t each = k; each < next; ++each)
      data += fmt::format("{} {}\n", drawn(rows[each].values[x], table.log_x),
                          drawn(rows[each].values[table.y], table.log_y));
    const std::string& name = rows[k].series.empty() ? rows[k].choice : rows[k].series;
    points += fmt::format("{}$rows every ::{}::{} using 1:2 with {} pt {} ps 1.4 title {}", k == 0 ? "" : ", ", k,
                          next - 1, rows[k].series.empty() ? "points" : "linespoints", 4 + lines, plotted(name));
    ++lines;
    longest = std::max(longest, name.size());
  }
  const std::string plot = fmt::format(
      "$rows << EOD\n{}EOD\nset title {}\nset xlabel {}\nset ylabel {}\n{}{}"
      "set grid\nset key outside right top\nset offsets graph 0.05, graph 0.05, graph 0.05, graph 0.05\n",
      data, plotted(study.help), plotted(table.columns[x]), plotted(table.columns[table.y]),
      table.log_x ? "set logscale x\nset format x '10^{%L}'\n" : "",
      table.log_y ? "set logscale y\nset format y '10^{%L}'\n" : "");
  // The plot is as high as its legend. Its output comes through a pipe, so that no output path reaches gnuplot.
  const std::size_t height = std::max<std::size_t>(440, 60 + 20 * lines);
  // Longer names need a wider legend.
  const std::size_t width = 860 + 8 * (std::max<std::size_t>(longest, 28) - 28);
  for (const auto& [terminal, extension] :
       {std::pair{fmt::format("svg size {},{} dynamic background rgb 'white'", width, height), "svg"},
        std::pair{fmt::format("pngcairo size {},{}", width, height), "png"}})
    write(base + "." + extension, run_gnuplot(fmt::format("{}set terminal {}\nplot {}\n", plot, terminal, points)));
}

void refuse_foreign_picture(const std::filesystem::path& file) {
  if (std::error_code error;
      std::filesystem::exists(file, error) && std::filesystem::file_size(file, error) > 0 && !is_rendered_picture(file))
    throw FileError(file, "was not made by a study, was changed since, or is of an earlier build; move it elsewhere");
}

}  // namespace

void write_study_picture(const Image& picture, const std::filesystem::path& file) {
  refuse_foreign_picture(file);
  write_picture(picture, file, {});
}

void write_line_plot(const std::string& title, const std::string& x, const std::string& y, bool log_y,
                     const std::vector<PlottedLine>& lines, const std::string& base) {
  std::string data, drawn;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    data += fmt::format("$line{} << EOD\n", k);
    for (const auto& [at, value] : lines[k].points) data += fmt::format("{} {}\n", at, value);
    data += "EOD\n";
    drawn += fmt::format("{}$line{} using 1:2 with lines lw 2 title {}", k == 0 ? "" : ", ", k, plotted(lines[k].name));
  }
  const std::string plot = fmt::format("{}set title {}\nset xlabel {}\nset ylabel {}\n{}set grid\nset key below\n",
                                       data, plotted(title), plotted(x), plotted(y), log_y ? "set logscale y\n" : "");
  // The legend is below the plot, in as many columns as fit.
  std::size_t longest = 0;
  for (const PlottedLine& line : lines) longest = std::max(longest, line.name.size());
  constexpr std::size_t width = 860, plot_height = 440;
  const std::size_t columns =
      std::clamp<std::size_t>(width / (8 * longest + 60), 1, std::max<std::size_t>(lines.size(), 1));
  const std::size_t height = plot_height + 20 * ((lines.size() + columns - 1) / columns);
  for (const auto& [terminal, extension] :
       {std::pair{fmt::format("svg size {},{} dynamic background rgb 'white'", width, height), "svg"},
        std::pair{fmt::format("pngcairo size {},{}", width, height), "png"}}) {
    refuse_foreign_picture(base + "." + extension);
    write_file_atomically(base + "." + extension,
                          with_mark(run_gnuplot(fmt::format("{}set key below maxcols {}\nset terminal {}\nplot {}\n",
                                                            plot, columns, terminal, drawn))),
                          {});
  }
}

std::filesystem::path own_folder(const StudyInput& input, const std::string& study) {
  const std::filesystem::path folder = input.folder / study, marker = folder / "study.json";
  input.sources.check_folder(folder);
  const std::string contents = fmt::format("{{\"software\": \"Rebake\", \"study\": \"{}\"}}\n", study);
  std::error_code error;
  if (std::filesystem::exists(folder, error) &&
      (!std::filesystem::is_directory(folder, error) || !std::filesystem::is_empty(folder, error)) &&
      (!std::filesystem::is_regular_file(marker, error) || read_file(marker) != contents))
    throw FileError(folder, "exists and was not made by this study; choose another output folder");
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError(folder, "cannot be created: " + error.message());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_symlink(error))
      throw FileError(entry.path(), "is a symbolic link; remove it, since the study would overwrite its target");
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (const auto extension = entry.path().extension(); extension == ".png" || extension == ".svg")
      refuse_foreign_picture(entry.path());
  write_file_atomically(marker, contents, {});
  return folder;
}

namespace {

constexpr const char* files_of_study[] = {".csv", ".svg", ".png", "-2.svg", "-2.png"};

// Content hashes of the files that an earlier run wrote or was about to write, by file name.
std::map<std::string, std::vector<std::string>> written_files(const std::string& base) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(base + ".json", error)) return {};
  const nlohmann::json record = nlohmann::json::parse(read_file(base + ".json"), nullptr, false);
  const auto refuse = [&] {
    throw FileError(base + ".json", "is not the record of an earlier study; choose another folder");
  };
  if (!record.is_object() || record.value("software", nlohmann::json()) != "Rebake" || !record.contains("plots"))
    refuse();
  std::map<std::string, std::vector<std::string>> files;
  try {
    for (const auto& [name, hashes] : record.at("plots").items())
      files[name] = hashes.is_string() ? std::vector<std::string>{hashes} : hashes.get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception&) {
    refuse();
  }
  return files;
}

std::string hash_at(const std::filesystem::path& file) { return hash_text(content_hash(read_file(file))); }

}  // namespace

void prepare_study_folder(const Study& study, const std::filesystem::path& folder, const SourceGuard& guard) {
  guard.check_file(folder / study.name);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError(folder, "cannot be created: " + error.message());
  if (::access(folder.c_str(), W_OK) != 0) throw FileError(folder, "cannot be written to");
  const std::string base = (folder / study.name).string();
  for (const char* ending : {".csv", ".json", ".svg", ".png", "-2.svg", "-2.png"}) {
    guard.check_file(base + ending);
    if (std::filesystem::is_symlink(base + ending, error))
      throw FileError(base + ending, "is a symbolic link; remove it, since the study would overwrite its target");
  }
  const auto known = written_files(base);
  // Records of earlier versions do not contain the table.
  const bool old_record =
      std::filesystem::exists(base + ".json", error) && !known.contains(study.name + std::string(".csv"));
  for (const char* ending : files_of_study) {
    const std::filesystem::path file = base + ending;
    if (!std::filesystem::exists(file, error)) continue;
    if (ending == files_of_study[0] && old_record && read_file(file).starts_with("choice,")) continue;
    const auto hashes = known.find(file.filename().string());
    if (hashes == known.end() ||
        std::find(hashes->second.begin(), hashes->second.end(), hash_at(file)) == hashes->second.end())
      throw FileError(file,
                      "was not written by an earlier study, or was changed since; move it, or choose another folder");
  }
}

void write_study(const Study& study, const StudyTable& table, const std::filesystem::path& folder,
                 const SourceGuard& guard) {
  prepare_study_folder(study, folder, guard);
  std::string csv = quoted("choice");
  for (const std::string& column : table.columns) csv += ',' + quoted(column);
  csv += '\n';
  for (const StudyTable::Row& row : table.rows) {
    csv += quoted(row.choice);
    for (const double value : row.values) csv += std::isnan(value) ? "," : fmt::format(",{:.6g}", value);
    csv += '\n';
  }
  const std::string base = (folder / study.name).string();
  // The record has the contents before and after until all files are written, so that a run that ends in between leaves
  // no file that the next run refuses, and no other file counts as the study's.
  std::map<std::string, std::vector<std::string>> files = written_files(base);
  if (std::filesystem::exists(base + ".csv")) files[study.name + std::string(".csv")].push_back(hash_at(base + ".csv"));
  const auto record = [&] {
    write_file_atomically(base + ".json", nlohmann::json{{"software", "Rebake"}, {"plots", files}}.dump(), guard);
  };
  std::map<std::string, std::vector<std::string>> made;
  const auto write = [&](const std::string& path, const std::string& bytes) {
    const std::string name = std::filesystem::path(path).filename().string(), hash = hash_text(content_hash(bytes));
    files[name].push_back(hash);
    made[name] = {hash};
    record();
    write_file_atomically(path, bytes, guard);
  };
  write(base + ".csv", csv);
  write_plot(study, table, table.x, base, write);
  if (table.second_x) write_plot(study, table, *table.second_x, base + "-2", write);
  // Plots of an earlier run that has more of them.
  for (const char* ending : files_of_study)
    if (!made.contains(study.name + std::string(ending))) std::filesystem::remove(base + ending);
  files = made;
  record();
}

}  // namespace rebake
