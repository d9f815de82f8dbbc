#include "editor/studies/study_soup.h"

#include <map>

#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/bends/closed_form.h"
#include "mesh_ops/index/index.h"

namespace rebake {

StudySoup study_soup(const Scene& scene) {
  StudySoup soup;
  Box box;
  std::map<std::array<double, 3>, std::uint8_t> seen;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    const auto traits = traits_of(*placed.node->object);
    std::size_t f = 0;
    for (const TextureSet& set : placed.node->object->sets) {
      const auto base = static_cast<std::uint32_t>(soup.opaque.points.size());
      for (const Vec3& p : set.soup.positions()) soup.opaque.points.push_back(placed.to_world * p);
      for (const Face& face : set.soup.faces()) {
        if ((*traits)[f++].opacity <= 0) continue;
        soup.opaque.faces.push_back({face[0] + base, face[1] + base, face[2] + base});
        for (const std::uint32_t v : soup.opaque.faces.back()) {
          const Vec3& p = soup.opaque.points[v];
          if (seen.emplace(std::array{p.x(), p.y(), p.z()}, std::uint8_t{1}).second) soup.places.push_back(p);
          box.extend(p);
        }
      }
    }
  }
  if (soup.places.empty())
    throw Error("the scene has no visible opaque triangle to deform; pass another one with --scene");
  soup.diagonal = box.diagonal().norm();
  return soup;
}

std::vector<Vec3> twisted(const Cage& cage) {
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  ClosedForm form;
  form.kind = ClosedForm::Kind::twist;
  form.origin = box.center();
  form.from = box.min().y() - box.center().y();
  form.to = box.max().y() - box.center().y();
  form.radians = 1;
  std::vector<Vec3> moved;
  for (const Vec3& v : cage.vertices) moved.push_back(deform(form, v).point);
  return moved;
}

}  // namespace rebake
