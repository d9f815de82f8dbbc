#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "mesh_ops/deform/cage_coordinates/far_quadrature.h"
#include "mesh_ops/deform/cage_coordinates/wide_frame.h"

namespace rebake {

namespace {

class Green final : public Coordinates {
 public:
  explicit Green(const Cage& cage)
      : Coordinates(cage.vertices.size() + cage.faces.size()), frame_(frame_of(cage)), face_count_(cage.faces.size()) {}

  void compute_weights(const std::array<Vec3, batch_lanes>& points, double* weights, double* gradients,
                       std::uint8_t* outside) const override {
    const std::size_t vertex_count = frame_.vertices.size();
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      const Vec3& p = points[lane];
      if (gradients == nullptr) {
        thread_local std::vector<double> phi, psi;
        outside[lane] = green_weights(frame_, p, face_count_, phi, psi) ? 0 : 1;
        for (std::size_t row = 0; row < rows(); ++row)
          weights[row * batch_lanes + lane] = outside[lane] != 0   ? 0
                                              : row < vertex_count ? phi[row]
                                                                   : psi[row - vertex_count];
      } else {
        thread_local std::vector<Dual> phi, psi;
        outside[lane] = green_weights(frame_, p, face_count_, phi, psi) ? 0 : 1;
        for (std::size_t row = 0; row < rows(); ++row) {
          const Dual w = outside[lane] != 0 ? Dual() : row < vertex_count ? phi[row] : psi[row - vertex_count];
          weights[row * batch_lanes + lane] = w.v;
          double* slope = gradients + row * 3 * batch_lanes + lane;
          slope[0] = w.x * frame_.scale;
          slope[batch_lanes] = w.y * frame_.scale;
          slope[2 * batch_lanes] = w.z * frame_.scale;
        }
      }
    }
  }

  std::vector<Vec3> row_motions(const Cage& rest, const std::vector<Vec3>& moved) const override {
    std::vector<Vec3> motions = Coordinates::row_motions(rest, moved);
    for (std::size_t k = 0; k < frame_.faces.size(); ++k) {
      const std::uint32_t f = frame_.face_numbers[k];
      const Face& face = rest.faces[f];
      if (moved[face[0]] == rest.vertices[face[0]] && moved[face[1]] == rest.vertices[face[1]] &&
          moved[face[2]] == rest.vertices[face[2]])
        continue;
      if (plane_local::is_needle(frame_.faces[k])) {
        motions[rest.vertices.size() + f] = needle_motion(frame_.faces[k], moved);
        continue;
      }
      // In local units, so that no product of lengths overflows.
      const Vec3 u = (rest.vertices[face[1]] - rest.vertices[face[0]]) * frame_.scale,
                 v = (rest.vertices[face[2]] - rest.vertices[face[0]]) * frame_.scale,
                 u2 = (moved[face[1]] - moved[face[0]]) * frame_.scale,
                 v2 = (moved[face[2]] - moved[face[0]]) * frame_.scale;
      const double area = frame_.faces[k].length * frame_.faces[k].height / 2;
      const double square =
          u2.squaredNorm() * v.squaredNorm() - 2 * u2.dot(v2) * u.dot(v) + v2.squaredNorm() * u.squaredNorm();
      const double stretch = std::sqrt(std::max(0.0, square)) / (std::sqrt(8.0) * area);
      const Vec3 n(frame_.faces[k].normal[0], frame_.faces[k].normal[1], frame_.faces[k].normal[2]);
      const Vec3 turned = u2.cross(v2);
      // A collapsed face has no normal, and its contribution vanishes with its area.
      const Vec3 normal = turned.stableNorm() > 0 ? Vec3(turned.stableNormalized()) : Vec3(0, 0, 0);
      motions[rest.vertices.size() + f] = (stretch * normal - n) / frame_.scale;
    }
    return motions;
  }

 private:
  // Motion of a needle's row with 50 digits, since double loses the height of a needle in its corners. Same formula as
  // for other faces, from the linear map of the face's plane.
  Vec3 needle_motion(const FaceFrame& face, const std::vector<Vec3>& moved) const {
    const WideFace wide = wide_face(frame_, face);
    std::array<std::array<Wide, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = wide_local_point(frame_, moved[face.vertices[k]]);
    std::array<Wide, 3> along, out;
    const FaceFrameOf<Wide>& f = wide.frame;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      along[axis] = (corners[2][axis] - corners[1][axis]) / f.length;
      out[axis] = (f.apex * along[axis] - (corners[0][axis] - corners[1][axis])) / f.height;
    }
    const auto dot = [](const std::array<Wide, 3>& a, const std::array<Wide, 3>& b) {
      return Wide(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    };
    const Wide stretch = real::sqrt(Wide((dot(along, along) + dot(out, out)) / 2));
    std::array<Wide, 3> normal;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
      normal[axis] = out[i] * along[j] - out[j] * along[i];
    }
    const Wide length = real::sqrt(dot(normal, normal));
    Vec3 motion;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Wide turned = length > 0 ? Wide(stretch * normal[axis] / length) : Wide(0);
      motion[static_cast<int>(axis)] = static_cast<double>(Wide(turned - f.normal[axis])) / frame_.scale;
    }
    return motion;
  }

  CageFrame frame_;
  std::size_t face_count_;
};

}  // namespace

std::unique_ptr<Coordinates> green_coordinates(const Cage& cage) { return std::make_unique<Green>(cage); }

}  // namespace rebake
