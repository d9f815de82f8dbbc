#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "editor/studies/representations/scene_kinds.h"
#include "editor/studies/study.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/texture/linear_filter.h"
#include "render/compare.h"
#include "render/contact_sheet.h"
#include "samples/bakery/bake.h"

// The three limits that MobileNeRF's authors name: a fixed resolution in close-ups, binary opacity, and surfaces seen
// from the side. Each is measured against the traced truth, with what Rebake offers against it.

namespace rebake {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr int picture_side = 400;

// Changes when bakes do: scenes of earlier versions are then baked again.
constexpr int bake_version = 1;

Scene scene_with(std::shared_ptr<const BakedObject> object) {
  Node node;
  node.object = std::move(object);
  return with_added({}, std::move(node), NodeId::none, 0);
}

// Texels per side of a quad: fewer in quick runs.
int texels_of(const StudyInput& input, int texels) { return input.quick ? texels / 2 : texels; }

// Bakes a scene, or reads it from the study's folder, where an earlier run has left it.
Scene baked(const StudyInput& input, const std::string& name, const bakery::Model& model,
            const bakery::RadianceField& field, int texels) {
  const bakery::BakeOptions options{.epochs = input.quick ? 2 : 20,
                                    .observations = input.quick ? 8 : 48,
                                    .texels_per_side = texels_of(input, texels)};
  const std::filesystem::path folder =
      own_folder(input, "limits") /
      fmt::format("{}-{}-{}-{}", name, options.texels_per_side, options.epochs, bake_version);
  if (format_at(folder) == nullptr)
    export_scene(scene_with(bakery::bake(model, field, options, input.progress)), folder, {}, input.progress);
  return read_any(folder, ReadOptions(model.axes), input.progress);
}

// The scene with textures that are interpolated linearly to `factor` times as many texels per side.
Scene interpolated(const Scene& scene, int factor) {
  Scene result = scene;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    auto object = std::make_shared<BakedObject>(*placed.node->object);
    for (TextureSet& set : object->sets)
      set.texels = std::make_shared<const FeatureTexture>(subdivided(*set.texels, factor));
    result = with_changed(result, placed.node->id, [&](Node& node) { node.object = object; });
  }
  return result;
}

double frame_milliseconds(const StudyInput& input, const Scene& scene, const View& view) {
  input.renderer().render(scene, view);
  return median_milliseconds(input.frames, [&] { input.renderer().time_frame(scene, view, {}, false); });
}

// A way to draw a scene that is compared with the truth.
struct Choice {
  std::string name;
  Scene scene;
  int samples;
};

View square_view(const Camera& camera, int samples) {
  View view;
  view.camera = camera;
  view.width = view.height = picture_side;
  view.samples = samples;
  return view;
}

double psnr_of(const StudyInput& input, const Choice& choice, const Camera& camera, const Image& truth,
               std::vector<Image>& pictures) {
  pictures.push_back(input.renderer().render(choice.scene, square_view(camera, choice.samples)));
  return compare(pictures.back(), truth, 2).psnr_db;
}

void write_plot(const StudyInput& input, const std::string& title, const std::string& x,
                const std::vector<PlottedLine>& lines, const std::filesystem::path& base) {
  try {
    write_line_plot(title, x, "PSNR dB", false, lines, base.string());
  } catch (const Error& error) {
    input.say(fmt::format("warning: {} was not plotted: {}", title, error.what()));
  }
}

// The camera moved towards the surface in the middle of its picture, to a share of the distance.
Camera nearer(const Camera& camera, const bakery::RadianceField& field, double share) {
  const Vec3 direction = (camera.target - camera.eye).normalized();
  const auto hit = field.hit(camera.eye, direction);
  const double distance = hit ? hit->distance : (camera.target - camera.eye).norm();
  Camera result = camera;
  result.eye = camera.eye + (1 - share) * distance * direction;
  result.target = camera.eye + distance * direction;
  result.near_plane = share * distance / 50;
  return result;
}

void study_distance(const StudyInput& input, const std::filesystem::path& own, StudyTable& table) {
  const bakery::Model model = procedural_model("kettle");
  const bakery::RadianceField field(model);
  input.say("close-ups: baking the kettle with 17×17 and 33×33 texels per quad");
  const Scene usual = baked(input, "kettle", model, field, 17), fine = baked(input, "kettle", model, field, 33);
  const std::vector<Choice> choices{{"close-up, nearest texels", usual, 4},
                                    {"close-up, texels interpolated to 3 × 3", interpolated(usual, 3), 4},
                                    {"close-up, baked with 4 times the texels", fine, 4}};
  const std::vector<HeldOutView> views = held_out_views(model, input.quick ? 1 : 3, picture_side);
  std::vector<PlottedLine> lines;
  std::vector<std::vector<StudyTable::Row>> rows(choices.size());
  for (const Choice& choice : choices) lines.push_back({choice.name, {}});
  std::vector<Image> shown;
  for (const double share : {1.0, 0.5, 0.25, 0.125, 0.0625}) {
    input.progress.at("close-ups", 1 - share);
    std::vector<double> sums(choices.size(), 0);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Camera camera = nearer(views[v].view.camera, field, share);
      const Image truth = field.trace(camera, picture_side, picture_side);
      std::vector<Image> pictures{truth};
      for (std::size_t k = 0; k < choices.size(); ++k) sums[k] += psnr_of(input, choices[k], camera, truth, pictures);
      if (v == 0 && share == 0.125) shown = pictures;
    }
    for (std::size_t k = 0; k < choices.size(); ++k) {
      const double psnr = sums[k] / static_cast<double>(views.size());
      lines[k].points.push_back({share, psnr});
      rows[k].push_back(
          {fmt::format("{}, {:g} of the distance", choices[k].name, share),
           {frame_milliseconds(input, choices[k].scene, square_view(nearer(views[0].view.camera, field, share), 4)),
            psnr, share, none},
           choices[k].name});
    }
  }
  for (const auto& of_choice : rows) table.rows.insert(table.rows.end(), of_choice.begin(), of_choice.end());
  write_study_picture(contact_sheet(shown, static_cast<int>(shown.size()), 4, {255, 255, 255}),
                      own / "close-up-pictures.png");
  write_plot(input, "error in close-ups of the kettle", "share of the usual distance", lines, own / "close-up");
}

// A veil that lets half of the light through, in front of the shelf: 8 × 6 quads.
constexpr int veil_columns = 8, veil_rows = 6;
bakery::Patch veil(const std::function<bool(double, double)>& opaque) {
  bakery::Patch patch{"veil", bakery::plane({-0.8, -0.6, -1.7}, {1.4, 0, 0}, {0, 1.1, 0}), veil_columns, veil_rows,
                      [](double, double, const Vec3&) -> Vec3 {
                        return {0.5, 0.5, 0.52};
                      }};
  patch.opaque = opaque;
  patch.two_sided = true;
  return patch;
}

// The truth with the veil at half opacity: the mean of its colours and of those behind it. All colours are in the light
// of `light`; the others find the surfaces with the veil and without.
Image veiled(const Camera& camera, const bakery::RadianceField& light, const bakery::RadianceField& with,
             const bakery::RadianceField& without, std::size_t veil_patch) {
  constexpr int rays = 4;  // per pixel side
  Image image{picture_side, picture_side, std::vector<std::uint8_t>(std::size_t{picture_side} * picture_side * 3), {}};
  const Mat3 to_world = world_to_camera(camera).transpose();
  const double extent = std::tan(camera.fov_degrees / 2 * std::numbers::pi / 180);
  tbb::parallel_for(0, picture_side, [&](int y) {
    for (int x = 0; x < picture_side; ++x) {
      Color sum = Color::Zero();
      for (int s = 0; s < rays * rays; ++s) {
        const int column = s % rays, row = s / rays;
        const Vec3 at(((x + (column + 0.5) / rays) / picture_side * 2 - 1) * extent,
                      (1 - (y + (row + 0.5) / rays) / picture_side * 2) * extent, -1);
        const Vec3 direction = (to_world * at).normalized();
        const auto behind = without.hit(camera.eye, direction), first = with.hit(camera.eye, direction);
        Color color = behind ? light.color(behind->patch, behind->u, behind->v, direction) : Color(Color::Ones());
        if (first && first->patch == veil_patch)
          color = (color + light.color(first->patch, first->u, first->v, direction)) / 2;
        sum += color;
      }
      for (Eigen::Index c = 0; c < 3; ++c)
        image.rgb[static_cast<std::size_t>((y * picture_side + x) * 3 + static_cast<int>(c))] =
            static_cast<std::uint8_t>(std::lround(255 * sum[c] / (rays * rays)));
    }
  });
  return image;
}

void study_opacity(const StudyInput& input, const std::filesystem::path& own, StudyTable& table) {
  const bakery::Model bare = procedural_model("shelf");
  bakery::Model closed = bare, dithered = bare;
  closed.patches.push_back(veil([](double, double) { return true; }));
  // A chequerboard of texels.
  const int steps = texels_of(input, 17) - 1;
  dithered.patches.push_back(veil([steps](double u, double v) {
    return (std::lround(u * veil_columns * steps) + std::lround(v * veil_rows * steps)) % 2 == 0;
  }));
  input.say("semi-transparent parts: baking a veil of half opacity in front of the shelf");
  // The veil lets half of the light through in all of them.
  const bakery::RadianceField light(dithered), with(closed), without(bare);
  const Scene none_of_it = baked(input, "shelf-without", bare, light, 17),
              all_of_it = baked(input, "shelf-with", closed, light, 17),
              half_of_it = baked(input, "shelf-half", dithered, light, 17);
  const std::vector<Choice> choices{{"half opacity: left out", none_of_it, 4},
                                    {"half opacity: opaque", all_of_it, 4},
                                    {"half opacity: every other texel, 1 sample", half_of_it, 1},
                                    {"half opacity: every other texel, 4 samples", half_of_it, 4},
                                    {"half opacity: every other texel, 16 samples", half_of_it, 16}};
  const Camera camera = bare.camera(0.4, 0.6);
  const Image truth = veiled(camera, light, with, without, bare.patches.size());
  std::vector<Image> pictures{truth};
  for (const Choice& choice : choices) {
    const double psnr = psnr_of(input, choice, camera, truth, pictures);
    table.rows.push_back(
        {choice.name,
         {frame_milliseconds(input, choice.scene, square_view(camera, choice.samples)), psnr, none, none},
         ""});
  }
  write_study_picture(contact_sheet(pictures, 3, 4, {255, 255, 255}), own / "opacity.png");
}

// Angle between a pixel's view ray and the surface's normal in degrees; −1 where nothing is.
std::vector<double> angles_of(const Camera& camera, const bakery::RadianceField& field) {
  std::vector<double> angles(std::size_t{picture_side} * picture_side, -1);
  const Mat3 to_world = world_to_camera(camera).transpose();
  const double extent = std::tan(camera.fov_degrees / 2 * std::numbers::pi / 180);
  tbb::parallel_for(0, picture_side, [&](int y) {
    for (int x = 0; x < picture_side; ++x) {
      const Vec3 at(((x + 0.5) / picture_side * 2 - 1) * extent, (1 - (y + 0.5) / picture_side * 2) * extent, -1);
      const Vec3 direction = (to_world * at).normalized();
      const auto hit = field.hit(camera.eye, direction);
      if (!hit) continue;
      const double cosine = std::abs(direction.dot(field.normal(hit->patch, hit->u, hit->v)));
      angles[static_cast<std::size_t>(y) * picture_side + static_cast<std::size_t>(x)] =
          std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi;
    }
  });
  return angles;
}

void study_angle(const StudyInput& input, const std::filesystem::path& own, StudyTable& table) {
  constexpr int bins = 6;
  constexpr double width = 90.0 / bins;
  const bakery::Model model = procedural_model("courtyard");
  const bakery::RadianceField field(model);
  input.say("surfaces seen from the side: baking the courtyard");
  const Scene scene = baked(input, "courtyard", model, field, 17);
  const std::vector<HeldOutView> views = held_out_views(model, input.quick ? 1 : 3, picture_side);
  std::vector<PlottedLine> lines;
  for (const int samples : {1, 4, 16}) {
    std::array<double, bins> squares{}, counts{};
    for (const HeldOutView& one : views) {
      input.progress.at("surfaces seen from the side", 0);
      const Image truth = field.trace(one.view.camera, picture_side, picture_side),
                  drawn = input.renderer().render(scene, square_view(one.view.camera, samples));
      const std::vector<double> angles = angles_of(one.view.camera, field);
      for (std::size_t p = 0; p < angles.size(); ++p) {
        if (angles[p] < 0) continue;
        const auto bin = static_cast<std::size_t>(std::min(bins - 1.0, angles[p] / width));
        for (std::size_t c = 0; c < 3; ++c) {
          const double off = (static_cast<double>(drawn.rgb[3 * p + c]) - truth.rgb[3 * p + c]) / 255;
          squares[bin] += off * off;
          counts[bin] += 1;
        }
      }
    }
    lines.push_back({fmt::format("{} sample{} per pixel", samples, samples == 1 ? "" : "s"), {}});
    const double milliseconds = frame_milliseconds(input, scene, square_view(views[0].view.camera, samples));
    for (std::size_t b = 0; b < bins; ++b) {
      if (counts[b] == 0) continue;
      const double middle = (static_cast<double>(b) + 0.5) * width, psnr = -10 * std::log10(squares[b] / counts[b]);
      lines.back().points.push_back({middle, psnr});
      table.rows.push_back(
          {fmt::format("{:g}° to {:g}° from the normal, {}", middle - width / 2, middle + width / 2, lines.back().name),
           {milliseconds, psnr, none, middle},
           "seen from the side, " + lines.back().name});
    }
  }
  write_plot(input, "error on surfaces of the courtyard by view angle", "degrees from the normal", lines,
             own / "angle");
}

}  // namespace

StudyTable study_limits(const StudyInput& input) {
  StudyTable table{{"milliseconds per frame", "PSNR dB", "share of the usual distance", "degrees from the normal"},
                   {},
                   0,
                   1,
                   true,
                   false};
  input.say(input.quick
                ? "few epochs and texels: about a minute on two cores"
                : "three parts, which bake six scenes: about 5 minutes on two cores; baked scenes stay in the output "
                  "folder, so the study can be stopped and started again");
  const std::filesystem::path own = own_folder(input, "limits");
  study_distance(input, own, table);
  study_opacity(input, own, table);
  study_angle(input, own, table);
  return table;
}

}  // namespace rebake
