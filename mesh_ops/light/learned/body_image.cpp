#include "mesh_ops/light/learned/body_image.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <map>

#include "mesh_ops/deform/cages/wrap.h"
#include "mesh_ops/index/opacity.h"

namespace rebake {

namespace {

TriangleList opaque_triangles(const BakedObject& object) {
  TriangleList list;
  for (const TextureSet& set : object.sets) {
    const std::vector<std::uint8_t> shows = faces_with_opaque_texels(set);
    const auto first = static_cast<std::uint32_t>(list.points.size());
    list.points.insert(list.points.end(), set.soup.positions().begin(), set.soup.positions().end());
    for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
      const Face& face = set.soup.faces()[f];
      if (shows[f] != 0) list.faces.push_back({first + face[0], first + face[1], first + face[2]});
    }
  }
  return list;
}

}  // namespace

ProxyMesh largest_component(const Cage& whole) {
  const std::vector<std::uint32_t> component = components(whole);
  std::map<std::uint32_t, std::size_t> sizes;
  for (const std::uint32_t c : component) ++sizes[c];
  const std::uint32_t largest = std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
                                  return a.second < b.second;
                                })->first;
  ProxyMesh mesh;
  std::vector<std::uint32_t> number(whole.vertices.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    number[v] = static_cast<std::uint32_t>(mesh.vertices.size());
    if (component[v] == largest) mesh.vertices.push_back(whole.vertices[v]);
  }
  for (const Face& face : whole.faces)
    if (component[face[0]] == largest) mesh.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
  return mesh;
}

BodyImage body_image(const BakedObject& object, const std::vector<LightSite>& sites, const std::vector<float>& facing,
                     double coarseness, const Progress& progress) {
  BodyImage image;
  const TriangleList opaque = opaque_triangles(object);
  // A fine wrap of loose parts has several components, but only one can be parametrised. The wrap is coarsened until
  // its largest component has 90 % of the vertices.
  constexpr double one_piece = 0.9, coarser = 1.4, coarsest = 0.3;
  for (double size = coarseness;; size = std::min(coarser * size, coarsest)) {
    const Cage whole = wrap(opaque, size, progress);
    image.mesh = largest_component(whole);
    const auto share = static_cast<double>(image.mesh.vertices.size()) / static_cast<double>(whole.vertices.size());
    if (share >= one_piece || size >= coarsest) break;
  }
  image.chart = disk_chart(image.mesh);
  const std::vector<LightSite> around =
      vertex_sites(image.mesh, image.mesh, std::vector<Mat3>(image.mesh.vertices.size(), Mat3::Identity()));
  image.sites.resize(around.size());
  tbb::parallel_for(std::size_t{0}, around.size(), [&](std::size_t v) {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < sites.size(); ++i) {
      const Vec3 normal = facing[i] == 0.0F ? Vec3(-sites[i].normal) : sites[i].normal;
      // Leaves overlap leaves of opposite orientation, so such a site counts as twice as far away.
      const double distance =
          (sites[i].position - around[v].position).squaredNorm() * (2.5 - 1.5 * normal.dot(around[v].normal));
      if (!(distance < least)) continue;
      least = distance;
      image.sites[v] = i;
    }
  });
  return image;
}

}  // namespace rebake
