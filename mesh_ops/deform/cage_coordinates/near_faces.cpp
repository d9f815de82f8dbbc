#include "mesh_ops/deform/cage_coordinates/near_faces.h"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>
#include <optional>

namespace rebake {

namespace {

namespace pl = plane_local;

// If all faces are farther than this, double separates inside from outside and preserves eight digits of a gradient.
constexpr double wide_green_distance = 1e-8;
// Nearer to a face than this, the weights are those of the surface: they change by less than rounding.
constexpr double on_surface = 1e-30;
// Gradients on the surface are taken this far inside: thin cages are thicker, and 50 digits compensate the
// cancellation.
constexpr double depth_inside = 1e-20;
// Such points are at least this share of that depth from all faces.
constexpr double least_share = 1e-10;
// A face counts as containing a 50-digit point if it is no farther from it than this.
constexpr double wide_rounding = 1e-40;

template <class T>
pl::Seen<T> seen_from(const WideFace& face, const pl::Point<T>& place) {
  std::array<pl::Point<T>, 3> offsets;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) offsets[k][axis] = T(face.corners[k][axis]) - place[axis];
  return pl::seen(face.frame, offsets);
}

std::vector<WideFace> wide_faces(const CageFrame& cage, std::span<const FaceFrame* const> near) {
  std::vector<WideFace> faces;
  for (const FaceFrame* face : near) faces.push_back(wide_face(cage, *face));
  return faces;
}

WidePoint moved(const WidePoint& from, const WidePoint& along, const Wide& share) {
  WidePoint result;
  for (std::size_t axis = 0; axis < 3; ++axis) result[axis] = from[axis] + along[axis] * share;
  return result;
}

// Twice the tolerance that decides whether a point counts as on the surface, so that every such point is found here.
const double snap_distance = 2 * pl::surface_tolerance<double>;

// The nearest point of edge k.
WidePoint nearest_of_edge(const WideFace& face, const pl::Seen<Wide>& s, std::size_t k) {
  const std::array<Wide, 3>&a = face.corners[(k + 1) % 3], &b = face.corners[(k + 2) % 3];
  if (s.begin[k] >= 0) return a;
  if (s.end[k] <= 0) return b;
  WidePoint along;
  for (std::size_t axis = 0; axis < 3; ++axis) along[axis] = b[axis] - a[axis];
  return moved(a, along, Wide(-s.begin[k] / face.frame.lengths[k]));
}

// The point of the surface that `point` is taken for if it lies within snap_distance: the nearest corner, else the
// nearest point of an edge, else of a face.
std::optional<WidePoint> snapped(const std::vector<WideFace>& faces, const WidePoint& point) {
  constexpr std::size_t corner = 0, edge = 1, face_interior = 2, kinds = 3;
  std::array<std::optional<WidePoint>, kinds> nearest;
  std::array<double, kinds> least;
  least.fill(snap_distance);
  const auto offer = [&](std::size_t kind, double distance, const WidePoint& place) {
    if (distance > least[kind]) return;
    least[kind] = distance;
    nearest[kind] = place;
  };
  for (const WideFace& face : faces) {
    const pl::Seen<Wide> s = seen_from(face, point);
    if (pl::distance_of(s) > snap_distance) continue;
    if (pl::distance_in_plane(s) == 0)
      offer(face_interior, std::abs(value_of(s.h)), moved(point, face.frame.normal, s.h));
    for (std::size_t k = 0; k < 3; ++k) {
      offer(corner, value_of(s.r[k]), face.corners[k]);
      const double beyond = std::max({0.0, value_of(s.begin[k]), -value_of(s.end[k])});
      offer(edge, std::hypot(value_of(s.c[k]), beyond), nearest_of_edge(face, s, k));
    }
  }
  for (const auto& place : nearest)
    if (place) return place;
  return std::nullopt;
}

// The angle of the face at a point of it: the angle of the corner at a corner, else 1.
double angle_at(const WideFace& face, const pl::Seen<Wide>& s) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (value_of(s.r[k]) > wide_rounding) continue;
    // Corner k lies between edges i and j.
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const FaceFrameOf<Wide>& f = face.frame;
    return real::atan2(std::abs(static_cast<double>(Wide(f.edge_t[i] * f.edge_o[j] - f.edge_o[i] * f.edge_t[j]))),
                       static_cast<double>(Wide(-(f.edge_t[i] * f.edge_t[j] + f.edge_o[i] * f.edge_o[j]))));
  }
  return 1;
}

// Whether the segment between two points passes through the face.
bool passes(const WideFace& face, const WidePoint& from, const WidePoint& to) {
  const auto above = [&](const WidePoint& p) { return dot(minus(p, face.corners[0]), face.frame.normal) > 0; };
  if (above(from) == above(to)) return false;
  const WidePoint along = minus(to, from);
  std::array<bool, 3> left;
  for (std::size_t k = 0; k < 3; ++k)
    left[k] = dot(along, cross(minus(face.corners[k], from), minus(face.corners[(k + 1) % 3], from))) > 0;
  return left[0] == left[1] && left[1] == left[2];
}

// A point just inside, beside a face that contains a point of the surface.
struct Beside {
  WidePoint place;
  double clearance = 0;  // distance of its projection from the face's edges
};

// Over the interior of the face, far closer to it than to others. Not on its symmetry axis, where segments might pass
// through edges.
Beside beside(const WideFace& face, const WidePoint& on) {
  WidePoint into = minus({Wide(0), Wide(0), Wide(0)}, on);
  for (const auto& [corner, share] : {std::pair(0, 0.523), std::pair(1, 0.291), std::pair(2, 0.186)})
    into = moved(into, face.corners[static_cast<std::size_t>(corner)], Wide(share));
  const Wide length = sqrt(dot(into, into));
  const WidePoint over = length > 0 ? moved(on, into, Wide(depth_inside / length)) : on;
  const pl::Seen<Wide> s = seen_from(face, over);
  return {moved(over, face.frame.normal, Wide(-depth_inside * least_share)),
          std::min({value_of(s.a[0]), value_of(s.a[1]), value_of(s.a[2])})};
}

// For a point on the surface, a point just inside; otherwise nothing. In the direction of the angle-weighted normal of
// the faces that meet, which is inside at most corners (Bærentzen, Aanæs 2005); not where parts of the cage touch, nor
// at the tip of a cone that does not contain its mean direction. There, beside the face with most clearance, which
// slivers do not have.
std::optional<WidePoint> point_just_inside(const std::vector<WideFace>& faces, const WidePoint& point) {
  const std::optional<WidePoint> on = snapped(faces, point);
  if (!on) return std::nullopt;
  WidePoint normal{Wide(0), Wide(0), Wide(0)};
  Beside inside{*on};
  for (const WideFace& face : faces) {
    const pl::Seen<Wide> s = seen_from(face, *on);
    if (pl::distance_of(s) > wide_rounding) continue;
    normal = moved(normal, face.frame.normal, Wide(angle_at(face, s)));
    if (const Beside one = beside(face, *on); one.clearance > inside.clearance) inside = one;
  }
  const Wide length = sqrt(dot(normal, normal));
  if (!(length > 0)) return inside.place;
  const WidePoint below = moved(*on, normal, Wide(-depth_inside / length));
  // Along an edge where parts touch, or outside.
  const bool is_close = std::any_of(faces.begin(), faces.end(), [&](const WideFace& face) {
    return pl::distance_of(seen_from(face, below)) < least_share * depth_inside;
  });
  const auto between = std::count_if(faces.begin(), faces.end(),
                                     [&](const WideFace& face) { return passes(face, inside.place, below); });
  return is_close || between % 2 != 0 ? inside.place : below;
}

// The point where gradients are taken: just inside for points on the surface.
WidePoint gradient_point(const std::vector<WideFace>& faces, const WidePoint& point) {
  return point_just_inside(faces, point).value_or(point);
}

pl::Point<WideDual> with_gradients(const WidePoint& place) {
  return {WideDual(place[0], 1, 0, 0), WideDual(place[1], 0, 1, 0), WideDual(place[2], 0, 0, 1)};
}

template <class T>
void add_terms(const WideFace& face, const pl::Seen<T>& s, std::vector<T>& sums) {
  const std::array<T, 3> terms = pl::mean_value(face.frame, s);
  for (std::size_t k = 0; k < 3; ++k) sums[face.frame.vertices[k]] += terms[k];
}

// Where parts with separate vertices touch, only the sum of the gradients of equal vertices is finite. The first one
// gets it. `inside`: the point just inside.
void join_equal_vertices(const CageFrame& cage, const std::vector<WideFace>& faces, const WidePoint& inside,
                         std::vector<WideDual>& gradients) {
  std::vector<std::uint32_t> vertices;
  for (const WideFace& face : faces)
    if (pl::distance_of(seen_from(face, inside)) <= 2 * depth_inside)
      vertices.insert(vertices.end(), face.frame.vertices.begin(), face.frame.vertices.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (std::size_t k = 1; k < vertices.size(); ++k) {
    const auto equal = std::find_if(vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(k),
                                    [&](std::uint32_t v) { return cage.given[v] == cage.given[vertices[k]]; });
    if (equal == vertices.begin() + static_cast<std::ptrdiff_t>(k)) continue;
    gradients[*equal] += gradients[vertices[k]];
    gradients[vertices[k]] = WideDual(Wide(0));
  }
}

}  // namespace

std::vector<Wide> near_faces::wide_values(const CageFrame& cage, const WidePoint& point,
                                          std::span<const FaceFrame* const> near, std::vector<Wide> sums,
                                          double& divisor) {
  for (const WideFace& face : wide_faces(cage, near)) {
    const pl::Seen<Wide> s = seen_from(face, point);
    if (pl::distance_of(s) <= on_surface) {
      sums.assign(sums.size(), Wide(0));
      const std::array<Wide, 3> lambda = pl::barycentric(face.frame, s);
      for (std::size_t k = 0; k < 3; ++k) sums[face.frame.vertices[k]] = lambda[k];
      divisor = std::numeric_limits<double>::infinity();
      return sums;
    }
    add_terms(face, s, sums);
  }
  divisor = normalise(sums);
  return sums;
}

std::vector<WideDual> near_faces::wide_gradients(const CageFrame& cage, const WidePoint& point,
                                                 std::span<const FaceFrame* const> near, std::vector<WideDual> sums) {
  const std::vector<WideFace> faces = wide_faces(cage, near);
  const std::optional<WidePoint> inside = point_just_inside(faces, point);
  const pl::Point<WideDual> place = with_gradients(inside.value_or(point));
  for (const WideFace& face : faces) add_terms(face, seen_from(face, place), sums);
  normalise(sums);
  if (inside) join_equal_vertices(cage, faces, *inside, sums);
  return sums;
}

namespace {

// The near faces with 50 digits; empty if double is enough.
std::vector<WideFace> faces_beyond_double(const CageFrame& cage, const WidePoint& exact,
                                          std::span<const FaceFrame* const> near) {
  const pl::Point<double> local{static_cast<double>(exact[0]), static_cast<double>(exact[1]),
                                static_cast<double>(exact[2])};
  double least = std::numeric_limits<double>::infinity();
  for (const FaceFrame* face : near) least = std::min(least, pl::distance_of(pl::seen(cage, *face, local)));
  if (!(least < wide_green_distance)) return {};
  if (near.size() == 1 && near_faces::is_over(pl::seen(cage, *near.front(), local))) return {};
  return wide_faces(cage, near);
}

}  // namespace

WideGreen wide_green(const CageFrame& cage, const WidePoint& exact, std::span<const FaceFrame* const> near) {
  WideGreen result;
  const std::vector<WideFace> faces = faces_beyond_double(cage, exact, near);
  if (faces.empty()) return result;
  const auto sum_at = [&](const WidePoint& place, std::vector<pl::GreenTerms<Wide>>* terms) {
    Wide sum = 0;
    for (const WideFace& face : faces) {
      const pl::GreenTerms<Wide> of_face = pl::green(face.frame, seen_from(face, place));
      for (const Wide& corner : of_face.corners) sum += corner;
      if (terms != nullptr) terms->push_back(of_face);
    }
    return static_cast<double>(Wide(sum / (4 * boost::math::constants::pi<Wide>())));
  };
  result.sum = result.sum_inside = sum_at(exact, &result.terms);
  if (const auto inside = point_just_inside(faces, exact)) result.sum_inside = sum_at(*inside, nullptr);
  return result;
}

std::vector<pl::GreenTerms<WideDual>> wide_green_gradients(const CageFrame& cage, const WidePoint& exact,
                                                           std::span<const FaceFrame* const> near) {
  const std::vector<WideFace> faces = faces_beyond_double(cage, exact, near);
  const pl::Point<WideDual> place = with_gradients(gradient_point(faces, exact));
  std::vector<pl::GreenTerms<WideDual>> terms;
  for (const WideFace& face : faces) terms.push_back(pl::green(face.frame, seen_from(face, place)));
  return terms;
}

}  // namespace rebake
