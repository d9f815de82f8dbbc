#include "render/graph/changed_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rebake {

namespace {

// Maximum number of changed tiles per texture that are compared texel by texel; with more, a whole frame is faster.
constexpr std::size_t max_tiles = 64;
// Share of the picture above which a whole frame is as fast, because partial frames run without occlusion culling.
constexpr double max_pixels = 1.0 / 3;

bool same_frame(const DecodeFrame& a, const DecodeFrame& b) {
  return a.decoder == b.decoder && a.alpha_code == b.alpha_code && a.world_to_decoder == b.world_to_decoder;
}

bool same_view(const View& a, const View& b) {
  return a.camera == b.camera && a.width == b.width && a.height == b.height && a.samples == b.samples;
}

bool same_but_texels(const Draw& a, const Draw& b) {
  const Soup &first = a.set.soup, &second = b.set.soup;
  const FeatureTexture &was = *a.set.texels, &is = *b.set.texels;
  return a.node == b.node && a.frame == b.frame && a.to_camera.matrix() == b.to_camera.matrix() && a.axes == b.axes &&
         a.selection == b.selection && a.first_triangle == b.first_triangle && a.light == b.light &&
         first.shared_positions() == second.shared_positions() && first.shared_uvs() == second.shared_uvs() &&
         first.shared_faces() == second.shared_faces() && first.rotations() == second.rotations() &&
         (&was == &is ||
          (was.width() == is.width() && was.height() == is.height() && was.alpha_code() == is.alpha_code()));
}

// Bounding rectangle of the changed texels per changed tile; nullopt if more than max_tiles tiles changed.
std::optional<std::vector<PixelRect>> changed_texels(const FeatureTexture& before, const FeatureTexture& now) {
  constexpr int size = TexelTile::size;
  std::vector<PixelRect> changed;
  for (int row = 0; row < now.tile_rows(); ++row)
    for (int column = 0; column < now.tile_columns(); ++column) {
      if (before.tile(column, row) == now.tile(column, row)) continue;
      const auto was = before.tile(column, row)->texels(), is = now.tile(column, row)->texels();
      PixelRect rect{size, size, 0, 0};
      for (int y = 0; y < size; ++y) {
        const auto first = static_cast<std::size_t>(y) * size;
        if (std::memcmp(&(*was)[first], &(*is)[first], size * sizeof(Texel)) == 0) continue;
        for (int x = 0; x < size; ++x)
          if (std::memcmp(&(*was)[first + static_cast<std::size_t>(x)], &(*is)[first + static_cast<std::size_t>(x)],
                          sizeof(Texel)) != 0)
            rect = join(rect, {x, y, x + 1, y + 1});
      }
      if (rect.empty()) continue;
      if (changed.size() == max_tiles) return std::nullopt;
      changed.push_back(
          {rect.left + column * size, rect.top + row * size, rect.right + column * size, rect.bottom + row * size});
    }
  return changed;
}

// Whether a triangle may show changed texels under nearest sampling, with a margin of one texel for rounding and
// clamping.
bool may_show(const std::array<Vec2, 3>& uvs, const FeatureTexture& texels, const std::vector<PixelRect>& changed) {
  const auto [left, right] = std::minmax({uvs[0].x(), uvs[1].x(), uvs[2].x()});
  const auto [low, high] = std::minmax({uvs[0].y(), uvs[1].y(), uvs[2].y()});
  const double x0 = std::min(left, 1.0) * texels.width() - 1, x1 = std::max(right, 0.0) * texels.width() + 1,
               y0 = (1 - std::max(high, 0.0)) * texels.height() - 1,
               y1 = (1 - std::min(low, 1.0)) * texels.height() + 1;
  return std::any_of(changed.begin(), changed.end(), [&](const PixelRect& rect) {
    return !(x1 < rect.left || x0 > rect.right || y1 < rect.top || y0 > rect.bottom);
  });
}

// Bounding rectangle of the pixels in which a draw may show changed texels.
PixelRect showing(const Draw& draw, const std::vector<PixelRect>& changed, const View& view) {
  const Soup& soup = draw.set.soup;
  PixelRect pixels;
  for (const Face& face : soup.faces()) {
    if (!may_show({soup.uvs()[face[0]], soup.uvs()[face[1]], soup.uvs()[face[2]]}, *draw.set.texels, changed)) continue;
    Box box;
    for (const std::uint32_t corner : face) box.extend(draw.to_camera * soup.positions()[corner]);
    if (const auto rect = projected(box, view)) pixels = join(pixels, *rect);
  }
  return pixels;
}

}  // namespace

ChangedPixels changed_pixels(const FramePlan* before, const FramePlan& now) {
  if (before == nullptr) return {std::nullopt, "no frame has been drawn yet"};
  if (!same_view(before->view, now.view) || before->options != now.options)
    return {std::nullopt, "the view or the options changed since the last frame"};
  if (now.guides.inspect != Guides::Inspect::none) return {std::nullopt, "triangles are inspected"};
  const bool same =
      before->overlays == now.overlays && before->guides == now.guides && before->background == now.background &&
      before->decoders == now.decoders &&
      std::equal(before->frames.begin(), before->frames.end(), now.frames.begin(), now.frames.end(), same_frame) &&
      std::equal(before->draws.begin(), before->draws.end(), now.draws.begin(), now.draws.end(), same_but_texels);
  if (!same) return {std::nullopt, "not only texels changed since the last frame"};
  PixelRect pixels;
  bool any = false;
  for (std::size_t k = 0; k < now.draws.size(); ++k) {
    if (before->draws[k].set.texels == now.draws[k].set.texels) continue;
    any = true;
    const auto changed = changed_texels(*before->draws[k].set.texels, *now.draws[k].set.texels);
    if (!changed) return {std::nullopt, "many texels changed since the last frame"};
    if (!changed->empty()) pixels = join(pixels, showing(now.draws[k], *changed, now.view));
  }
  // If the same frame is requested again, the caller wants it to be drawn.
  if (!any) return {std::nullopt, "nothing changed since the last frame"};
  pixels = around(pixels, mask_radius, now.view);
  const auto area = [](double width, double height) { return width * height; };
  if (area(pixels.right - pixels.left, pixels.bottom - pixels.top) > max_pixels * area(now.view.width, now.view.height))
    return {std::nullopt, "texels changed in much of the picture since the last frame"};
  return {pixels,
          fmt::format("texels changed since the last frame in {}×{} of {}×{} pixels; the other pixels are reused",
                      pixels.right - pixels.left, pixels.bottom - pixels.top, now.view.width, now.view.height)};
}

}  // namespace rebake
