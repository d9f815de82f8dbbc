#include "editor/studies/folder_size.h"

#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/obj.h"

namespace rebake {

double folder_megabytes(const Scene& scene) {
  std::uint64_t bytes = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object || !placed.visible) continue;
    for (const TextureSet& set : placed.node->object->sets) {
      const Soup& soup = set.soup;
      bytes += write_obj(soup.positions(), soup.uvs(), soup.faces(), 0, soup.faces().size()).size();
      for (const int image : {0, 1}) bytes += write_feature_png(*set.texels, image).size();
    }
  }
  return static_cast<double>(bytes) / 1e6;
}

std::size_t triangles_in(const Scene& scene) {
  std::size_t triangles = 0;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object && placed.visible) triangles += placed.node->object->triangle_count();
  return triangles;
}

}  // namespace rebake
