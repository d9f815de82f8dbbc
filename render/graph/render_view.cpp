#include "render/graph/render_view.h"

#include "mesh_ops/base/error.h"

namespace rebake {

void check(const View& view) {
  if (view.width < 1 || view.width > 16384 || view.height < 1 || view.height > 16384)
    throw FieldError("size", "must be 1 to 16384 pixels per side");
  if (view.samples != 1 && view.samples != 4 && view.samples != 16 && view.samples != 64)
    throw FieldError("samples", "must be 1, 4 or 16 (or 64 for references)");
  check(view.camera);
  if (!(view.camera.near_plane > 0)) throw FieldError("near", "must be greater than 0");
  if (!(view.camera.far_plane > view.camera.near_plane)) throw FieldError("far", "must be greater than near");
}

}  // namespace rebake
