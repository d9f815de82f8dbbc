#include "mesh_ops/light/learned/unet_transfer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace rebake {

namespace {

// Appends the six input planes: positions relative to the centre of the body at rest, in half diagonals of its box, and
// unit normals.
void append_image(const GeometryImage& image, const Box& box, const std::vector<LightSite>& sites,
                  std::vector<float>& planes) {
  const std::size_t texels = image.texels().size(), first = planes.size();
  planes.resize(first + unet_inputs * texels);
  const double half = box.diagonal().norm() / 2;
  for (std::size_t t = 0; t < texels; ++t) {
    const GeometryImage::Texel& texel = image.texels()[t];
    Vec3 position = Vec3::Zero(), normal = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double w = static_cast<double>(texel.weights[static_cast<Eigen::Index>(k)]);
      position += w * sites[texel.vertices[k]].position;
      normal += w * sites[texel.vertices[k]].normal;
    }
    position = (position - box.center()) / (half > 0 ? half : 1);
    normal = normal.stableNorm() > 0 ? normal.stableNormalized() : Vec3(0, 0, 0);
    for (std::size_t c = 0; c < 3; ++c) {
      planes[first + c * texels + t] = static_cast<float>(position[static_cast<Eigen::Index>(c)]);
      planes[first + (3 + c) * texels + t] = static_cast<float>(normal[static_cast<Eigen::Index>(c)]);
    }
  }
}

void check(const UnetTransfer::State& state) {
  const auto vertices = static_cast<std::size_t>(state.mean.size()) / sh::count;
  const bool fits =
      state.side >= 64 && state.side <= 1024 && vertices > 0 &&
      static_cast<std::size_t>(state.mean.size()) == vertices * sh::count && !state.box.isEmpty() &&
      state.box.min().allFinite() && state.box.max().allFinite() && state.mean.allFinite() &&
      std::isfinite(state.scale) &&
      std::all_of(state.weights.begin(), state.weights.end(), [](float weight) { return std::isfinite(weight); });
  if (!fits) throw std::invalid_argument("the sizes of the image and the mean of a U-Net do not match");
  check_chart(state.chart, vertices);
}

}  // namespace

UnetTransfer::Training::Training(ProxyMesh rest, GeometryImage image)
    : rest_(std::move(rest)), image_(std::move(image)) {}

void UnetTransfer::Training::add(const std::vector<LightSite>& sites, const std::vector<Mat3>& turns,
                                 const std::vector<sh::Coefficients>& transfer) {
  append_image(image_, bounds(rest_), sites, images_);
  std::vector<sh::Coefficients> local(transfer.size());
  tbb::parallel_for(std::size_t{0}, local.size(),
                    [&](std::size_t i) { local[i] = sh::Rotation(turns[i].transpose()) * transfer[i]; });
  for (const sh::Coefficients& one : local)
    for (const double value : one) local_.push_back(static_cast<float>(value));
  ++poses_;
}

UnetTransfer UnetTransfer::Training::learned(const UnetTraining& options, const Progress& progress) const {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t texels = image_.texels().size(), own = rest_.vertices.size() * sh::count;
  Eigen::VectorXf mean = Eigen::VectorXf::Zero(static_cast<Eigen::Index>(own));
  const auto of_pose = [&](std::size_t p) {
    return Eigen::Map<const Eigen::VectorXf>(local_.data() + p * own, static_cast<Eigen::Index>(own));
  };
  for (std::size_t p = 0; p < poses_; ++p) mean += of_pose(p) / static_cast<float>(poses_);
  // One scale for all coefficients, so that large ones count most, as they do in pictures.
  UnetImages images{image_.side(), poses_, images_, {}};
  images.targets.reserve(poses_ * unet_outputs * texels);
  double squares = 0;
  for (std::size_t p = 0; p < poses_; ++p) {
    const Eigen::VectorXf away = of_pose(p) - mean;
    for (std::size_t c = 0; c < sh::count; ++c)
      for (const GeometryImage::Texel& texel : image_.texels()) {
        float value = 0;
        for (std::size_t k = 0; k < 3; ++k)
          value += texel.weights[static_cast<Eigen::Index>(k)] *
                   away[static_cast<Eigen::Index>(texel.vertices[k] * sh::count + c)];
        images.targets.push_back(value);
        squares += static_cast<double>(value) * static_cast<double>(value);
      }
  }
  const std::size_t values = unet_outputs * texels;
  const double deviation = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, poses_ * values)));
  const float scale = deviation > 0 ? static_cast<float>(deviation) : 1.0F;
  for (float& value : images.targets) value /= scale;
  const Unet net = train_unet(images, options, progress);
  return UnetTransfer({image_.chart(), image_.side(), options.channels, net.weights(), bounds(rest_), std::move(mean),
                       scale, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
}

UnetTransfer::UnetTransfer(State state)
    : state_((check(state), std::move(state))),
      image_(state_.chart, state_.side),
      net_(UnetForm::added, state_.side, state_.channels, state_.weights) {}

Eigen::VectorXf UnetTransfer::predict(const std::vector<LightSite>& sites) const {
  std::vector<float> planes;
  append_image(image_, state_.box, sites, planes);
  return state_.mean + state_.scale * image_.at_vertices(net_.run(planes), sh::count);
}

std::uint64_t UnetTransfer::memory() const {
  return (state_.weights.size() + static_cast<std::size_t>(state_.mean.size())) * sizeof(float) +
         image_.texels().size() * sizeof(GeometryImage::Texel);
}

}  // namespace rebake
