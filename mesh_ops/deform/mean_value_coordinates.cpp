#include "mesh_ops/deform/coordinates.h"
#include "mesh_ops/deform/far_quadrature.h"

namespace rebake {

namespace {

namespace pl = plane_local;

// Below this distance (local units) from a face the batch cannot weigh a point.
constexpr double delicate_distance = 1e-6;
// Farther out than this from the cage's centre (its diagonal is 1 to 2), all faces are small beside their distance.
constexpr double far_distance = 4;

class MeanValue final : public Coordinates {
 public:
  MeanValue(const Cage& cage, MeanValueBatch batch)
      : Coordinates(cage.vertices.size()), frame_(frame_of(cage)), run_(batch) {
    for (const Vec3& v : frame_.vertices) vertices_.insert(vertices_.end(), {v.x(), v.y(), v.z()});
    for (const EdgeFrame& edge : frame_.edges) {
      edges_.insert(edges_.end(), {edge.first, edge.second});
      edge_frames_.insert(edge_frames_.end(), edge.tangent.begin(), edge.tangent.end());
      edge_frames_.push_back(edge.length);
    }
    for (const FaceFrame& face : frame_.faces) {
      if (pl::is_needle(face)) {
        needles_.push_back(&face);
        continue;
      }
      faces_.insert(faces_.end(), face.vertices.begin(), face.vertices.end());
      faces_.insert(faces_.end(), face.edges.begin(), face.edges.end());
      const auto append = [&](const std::array<double, 3>& numbers) {
        face_frames_.insert(face_frames_.end(), numbers.begin(), numbers.end());
      };
      append(face.normal);
      append(face.tangent);
      append(face.outward);
      append({face.length, face.height, face.apex});
      append(face.edge_t);
      append(face.edge_o);
      append(face.normal_t);
      append(face.normal_o);
      append(face.lengths);
      double half = 1;  // sine of half the smallest angle
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const double sine = std::abs(face.edge_t[i] * face.edge_o[j] - face.edge_o[i] * face.edge_t[j]),
                     cosine = -(face.edge_t[i] * face.edge_t[j] + face.edge_o[i] * face.edge_o[j]);
        half = std::min(half, std::sin(std::atan2(sine, cosine) / 2));
      }
      face_frames_.push_back(half);
    }
    batch_ = {frame_.vertices.size(), frame_.edges.size(), faces_.size() / 6, vertices_.data(),
              edges_.data(),          edge_frames_.data(), faces_.data(),     face_frames_.data()};
  }
  MeanValue(const MeanValue&) = delete;
  MeanValue& operator=(const MeanValue&) = delete;

  void weigh(const std::array<Vec3, batch_lanes>& points, double* weights, double* gradients,
             std::uint8_t* outside) const override {
    std::array<double, 3 * batch_lanes> local;
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      const Vec3 p = frame_.to_local(points[lane]);
      for (std::size_t axis = 0; axis < 3; ++axis) local[axis * batch_lanes + lane] = p[static_cast<int>(axis)];
      outside[lane] = 0;
    }
    thread_local std::vector<double> workspace;
    workspace.resize(batch_workspace(batch_, gradients != nullptr));
    thread_local std::vector<double> start;
    start.clear();
    std::array<std::uint8_t, batch_lanes> near_needles{}, delicate;
    if (!needles_.empty()) {
      start.assign((gradients != nullptr ? 4U : 1U) * batch_lanes * rows(), 0.0);
      for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
        const Vec3 p(local[lane], local[batch_lanes + lane], local[2 * batch_lanes + lane]);
        const bool near = gradients != nullptr ? !add_needles<Dual>(p, start.data() + lane)
                                               : !add_needles<double>(p, start.data() + lane);
        near_needles[lane] = near ? 1 : 0;
      }
    }
    run_(batch_, local.data(), start.empty() ? nullptr : start.data(), workspace.data(), weights, gradients,
         delicate.data());
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      const Vec3 p(local[lane], local[batch_lanes + lane], local[2 * batch_lanes + lane]);
      if (delicate[lane] == 0 && near_needles[lane] == 0 && p.cwiseAbs().maxCoeff() < far_distance) continue;
      if (gradients != nullptr) {
        thread_local std::vector<Dual> exact;
        mean_value_weights(frame_, p, exact);
        for (std::size_t v = 0; v < exact.size(); ++v) {
          weights[v * batch_lanes + lane] = exact[v].v;
          double* slope = gradients + v * 3 * batch_lanes + lane;
          slope[0] = exact[v].x;
          slope[batch_lanes] = exact[v].y;
          slope[2 * batch_lanes] = exact[v].z;
        }
      } else {
        thread_local std::vector<double> exact;
        mean_value_weights(frame_, p, exact);
        for (std::size_t v = 0; v < exact.size(); ++v) weights[v * batch_lanes + lane] = exact[v];
      }
    }
    if (gradients != nullptr)
      for (std::size_t i = 0; i < rows() * 3 * batch_lanes; ++i) gradients[i] *= frame_.scale;
  }

 private:
  // What needles weigh, into one lane of rows of them. False where the point is too near one.
  template <class T>
  bool add_needles(const Vec3& local, double* sums) const {
    const pl::Point<T> x = pl::local_point(local, T());
    for (const FaceFrame* face : needles_) {
      const pl::Seen<T> s = pl::seen(frame_, *face, x);
      if (std::max(std::abs(value_of(s.h)), pl::distance_in_plane(s)) < delicate_distance) return false;
      const bool in_plane = pl::place(s) != pl::Place::off_plane;
      const auto terms = pl::mean_value_terms(*face, s);
      for (std::size_t k = 0; k < 3; ++k) {
        double* sum = sums + face->vertices[k] * (pl::has_gradient<T> ? 4 : 1) * batch_lanes;
        // In its plane a face weighs nothing, but what it weighs changes.
        if (!in_plane) sum[0] += value_of(terms[k]);
        if constexpr (pl::has_gradient<T>) {
          sum[batch_lanes] += terms[k].x;
          sum[2 * batch_lanes] += terms[k].y;
          sum[3 * batch_lanes] += terms[k].z;
        }
      }
    }
    return true;
  }

  CageFrame frame_;
  std::vector<const FaceFrame*> needles_;  ///< weighed one by one
  std::vector<double> vertices_, edge_frames_, face_frames_;
  std::vector<std::uint32_t> edges_, faces_;
  BatchCage batch_;
  MeanValueBatch run_;
};

}  // namespace

std::vector<Vec3> Coordinates::row_motions(const Cage& rest, const std::vector<Vec3>& moved) const {
  std::vector<Vec3> motions(rows_, Vec3(0, 0, 0));
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) motions[v] = moved[v] - rest.vertices[v];
  return motions;
}

std::unique_ptr<Coordinates> mean_value_coordinates(const Cage& cage, MeanValueBatch batch) {
  return std::make_unique<MeanValue>(cage, batch);
}

std::unique_ptr<Coordinates> coordinates_of(const Cage& cage, CageCoordinates kind, int resolution,
                                            const Progress& progress) {
  switch (kind) {
    case CageCoordinates::green:
      return green_coordinates(cage);
    case CageCoordinates::harmonic:
      return harmonic_coordinates(cage, resolution, progress);
    default:
      return mean_value_coordinates(cage);
  }
}

}  // namespace rebake
