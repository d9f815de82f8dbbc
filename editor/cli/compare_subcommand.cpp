#include "render/compare.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "editor/cli/subcommands.h"
#include "mesh_ops/base/error.h"

namespace rebake {

void describe_compare(SubcommandDescription& command) {
  struct Options {
    std::string a, b;
    int tolerance = 2;
    double min_psnr = 0;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  command.option("a", options->a, "picture", "A.png").required();
  command.option("b", options->b, "picture of the same size", "B.png").required();
  command
      .option("--tolerance", options->tolerance, "largest difference per channel that counts as equal, in 1/255",
              "N [2]")
      .between(0, 255);
  command.option("--min-psnr", options->min_psnr, "minimum PSNR; exit code 3 below it", "dB");
  command.flag("--json", options->json, "print JSON; psnr_db is null for equal pictures");
  command.does([options] {
    if (std::isnan(options->min_psnr)) throw FieldError("--min-psnr", "must be a number (dB)");
    const Difference d = compare(read_image(options->a), read_image(options->b), options->tolerance);
    if (options->json) {
      nlohmann::json out = {{"ssim", d.ssim},
                            {"largest", d.largest},
                            {"largest_at", {d.x, d.y}},
                            {"share_beyond", d.share_beyond},
                            {"tolerance", options->tolerance}};
      out["psnr_db"] = std::isinf(d.psnr_db) ? nlohmann::json() : nlohmann::json(d.psnr_db);
      fmt::print("{}\n", out.dump(1));
    } else {
      fmt::print("PSNR     {}\n", std::isinf(d.psnr_db) ? "equal" : fmt::format("{:.2f} dB", d.psnr_db));
      fmt::print("SSIM     {:.5f}\nlargest  {}/255{}\nbeyond   {:.4f} % of pixels differ by more than {}/255\n", d.ssim,
                 d.largest, d.largest > 0 ? fmt::format(" at pixel {}, {}", d.x, d.y) : "", d.share_beyond * 100,
                 options->tolerance);
    }
    if (d.psnr_db < options->min_psnr) throw ExitWith{3};
  });
}

}  // namespace rebake
