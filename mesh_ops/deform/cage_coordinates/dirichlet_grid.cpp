#include "mesh_ops/deform/cage_coordinates/dirichlet_grid.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mesh_ops/base/elementary.h"

namespace rebake {

namespace {

constexpr std::uint32_t none = GridDomain::none;
constexpr std::string_view task = "harmonic coordinates";

// Lengths in steps. Largest distance of a corner of a cell that the surface cuts:
constexpr double cell_reach = 1.75;
// Nodes farther from the surface than this lie on the same side as their neighbours.
constexpr double clear_of_surface = 1.01;
// Nodes nearer to the surface than this take its value.
constexpr double min_cut = 1e-8;
// Search radius of an outer node for samples to extrapolate from, and the radius if too few are found.
constexpr double search_radius = 2.45, wide_search_radius = 3.75;

// Barycentric coordinates of the nearest point of a triangle (Ericson 2005, 5.1.5: by the region that contains the
// projection).
std::array<double, 3> nearest_on(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double area = n.squaredNorm();
  if (area > 0) {
    const double u = n.dot((c - b).cross(p - b)), v = n.dot((a - c).cross(p - c)), w = n.dot((b - a).cross(p - a));
    if (u >= 0 && v >= 0 && w >= 0) return {u / (u + v + w), v / (u + v + w), w / (u + v + w)};
  }
  const std::array<const Vec3*, 3> corners{&a, &b, &c};
  std::array<double, 3> best{1, 0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &s = *corners[k], along = *corners[(k + 1) % 3] - s;
    const double square = along.squaredNorm();
    const double t = square > 0 ? std::clamp((p - s).dot(along) / square, 0.0, 1.0) : 0.0;
    const double distance = (p - s - t * along).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = {0, 0, 0};
    best[k] = 1 - t;
    best[(k + 1) % 3] = t;
  }
  return best;
}

Vec3 weighted(const std::array<double, 3>& corners, const std::vector<Vec3>& vertices, const Face& face) {
  return corners[0] * vertices[face[0]] + corners[1] * vertices[face[1]] + corners[2] * vertices[face[2]];
}

// Winding number of the surface around a point (van Oosterom and Strackee 1983).
double winding_number(const Vec3& p, const std::vector<Vec3>& vertices, const std::vector<Face>& faces) {
  double sum = 0;
  for (const Face& face : faces) {
    const Vec3 a = vertices[face[0]] - p, b = vertices[face[1]] - p, c = vertices[face[2]] - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    sum += elementary::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace

std::size_t DirichletGrid::number(int x, int y, int z) const {
  return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
             static_cast<std::size_t>(size_[0]) +
         static_cast<std::size_t>(x);
}

Vec3 DirichletGrid::place_of(std::size_t node) const {
  const auto nx = static_cast<std::size_t>(size_[0]), ny = static_cast<std::size_t>(size_[1]);
  const std::array<std::size_t, 3> at{node % nx, node / nx % ny, node / nx / ny};
  return {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
}

Vec3 DirichletGrid::place(std::size_t node) const {
  const std::size_t inside = inside_nodes();
  return origin_ + step_ * place_of(node < inside ? multigrid_->domain().node_of[node] : outer_[node - inside].node);
}

DirichletGrid::DirichletGrid(const Cage& surface, int resolution, const Progress& progress) {
  const Box box = surface_box(surface);
  step_ = box.sizes().maxCoeff() / resolution;
  origin_ = box.min() - Vec3::Constant(2.5 * step_);
  std::size_t nodes = 1;
  for (int axis = 0; axis < 3; ++axis) {
    size_[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil(box.sizes()[axis] / step_)) + 6;
    nodes *= static_cast<std::size_t>(size_[static_cast<std::size_t>(axis)]);
  }
  std::vector<Vec3> vertices;
  for (const Vec3& v : surface.vertices) vertices.emplace_back((v - origin_) / step_);
  distance_.assign(nodes, std::numeric_limits<float>::infinity());
  nearest_.assign(nodes, none);
  find_distances(vertices, surface.faces, progress);
  const std::vector<std::uint8_t> inside = find_inside(vertices, surface.faces, progress);
  GridDomain domain;
  domain.size = size_;
  domain.slot_of.assign(nodes, none);
  for (std::size_t node = 0; node < nodes; ++node)
    if (inside[node] != 0) {
      domain.slot_of[node] = static_cast<std::uint32_t>(domain.node_of.size());
      domain.node_of.push_back(static_cast<std::uint32_t>(node));
    }
  cut_links(domain, vertices, surface.faces, progress);
  multigrid_ = std::make_unique<GridMultigrid>(std::move(domain));
  extrapolate_outwards(vertices, surface.faces, progress);
}

void DirichletGrid::find_distances(const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                                   const Progress& progress) {
  for (std::uint32_t number_of_face = 0; number_of_face < faces.size(); ++number_of_face) {
    progress.at(task, 0);
    const Face& face = faces[number_of_face];
    const Vec3 &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
    std::array<int, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      low[k] = std::max(0, static_cast<int>(std::ceil(std::min({a[axis], b[axis], c[axis]}) - cell_reach)));
      high[k] =
          std::min(size_[k] - 1, static_cast<int>(std::floor(std::max({a[axis], b[axis], c[axis]}) + cell_reach)));
    }
    const Vec3 normal = (b - a).cross(c - a).stableNormalized();
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) {
          const Vec3 p(x, y, z);
          if (!(std::abs(normal.dot(p - a)) <= cell_reach)) continue;
          const auto distance = static_cast<float>((p - weighted(nearest_on(p, a, b, c), vertices, face)).norm());
          const std::size_t node = number(x, y, z);
          if (distance > static_cast<float>(cell_reach) || distance >= distance_[node]) continue;
          distance_[node] = distance;
          nearest_[node] = number_of_face;
        }
  }
}

// Classifies nodes by winding number: each node near the surface, and one node per connected component (flood fill) of
// the others.
std::vector<std::uint8_t> DirichletGrid::find_inside(const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                                                     const Progress& progress) const {
  constexpr std::uint8_t unknown = 2;
  std::vector<std::uint8_t> inside(distance_.size(), unknown);
  const auto is_inside = [&](std::size_t node) -> std::uint8_t {
    return winding_number(place_of(node), vertices, faces) > 0.5 ? 1 : 0;
  };
  const std::size_t layer = static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]);
  tbb::parallel_for(std::size_t{0}, inside.size() / layer, [&](std::size_t z) {
    progress.at(task, 0);
    for (std::size_t node = z * layer; node < (z + 1) * layer; ++node)
      if (distance_[node] <= clear_of_surface) inside[node] = is_inside(node);
  });
  const auto nx = static_cast<std::size_t>(size_[0]), ny = static_cast<std::size_t>(size_[1]),
             nz = static_cast<std::size_t>(size_[2]);
  std::vector<std::size_t> open;
  for (std::size_t seed = 0; seed < inside.size(); ++seed) {
    if (inside[seed] != unknown) continue;
    const std::uint8_t side = is_inside(seed);
    inside[seed] = side;
    open.push_back(seed);
    while (!open.empty()) {
      const std::size_t node = open.back();
      open.pop_back();
      const std::size_t x = node % nx, y = node / nx % ny, z = node / nx / ny;
      const auto visit = [&](bool exists, std::size_t next) {
        if (!exists || inside[next] != unknown) return;
        inside[next] = side;
        open.push_back(next);
      };
      visit(x > 0, node - 1);
      visit(x + 1 < nx, node + 1);
      visit(y > 0, node - nx);
      visit(y + 1 < ny, node + nx);
      visit(z > 0, node - nx * ny);
      visit(z + 1 < nz, node + nx * ny);
    }
  }
  return inside;
}

// Intersections of grid lines with faces. A line through an edge intersects both of its faces, never neither.
std::vector<DirichletGrid::LinkCut> DirichletGrid::line_cuts(const GridDomain& domain,
                                                             const std::vector<Vec3>& vertices,
                                                             const std::vector<Face>& faces,
                                                             const Progress& progress) const {
  std::vector<LinkCut> hits;
  const auto add = [&](std::ptrdiff_t node, std::size_t direction, double share, const SurfacePoint& point) {
    if (domain.slot_of[static_cast<std::size_t>(node)] != none)
      hits.push_back({static_cast<std::size_t>(node), direction, std::max(share, min_cut), point});
  };
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    progress.at(task, 0);
    for (int axis = 0; axis < 3; ++axis) {
      const int right = (axis + 1) % 3, up = (axis + 2) % 3;
      const std::array<const Vec3*, 3> corners{&vertices[faces[f][0]], &vertices[faces[f][1]], &vertices[faces[f][2]]};
      const auto edge = [&](std::size_t k, double r, double u) {
        const Vec3 &s = *corners[(k + 1) % 3], &e = *corners[(k + 2) % 3];
        return (e[right] - s[right]) * (u - s[up]) - (e[up] - s[up]) * (r - s[right]);
      };
      const double area = edge(0, (*corners[0])[right], (*corners[0])[up]);
      if (area == 0) continue;
      constexpr double slack = 1e-9;  // relative to the triangle's size
      const auto range = [&](int along) {
        const double least = std::min({(*corners[0])[along], (*corners[1])[along], (*corners[2])[along]}),
                     most = std::max({(*corners[0])[along], (*corners[1])[along], (*corners[2])[along]});
        return std::pair(static_cast<int>(std::ceil(least - slack * (most - least))),
                         static_cast<int>(std::floor(most + slack * (most - least))));
      };
      const auto [first_r, last_r] = range(right);
      const auto [first_u, last_u] = range(up);
      for (int u = first_u; u <= last_u; ++u)
        for (int r = first_r; r <= last_r; ++r) {
          SurfacePoint point{f, {}};
          for (std::size_t k = 0; k < 3; ++k) point.corners[k] = edge(k, r, u) / area;
          if (std::any_of(point.corners.begin(), point.corners.end(), [](double w) { return !(w >= -slack); }))
            continue;
          double sum = 0;
          for (double& w : point.corners) sum += w = std::max(w, 0.0);
          for (double& w : point.corners) w /= sum;
          const double t = weighted(point.corners, vertices, faces[f])[axis];
          std::array<int, 3> at;
          at[static_cast<std::size_t>(right)] = r;
          at[static_cast<std::size_t>(up)] = u;
          at[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(t));
          const auto node = static_cast<std::ptrdiff_t>(number(at[0], at[1], at[2]));
          const double share = t - std::floor(t);
          const auto back = static_cast<std::size_t>(2 * axis), on = back + 1;
          const std::ptrdiff_t stride = domain.stride(on);
          add(node, on, share, point);
          add(node + stride, back, 1 - share, point);
          // The links of a node on the surface are cut on both sides.
          if (share < min_cut) {
            add(node, back, 0, point);
            add(node - stride, on, 1, point);
          }
          if (1 - share < min_cut) {
            add(node + stride, on, 0, point);
            add(node + 2 * stride, back, 1, point);
          }
        }
    }
  }
  return hits;
}

// If rounding missed the intersection between an inside and an outside node, the surface point nearest to the closer
// node stands in. Returns a flag per slot and direction: whether the link is cut.
std::vector<std::uint8_t> DirichletGrid::add_missed_cuts(const GridDomain& domain, const std::vector<Vec3>& vertices,
                                                         const std::vector<Face>& faces,
                                                         std::vector<LinkCut>& hits) const {
  std::vector<std::uint8_t> cut(domain.node_of.size() * grid_directions, 0);
  for (const LinkCut& hit : hits) cut[domain.slot_of[hit.node] * grid_directions + hit.direction] = 1;
  for (std::size_t slot = 0; slot < domain.node_of.size(); ++slot)
    for (std::size_t direction = 0; direction < grid_directions; ++direction) {
      const std::size_t node = domain.node_of[slot];
      const auto next = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(node) + domain.stride(direction));
      if (cut[slot * grid_directions + direction] != 0 || domain.slot_of[next] != none) continue;
      const bool here = distance_[node] <= distance_[next];
      const std::size_t beside = here ? node : next;
      const Face& face = faces[nearest_[beside]];
      hits.push_back(
          {node,
           direction,
           here ? min_cut : 1.0,
           {nearest_[beside], nearest_on(place_of(beside), vertices[face[0]], vertices[face[1]], vertices[face[2]])}});
      cut[slot * grid_directions + direction] = 1;
    }
  return cut;
}

void DirichletGrid::cut_links(GridDomain& domain, const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                              const Progress& progress) {
  std::vector<LinkCut> hits = line_cuts(domain, vertices, faces, progress);
  const std::vector<std::uint8_t> cut = add_missed_cuts(domain, vertices, faces, hits);
  domain.cuts_of.assign(domain.node_of.size(), none);
  for (std::uint32_t slot = 0; slot < domain.node_of.size(); ++slot) {
    const auto* flags = &cut[slot * grid_directions];
    if (std::none_of(flags, flags + grid_directions, [](auto flag) { return flag != 0; })) continue;
    domain.cuts_of[slot] = static_cast<std::uint32_t>(domain.cut_slots.size());
    domain.cut_slots.push_back(slot);
  }
  domain.cuts.resize(domain.cut_slots.size());
  cut_points_.assign(domain.cut_slots.size(), {none, none, none, none, none, none});
  for (const LinkCut& hit : hits) {
    const std::uint32_t row = domain.cuts_of[domain.slot_of[hit.node]];
    double& nearest = domain.cuts[row][hit.direction];
    std::uint32_t& point = cut_points_[row][hit.direction];
    if (point == none) {
      point = static_cast<std::uint32_t>(surface_.size());
      surface_.push_back(hit.point);
    } else if (hit.share < nearest) {
      surface_[point] = hit.point;
    } else {
      continue;
    }
    nearest = hit.share;
  }
}

void DirichletGrid::extrapolate_outwards(const std::vector<Vec3>& vertices, const std::vector<Face>& faces,
                                         const Progress& progress) {
  const GridDomain& domain = multigrid_->domain();
  outer_index_.assign(distance_.size(), none);
  for (std::uint32_t node = 0; node < distance_.size(); ++node) {
    if (nearest_[node] == none || domain.slot_of[node] != none) continue;
    const Face& face = faces[nearest_[node]];
    const SurfacePoint foot{nearest_[node],
                            nearest_on(place_of(node), vertices[face[0]], vertices[face[1]], vertices[face[2]])};
    outer_index_[node] = static_cast<std::uint32_t>(outer_.size());
    outer_.push_back({node, static_cast<std::uint32_t>(surface_.size()), weighted(foot.corners, vertices, face)});
    surface_.push_back(foot);
  }
  std::vector<Vec3> places;
  places.reserve(surface_.size());
  for (const SurfacePoint& point : surface_) places.push_back(weighted(point.corners, vertices, faces[point.face]));
  std::vector<std::vector<Term>> terms(outer_.size());
  tbb::parallel_for(std::size_t{0}, outer_.size(), [&](std::size_t k) {
    if (k % 1024 == 0) progress.at(task, 0);
    terms[k] = extrapolation_terms(outer_[k], search_radius, places);
    if (terms[k].empty()) terms[k] = extrapolation_terms(outer_[k], wide_search_radius, places);
  });
  first_term_.assign(1, 0);
  for (std::size_t k = 0; k < outer_.size(); ++k) {
    terms_.insert(terms_.end(), terms[k].begin(), terms[k].end());
    first_term_.push_back(terms_.size());
    if (terms[k].empty()) isolated_nodes_.push_back(inside_nodes() + k);
  }
}

// Linear extrapolation: the value at the foot plus a gradient. The gradient is fitted by weighted least squares to
// inside nodes and to the surface points where their links are cut.
std::vector<DirichletGrid::Term> DirichletGrid::extrapolation_terms(const OuterNode& outer, double reach,
                                                                    const std::vector<Vec3>& surface_places) const {
  const GridDomain& domain = multigrid_->domain();
  const auto inside = static_cast<std::uint32_t>(domain.node_of.size());
  const Vec3 place = place_of(outer.node), out = place - outer.foot_place;
  struct Sample {
    std::uint32_t source;
    Vec3 from_foot;
    double weight;
  };
  std::vector<Sample> samples;
  Mat3 moments = Mat3::Zero();
  const auto add = [&](std::uint32_t source, const Vec3& at) {
    const double square = (at - place).squaredNorm();
    if (square > reach * reach) return;
    const Vec3 from_foot = at - outer.foot_place;
    const double weight = 1 / ((0.25 + square) * (0.25 + square));
    samples.push_back({source, from_foot, weight});
    moments += weight * from_foot * from_foot.transpose();
  };
  const int whole = static_cast<int>(reach);
  std::array<int, 3> low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int at = static_cast<int>(place[static_cast<Eigen::Index>(axis)]);
    low[axis] = std::max(0, at - whole);
    high[axis] = std::min(size_[axis] - 1, at + whole);
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const std::uint32_t slot = domain.slot_of[number(x, y, z)];
        // Only samples on the side of the surface where the foot is, not those across a gap.
        if (slot == none || (Vec3(x, y, z) - outer.foot_place).dot(out) > 0) continue;
        add(slot, Vec3(x, y, z));
        const std::uint32_t row = domain.cuts_of[slot];
        if (row == none) continue;
        for (const std::uint32_t point : cut_points_[row])
          if (point != none) add(inside + point, surface_places[point]);
      }
  if (samples.size() < 3) return {};
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(moments);
  constexpr double min_spread = 1e-3;
  if (!(axes.eigenvalues()[0] >= min_spread * axes.eigenvalues()[2])) return {};
  const Vec3 pull = axes.eigenvectors() * (axes.eigenvectors().transpose() * out).cwiseQuotient(axes.eigenvalues());
  std::vector<Term> terms;
  double rest = 1;
  for (const Sample& sample : samples) {
    const double coefficient = sample.weight * pull.dot(sample.from_foot);
    terms.push_back({sample.source, coefficient});
    rest -= coefficient;
  }
  terms.push_back({inside + outer.foot, rest});
  return terms;
}

void DirichletGrid::solve(const std::vector<GridLanes>& surface_values, std::vector<GridLanes>& values,
                          const std::function<void()>& check_stop) {
  const GridDomain& domain = multigrid_->domain();
  const std::size_t inside = inside_nodes();
  std::vector<GridLanes> right(inside, GridLanes::Zero());
  for (std::size_t row = 0; row < cut_points_.size(); ++row)
    for (std::size_t direction = 0; direction < grid_directions; ++direction)
      if (const std::uint32_t point = cut_points_[row][direction]; point != none)
        right[domain.cut_slots[row]] += multigrid_->surface_coefficient(row, direction) * surface_values[point];
  values.resize(nodes());
  const std::vector<GridLanes>& solved = multigrid_->solve(right, check_stop);
  std::copy(solved.begin(), solved.begin() + static_cast<std::ptrdiff_t>(inside), values.begin());
  tbb::parallel_for(std::size_t{0}, outer_.size(), [&](std::size_t k) {
    GridLanes sum = GridLanes::Zero();
    for (std::size_t t = first_term_[k]; t < first_term_[k + 1]; ++t) {
      const Term& term = terms_[t];
      sum += term.coefficient * (term.source < inside ? values[term.source] : surface_values[term.source - inside]);
    }
    values[inside + k] = sum;
  });
}

bool DirichletGrid::find_cell(const Vec3& point, Cell& cell) const {
  const Vec3 at = (point - origin_) / step_;
  std::array<int, 3> low;
  for (int axis = 0; axis < 3; ++axis) {
    const double floor = std::floor(at[axis]);
    if (!(floor >= 0 && floor + 1 < size_[static_cast<std::size_t>(axis)])) return false;
    low[static_cast<std::size_t>(axis)] = static_cast<int>(floor);
    cell.at[axis] = at[axis] - floor;
  }
  const GridDomain& domain = multigrid_->domain();
  for (std::size_t k = 0; k < 8; ++k) {
    const std::size_t node = number(low[0] + static_cast<int>(k & 1U), low[1] + static_cast<int>((k >> 1U) & 1U),
                                    low[2] + static_cast<int>(k >> 2U));
    if (domain.slot_of[node] != none)
      cell.nodes[k] = domain.slot_of[node];
    else if (outer_index_[node] != none)
      cell.nodes[k] = static_cast<std::uint32_t>(domain.node_of.size()) + outer_index_[node];
    else
      return false;
  }
  return true;
}

}  // namespace rebake
