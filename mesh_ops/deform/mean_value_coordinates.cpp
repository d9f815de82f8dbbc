#include "mesh_ops/deform/coordinates.h"

namespace rebake {

namespace {

class MeanValue final : public Coordinates {
 public:
  explicit MeanValue(const Cage& cage) : Coordinates(cage.vertices.size()), frame_(frame_of(cage)) {
    for (const Vec3& v : frame_.vertices) vertices_.insert(vertices_.end(), {v.x(), v.y(), v.z()});
    for (const EdgeFrame& edge : frame_.edges) {
      edges_.insert(edges_.end(), {edge.first, edge.second});
      edge_frames_.insert(edge_frames_.end(), edge.tangent.begin(), edge.tangent.end());
      edge_frames_.push_back(edge.length);
    }
    for (const FaceFrame& face : frame_.faces) {
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
    batch_ = {frame_.vertices.size(), frame_.edges.size(), frame_.faces.size(), vertices_.data(),
              edges_.data(),          edge_frames_.data(), faces_.data(),       face_frames_.data()};
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
    std::array<std::uint8_t, batch_lanes> delicate;
    run_(batch_, local.data(), workspace.data(), weights, gradients, delicate.data());
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      if (delicate[lane] == 0) continue;
      const Vec3 p(local[lane], local[batch_lanes + lane], local[2 * batch_lanes + lane]);
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
  CageFrame frame_;
  std::vector<double> vertices_, edge_frames_, face_frames_;
  std::vector<std::uint32_t> edges_, faces_;
  BatchCage batch_;
  MeanValueBatch run_ = mean_value_batch();
};

}  // namespace

std::vector<Vec3> Coordinates::row_motions(const Cage& rest, const std::vector<Vec3>& moved) const {
  std::vector<Vec3> motions(rows_, Vec3(0, 0, 0));
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) motions[v] = moved[v] - rest.vertices[v];
  return motions;
}

std::unique_ptr<Coordinates> mean_value_coordinates(const Cage& cage) { return std::make_unique<MeanValue>(cage); }

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
