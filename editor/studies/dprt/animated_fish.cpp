#include <array>
#include <cmath>
#include <numbers>

#include "editor/studies/dprt/animated_object.h"

namespace rebake {

namespace {

constexpr int fish_rings = 120, fish_segments = 64;
using std::numbers::pi;

double bump(double x, double width) { return std::exp(-x * x / (2 * width * width)); }

// Point of the body: `along` from the mouth (0) to the end of the tail fin (1), `around` from the back.
Vec3 at_rest(double along, double around) {
  // Half height and half width of the cross-section: a spindle, a narrow tail, and a flat, high tail fin.
  const double body = std::pow(std::sin(pi * std::min(1.0, 0.06 + 0.98 * along)), 0.7);
  const double fin = along > 0.78 ? std::pow((along - 0.78) / 0.22, 1.2) : 0;
  const double height = 0.06 + 0.24 * body * (1 - fin) + 0.30 * fin;
  const double width = 0.02 + 0.14 * body * (1 - fin);
  const double up = std::cos(around), side = std::sin(around);
  Vec3 p(2.4 * along - 1.2, height * up, width * side);
  const double ridge = std::pow(std::max(0.0, up), 24), keel = std::pow(std::max(0.0, -up), 24);
  p.y() += ridge * 0.24 * bump(along - 0.42, 0.10) - keel * 0.14 * bump(along - 0.62, 0.06);  // fins of back and belly
  // Pectoral fins.
  p += std::pow(std::abs(side), 24) * bump(along - 0.30, 0.04) * Vec3(0.10, -0.04, side > 0 ? 0.20 : -0.20);
  // The tail fin is forked.
  p.x() -= 0.22 * fin * bump(up, 0.5);
  return p;
}

constexpr int shapes = 7;

std::array<Vec3, shapes> blendshapes(double along, double around) {
  const double amplitude = 0.04 + 0.30 * along * along;
  const double up = std::cos(around), side = std::sin(around);
  std::array<Vec3, shapes> result;
  // Two phases of the wave that travels along the body.
  result[0] = amplitude * std::sin(1.9 * pi * along) * Vec3(0, 0, 1);
  result[1] = amplitude * std::cos(1.9 * pi * along) * Vec3(0, 0, 1);
  const double back = along - 0.35;
  result[2] = 0.9 * back * back * Vec3(0, 0, 1);  // turns
  result[3] = 0.7 * back * back * Vec3(0, 1, 0);  // climbs
  result[4] =
      std::pow(std::max(0.0, up), 24) * bump(along - 0.42, 0.10) * Vec3(0.12, -0.16, 0.05);  // folds the back fin
  const double pectoral = std::pow(std::abs(side), 24) * bump(along - 0.30, 0.05);
  result[5] = pectoral * Vec3(-0.04, 0.20, 0);                             // raises the pectoral fins
  result[6] = bump(along - 0.12, 0.10) * Vec3(0, 0.04 * up, 0.06 * side);  // gills
  return result;
}

}  // namespace

AnimatedObject animated_fish(int frames) {
  AnimatedObject object{"fish", {}, {}};
  std::vector<std::array<Vec3, shapes>> displacements;
  const auto add = [&](double along, double around) {
    object.rest.vertices.push_back(at_rest(along, around));
    displacements.push_back(blendshapes(along, around));
  };
  // Cut open along the belly, from the mouth to the end of the tail fin.
  for (int ring = 0; ring <= fish_rings; ++ring)
    for (int segment = 0; segment <= fish_segments; ++segment)
      add(static_cast<double>(ring) / fish_rings, 2 * pi * segment / fish_segments - pi);
  const auto at = [](int ring, int segment) {
    return static_cast<std::uint32_t>(ring * (fish_segments + 1) + segment);
  };
  for (int ring = 0; ring < fish_rings; ++ring)
    for (int segment = 0; segment < fish_segments; ++segment) {
      object.rest.faces.push_back({at(ring, segment), at(ring + 1, segment + 1), at(ring + 1, segment)});
      object.rest.faces.push_back({at(ring, segment), at(ring, segment + 1), at(ring + 1, segment + 1)});
    }
  for (int frame = 0; frame < frames; ++frame) {
    const double t = 2 * pi * frame / frames, stroke = 11 * t, vigour = 0.7 + 0.3 * std::sin(2 * t + 0.5);
    const std::array<double, shapes> weights{
        vigour * std::cos(stroke),   -vigour * std::sin(stroke), 0.8 * std::sin(3 * t), 0.7 * std::sin(2 * t + 1.3),
        0.5 + 0.5 * std::sin(5 * t), std::sin(7 * t + 0.4),      std::sin(17 * t)};
    std::vector<Vec3> posed = object.rest.vertices;
    for (std::size_t v = 0; v < posed.size(); ++v)
      for (std::size_t k = 0; k < shapes; ++k) posed[v] += weights[k] * displacements[v][k];
    object.frames.push_back(std::move(posed));
  }
  return object;
}

}  // namespace rebake
