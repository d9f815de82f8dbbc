#pragma once

#include "mesh_ops/scene/scene.h"
#include "render/graph/render_view.h"
#include "render/image.h"

namespace rebake::test {

/// Reference picture: MobileNeRF's rendering rule by ray casting, shaded in double precision. Shares no code with the
/// GPU renderer except the loader and the scene types.
Image cast_picture(const Scene& scene, const View& view);

}  // namespace rebake::test
