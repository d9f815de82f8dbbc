#include "mesh_ops/deform/near_faces.h"

#include "mesh_ops/deform/far_quadrature.h"
#include "mesh_ops/deform/wide_frame.h"

namespace rebake {

namespace {

namespace pl = plane_local;
using WideDual = DualOf<Quad>;

// Nearer than this to an edge, double leaves less than eight digits of a gradient.
constexpr double quad_distance = 1e-8;
// A point nearer than this lies on the surface, or on an edge or corner of it, and its gradients are taken so far
// inside.
constexpr double on_surface = 1e-12;
constexpr double depth_inside = 1e-13;

template <class T>
bool is_over(const pl::Seen<T>& s) {
  const double height = std::abs(value_of(s.h));
  return value_of(s.a[0]) > height && value_of(s.a[1]) > height && value_of(s.a[2]) > height;
}

double least_distance(const CageFrame& cage, const Vec3& local, std::span<const FaceFrame* const> near) {
  double least = std::numeric_limits<double>::infinity();
  for (const FaceFrame* face : near)
    least = std::min(least, distance_of(pl::seen(cage, *face, pl::local_point(local, 0.0))));
  return least;
}

template <class T>
Vec3 values_of(const pl::Point<T>& p) {
  return {value_of(p[0]), value_of(p[1]), value_of(p[2])};
}

// The edge or corner that the point lies on, exactly: a gradient depends on the direction from there, and a point in
// doubles is 1e-17 beside it.
std::array<Quad, 3> snapped(const CageFrame& cage, const Vec3& local, std::span<const FaceFrame* const> near) {
  const std::array<Quad, 3> point{Quad(local.x()), Quad(local.y()), Quad(local.z())};
  std::array<Quad, 3> result = point;
  for (const FaceFrame* face : near) {
    const pl::Seen<double> s = pl::seen(cage, *face, pl::local_point(local, 0.0));
    if (distance_of(s) > on_surface) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      if (s.r[k] <= on_surface) return wide_face(cage, *face).corners[k];
      if (s.c[k] > on_surface) continue;
      const WideFace wide = wide_face(cage, *face);
      const auto &a = wide.corners[(k + 1) % 3], &b = wide.corners[(k + 2) % 3];
      Quad along = 0, square = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        along += (point[axis] - a[axis]) * (b[axis] - a[axis]);
        square += (b[axis] - a[axis]) * (b[axis] - a[axis]);
      }
      for (std::size_t axis = 0; axis < 3; ++axis) result[axis] = a[axis] + (b[axis] - a[axis]) * (along / square);
    }
  }
  return result;
}

// Where to take gradients: the point itself, or inside beside it where it lies on the surface. The direction is the
// normal weighed by the angles under which the faces meet there, which points outwards at every corner (Bærentzen,
// Aanæs 2005).
pl::Point<WideDual> gradient_place(const CageFrame& cage, const Vec3& local, std::span<const FaceFrame* const> near) {
  Vec3 normal(0, 0, 0);
  for (const FaceFrame* face : near) {
    const pl::Seen<double> s = pl::seen(cage, *face, pl::local_point(local, 0.0));
    if (distance_of(s) > on_surface) continue;
    double angle = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      if (s.r[k] > on_surface) continue;
      // Corner k lies between edges i and j.
      angle = real::atan2(std::abs(face->edge_t[i] * face->edge_o[j] - face->edge_o[i] * face->edge_t[j]),
                          -(face->edge_t[i] * face->edge_t[j] + face->edge_o[i] * face->edge_o[j]));
    }
    normal += angle * Vec3(face->normal[0], face->normal[1], face->normal[2]);
  }
  std::array<Quad, 3> place{Quad(local.x()), Quad(local.y()), Quad(local.z())};
  if (normal.norm() > 0) {
    place = snapped(cage, local, near);
    for (std::size_t axis = 0; axis < 3; ++axis)
      place[axis] -= Quad(normal[static_cast<int>(axis)]) * (Quad(depth_inside) / Quad(normal.norm()));
  }
  return {WideDual(place[0], 1, 0, 0), WideDual(place[1], 0, 1, 0), WideDual(place[2], 0, 0, 1)};
}

pl::Seen<WideDual> seen_from(const WideFace& face, const pl::Point<WideDual>& place) {
  std::array<pl::Point<WideDual>, 3> offsets;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) offsets[k][axis] = WideDual(face.corners[k][axis]) - place[axis];
  return pl::seen(face.frame, offsets);
}

template <class R>
void set_gradient(DualOf<R>& to, const WideDual& from) {
  to.x = static_cast<R>(from.x);
  to.y = static_cast<R>(from.y);
  to.z = static_cast<R>(from.z);
}

template <class R>
void set_gradients(const CageFrame& cage, const Vec3& local, std::span<const FaceFrame* const> near,
                   const std::vector<DualOf<R>>& others, std::vector<DualOf<R>>& weights) {
  const pl::Point<WideDual> place = gradient_place(cage, local, near);
  std::vector<WideDual> sums(weights.size());
  WideDual total;
  for (std::size_t v = 0; v < sums.size(); ++v) {
    sums[v] = {Quad(others[v].v), Quad(others[v].x), Quad(others[v].y), Quad(others[v].z)};
    total += sums[v];
  }
  for (const FaceFrame* face : near) {
    const WideFace wide = wide_face(cage, *face);
    const auto terms = pl::mean_value(wide.frame, seen_from(wide, place));
    for (std::size_t k = 0; k < 3; ++k) {
      sums[face->vertices[k]] += terms[k];
      total += terms[k];
    }
  }
  for (std::size_t v = 0; v < sums.size(); ++v) set_gradient(weights[v], sums[v] / total);
}

template <class T>
void normalise(std::vector<T>& weights) {
  T total = pl::constant<T>(0);
  for (const T& weight : weights) total += weight;
  for (T& weight : weights) weight = weight / total;
}

// The one face that the point is over, or on.
template <class T>
void add_face_below(const FaceFrame& face, pl::Seen<T> s, std::vector<T>& weights) {
  // Rounding's height: to the face's weights it is none, to their gradients it is the height's own.
  if (pl::place(s) == pl::Place::on_face) s.h = s.h - pl::constant<T>(value_of(s.h));
  const pl::OverFace<T> over = pl::over_face(face, s);
  T total = pl::constant<T>(0);
  for (const T& weight : weights) total += weight;
  const T divisor = pl::constant<T>(1) + over.width * total;
  for (T& weight : weights) weight = over.width * weight / divisor;
  for (std::size_t k = 0; k < 3; ++k)
    weights[face.vertices[k]] += (over.lambda[k] + over.width * over.rest[k]) / divisor;
}

// Without regard to what gradients lose.
template <class T>
void add_faces(const CageFrame& cage, const pl::Point<T>& local, std::span<const FaceFrame* const> near,
               std::vector<T>& weights) {
  for (const FaceFrame* face : near) {
    const pl::Seen<T> s = pl::seen(cage, *face, local);
    const pl::Place place = pl::place(s);
    if (place == pl::Place::on_face) {
      weights.assign(weights.size(), pl::constant<T>(0));
      const auto lambda = pl::barycentric(*face, s);
      for (std::size_t k = 0; k < 3; ++k) weights[face->vertices[k]] = lambda[k];
      return;
    }
    // In its plane a face has value 0, whatever rounding makes of its height, and a gradient: else coplanar neighbours
    // could get heights of opposite signs, and weights of ±9.
    if (place == pl::Place::in_plane && !pl::has_gradient<T>) continue;
    auto terms = pl::mean_value_terms(*face, s);
    if (place == pl::Place::in_plane)
      for (T& term : terms) term = term - pl::constant<T>(value_of(term));
    for (std::size_t k = 0; k < 3; ++k) weights[face->vertices[k]] += terms[k];
  }
  normalise(weights);
}

template <class T>
T part_of(const T& number) {
  return number;
}
template <class R>
R part_of(const DualOf<R>& number) {
  return number.v;
}

}  // namespace

template <class T>
void add_near_faces(const CageFrame& cage, const pl::Point<T>& local, std::span<const FaceFrame* const> near,
                    std::vector<T>& weights) {
  if (near.size() == 1) {
    const pl::Seen<T> s = pl::seen(cage, *near.front(), local);
    if (is_over(s)) {
      add_face_below(*near.front(), s, weights);
      return;
    }
  }
  if constexpr (pl::has_gradient<T>) {
    const Vec3 at = values_of(local);
    if (!near.empty() && least_distance(cage, at, near) < quad_distance) {
      using R = typename pl::RealOf<T>::type;
      std::vector<R> values;
      for (const T& weight : weights) values.push_back(part_of(weight));
      add_faces<R>(cage, {part_of(local[0]), part_of(local[1]), part_of(local[2])}, near, values);
      std::vector<T> result(weights.size());
      for (std::size_t v = 0; v < values.size(); ++v) result[v].v = values[v];
      set_gradients(cage, at, near, weights, result);
      weights = std::move(result);
      return;
    }
  }
  add_faces(cage, local, near, weights);
}

bool mend_gradients(const CageFrame& cage, const pl::Point<Dual>& local, std::span<const FaceFrame* const> near,
                    std::span<pl::GreenTerms<Dual>> terms) {
  const Vec3 at = values_of(local);
  if (near.empty() || least_distance(cage, at, near) >= quad_distance) return false;
  if (near.size() == 1 && is_over(pl::seen(cage, *near.front(), local))) return false;
  const pl::Point<WideDual> place = gradient_place(cage, at, near);
  for (std::size_t n = 0; n < near.size(); ++n) {
    const WideFace wide = wide_face(cage, *near[n]);
    const auto exact = pl::green(wide.frame, seen_from(wide, place));
    for (std::size_t k = 0; k < 3; ++k) set_gradient(terms[n].corners[k], exact.corners[k]);
    set_gradient(terms[n].face, exact.face);
  }
  return true;
}

template void add_near_faces(const CageFrame&, const pl::Point<double>&, std::span<const FaceFrame* const>,
                             std::vector<double>&);
template void add_near_faces(const CageFrame&, const pl::Point<float>&, std::span<const FaceFrame* const>,
                             std::vector<float>&);
template void add_near_faces(const CageFrame&, const pl::Point<Dual>&, std::span<const FaceFrame* const>,
                             std::vector<Dual>&);
template void add_near_faces(const CageFrame&, const pl::Point<long double>&, std::span<const FaceFrame* const>,
                             std::vector<long double>&);
template void add_near_faces(const CageFrame&, const pl::Point<LongDual>&, std::span<const FaceFrame* const>,
                             std::vector<LongDual>&);

}  // namespace rebake
