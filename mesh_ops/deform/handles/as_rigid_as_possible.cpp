#include "mesh_ops/deform/handles/as_rigid_as_possible.h"

#include <CGAL/Deformation_Eigen_closest_rotation_traits_3.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

#include <Eigen/SVD>
#include <algorithm>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"

namespace rebake {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Closest rotations by sums, products and square roots only. CGAL's default uses Eigen's closed-form eigenvalues, whose
// arctangent has different last bits on other processors and C libraries.
struct RotationTraits : CGAL::Deformation_Eigen_closest_rotation_traits_3 {
  void compute_close_rotation(const Matrix& covariance, Matrix& rotation) {
    rotation = local_rotation(covariance.transpose()).rotation;
  }
};
using Deformation = CGAL::Surface_mesh_deformation<Mesh, CGAL::Default, CGAL::Default, CGAL::SPOKES_AND_RIMS,
                                                   CGAL::Default, CGAL::Default, RotationTraits>;

struct RigidMotion {
  Mat3 turn = Mat3::Identity();
  Vec3 shift{0, 0, 0};
  bool is_exact = false;  ///< it maps all points to their targets, up to rounding

  Vec3 operator()(const Vec3& p) const { return turn * p + shift; }
};

// The smallest rotation that maps unit vector a to unit vector b. For nearly opposite vectors it is the product of two
// reflections: in the plane halfway between them, and in the plane that contains b and is perpendicular to the plane of
// a and b. The usual formula divides by the cosine of the half angle, which is lost there.
Mat3 rotation_between(const Vec3& a, const Vec3& b) {
  constexpr double nearly_opposite = -0.99;
  if (a.dot(b) > nearly_opposite) return Eigen::Quaterniond::FromTwoVectors(a, b).toRotationMatrix();
  const Vec3 between = (b - a).normalized(), sum = a + b;
  Vec3 across = sum - sum.dot(b) * b;
  across = across.squaredNorm() > 0 ? Vec3(across.stableNormalized()) : b.unitOrthogonal();
  across = (across - across.dot(b) * b).normalized();
  const auto reflection = [](const Vec3& n) { return Mat3(Mat3::Identity() - 2 * n * n.transpose()); };
  return reflection(across) * reflection(between);
}

// The rotation that best maps centred points to their targets (Kabsch). If it is not unique (collinear or coincident
// points), the one with the smallest angle.
Mat3 fit_rotation(const Mat3& covariance) {
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3& sizes = svd.singularValues();
  if (!(sizes[0] > 0)) return Mat3::Identity();
  if (sizes[1] <= 1e-12 * sizes[0]) return rotation_between(svd.matrixV().col(0), svd.matrixU().col(0));
  Vec3 signs(1, 1, 1);
  signs.z() = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

// The rigid motion that best maps points to their targets. Coordinates must be of order 1.
RigidMotion fitted(const std::vector<Vec3>& rest, const std::vector<Vec3>& places) {
  RigidMotion motion;
  Vec3 from(0, 0, 0), to(0, 0, 0);
  for (std::size_t k = 0; k < rest.size(); ++k) {
    from += rest[k] / static_cast<double>(rest.size());
    to += places[k] / static_cast<double>(rest.size());
  }
  Mat3 covariance = Mat3::Zero();
  for (std::size_t k = 0; k < rest.size(); ++k) covariance += (places[k] - to) * (rest[k] - from).transpose();
  motion.turn = fit_rotation(covariance);
  motion.shift = to - motion.turn * from;
  double farthest = 0, size = 1;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    farthest = std::max(farthest, (motion(rest[k]) - places[k]).norm());
    size = std::max(size, places[k].norm());
  }
  motion.is_exact = farthest <= 1e-13 * size;
  return motion;
}

// The energy that is minimised (Chao et al. 2010, spokes and rims): per vertex, squared differences between deformed
// and rotated edges of its triangles, weighted by the cotangents of the opposite angles. 0 if the surroundings of every
// triangle rotate rigidly.
double rigidity_energy(const std::vector<Vec3>& rest, const std::vector<Vec3>& moved, const std::vector<Face>& faces) {
  std::vector<Mat3> turns(rest.size(), Mat3::Zero());
  const auto for_edges = [&](const Face& face, const auto& visit) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t apex = face[k], a = face[(k + 1) % 3], b = face[(k + 2) % 3];
      const Vec3 u = rest[a] - rest[apex], v = rest[b] - rest[apex];
      const double area = u.cross(v).norm();
      if (area > 0) visit(u.dot(v) / area, Vec3(rest[b] - rest[a]), Vec3(moved[b] - moved[a]));
    }
  };
  for (const Face& face : faces)
    for_edges(face, [&](double weight, const Vec3& before, const Vec3& after) {
      for (const std::uint32_t v : face) turns[v] += weight * after * before.transpose();
    });
  for (Mat3& turn : turns) turn = svd_rotation(turn).rotation;
  double energy = 0;
  for (const Face& face : faces)
    for_edges(face, [&](double weight, const Vec3& before, const Vec3& after) {
      for (const std::uint32_t v : face) energy += weight * (after - turns[v] * before).squaredNorm();
    });
  return energy;
}

Kernel::Point_3 point_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// Minimises the rigidity energy of the vertices with a flag in `solved`, from `rest`, with constrained vertices at
// their targets. `local`: maps targets to the scale of `rest`. Writes the positions to `moved`, and the course to
// `result`.
template <class Local>
void minimise(const Cage& cage, const std::vector<ConstrainedVertex>& held, const std::vector<std::uint8_t>& solved,
              const Local& local, const std::vector<Vec3>& rest, int iterations, const Progress& progress,
              std::vector<Vec3>& moved, ConstrainedCage& result) {
  Mesh mesh;
  std::vector<Mesh::Vertex_index> number(cage.vertices.size());
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v)
    if (solved[v] != 0) number[v] = mesh.add_vertex(point_of(rest[v]));
  for (const Face& face : cage.faces)
    if (solved[face[0]] != 0 && mesh.add_face(number[face[0]], number[face[1]], number[face[2]]) == Mesh::null_face())
      throw Error("two parts of the cage meet in a single point: handles need a manifold cage; separate the parts");
  Deformation deformation(mesh);
  for (const auto v : mesh.vertices()) deformation.insert_roi_vertex(v);
  // A vertex of no face gets its target, and influences no other.
  for (const ConstrainedVertex& h : held)
    if (solved[h.vertex] != 0) deformation.insert_control_vertex(number[h.vertex]);
  if (!deformation.preprocess()) throw Error("the handles do not determine the cage; fix some more points");
  for (const ConstrainedVertex& h : held)
    if (solved[h.vertex] != 0) deformation.set_target_position(number[h.vertex], point_of(local(h.place)));
  do {
    deformation.deform(1, 0);
    result.residual = 0;
    for (std::uint32_t v = 0; v < cage.vertices.size(); ++v) {
      if (solved[v] == 0) continue;
      const Kernel::Point_3& p = mesh.point(number[v]);
      const Vec3 place(p.x(), p.y(), p.z());
      result.residual = std::max(result.residual, (place - moved[v]).norm());
      moved[v] = place;
    }
    progress.at("deforming as rigidly as possible", static_cast<double>(++result.iterations) / iterations);
  } while (result.iterations < iterations && result.residual > handles_residual);
  std::vector<Face> faces;
  for (const Face& face : cage.faces)
    if (solved[face[0]] != 0) faces.push_back(face);
  result.energy = rigidity_energy(rest, moved, faces);
}

}  // namespace

ConstrainedCage as_rigid_as_possible(const Cage& cage, const std::vector<ConstrainedVertex>& held, int iterations,
                                     const Progress& progress) {
  if (held.empty()) throw Error("no cage point is fixed or moved; fix some points and move others");
  ConstrainedCage result{cage.vertices};
  const std::vector<std::uint32_t> component = components(cage);
  const std::vector<std::uint8_t> used = used_vertices(cage);
  std::vector<std::uint8_t> has_held(cage.vertices.size(), 0);
  for (const ConstrainedVertex& h : held) has_held[component[h.vertex]] = 1;
  if (std::none_of(held.begin(), held.end(), [&](const ConstrainedVertex& h) { return used[h.vertex] != 0; }))
    throw Error("none of the fixed or moved points belongs to a triangle of the cage; fix some that do");
  // Constrained vertices get exactly their targets.
  for (const ConstrainedVertex& h : held) result.vertices[h.vertex] = h.place;
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v)
    if (used[v] != 0 && component[v] == v && has_held[v] == 0) ++result.free_components;
  if (result.vertices == cage.vertices) return result;

  std::vector<std::uint8_t> solved(cage.vertices.size());
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v)
    solved[v] = used[v] != 0 && has_held[component[v]] != 0 ? 1 : 0;
  // Scaled to a box of diagonal 1, which the solver's tolerances expect.
  const Box box = surface_box(cage);
  const double size = box.diagonal().stableNorm();
  const auto local = [&](const Vec3& v) { return Vec3((v - box.center()) / size); };
  std::vector<RigidMotion> motions(cage.vertices.size());
  bool all_exact = true;
  for (std::uint32_t first = 0; first < cage.vertices.size(); ++first) {
    if (used[first] == 0 || component[first] != first || has_held[first] == 0) continue;
    std::vector<Vec3> rest, places;
    for (const ConstrainedVertex& h : held)
      if (used[h.vertex] != 0 && component[h.vertex] == first) {
        rest.push_back(local(cage.vertices[h.vertex]));
        places.push_back(local(h.place));
      }
    motions[first] = fitted(rest, places);
    if (rest == places) motions[first] = {Mat3::Identity(), Vec3(0, 0, 0), true};
    all_exact = all_exact && motions[first].is_exact;
  }
  // The energy does not change under rigid motions, so the solver starts from the rigidly moved cage.
  std::vector<Vec3> rest(cage.vertices.size()), moved(cage.vertices.size());
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v) {
    rest[v] = local(cage.vertices[v]);
    if (solved[v] != 0) rest[v] = motions[component[v]](rest[v]);
  }
  moved = rest;
  if (!all_exact) {
    minimise(cage, held, solved, local, rest, iterations, progress, moved, result);
  }
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v) {
    // A component whose constrained vertices did not move keeps its bits.
    const bool stands = motions[component[v]].is_exact && motions[component[v]].turn.isIdentity(0) &&
                        motions[component[v]].shift.isZero(0);
    if (solved[v] != 0 && !stands) result.vertices[v] = box.center() + moved[v] * size;
  }
  for (const ConstrainedVertex& h : held) result.vertices[h.vertex] = h.place;
  return result;
}

}  // namespace rebake
