#include <fmt/format.h>

#include <limits>
#include <set>

#include "editor/studies/study.h"
#include "editor/studies/study_soup.h"
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"

namespace rebake {

StudyTable study_wrap(const StudyInput& input) {
  const StudySoup soup = study_soup(input.scene);
  StudyTable table{
      {"wrap ms", "bind ms", "points", "faces", "components", "volume / box volume"}, {}, 0, 5, true, false};
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
    const std::vector<std::uint32_t> component = components(cage);
    table.rows.push_back(
        {fmt::format("{}", coarseness),
         {time, bind, static_cast<double>(cage.vertices.size()), static_cast<double>(cage.faces.size()),
          static_cast<double>(std::set(component.begin(), component.end()).size()),
          // A flat object's box has no volume to compare with.
          box.volume() > 0 ? volume(cage) / box.volume() : std::numeric_limits<double>::quiet_NaN()}});
  }
  return table;
}

}  // namespace rebake
