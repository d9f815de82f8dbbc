#include "editor/commands/export.h"

#include "editor/commands/describe.h"
#include "editor/commands/views.h"

#include <fmt/format.h>

#include <numbers>

#include "mesh_ops/formats/export.h"
#include "render/compare.h"
#include "render/picture.h"

namespace rebake {

namespace {

// What the pictures lose when bends no longer turn colours, from four sides. Needs OpenGL; says so where there is none.
std::string cost_of_bends(Session& session, const Scene& flat) {
  try {
    const Camera front = framing_of(session.scene(), 1);
    double squares = 0, worst = 100;
    constexpr int sides = 4;
    for (int side = 0; side < sides; ++side) {
      View view;
      view.width = view.height = 400;
      view.camera = front;
      view.camera.eye = front.target + Eigen::AngleAxisd(side * 2 * std::numbers::pi / sides, front.up.normalized()) *
                                           (front.eye - front.target);
      Renderer& renderer = session.renderer();
      const double psnr =
          std::min(100.0, compare(renderer.render(session.scene(), view), renderer.render(flat, view), 2).psnr_db);
      squares += std::pow(10, -psnr / 10) / sides;
      worst = std::min(worst, psnr);
    }
    return fmt::format("that costs {:.1f} dB PSNR over four sides, {:.1f} dB at the worst", -10 * std::log10(squares),
                       worst);
  } catch (const Error& error) {
    return fmt::format("what that costs cannot be measured here: {}", error.what());
  }
}

}  // namespace

void run(Session& session, const ExportAction& action) {
  const ExportReport report =
      export_scene(session.scene(), action.out, {action.layout, session.document.sources()}, session.progress);
  session.exports.push_back(action.out);
  for (const std::string& note : report.notes) session.say("note: " + note);
  std::vector<std::string> bent;
  const Scene flat = without_bends(session.scene(), &bent);
  if (!bent.empty()) session.say("note: " + cost_of_bends(session, flat));
  session.say(fmt::format("exported {}", action.out));
}

REBAKE_DESCRIBE_ACTION(
    ExportAction, "Writes the scene in the MobileNeRF format, or as scene.json where one folder cannot hold it.",
    (auto& action, auto& visit) {
      visit("out", action.out, Need::required, "folder to write");
      visit("layout", action.layout, Need::optional, "convert to this layout; left out: as read");
    })

}  // namespace rebake
