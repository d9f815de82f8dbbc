#include "editor/studies/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "mesh_ops/error.h"
#include "mesh_ops/formats/files.h"
#include "render/compare.h"

namespace rebake {

StudyRow measured(const StudyInput& input, const std::string& choice, const View& view, const RenderOptions& options,
                  const Image& reference) {
  const Image picture = input.renderer.render(input.scene, view, options);
  std::vector<double> times;
  for (int i = 0; i < input.frames; ++i)
    times.push_back(input.renderer.time_frame(input.scene, view, options, false).frame_ms);
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  const Difference difference = compare(picture, reference, 2);
  return {choice, times[times.size() / 2], std::min(difference.psnr_db, 100.0), difference.largest};
}

void write_study(const Study& study, const std::vector<StudyRow>& rows, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError(folder, "cannot be created: " + error.message());
  std::string csv = "choice,milliseconds,psnr_db,largest_difference\n";
  std::string data;
  for (const StudyRow& row : rows) {
    csv += fmt::format("{},{:.3f},{:.2f},{}\n", row.choice, row.milliseconds, row.psnr_db, row.largest);
    data += fmt::format("\"{}\" {} {}\n", row.choice, row.milliseconds, row.psnr_db);
  }
  const std::string base = (folder / study.name).string();
  std::string quoted;  // for gnuplot, which doubles single quotes
  for (const char c : base) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  write_file_atomically(base + ".csv", csv);
  std::string plot = fmt::format(
      "$rows << EOD\n{}EOD\nset title \"{}\"\nset xlabel \"milliseconds a frame (median)\"\nset ylabel \"PSNR, dB "
      "(100: equal)\"\n"
      "set grid\nset key off\nset offsets graph 0.15, graph 0.25, graph 0.15, graph 0.1\n",
      data, study.help);
  for (const auto& [terminal, extension] :
       {std::pair{"svg size 720,440 dynamic background rgb 'white'", "svg"}, std::pair{"pngcairo size 720,440", "png"}})
    plot += fmt::format(
        "set terminal {}\nset output '{}.{}'\nplot $rows using 2:3 with points pt 7 ps 1.2, $rows using 2:3:1 with "
        "labels offset 0,1\n",
        terminal, quoted, extension);
  std::signal(SIGPIPE, SIG_IGN);  // gnuplot may be missing; its exit status says so
  FILE* pipe = popen("gnuplot", "w");
  if (pipe == nullptr) throw Error("gnuplot cannot be started; install gnuplot-nox for the plots");
  std::fputs(plot.c_str(), pipe);
  if (pclose(pipe) != 0) throw Error(base + ".csv is written, but gnuplot failed; install gnuplot-nox for the plots");
}

}  // namespace rebake
