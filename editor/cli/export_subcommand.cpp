#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/actions/export_action.h"
#include "editor/actions/session.h"
#include "editor/cli/options.h"
#include "editor/cli/subcommands.h"
#include "editor/cli/terminal.h"
#include "editor/fields/codec.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

void describe_export(SubcommandDescription& command) {
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
  command.option("folder", options->folder, "MobileNeRF folder, Rebake scene or project", "FOLDER|SCENE|PROJECT")
      .required();
  command.option("-o,--out", options->out, "output folder; replaced atomically", "FOLDER").required();
  const std::vector<std::string> layouts = Codec<Layout>::type().choices, ways = Codec<FuseMethod>::type().choices;
  command
      .option("--layout", options->layout, "layout of the output", fmt::format("{} [as read]", fmt::join(layouts, "|")))
      .one_of(layouts);
  command
      .option("--page-size", options->page_size, "maximum side of repacked textures, in texels",
              "N [4096, or that of the largest source texture]")
      .between(1, 16384);
  command
      .option("--format", options->format, written_formats_help(),
              fmt::format("{} [{}]", fmt::join(written_formats(), "|"), ExportAction().format))
      .one_of(written_formats());
  command.flag("--plain", options->plain,
               "write one folder for any scene; fits one decoder if none represents the scene exactly");
  command.option("--width", options->width, "plain: maximum width of the decoder's hidden layers",
                 "auto|16|24|32|N [auto]");
  command
      .option("--way", options->way, "plain: method of fusing the decoders",
              fmt::format("{} [the best]", fmt::join(ways, "|")))
      .one_of(ways);
  command.option("--keep", options->keep, "plain: node that stays bit for bit", "NODE|none|auto [auto]");
  command.option("--psnr", options->psnr, "plain: target quality; fitting stops there", "dB [40, and fits all texels]");
  command.option("--seconds", options->seconds, "plain: time limit of fitting", "S [no limit]");
  command
      .option("--picture-size", options->picture_size, "plain: side of the pictures for measuring, in pixels",
              fmt::format("N [{}]", ExportAction().picture_size))
      .between(16, 4096);
  command.option("--report", options->report, "plain: JSON file for the measured errors", "FILE");
  add_axes_option(command, options->axes);
  command.does([options] {
    Session session;
    session.progress = progress_bar();
    session.say = print_message;
    LoadedScene opened = load_scenes({options->folder}, options->axes, session.progress);
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
        throw FieldError("width", "must be auto or a whole number from 4 to 256");
      action.width.neurons = neurons;
    }
    if (!options->way.empty()) action.way = Codec<FuseMethod>::read(nlohmann::json(options->way), session.scene());
    action.keep = options->keep;
    action.psnr = options->psnr;
    action.seconds = options->seconds;
    action.report = options->report;
    action.picture_size = options->picture_size;
    run(session, action);
    if (replaces) print_message("note: the existing folder was replaced");
    if (session.below_requested_psnr) throw ExitWith{4};
  });
}

}  // namespace rebake
