#include <array>
#include <cmath>
#include <numbers>

#include "editor/studies/dprt/animated_object.h"

namespace rebake {

namespace {

constexpr int head_rings = 64, head_segments = 96;
using std::numbers::pi;
// Angle from the nose at which the head is cut open, behind the ears.
constexpr double open_from = 0.68 * pi;

// Direction of a vertex from the centre. The face looks along z; `polar` is the angle from there.
Vec3 direction(double polar, double azimuth) {
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

double bump(double x, double y, double across, double up) {
  return std::exp(-(x * x) / (2 * across * across) - (y * y) / (2 * up * up));
}

// Point of the head along a direction.
Vec3 at_rest(const Vec3& d) {
  Vec3 p(0.78 * d.x(), 1.0 * d.y(), 0.9 * d.z());
  const double front = d.z() > 0 ? 1 : 0;
  p += front * 0.40 * bump(d.x(), d.y() + 0.06, 0.10, 0.17) * Vec3(0, -0.15, 1);  // nose
  p += front * 0.13 * bump(d.x(), d.y() - 0.30, 0.40, 0.09) * Vec3(0, 0, 1);      // brow
  for (const double side : {-1.0, 1.0}) {
    p -= front * 0.24 * bump(d.x() - 0.29 * side, d.y() - 0.13, 0.13, 0.11) * Vec3(0, 0, 1);  // eye socket
    p += front * 0.10 * bump(d.x() - 0.29 * side, d.y() - 0.13, 0.07, 0.06) * Vec3(0, 0, 1);  // eye
    p += 0.28 * bump(d.z() + 0.05, d.y() - 0.02, 0.10, 0.20) * (d.x() * side > 0 ? 1 : 0) * Vec3(side, 0, -0.3);  // ear
  }
  p += front * 0.13 * bump(d.x(), d.y() + 0.36, 0.19, 0.055) * Vec3(0, 0, 1);    // upper lip
  p -= front * 0.16 * bump(d.x(), d.y() + 0.46, 0.19, 0.045) * Vec3(0, 0, 1);    // mouth
  p += front * 0.13 * bump(d.x(), d.y() + 0.57, 0.17, 0.055) * Vec3(0, 0, 1);    // lower lip
  p += front * 0.20 * bump(d.x(), d.y() + 0.78, 0.22, 0.11) * Vec3(0, -0.3, 1);  // chin
  return p;
}

// Displacement of each blendshape at full weight.
std::array<Vec3, head_shapes> blendshapes(const Vec3& d) {
  const double front = std::max(0.0, d.z());
  std::array<Vec3, head_shapes> result;
  const double jaw = bump(d.x(), d.y() + 0.72, 0.45, 0.17) * front;
  result[0] = jaw * Vec3(0, -0.42, -0.14);                                            // opens the mouth
  result[1] = bump(d.x(), d.y() + 0.46, 0.20, 0.06) * front * Vec3(0, -0.02, -0.34);  // mouth cavity
  result[2] = Vec3::Zero();
  result[3] = Vec3::Zero();
  result[4] = Vec3::Zero();
  for (const double side : {-1.0, 1.0}) {
    const double mouth_corner = bump(d.x() - 0.24 * side, d.y() + 0.44, 0.10, 0.09) * front;
    const double cheek = bump(d.x() - 0.42 * side, d.y() + 0.25, 0.16, 0.18) * front;
    result[2] += mouth_corner * Vec3(0.12 * side, 0.13, -0.05) + 0.5 * cheek * Vec3(0.04 * side, 0.05, 0.12);  // smile
    result[3] += cheek * Vec3(0.16 * side, 0, 0.14);                                                 // puffs the cheeks
    result[4] += bump(d.x() - 0.25 * side, d.y() - 0.30, 0.18, 0.09) * front * Vec3(0, 0.14, 0.05);  // raises brows
  }
  result[5] = bump(d.x(), d.y() - 0.27, 0.20, 0.08) * front * Vec3(0, -0.10, 0.14);     // frowns
  result[6] = bump(d.x(), d.y() + 0.46, 0.16, 0.11) * front * Vec3(0, 0, 0.22);         // pouts
  result[7] = bump(d.x() + 0.05, d.y() + 0.02, 0.16, 0.22) * front * Vec3(0.13, 0, 0);  // moves the nose aside
  return result;
}

// Smooth weights, −0.3 … 1, which repeat only after all frames.
double weight(std::size_t k, double time) {
  constexpr std::array<double, head_shapes> rate{3, 5, 2, 7, 4, 6, 8, 9}, phase{0, 1.1, 2.3, 0.7, 3.9, 5.1, 1.9, 4.4};
  const double wave = std::sin(2 * pi * rate[k] * time + phase[k]) * (0.75 + 0.25 * std::sin(2 * pi * time + phase[k]));
  return 0.35 + 0.65 * wave;
}

// Calls use(polar, azimuth) for each vertex: the nose, then the head_rings.
template <class Use>
void for_each_vertex(Use use) {
  use(0.0, 0.0);
  for (int ring = 1; ring <= head_rings; ++ring)
    for (int segment = 0; segment < head_segments; ++segment)
      use(open_from * ring / head_rings, 2 * pi * segment / head_segments);
}

std::vector<Face> faces_of_head() {
  std::vector<Face> faces;
  const auto at = [](int ring, int segment) {
    return static_cast<std::uint32_t>(1 + (ring - 1) * head_segments + segment % head_segments);
  };
  for (int segment = 0; segment < head_segments; ++segment) {
    faces.push_back({0, at(1, segment), at(1, segment + 1)});
    for (int ring = 1; ring < head_rings; ++ring) {
      faces.push_back({at(ring, segment), at(ring + 1, segment), at(ring + 1, segment + 1)});
      faces.push_back({at(ring, segment), at(ring + 1, segment + 1), at(ring, segment + 1)});
    }
  }
  return faces;
}

}  // namespace

std::vector<Vec3> head_pose(const std::array<double, head_shapes>& weights) {
  std::vector<Vec3> posed;
  for_each_vertex([&](double polar, double azimuth) {
    const Vec3 d = direction(polar, azimuth);
    Vec3 place = at_rest(d);
    const std::array<Vec3, head_shapes> displacements = blendshapes(d);
    for (std::size_t k = 0; k < head_shapes; ++k) place += weights[k] * displacements[k];
    posed.push_back(place);
  });
  return posed;
}

AnimatedObject animated_head(int frames) {
  AnimatedObject object{"head", {head_pose({}), faces_of_head()}, {}};
  for (int frame = 0; frame < frames; ++frame) {
    std::array<double, head_shapes> weights{};
    for (std::size_t k = 0; k < head_shapes; ++k) weights[k] = weight(k, static_cast<double>(frame) / frames);
    object.frames.push_back(head_pose(weights));
  }
  return object;
}

ProxyMesh plane_like_head() {
  ProxyMesh plane{{}, faces_of_head()};
  for_each_vertex([&](double polar, double azimuth) {
    const double radius = polar / open_from;
    plane.vertices.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth), 0);
  });
  return plane;
}

}  // namespace rebake
