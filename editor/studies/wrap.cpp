#include <fmt/format.h>

#include <numeric>

#include "editor/studies/deforming.h"
#include "editor/studies/study.h"
#include "mesh_ops/deform/cage_deformation.h"

namespace rebake {

namespace {

std::size_t components(const Cage& cage) {
  std::vector<std::uint32_t> parent(cage.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::size_t count = parent.size();
  for (const Face& face : cage.faces)
    for (std::size_t k = 1; k < 3; ++k)
      if (const std::uint32_t a = root(face[0]), b = root(face[k]); a != b) {
        parent[b] = a;
        --count;
      }
  return count;
}

}  // namespace

StudyTable study_wrap(const StudyInput& input) {
  const StudySoup soup = study_soup(input.scene);
  StudyTable table{{"wrap ms", "bind ms", "points", "faces", "components", "volume, in boxes"}, {}, 0, 5, true, false};
  Box box;
  for (const Vec3& p : soup.places) box.extend(p);
  for (const double coarseness : {0.3, 0.2, 0.1, 0.05, 0.03, 0.02}) {
    input.progress.at("wraps", static_cast<double>(table.rows.size()) / 6);
    Cage cage;
    const double time = median_milliseconds(std::min(input.frames, 3), [&] { cage = wrap(soup.opaque, coarseness); });
    const double bind = median_milliseconds(1, [&] {
      const auto coordinates = mean_value_coordinates(cage);
      deform_points(*coordinates, cage, cage.vertices, soup.places, false);
    });
    table.rows.push_back(
        {fmt::format("{}", coarseness),
         {time, bind, static_cast<double>(cage.vertices.size()), static_cast<double>(cage.faces.size()),
          static_cast<double>(components(cage)), volume(cage) / box.volume()}});
  }
  return table;
}

}  // namespace rebake
