#include "mesh_ops/deform/near_faces.h"

#include "mesh_ops/deform/far_quadrature.h"
#include "mesh_ops/deform/wide_frame.h"

namespace rebake {

namespace {

namespace pl = plane_local;

// A point nearer than this lies on the surface, or on an edge or corner of it, and its gradients are taken so far
// inside.
constexpr double on_surface = 1e-12;
constexpr double depth_inside = 1e-13;

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

}  // namespace

double near_faces::least_distance(const CageFrame& cage, const Vec3& local, std::span<const FaceFrame* const> near) {
  double least = std::numeric_limits<double>::infinity();
  for (const FaceFrame* face : near)
    least = std::min(least, distance_of(pl::seen(cage, *face, pl::local_point(local, 0.0))));
  return least;
}

std::vector<WideDual> near_faces::wide_weights(const CageFrame& cage, const Vec3& local,
                                               std::span<const FaceFrame* const> near, std::vector<WideDual> sums) {
  const pl::Point<WideDual> place = gradient_place(cage, local, near);
  WideDual total;
  for (const WideDual& sum : sums) total += sum;
  for (const FaceFrame* face : near) {
    const WideFace wide = wide_face(cage, *face);
    const auto terms = pl::mean_value(wide.frame, seen_from(wide, place));
    for (std::size_t k = 0; k < 3; ++k) {
      sums[face->vertices[k]] += terms[k];
      total += terms[k];
    }
  }
  for (WideDual& sum : sums) sum = sum / total;
  return sums;
}

bool mend_gradients(const CageFrame& cage, const pl::Point<Dual>& local, std::span<const FaceFrame* const> near,
                    std::span<pl::GreenTerms<Dual>> terms) {
  const Vec3 at = near_faces::values_of(local);
  if (near.empty() || near_faces::least_distance(cage, at, near) >= near_faces::quad_distance) return false;
  if (near.size() == 1 && near_faces::is_over(pl::seen(cage, *near.front(), local))) return false;
  const pl::Point<WideDual> place = gradient_place(cage, at, near);
  for (std::size_t n = 0; n < near.size(); ++n) {
    const WideFace wide = wide_face(cage, *near[n]);
    const auto exact = pl::green(wide.frame, seen_from(wide, place));
    for (std::size_t k = 0; k < 3; ++k) near_faces::set_gradient(terms[n].corners[k], exact.corners[k]);
    near_faces::set_gradient(terms[n].face, exact.face);
  }
  return true;
}

}  // namespace rebake
