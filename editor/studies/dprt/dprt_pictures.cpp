#include "editor/studies/dprt/dprt_pictures.h"

#include <fmt/format.h>

#include <cmath>

#include "editor/actions/views.h"
#include "editor/studies/dprt/dprt_gloss.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/light/transport/rotated_product.h"
#include "mesh_ops/scene/scene_light.h"
#include "render/contact_sheet.h"
#include "render/image.h"

namespace rebake {

namespace {

using Rgb8 = std::array<std::uint8_t, 3>;

std::uint8_t byte(double value) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0))); }

// The texels' mesh with a colour per texel.
Scene colored(const TracedFrames& traced, const std::vector<Vec3>& places, const std::vector<Rgb8>& colors,
              const Color& background) {
  const int side = traced.side;
  std::vector<Vec2> uvs;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) uvs.emplace_back((column + 0.5) / side, 1 - (row + 0.5) / side);
  auto object = std::make_shared<BakedObject>();
  object->sets.push_back(
      {Soup(places, uvs, traced.rest.faces), std::make_shared<const FeatureTexture>(FeatureTexture::from_rows(
                                                 side, side, AlphaCode::plain, [&](int y, Texel* row) {
                                                   for (int x = 0; x < side; ++x) {
                                                     const Rgb8& c = colors[static_cast<std::size_t>(y * side + x)];
                                                     row[x] = {{255, c[0], c[1], c[2]}, {0, 0, 0, 255}};
                                                   }
                                                 }))});
  object->decoder = std::make_shared<const Decoder>(diffuse_decoder());
  Node node;
  node.object = std::move(object);
  Scene scene = with_added({}, node, NodeId::none, 0);
  scene.background = background;
  return scene;
}

std::vector<Radiance> lit(const std::vector<float>& transfer) {
  const Light light = sky_and_sun({0.34, 0.3, 0.27}, {0.75, 0.88, 1.1}, {}, {0, 0, 0});
  const std::array<sh::Coefficients, 3> sky = projected_sky(light, Mat3::Identity());
  const std::size_t texels = transfer.size() / sh::count;
  std::vector<Radiance> result(texels);
  for (std::size_t t = 0; t < texels; ++t)
    for (Eigen::Index channel = 0; channel < 3; ++channel) {
      double sum = 0;
      for (std::size_t c = 0; c < sh::count; ++c)
        sum += static_cast<double>(transfer[c * texels + t]) *
               sky[static_cast<std::size_t>(channel)][static_cast<Eigen::Index>(c)];
      result[t][channel] = std::max(0.0, sum);
    }
  return result;
}

void write_pictures(const StudyInput& input, const TracedFrames& traced, const std::vector<Vec3>& places,
                    const std::vector<float>& truth, const std::vector<float>& found,
                    const std::vector<Radiance>& wanted, const std::vector<Radiance>& got,
                    const std::filesystem::path& file) {
  const std::size_t texels = wanted.size();
  std::array<std::vector<Rgb8>, 4> colors;
  constexpr double exposure = 1.1, error_gain = 10, coefficient_gain = 10;
  for (std::size_t t = 0; t < texels; ++t) {
    Rgb8 a{}, b{}, off{};
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = to_display(std::min(1.0, exposure * wanted[t][static_cast<Eigen::Index>(c)])),
                   y = to_display(std::min(1.0, exposure * got[t][static_cast<Eigen::Index>(c)]));
      a[c] = byte(x);
      b[c] = byte(y);
      off[c] = byte(error_gain * std::abs(x - y));
    }
    double squares = 0;
    for (std::size_t c = 0; c < sh::count; ++c) {
      const double difference = static_cast<double>(truth[c * texels + t]) - static_cast<double>(found[c * texels + t]);
      squares += difference * difference / sh::count;
    }
    const std::uint8_t grey = byte(coefficient_gain * std::sqrt(squares));
    colors[0].push_back(a);
    colors[1].push_back(b);
    colors[2].push_back(off);
    colors[3].push_back({grey, grey, grey});
  }
  try {
    std::vector<Image> pictures;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      // Errors on black, which stands for none.
      const Color background = k < 2 ? Color{1, 1, 1} : Color{0, 0, 0};
      const Scene scene = colored(traced, places, colors[k], background);
      View view{framing_camera(scene, 1), 420, 420, 4};
      pictures.push_back(input.renderer().render(scene, view, {}));
    }
    write_study_picture(contact_sheet(pictures, 4, 6, {255, 255, 255}), file);
  } catch (const DeviceError& error) {
    input.say(fmt::format("warning: {} was not written: {}", file.filename().string(), error.what()));
  }
}

}  // namespace

void write_dprt_picture(const StudyInput& input, const TracedFrames& traced, const std::vector<Vec3>& places,
                        const std::vector<float>& truth, const std::vector<float>& found,
                        const std::filesystem::path& file) {
  write_pictures(input, traced, places, truth, found, lit(truth), lit(found), file);
}

Vec3 eye_of_picture(const TracedFrames& traced, const std::vector<Vec3>& places) {
  const std::vector<Rgb8> black(places.size());
  return framing_camera(colored(traced, places, black, {1, 1, 1}), 1).eye;
}

void write_glossy_picture(const StudyInput& input, const TracedFrames& traced, const std::vector<Vec3>& places,
                          const std::vector<LightSite>& sites, const std::vector<float>& truth,
                          const std::vector<float>& found, const std::filesystem::path& file) {
  constexpr double ground = 0.3, gloss = 0.35;
  const auto light = glossy_light(sites, eye_of_picture(traced, places));
  const auto seen = [&](const std::vector<float>& transfer) {
    std::vector<Radiance> result = lit(transfer);
    const std::vector<Radiance> mirrored = reflected(light, transfer);
    for (std::size_t t = 0; t < result.size(); ++t) result[t] = ground * result[t] + gloss * mirrored[t];
    return result;
  };
  write_pictures(input, traced, places, truth, found, seen(truth), seen(found), file);
}

}  // namespace rebake
