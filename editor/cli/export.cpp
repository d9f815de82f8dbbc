#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/cli/commands.h"
#include "editor/cli/options.h"
#include "editor/cli/terminal.h"
#include "editor/commands/export.h"
#include "editor/commands/session.h"
#include "editor/fields/codec.h"
#include "mesh_ops/base/error.h"

namespace rebake {

void describe_export(CommandDescription& command) {
  struct Options {
    std::string folder, out, layout, report;
    bool plain = false;
    int page_size = 0, picture_size = ExportAction().picture_size;
    std::string width = "auto", way, keep = ExportAction().keep;
    std::optional<double> psnr;
    double seconds = 0;
    std::string format = ExportAction().format;
    std::string axes = "360";
  };
  auto options = std::make_shared<Options>();
  command.option("folder", options->folder, "what to export", "FOLDER|SCENE").required();
  command.option("-o,--out", options->out, "folder to write; replaced whole or not at all", "FOLDER").required();
  command.option("--layout", options->layout, "convert the layout", "split|chunked|unsplit [as read]")
      .one_of(std::vector<std::string>{"split", "chunked", "unsplit"});
  command
      .option("--page-size", options->page_size, "texels a side of textures that are laid out again, at most",
              "N [4096, or as the largest read]")
      .between(1, 16384);
  command.option("--format", options->format, "what to write", "mobilenerf|rebake [mobilenerf]");
  command.flag("--plain", options->plain,
               "one ordinary folder for any scene: where one decoder cannot show it exactly, one is fitted");
  command.option("--width", options->width, "plain: neurons of the decoder's layers, at most",
                 "auto|16|24|32|N [auto]");
  command.option("--way", options->way, "plain: how the decoder is made", "keep|train|new|side_by_side [the best]")
      .one_of(std::vector<std::string>{"keep", "train", "new", "side_by_side"});
  command.option("--keep", options->keep, "plain: what stays bit for bit", "NODE|none|auto [auto]");
  command.option("--psnr", options->psnr, "plain: what to reach; nothing is fitted further", "dB [40, all is fitted]");
  command.option("--seconds", options->seconds, "plain: for fitting", "S [as long as it takes]");
  command
      .option("--picture-size", options->picture_size, "plain: pixels a side of the pictures that it is judged by",
              fmt::format("N [{}]", ExportAction().picture_size))
      .between(16, 4096);
  command.option("--report", options->report, "plain: JSON file for what was measured", "FILE");
  add_axes_option(command, options->axes);
  command.does([options] {
    Session session;
    session.progress = progress_bar();
    session.say = say_line;
    Opened opened = read_all({options->folder}, options->axes, session.progress);
    session.document = Document(std::move(opened.scene));
    // The sources include the scene or project file that refers to the source folders.
    opened.sources.check_folder(options->out);
    std::error_code error;
    const bool replaces = std::filesystem::exists(options->out, error);
    ExportAction action;
    action.out = options->out;
    action.format = options->format;
    if (!options->layout.empty()) action.layout = Codec<Layout>::read(nlohmann::json(options->layout), session.scene());
    if (options->page_size > 0) action.page_size = options->page_size;
    action.plain = options->plain;
    if (options->width != "auto") {
      int neurons = 0;
      const char* const end = options->width.data() + options->width.size();
      if (const auto read = std::from_chars(options->width.data(), end, neurons);
          read.ec != std::errc() || read.ptr != end)
        throw FieldError("width", "must be auto, or 4 to 256");
      action.width.neurons = neurons;
    }
    if (!options->way.empty()) action.way = Codec<FuseWay>::read(nlohmann::json(options->way), session.scene());
    action.keep = options->keep;
    action.psnr = options->psnr;
    action.seconds = options->seconds;
    action.report = options->report;
    action.picture_size = options->picture_size;
    run(session, action);
    if (replaces) say_line("note: it took the place of the folder that was there");
    if (session.below_asked) throw ExitWith{4};
  });
}

}  // namespace rebake
