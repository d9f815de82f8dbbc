#include "render/compare.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/cli/commands.h"

namespace rebake {

void add_compare(CLI::App& program) {
  struct Options {
    std::string a, b;
    int tolerance = 2;
    double least_psnr = 0;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("compare", "says how much two pictures differ");
  command->add_option("a", options->a, "picture")->required()->option_text("A.png");
  command->add_option("b", options->b, "picture of the same size")->required()->option_text("B.png");
  command->add_option("--tolerance", options->tolerance, "difference of a channel that still counts as equal, in 1/255")
      ->check(CLI::Range(0, 255))
      ->option_text("N [2]");
  command->add_option("--min-psnr", options->least_psnr, "exit with 3 below this")->option_text("dB");
  command->add_flag("--json", options->json, "machine-readable; psnr_db is null for equal pictures");
  command->callback([options] {
    const Difference d = compare(read_image(options->a), read_image(options->b), options->tolerance);
    if (options->json) {
      nlohmann::json out = {{"ssim", d.ssim},
                            {"largest", d.largest},
                            {"share_beyond", d.share_beyond},
                            {"tolerance", options->tolerance}};
      out["psnr_db"] = std::isinf(d.psnr_db) ? nlohmann::json() : nlohmann::json(d.psnr_db);
      fmt::print("{}\n", out.dump(1));
    } else {
      fmt::print("PSNR     {}\n", std::isinf(d.psnr_db) ? "equal" : fmt::format("{:.2f} dB", d.psnr_db));
      fmt::print("SSIM     {:.5f}\nlargest  {}/255\nbeyond   {:.4f} % of pixels differ by more than {}/255\n", d.ssim,
                 d.largest, d.share_beyond * 100, options->tolerance);
    }
    if (d.psnr_db < options->least_psnr) throw ExitWith{3};
  });
}

}  // namespace rebake
