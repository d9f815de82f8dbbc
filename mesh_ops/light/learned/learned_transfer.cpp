#include "mesh_ops/light/learned/learned_transfer.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

std::vector<Vec3> picked(const std::vector<Vec3>& places, const std::vector<std::uint32_t>& numbers) {
  std::vector<Vec3> result;
  for (const std::uint32_t i : numbers) result.push_back(places[i]);
  return result;
}

Eigen::MatrixXd with_one(const Eigen::MatrixXd& coordinates) {
  Eigen::MatrixXd result(coordinates.rows() + 1, coordinates.cols());
  result << Eigen::RowVectorXd::Ones(coordinates.cols()), coordinates;
  return result;
}

// Ridge regression: weights w with w · inputs ≈ outputs, one sample per column.
Eigen::MatrixXd ridge(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& outputs, double share) {
  Eigen::MatrixXd squares = inputs * inputs.transpose();
  squares.diagonal().array() += share * static_cast<double>(inputs.cols());
  const Eigen::MatrixXd right = inputs * outputs.transpose();
  return squares.llt().solve(right).transpose();
}

Eigen::MatrixXd gaussians(const Eigen::MatrixXd& centers, const Eigen::MatrixXd& at, double width) {
  Eigen::MatrixXd values(centers.cols(), at.cols());
  for (Eigen::Index j = 0; j < at.cols(); ++j)
    for (Eigen::Index i = 0; i < centers.cols(); ++i)
      values(i, j) = std::exp(-0.5 * (centers.col(i) - at.col(j)).squaredNorm() / (width * width));
  return values;
}

}  // namespace

TransferTraining::TransferTraining(const std::vector<Vec3>& rest, std::size_t poses, Frames frames,
                                   std::size_t probe_count)
    : probes(PoseSpace::probes_of(rest, probe_count)), rest_probes(picked(rest, probes)), posed_probes(poses) {
  const auto rows = static_cast<Eigen::Index>(poses), columns = static_cast<Eigen::Index>(rest.size() * sh::count);
  local.setZero(rows, columns);
  if (frames == Frames::both) plain.setZero(rows, columns);
}

std::vector<Vec3> TransferTraining::probes_in(const std::vector<Vec3>& places) const { return picked(places, probes); }

void TransferTraining::set(std::size_t k, const std::vector<Vec3>& places, const std::vector<Mat3>& turns,
                           const std::vector<sh::Coefficients>& transfer) {
  posed_probes[k] = probes_in(places);
  const auto row = static_cast<Eigen::Index>(k);
  tbb::parallel_for(std::size_t{0}, transfer.size(), [&](std::size_t i) {
    const auto column = static_cast<Eigen::Index>(i * sh::count);
    if (plain.size() > 0) plain.block<1, sh::count>(row, column) = transfer[i].transpose().cast<float>();
    const sh::Coefficients back = sh::Rotation(turns[i].transpose()) * transfer[i];
    local.block<1, sh::count>(row, column) = back.transpose().cast<float>();
  });
}

namespace {

// Adds Gaussian kernels to a linear model if they reduce `least`, the error on the held-out poses. Columns of
// `coordinates` and `scores` are poses; `share`: regularisation of the linear model.
void add_kernels(LearnedTransfer& model, const Eigen::MatrixXd& coordinates, const Eigen::MatrixXd& scores,
                 double share, const std::vector<Eigen::Index>& kept, const std::vector<Eigen::Index>& held,
                 double& least) {
  const Eigen::MatrixXd inputs = with_one(coordinates);
  const Eigen::MatrixXd kept_inputs = inputs(Eigen::all, kept), held_inputs = inputs(Eigen::all, held),
                        kept_scores = scores(Eigen::all, kept), held_scores = scores(Eigen::all, held);
  const Eigen::MatrixXd linear = ridge(kept_inputs, kept_scores, share);
  const Eigen::MatrixXd kept_places = coordinates(Eigen::all, kept), held_places = coordinates(Eigen::all, held);
  const Eigen::MatrixXd over = kept_scores - linear * kept_inputs, held_over = held_scores - linear * held_inputs;
  const double unit = std::sqrt(static_cast<double>(std::max<Eigen::Index>(1, coordinates.rows())));
  double best_width = 0, best_noise = 0;
  for (const double width : {0.5, 1.0, 2.0, 4.0, 8.0})
    for (const double noise : {1e-6, 1e-4, 1e-2, 1e-1}) {
      Eigen::MatrixXd among = gaussians(kept_places, kept_places, width * unit);
      among.diagonal().array() += noise;
      const Eigen::MatrixXd weights = among.llt().solve(over.transpose()).transpose();
      const double error = (weights * gaussians(kept_places, held_places, width * unit) - held_over).squaredNorm();
      if (!(error < least)) continue;
      least = error;
      best_width = width * unit;
      best_noise = noise;
    }
  // Kernels are used only if they reduce the held-out error.
  if (best_width > 0) {
    model.width = best_width;
    model.centers = coordinates;
    Eigen::MatrixXd among = gaussians(coordinates, coordinates, best_width);
    among.diagonal().array() += best_noise;
    model.kernel = among.llt().solve((scores - model.linear * inputs).transpose()).transpose();
  }
}

}  // namespace

LearnedTransfer LearnedTransfer::learned(const TransferTraining& training, const Options& options,
                                         const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const Eigen::MatrixXf& rows = options.way == TransferMethod::linear ? training.plain : training.local;
  const Eigen::Index poses = rows.rows();
  if (poses < 8) throw Error("too few poses: training needs at least 8");
  LearnedTransfer model;
  model.way = options.way;
  model.probes = training.probes;
  model.space = PoseSpace(training.rest_probes, training.posed_probes);
  Eigen::MatrixXd coordinates(model.space.dimensions(), poses);
  for (Eigen::Index k = 0; k < poses; ++k)
    coordinates.col(k) = model.space.place(training.posed_probes[static_cast<std::size_t>(k)]).coordinates;

  progress.at("principal components", 0.1);
  model.mean = rows.colwise().mean();
  const Eigen::MatrixXf away = rows.rowwise() - model.mean.transpose();
  const Eigen::MatrixXf products = away * away.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(products.cast<double>());
  Eigen::Index rank = 0;
  // Eigenvalues below a millionth of the largest are rounding errors of floats.
  while (rank < std::min<Eigen::Index>(options.rank, poses) &&
         eigen.eigenvalues()[poses - 1 - rank] > 1e-6 * eigen.eigenvalues()[poses - 1])
    ++rank;
  const Eigen::MatrixXd vectors = eigen.eigenvectors().rightCols(rank).rowwise().reverse();
  if (rank == 0) {
    // Transfer does not depend on the pose: the mean is the prediction.
    model.linear.setZero(0, coordinates.rows() + 1);
    model.components.resize(rows.cols(), 0);
    return model;
  }
  const Eigen::VectorXd sizes = eigen.eigenvalues().tail(rank).reverse().cwiseMax(0.0).cwiseSqrt();
  model.components = away.transpose() * (vectors * sizes.cwiseInverse().asDiagonal()).cast<float>();
  const Eigen::MatrixXd scores = sizes.asDiagonal() * vectors.transpose();  // one column per pose

  progress.at("weights", 0.6);
  // Every eighth pose is held out to select the hyperparameters; then all poses are fitted.
  std::vector<Eigen::Index> kept, held;
  for (Eigen::Index k = 0; k < poses; ++k) (k % 8 == 7 ? held : kept).push_back(k);
  const Eigen::MatrixXd inputs = with_one(coordinates);
  const Eigen::MatrixXd kept_inputs = inputs(Eigen::all, kept), held_inputs = inputs(Eigen::all, held),
                        kept_scores = scores(Eigen::all, kept), held_scores = scores(Eigen::all, held);
  double least = std::numeric_limits<double>::infinity(), best_share = 0;
  for (const double share : {1e-8, 1e-4, 1e-3, 1e-2, 1e-1, 1.0}) {
    const double error = (ridge(kept_inputs, kept_scores, share) * held_inputs - held_scores).squaredNorm();
    if (error < least) {
      least = error;
      best_share = share;
    }
  }
  model.linear = ridge(inputs, scores, best_share);
  if (options.way == TransferMethod::rotated_kernel) {
    add_kernels(model, coordinates, scores, best_share, kept, held, least);
  }
  const double all = static_cast<double>(products.trace()), cut = std::max(0.0, all - sizes.squaredNorm());
  const double truth = static_cast<double>(rows.squaredNorm());
  model.held_back_error =
      truth > 0 ? std::sqrt((least * static_cast<double>(poses) / static_cast<double>(held.size()) + cut) / truth) : 0;
  model.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return model;
}

Eigen::VectorXf LearnedTransfer::predict(const PoseSpace::Place& place) const {
  Eigen::VectorXd inputs(place.coordinates.size() + 1);
  inputs << 1, place.coordinates;
  Eigen::VectorXd weights = linear * inputs;
  if (centers.size() > 0) weights += kernel * gaussians(centers, place.coordinates, width);
  const Eigen::VectorXf rounded = weights.cast<float>();
  Eigen::VectorXf result = mean;
  constexpr Eigen::Index block = 4096;
  tbb::parallel_for(Eigen::Index{0}, (result.size() + block - 1) / block, [&](Eigen::Index b) {
    const Eigen::Index size = std::min(block, result.size() - b * block);
    result.segment(b * block, size).noalias() += components.middleRows(b * block, size) * rounded;
  });
  return result;
}

std::vector<Vec3> LearnedTransfer::probes_in(const std::vector<Vec3>& places) const { return picked(places, probes); }

void LearnedTransfer::drop_weights() {
  mean.resize(0);
  components.resize(0, 0);
  linear.resize(0, space.dimensions() + 1);
}

std::uint64_t LearnedTransfer::memory() const {
  return static_cast<std::uint64_t>(mean.size() + components.size()) * sizeof(float) +
         static_cast<std::uint64_t>(linear.size() + centers.size() + kernel.size() + space.axes.size()) *
             sizeof(double);
}

}  // namespace rebake
