#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "editor/actions/plain_report.h"
#include "editor/studies/study.h"
#include "render/compare.h"
#include "render/web_page/web_page.h"

namespace rebake {

namespace {

// Bytes that browsers load to show the scene.
double megabytes(const WebPage& page) {
  double bytes = 0;
  for (const auto& [name, content] : page.files)
    if (name.starts_with("data/")) bytes += static_cast<double>(content.size());
  return bytes / 1e6;
}

// The scene with its positions on the grids of a page, as the page shows it. Sets must not be shared.
Scene on_grids_of(const WebPage& page, const Scene& scene) {
  const nlohmann::json manifest = nlohmann::json::parse(page.files.at("scene.json"));
  Scene result = scene;
  std::size_t draw = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    auto object = std::make_shared<BakedObject>(*placed.node->object);
    for (TextureSet& set : object->sets) {
      const nlohmann::json& stored =
          manifest.at("sets").at(manifest.at("draws").at(draw++).at("set").get<std::size_t>());
      const double step = stored.at("step").get<double>();
      const Vec3 origin(stored.at("origin").at(0), stored.at("origin").at(1), stored.at("origin").at(2));
      auto positions = std::make_shared<std::vector<Vec3>>(set.soup.positions());
      for (Vec3& p : *positions) p = origin + step * ((p - origin) / step).array().round().matrix();
      set.soup = Soup(positions, set.soup.shared_uvs(), set.soup.shared_faces(), set.soup.vertex_attributes(),
                      set.soup.face_attributes());
    }
    result = with_changed(result, placed.node->id, [&](Node& node) { node.object = object; });
  }
  return result;
}

}  // namespace

// Positions: pictures of the rounded scene against the exact one, 4 samples. Textures are without loss. Moving: 1
// sample at a lower resolution against 4 samples.
StudyTable study_publish(const StudyInput& input) {
  StudyTable table{{"MB of data", "PSNR dB (100: equal)", "milliseconds per frame", "milliseconds to publish",
                    "largest error of 255"},
                   {},
                   0,
                   1,
                   false,
                   false};
  table.second_x = 2;
  const Lighting lighting;
  WebPageOptions options;
  options.home = input.view.camera;
  const Image exact = input.renderer().render(input.scene, input.view);
  const auto add = [&](const std::string& choice, const Scene& shown, const View& view, double size,
                       double publishing) {
    const Image picture = input.renderer().render(shown, view);
    const Difference difference =
        compare(exact, picture.width == exact.width ? picture : enlarged(picture, exact.width, exact.height), 0);
    table.rows.push_back(
        {choice,
         {size, std::min(100.0, difference.psnr_db), median_frame_ms(input.renderer(), shown, view, input.frames),
          publishing, static_cast<double>(difference.largest)}});
    input.progress.at("pages", static_cast<double>(table.rows.size()) / 12);
  };
  const auto published = [&](WebPage& page) {
    return median_milliseconds(1, [&] { page = web_page({input.scene, lighting}, options); });
  };
  WebPage page;
  for (const double steps : {1.0, 4.0, 16.0, 64.0, 256.0, 1024.0}) {
    options.steps_per_pixel = steps;
    const double milliseconds = published(page);
    add(fmt::format("positions on 1/{:.0f} pixel", steps), on_grids_of(page, input.scene), input.view, megabytes(page),
        milliseconds);
  }
  options.steps_per_pixel = WebPageOptions().steps_per_pixel;
  for (const auto& [coding, name] :
       {std::pair(WebImageCoding::png, "textures as PNG"), {WebImageCoding::webp, "textures as lossless WebP"}}) {
    options.coding = coding;
    const double milliseconds = published(page);
    add(name, on_grids_of(page, input.scene), input.view, megabytes(page), milliseconds);
  }
  options.coding = WebImageCoding::smaller;
  const double milliseconds = published(page);
  for (const int percent : {100, 70, 50, 35}) {
    View view = input.view;
    view.samples = 1;
    view.width = std::max(1, static_cast<int>(std::lround(view.width * percent / 100.0)));
    view.height = std::max(1, static_cast<int>(std::lround(view.height * percent / 100.0)));
    add(fmt::format("moving, {} % resolution", percent), input.scene, view, megabytes(page), milliseconds);
  }
  return table;
}

}  // namespace rebake
