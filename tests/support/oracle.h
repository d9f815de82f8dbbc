#pragma once

#include "mesh_ops/scene/scene.h"
#include "render/graph/view.h"
#include "render/image.h"

namespace rebake::test {

/// The rendering rule of format.md, cast with rays and shaded in double precision. Shares no code with the GPU's way
/// but the loader and the scene's types: it says what a picture must look like.
Image cast_picture(const Scene& scene, const View& view);

}  // namespace rebake::test
