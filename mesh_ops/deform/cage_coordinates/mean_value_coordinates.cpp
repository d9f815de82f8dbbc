#include <limits>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "mesh_ops/deform/cage_coordinates/far_quadrature.h"
#include "mesh_ops/deform/cage_coordinates/near_faces.h"

namespace rebake {

namespace {

namespace pl = plane_local;

// If the terms are at most this many times as large as their sum, ten digits remain. Otherwise all faces are evaluated
// with 50 digits: outside thin cages and beside sharp edges, where points are few, since it takes a tenth of a
// millisecond per face. Beyond `exact_within` diagonals, weights are of no use and stay as double gives them.
constexpr double max_cancellation = 1e5, exact_within = 10;
// The same limit for points near a face. They are few, so all digits are preserved.
constexpr double max_cancelled_near = 8;

class MeanValue final : public Coordinates {
 public:
  MeanValue(const Cage& cage, MeanValueBatch batch)
      : Coordinates(cage.vertices.size()), frame_(frame_of(cage)), evaluate_batch_(batch) {
    for (const Vec3& v : frame_.vertices) vertices_.insert(vertices_.end(), {v.x(), v.y(), v.z()});
    for (const EdgeFrame& edge : frame_.edges) {
      edges_.insert(edges_.end(), {edge.first, edge.second});
      edge_frames_.insert(edge_frames_.end(), edge.tangent.begin(), edge.tangent.end());
      edge_frames_.push_back(edge.length);
    }
    for (const FaceFrame& face : frame_.faces) {
      all_faces_.push_back(&face);
      if (pl::is_needle(face)) {
        needles_.push_back(&face);
        continue;
      }
      batched_.push_back(&face);
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
        half = std::min(half, elementary::sine_cosine(elementary::atan2(sine, cosine) / 2).sine);
      }
      face_frames_.push_back(half);
    }
    batch_ = {frame_.vertices.size(), frame_.edges.size(), faces_.size() / 6, vertices_.data(),
              edges_.data(),          edge_frames_.data(), faces_.data(),     face_frames_.data()};
  }
  MeanValue(const MeanValue&) = delete;
  MeanValue& operator=(const MeanValue&) = delete;

  void compute_weights(const std::array<Vec3, batch_lanes>& points, double* weights, double* gradients,
                       std::uint8_t* outside) const override {
    std::array<double, 3 * batch_lanes> local;
    std::array<Vec3, batch_lanes> places;
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      // A point that is not finite has no weights and must not influence other lanes.
      places[lane] = frame_.to_local(points[lane]).allFinite() ? points[lane] : frame_.center;
      const Vec3 p = frame_.to_local(places[lane]);
      for (std::size_t axis = 0; axis < 3; ++axis) local[axis * batch_lanes + lane] = p[static_cast<int>(axis)];
      outside[lane] = 0;
    }
    if (gradients != nullptr) {
      weigh_local<Dual>(places, local, weights, gradients);
      for (std::size_t i = 0; i < rows() * 3 * batch_lanes; ++i) gradients[i] *= frame_.scale;
    } else {
      weigh_local<double>(places, local, weights, gradients);
    }
    // Too far away to be a number of cage diagonals: no weights either.
    for (std::size_t lane = 0; lane < batch_lanes; ++lane)
      if (points[lane].allFinite() && !frame_.to_local(points[lane]).allFinite())
        for (std::size_t v = 0; v < rows(); ++v)
          weights[v * batch_lanes + lane] = std::numeric_limits<double>::quiet_NaN();
  }

 private:
  using Near = std::array<std::vector<const FaceFrame*>, batch_lanes>;

  static Vec3 point_of(const std::array<double, 3 * batch_lanes>& local, std::size_t lane) {
    return {local[lane], local[batch_lanes + lane], local[2 * batch_lanes + lane]};
  }

  template <class T>
  void weigh_local(const std::array<Vec3, batch_lanes>& places, const std::array<double, 3 * batch_lanes>& local,
                   double* weights, double* gradients) const {
    constexpr std::size_t row = (pl::has_gradient<T> ? 4 : 1) * batch_lanes;
    thread_local std::vector<double> workspace, start;
    thread_local std::vector<SkippedFace> left_out;
    thread_local Near near;
    workspace.resize(batch_workspace(batch_, pl::has_gradient<T>));
    left_out.resize(batch_.face_count * batch_lanes);
    for (auto& faces : near) faces.clear();
    start.clear();
    std::array<double, batch_lanes> needle_sizes{};
    if (!needles_.empty()) {
      start.assign(row * rows(), 0.0);
      for (std::size_t lane = 0; lane < batch_lanes; ++lane)
        for (const FaceFrame* face : needles_)
          needle_sizes[lane] += add_face<T>(*face, point_of(local, lane), start.data() + lane, near[lane]);
    }
    const std::size_t left = evaluate_batch_(batch_, local.data(), start.empty() ? nullptr : start.data(),
                                             workspace.data(), weights, gradients, left_out.data());
    double* const sums = workspace.data() + batch_sums_at(batch_, pl::has_gradient<T>);
    std::array<std::uint8_t, batch_lanes> again{};
    for (std::size_t n = 0; n < left; ++n) {
      const std::size_t lane = left_out[n].lane;
      const FaceFrame* face = batched_[left_out[n].face];
      again[lane] = 1;
      if (left_out[n].on)
        near[lane].push_back(face);
      else
        needle_sizes[lane] += add_face<T>(*face, point_of(local, lane), sums + lane, near[lane]);
    }
    const double* const sizes = sums + rows() * row;
    const auto cancels = [&](std::size_t lane) {
      double total = 0;
      for (std::size_t v = 0; v < rows(); ++v) total += sums[v * row + lane];
      return sizes[lane] + needle_sizes[lane] > max_cancellation * std::abs(total);
    };
    thread_local std::vector<T> exact;
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      const Vec3 p = point_of(local, lane);
      const bool far_out = frame_.is_far_out(p);
      if (far_out ? mean_value_weights(frame_, p, exact) > max_cancellation &&
                        p.stableNorm() < exact_within * frame_.diagonal
                  : near[lane].empty() && cancels(lane)) {
        exact.assign(rows(), pl::constant<T>(0));
        add_near_faces<T>(frame_, pl::local_point(p, T()), wide_local_point(frame_, places[lane]), all_faces_, exact);
      } else if (far_out) {
        // mean_value_weights() has already set `exact`.
      } else if (again[lane] != 0 || !near[lane].empty()) {
        exact.resize(rows());
        for (std::size_t v = 0; v < rows(); ++v) {
          const double* sum = sums + v * row + lane;
          if constexpr (pl::has_gradient<T>)
            exact[v] = T(sum[0], sum[batch_lanes], sum[2 * batch_lanes], sum[3 * batch_lanes]);
          else
            exact[v] = sum[0];
        }
        const double divisor = add_near_faces<T>(frame_, pl::local_point(p, T()),
                                                 wide_local_point(frame_, places[lane]), near[lane], exact);
        if (!near[lane].empty() && sizes[lane] + needle_sizes[lane] > max_cancelled_near * std::abs(divisor)) {
          exact.assign(rows(), pl::constant<T>(0));
          add_near_faces<T>(frame_, pl::local_point(p, T()), wide_local_point(frame_, places[lane]), all_faces_, exact);
        }
      } else {
        continue;
      }
      for (std::size_t v = 0; v < rows(); ++v) {
        weights[v * batch_lanes + lane] = part(exact[v]);
        if constexpr (pl::has_gradient<T>) {
          double* slope = gradients + v * 3 * batch_lanes + lane;
          slope[0] = exact[v].x;
          slope[batch_lanes] = exact[v].y;
          slope[2 * batch_lanes] = exact[v].z;
        }
      }
    }
  }

  static double part(double number) { return number; }
  static double part(const Dual& number) { return number.v; }

  // Adds a face's terms to one lane of the sums, or the face to `near`. Returns the sum of the terms' magnitudes.
  template <class T>
  double add_face(const FaceFrame& face, const Vec3& local, double* sums, std::vector<const FaceFrame*>& near) const {
    const pl::Seen<T> s = pl::seen(frame_, face, pl::local_point(local, T()));
    if (pl::distance_of(s) < near_distance) {
      near.push_back(&face);
      return 0;
    }
    const bool in_plane = pl::place(s) != pl::Place::off_plane;
    const auto terms = pl::mean_value_terms(face, s);
    double size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      size += std::abs(value_of(terms[k]));
      double* sum = sums + face.vertices[k] * (pl::has_gradient<T> ? 4 : 1) * batch_lanes;
      // In its own plane a face has value 0 but a gradient.
      if (!in_plane) sum[0] += value_of(terms[k]);
      if constexpr (pl::has_gradient<T>) {
        sum[batch_lanes] += terms[k].x;
        sum[2 * batch_lanes] += terms[k].y;
        sum[3 * batch_lanes] += terms[k].z;
      }
    }
    return size;
  }

  CageFrame frame_;
  std::vector<const FaceFrame*> all_faces_;
  std::vector<const FaceFrame*> needles_;  ///< thin faces (is_needle), evaluated one by one
  std::vector<const FaceFrame*> batched_;  ///< faces that the batch evaluates
  std::vector<double> vertices_, edge_frames_, face_frames_;
  std::vector<std::uint32_t> edges_, faces_;
  BatchCage batch_;
  MeanValueBatch evaluate_batch_;
};

}  // namespace

std::unique_ptr<Coordinates> mean_value_coordinates(const Cage& cage, MeanValueBatch batch) {
  return std::make_unique<MeanValue>(cage, batch);
}

}  // namespace rebake
