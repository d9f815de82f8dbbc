#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/features/distill/fuse_training.h"

namespace rebake {

namespace {

using Branch = Student::Branch;

// The two features to which colours are least sensitive, over the sample.
std::array<Eigen::Index, 2> least_sensitive_features(const Composition& composition, const TexelSample& sample) {
  const std::vector<FeatureNetwork> teachers = networks_of(composition);
  std::array<double, texel_features> change{};
  for (const TexelSample::Piece& piece : sample.pieces) {
    const FeatureNetwork& teacher = teachers[composition.parts[piece.part].teacher];
    std::vector<Lanes> work(network_kernels().workspace(teacher.view()));
    Lanes colors[3], moved[3];
    const Vec3& direction = piece.directions.front();
    teacher_colors(teacher, piece.group, direction, 1, 0, colors, work.data());
    for (std::size_t c = 0; c < texel_features; ++c) {
      // A step of the size of rounding errors: alpha channels of split folders have one bit less.
      TexelGroup other = piece.group;
      const float step = (c % 4 == 3 ? 4.0F : 2.0F) / 255;
      for (float& value : other.features[c].at) value += value > 0.5F ? -step : step;
      teacher_colors(teacher, other, direction, 1, 0, moved, work.data());
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < network_lanes; ++l) {
          const auto off = static_cast<double>(moved[k].at[l] - colors[k].at[l]);
          change[c] += off * off;
        }
    }
  }
  std::array<Eigen::Index, texel_features> order{0, 1, 2, 3, 4, 5, 6, 7};
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return change[static_cast<std::size_t>(a)] < change[static_cast<std::size_t>(b)];
  });
  return {std::min(order[0], order[1]), std::max(order[0], order[1])};
}

// Up to `wanted` representative rotations of a teacher's bent texels: k-means with farthest-point initialisation, with
// `known` as fixed centres.
std::vector<Mat3> representative_rotations(const Composition& composition, const TexelSample& sample,
                                           std::size_t teacher, std::vector<Mat3> known, std::size_t wanted) {
  std::vector<Mat3> turns;
  for (const TexelSample::Piece& piece : sample.pieces) {
    const Composition::Part& part = composition.parts[piece.part];
    if (part.teacher != teacher || !part.bent) continue;
    Mat3 turn;
    for (Eigen::Index k = 0; k < 9; ++k)
      turn(k / 3, k % 3) = static_cast<double>(piece.group.turn[static_cast<std::size_t>(k)].at[0]);
    turns.push_back(turn);
  }
  const std::size_t fixed = known.size();
  const auto nearest = [&](const Mat3& turn) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < known.size(); ++k)
      if ((known[k] - turn).squaredNorm() < (known[best] - turn).squaredNorm()) best = k;
    return best;
  };
  for (std::size_t k = 0; k < wanted && !turns.empty(); ++k) {
    const auto far = std::max_element(turns.begin(), turns.end(), [&](const Mat3& a, const Mat3& b) {
      if (known.empty()) return false;
      return (known[nearest(a)] - a).squaredNorm() < (known[nearest(b)] - b).squaredNorm();
    });
    // All rotations are represented.
    if (!known.empty() && (known[nearest(*far)] - *far).norm() < 0.02) break;
    known.push_back(local_rotation(*far).rotation);
    for (int round = 0; round < 10; ++round) {
      std::vector<Mat3> sum(known.size(), Mat3::Zero());
      for (const Mat3& turn : turns) sum[nearest(turn)] += turn;
      for (std::size_t c = fixed; c < known.size(); ++c)
        if (sum[c].norm() > 0) known[c] = local_rotation(sum[c]).rotation;
    }
  }
  return {known.begin() + static_cast<std::ptrdiff_t>(fixed), known.end()};
}

// Up to max_branches branches: first the teachers of rigid texels, most texels first; then up to `bent_turns`
// rotations per teacher of bent texels.
std::vector<Branch> chosen_branches(const Composition& composition, const TexelSample& sample, std::size_t bent_turns) {
  struct Wanted {
    std::uint64_t rigid = 0, bent = 0;
  };
  std::vector<Wanted> texels(composition.teachers.size());
  for (const Composition::Block& block : composition.blocks) {
    const Composition::Part& part = composition.parts[block.part];
    (part.bent ? texels[part.teacher].bent : texels[part.teacher].rigid) += block.opaque;
  }
  std::vector<std::size_t> order(texels.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return texels[a].rigid + texels[a].bent > texels[b].rigid + texels[b].bent;
  });
  std::vector<Branch> branches;
  for (const std::size_t k : order)
    if (texels[k].rigid > 0 && branches.size() < max_branches) branches.push_back({k, Mat3::Identity()});
  for (const std::size_t k : order) {
    if (texels[k].bent == 0) continue;
    std::vector<Mat3> known;
    if (texels[k].rigid > 0) known.emplace_back(Mat3::Identity());
    for (const Mat3& turn : representative_rotations(composition, sample, k, known, bent_turns))
      if (branches.size() < max_branches) branches.push_back({k, turn});
  }
  // All texels are bent and none was sampled.
  if (branches.empty()) branches.push_back({order.front(), composition.frames[order.front()].transpose()});
  return branches;
}

// Border j of n sectors of the positive quadrant: a direction to one of n equal steps along the unit square's outer
// sides.
Vec2 border(std::size_t j, std::size_t n) {
  const double along = 2 * static_cast<double>(j) / static_cast<double>(n);
  return {std::min(1.0, 2 - along), std::min(1.0, along)};
}

// Smallest determinant of two adjacent borders.
double narrowest(std::size_t n) {
  double least = 1;
  for (std::size_t j = 0; j < n; ++j) {
    const Vec2 a = border(j, n), b = border(j + 1, n);
    least = std::min(least, a.x() * b.y() - a.y() * b.x());
  }
  return least;
}

// Bound of the absolute sums of a layer whose inputs are at most `largest`.
Eigen::VectorXd reach(const Eigen::MatrixXd& weights, const Eigen::VectorXd& bias, const Eigen::VectorXd& largest) {
  return weights.cwiseAbs().transpose() * largest + bias.cwiseAbs();
}

// Maps the two selecting features into the sector between two rays, `inside` away from its borders.
void encode_into_sector(Branch& branch, const std::array<Eigen::Index, 2>& selectors, const Vec2& r1, const Vec2& r2,
                        double inside) {
  const auto [c, e] = selectors;
  branch.encode(c, c) = (0.5 - inside) * r1.x();
  branch.encode(c, e) = (0.5 - inside) * r2.x();
  branch.encode(e, c) = (0.5 - inside) * r1.y();
  branch.encode(e, e) = (0.5 - inside) * r2.y();
  branch.offset[c] = inside * (r1.x() + r2.x());
  branch.offset[e] = inside * (r1.y() + r2.y());
}

}  // namespace

Student side_by_side(const Composition& composition, const TexelSample& sample, std::size_t bent_turns) {
  Student student{FeatureNetwork(decoder_inputs, 1, 1, 3),
                  std::nullopt,
                  chosen_branches(composition, sample, bent_turns),
                  0,
                  false,
                  true};
  std::vector<Branch>& branches = student.branches;
  const auto [c, e] = least_sensitive_features(composition, sample);
  const std::size_t n = branches.size();
  if (n > 1) student.selectors = 1U << c | 1U << e;
  // Distance of texels from the borders of their sector, so that rounding to bytes cannot bring them near a border.
  const double inside = 5.0 / 255 / narrowest(n);
  std::vector<Decoder> decoders;
  Eigen::Index first = static_cast<Eigen::Index>(2 * (n - 1)), second = static_cast<Eigen::Index>(n - 1);
  const Eigen::Index gates = first, constants = second;
  double most = 1;
  for (std::size_t k = 0; k < n; ++k) {
    Branch& branch = branches[k];
    if (n > 1) encode_into_sector(branch, {c, e}, border(k, n), border(k + 1, n), inside);
    Decoder decoder =
        fold_rotation(*composition.teachers[branch.teacher], branch.turn.transpose(), Axes::forward, Axes::forward);
    // The teacher's input is encode⁻¹ · (features − offset).
    decoder.weights0.topRows<8>() = branch.encode.inverse().transpose() * decoder.weights0.topRows<8>();
    decoder.bias0 -= decoder.weights0.topRows<8>().transpose() * branch.offset;
    const Eigen::VectorXd inner = reach(decoder.weights0, decoder.bias0, Eigen::VectorXd::Ones(decoder_inputs));
    most = std::max(most, reach(decoder.weights1, decoder.bias1, inner).maxCoeff());
    first += decoder.hidden0();
    second += decoder.hidden1();
    decoders.push_back(std::move(decoder));
  }
  Decoder all;
  all.weights0 = Eigen::MatrixXd::Zero(decoder_inputs, first);
  all.bias0 = Eigen::VectorXd::Zero(first);
  all.weights1 = Eigen::MatrixXd::Zero(first, second);
  all.bias1 = Eigen::VectorXd::Zero(second);
  all.weights2 = Eigen::MatrixXd::Zero(second, 3);
  all.bias2 = decoders.front().bias2;
  // A texel 2/255 inside its sector must silence all other branches, even at a coverage of a quarter.
  const double gain = std::sqrt(most / (0.25 * 2 / 255));
  for (std::size_t j = 1; j < n; ++j) {
    const Vec2 ray = border(j, n);
    const auto below = static_cast<Eigen::Index>(2 * (j - 1)), above = below + 1;
    all.weights0(c, below) = gain * ray.y();
    all.weights0(e, below) = -gain * ray.x();
    all.weights0.col(above) = -all.weights0.col(below);
  }
  Eigen::Index at0 = gates, at1 = constants;
  for (std::size_t k = 0; k < n; ++k) {
    const Decoder& d = decoders[k];
    all.weights0.middleCols(at0, d.hidden0()) = d.weights0;
    all.bias0.segment(at0, d.hidden0()) = d.bias0;
    all.weights1.block(at0, at1, d.hidden0(), d.hidden1()) = d.weights1;
    all.bias1.segment(at1, d.hidden1()) = d.bias1;
    all.weights2.middleRows(at1, d.hidden1()) = d.weights2;
    const auto silence = [&](Eigen::Index from, Eigen::Index count) {
      if (k > 0) all.weights1.row(static_cast<Eigen::Index>(2 * (k - 1))).segment(from, count).setConstant(-gain);
      if (k + 1 < n) all.weights1.row(static_cast<Eigen::Index>(2 * k + 1)).segment(from, count).setConstant(-gain);
    };
    silence(at1, d.hidden1());
    // A constant neuron adds the difference between this branch's output bias and the first branch's.
    if (k > 0) {
      const auto constant = static_cast<Eigen::Index>(k - 1);
      all.bias1[constant] = 1;
      all.weights2.row(constant) = (d.bias2 - all.bias2).transpose();
      silence(constant, 1);
    }
    at0 += d.hidden0();
    at1 += d.hidden1();
  }
  student.decoder = FeatureNetwork(all);
  return student;
}

}  // namespace rebake
