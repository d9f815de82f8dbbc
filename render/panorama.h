#pragma once

#include "render/picture.h"

namespace rebake {

/// A picture of all directions from a point, equirectangular: the column gives the angle about `up` from −180° to 180°,
/// the row the angle above the horizon from 90° to −90°; the middle looks from the eye towards the target, level. Six
/// pictures of 90° are resampled bilinearly (1.57 of their pixels per pixel at the horizon), so a pixel differs from an
/// exact one by less than the colours change within a pixel. `view.width` must be twice `view.height`. Throws
/// FieldError.
Image render_panorama(Renderer& renderer, const Scene& scene, const View& view, const RenderOptions& options,
                      const Lighting* lighting);

}  // namespace rebake
