#include "mesh_ops/deform/cages/wrap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <CGAL/version.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Expected number of points of a wrap, extrapolated from a coarser one; 0 if unknown. `words` is the progress text.
struct Expected {
  double points = 0;
  std::string words = "wrap";
};

// Visitor of CGAL's carving: reports progress. Cancelling throws out of it.
struct Watch : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
  Watch(const Progress& to, const Expected& work) : progress(&to), expected(&work) {}

  template <class Wrapper, class Facet>
  void before_facet_treatment(const Wrapper& wrapper, const Facet& /*unused*/) {
    if (facets++ % 1024 != 0) return;
    const auto points = static_cast<double>(wrapper.triangulation().number_of_vertices());
    progress->at(fmt::format("{}, {} points", expected->words, points),
                 expected->points > 0 ? std::min(0.95, points / expected->points) : 0);
  }

  const Progress* progress;
  const Expected* expected;
  std::size_t facets = 0;
};

struct Triangles {
  std::vector<Kernel::Point_3> points;  // scaled to a box of diagonal 1, since CGAL's constructions fail at 1e±300
  std::vector<std::vector<std::size_t>> faces;
};

Mesh wrapped(const Triangles& of, double coarseness, const Progress& progress, const Expected& expected) {
  Mesh mesh;
  CGAL::alpha_wrap_3(of.points, of.faces, coarseness, coarseness / 4, mesh, CGAL::parameters::default_values(),
                     CGAL::parameters::visitor(Watch(progress, expected)));
  return mesh;
}

// Extrapolates from a wrap four times as coarse. The number of points grows with the square of the fineness, and time a
// little faster (measured on two scenes: by 5.3 to 6 per halved coarseness, from 0.05 on).
Expected estimate_work(const Triangles& of, double coarseness, const Progress& progress) {
  constexpr double coarser = 4, time_power = 2.4;
  const auto start = std::chrono::steady_clock::now();
  const Mesh coarse = wrapped(of, coarser * coarseness, progress, {});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  return {static_cast<double>(coarse.num_vertices()) * coarser * coarser,
          std::string("wrap") + about + duration_text(took.count() * std::pow(coarser, time_power))};
}

}  // namespace

Cage wrap(const TriangleList& triangles, double coarseness, const Progress& progress) {
  if (!(coarseness >= 0.005 && coarseness <= 0.5)) throw FieldError("wrap", "must lie between 0.005 and 0.5");
  Box box;
  Triangles given;
  auto& [points, faces] = given;
  for (const Face& face : triangles.faces) {
    const Vec3 &a = triangles.points[face[0]], &b = triangles.points[face[1]], &c = triangles.points[face[2]];
    if (!a.allFinite() || !b.allFinite() || !c.allFinite()) continue;
    for (const Vec3* p : {&a, &b, &c}) box.extend(*p);
    faces.push_back({face[0], face[1], face[2]});
  }
  if (faces.empty()) throw Error("there is no triangle with finite positions to wrap");
  const double diagonal = box.diagonal().stableNorm();
  if (!(diagonal > 0) || !std::isfinite(diagonal))
    throw Error("the triangles have no extent, or positions out of range; they cannot be wrapped");
  const Vec3 center = box.center();
  for (const Vec3& p : triangles.points) {
    const Vec3 q = p.allFinite() ? Vec3((p - center) / diagonal) : Vec3(0, 0, 0);
    points.emplace_back(q.x(), q.y(), q.z());
  }
  // CGAL needs triangles with an area. Others lie on edges of neighbours or are invisible.
  std::erase_if(faces, [&](const std::vector<std::size_t>& f) {
    return CGAL::collinear(points[f[0]], points[f[1]], points[f[2]]);
  });
  if (faces.empty()) throw Error("no triangle has an area, so none can be wrapped; use a lattice");
  // Only finer wraps take more than a second and need an estimate.
  constexpr double estimated_below = 0.02;
  const Expected expected = coarseness < estimated_below ? estimate_work(given, coarseness, progress) : Expected{};
  progress.at(expected.words, 0);
  const Mesh mesh = wrapped(given, coarseness, progress, expected);
  Cage cage;
  std::vector<std::uint32_t> number(mesh.num_vertices());
  for (const auto v : mesh.vertices()) {
    const Kernel::Point_3& p = mesh.point(v);
    number[v] = static_cast<std::uint32_t>(cage.vertices.size());
    cage.vertices.push_back(center + Vec3(p.x(), p.y(), p.z()) * diagonal);
  }
  for (const auto f : mesh.faces()) {
    Face face{};
    std::size_t k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) face[k++] = number[v];
    cage.faces.push_back(face);
  }
  return checked_cage(std::move(cage));
}

const char* wrap_version() { return "wrap1-cgal" CGAL_VERSION_STR; }

}  // namespace rebake
