#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <limits>

#include "editor/studies/hard_points.h"
#include "editor/studies/study.h"
#include "editor/studies/study_soup.h"
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"

namespace rebake {

namespace {

constexpr std::size_t error_sample_count = 1000;  ///< number of points for which errors are measured

// At most error_sample_count of the places, evenly spaced in the list.
std::vector<Vec3> judged(const std::vector<Vec3>& places) {
  std::vector<Vec3> points;
  const std::size_t count = std::min(error_sample_count, places.size());
  for (std::size_t k = 0; k < count; ++k) points.push_back(places[k * places.size() / count]);
  return points;
}

/// A deformation by a cage, and the points for which errors are measured.
struct Setting {
  double diagonal;  ///< of the scene, unit of errors
  const Cage& cage;
  std::vector<Vec3> moved;  ///< vertices of the deformed cage
  std::vector<Vec3> points;
};

// Largest distance between corresponding points, as a multiple of `unit`.
double largest(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double unit) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, (a[k] - b[k]).norm() / unit);
  return worst;
}

// Positions of the deformed points, from weights computed point by point with numbers of type T.
template <class T>
std::vector<Vec3> moved_by(const Setting& setting, const Coordinates& coordinates, bool green) {
  const CageFrame frame = frame_of(setting.cage);
  const std::vector<Vec3> motions = coordinates.row_motions(setting.cage, setting.moved);
  std::vector<Vec3> result(setting.points.size());
  tbb::parallel_for(std::size_t{0}, result.size(), [&](std::size_t k) {
    std::vector<T> weights, faces;
    if (green) {
      green_weights(frame, setting.points[k], setting.cage.faces.size(), weights, faces);
      weights.insert(weights.end(), faces.begin(), faces.end());
    } else {
      mean_value_weights(frame, frame.to_local(setting.points[k]), weights);
    }
    std::array<T, 3> sum{};
    for (std::size_t row = 0; row < weights.size(); ++row)
      for (std::size_t axis = 0; axis < 3; ++axis)
        sum[axis] += weights[row] * static_cast<T>(motions[row][static_cast<int>(axis)]);
    result[k] =
        setting.points[k] + Vec3(static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2]));
  });
  return result;
}

// Error of linear reproduction: if the cage shrinks to the origin, all points must end there. Returns the largest
// distance from it, as a share of the diagonal.
double reproduction(const Setting& setting, const Coordinates& coordinates) {
  const std::vector<Vec3> nowhere(setting.cage.vertices.size(), Vec3(0, 0, 0));
  const std::vector<Vec3> motions = coordinates.row_motions(setting.cage, nowhere);
  const DeformedPoints result = deform_points(coordinates, setting.cage, nowhere, setting.points, false);
  double worst = 0;
  for (std::size_t k = 0; k < setting.points.size(); ++k)
    if (result.outside[k] == 0) worst = std::max(worst, result.points[k].norm() / setting.diagonal);
  return worst;
}

// As reproduction(), for weights computed point by point with numbers of type T.
template <class T>
double single_reproduction(const Setting& setting, const Coordinates& coordinates, bool green) {
  Setting shrunk = setting;
  shrunk.moved.assign(setting.cage.vertices.size(), Vec3(0, 0, 0));
  double worst = 0;
  for (const Vec3& p : moved_by<T>(shrunk, coordinates, green)) worst = std::max(worst, p.norm() / setting.diagonal);
  return worst;
}

// Largest error at hard_points(), with weights computed in double, or in float if `single`. NaN for harmonic
// coordinates, whose grids reject cages as thin as these.
double hard_error(CageCoordinates kind, int resolution, bool single) {
  if (kind == CageCoordinates::harmonic) return std::numeric_limits<double>::quiet_NaN();
  double worst = 0;
  for (const HardPoints& hard : hard_points()) {
    const auto coordinates = coordinates_of(hard.cage, kind, resolution);
    if (single) {
      const Setting setting{1, hard.cage, hard.moved, hard.points};
      const auto moved = moved_by<float>(setting, *coordinates, kind == CageCoordinates::green);
      worst = std::max(worst, largest_error(hard, moved, nullptr));
    } else {
      const DeformedPoints moved = deform_points(*coordinates, hard.cage, hard.moved, hard.points, false);
      worst = std::max(worst, largest_error(hard, moved.points, &moved.outside));
    }
  }
  return worst;
}

// Largest error at hard_points() with the weights that CageBinding stores as float.
double stored_hard_error(CageCoordinates kind, int resolution) {
  double worst = 0;
  for (const HardPoints& hard : hard_points()) {
    const auto coordinates = coordinates_of(hard.cage, kind, resolution);
    std::vector<Vec3> moved;
    CageBinding(*coordinates, hard.cage, hard.points).positions(hard.moved, moved);
    const auto outside = deform_points(*coordinates, hard.cage, hard.moved, hard.points, false).outside;
    worst = std::max(worst, largest_error(hard, moved, &outside));
  }
  return worst;
}

}  // namespace

StudyTable study_cage(const StudyInput& input) {
  const StudySoup soup = study_soup(input.scene);
  const Cage cage = wrap(soup.opaque, 0.1);
  const Setting setting{soup.diagonal, cage, twisted(cage), judged(soup.places)};
  StudyTable table{{"bind ms", "drag ms", "MB", "reproduction error", "deformation error", "error at hard points"},
                   {},
                   0,
                   4,
                   true,
                   true};
  const auto add = [&](const std::string& name, CageCoordinates kind, int resolution,
                       const std::vector<Vec3>& reference) {
    input.progress.at(name, static_cast<double>(table.rows.size()) / 9);
    std::unique_ptr<Coordinates> coordinates;
    std::unique_ptr<CageBinding> binding;
    const double bind = median_milliseconds(kind == CageCoordinates::mean_value ? std::min(input.frames, 3) : 1, [&] {
      coordinates = coordinates_of(cage, kind, resolution);
      binding = std::make_unique<CageBinding>(*coordinates, cage, soup.places);
    });
    std::vector<Vec3> out;
    const double drag = median_milliseconds(input.frames, [&] { binding->positions(setting.moved, out); });
    const DeformedPoints exact = deform_points(*coordinates, cage, setting.moved, setting.points, false);
    table.rows.push_back(
        {name + ", double",
         {bind, drag, static_cast<double>(binding->memory()) / 1e6, reproduction(setting, *coordinates),
          largest(exact.points, reference, soup.diagonal), hard_error(kind, resolution, false)}});
    if (kind == CageCoordinates::harmonic) return;
    // With weights stored as float (CageBinding), as while a cage is dragged.
    const CageBinding kept(*coordinates, cage, setting.points);
    kept.positions(setting.moved, out);
    std::vector<Vec3> nowhere;
    kept.positions(std::vector<Vec3>(cage.vertices.size(), Vec3(0, 0, 0)), nowhere);
    double lost = 0;
    for (const Vec3& p : nowhere) lost = std::max(lost, p.norm() / soup.diagonal);
    table.rows.push_back({name + ", stored as float",
                          {bind, drag, static_cast<double>(binding->memory()) / 1e6, lost,
                           largest(out, reference, soup.diagonal), stored_hard_error(kind, resolution)}});
    // With weights computed in float, point by point.
    const bool green = kind == CageCoordinates::green;
    const double single = median_milliseconds(1, [&] { moved_by<float>(setting, *coordinates, green); }) *
                          static_cast<double>(soup.places.size()) / static_cast<double>(setting.points.size());
    table.rows.push_back({name + ", computed in float",
                          {single, drag, static_cast<double>(binding->memory()) / 1e6,
                           single_reproduction<float>(setting, *coordinates, green),
                           largest(moved_by<float>(setting, *coordinates, green), reference, soup.diagonal),
                           hard_error(kind, resolution, true)}});
  };
  add("mean value", CageCoordinates::mean_value, 0,
      moved_by<long double>(setting, *mean_value_coordinates(cage), false));
  add("Green", CageCoordinates::green, 0, moved_by<long double>(setting, *green_coordinates(cage), true));
  const auto finest = harmonic_coordinates(cage, 96, input.progress);
  const std::vector<Vec3> reference = deform_points(*finest, cage, setting.moved, setting.points, false).points;
  for (const int resolution : {16, 32, 64})
    add(fmt::format("harmonic {}", resolution), CageCoordinates::harmonic, resolution, reference);
  return table;
}

}  // namespace rebake
