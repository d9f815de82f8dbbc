#include "mesh_ops/light/learned/dprt_transfer.h"

#include <algorithm>
#include <chrono>

#include "mesh_ops/light/learned/dprt_ranges.h"

namespace rebake {

namespace {

// The sites of the texels, interpolated from those of the vertices.
std::vector<LightSite> texel_sites(const GeometryImage& image, const std::vector<LightSite>& sites) {
  std::vector<LightSite> result;
  result.reserve(image.texels().size());
  for (const GeometryImage::Texel& texel : image.texels()) {
    LightSite site{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const double weight = static_cast<double>(texel.weights[static_cast<Eigen::Index>(k)]);
      site.position += weight * sites[texel.vertices[k]].position;
      site.normal += weight * sites[texel.vertices[k]].normal;
    }
    site.normal = site.normal.stableNorm() > 0 ? site.normal.stableNormalized() : Vec3(0, 0, 0);
    result.push_back(site);
  }
  return result;
}

}  // namespace

void DprtTransfer::Training::add(const std::vector<LightSite>& sites, const std::vector<sh::Coefficients>& transfer) {
  texels_.push_back(texel_sites(image_, sites));
  const std::size_t texels = image_.texels().size();
  std::vector<float> planes(sh::count * texels);
  for (std::size_t t = 0; t < texels; ++t) {
    const GeometryImage::Texel& texel = image_.texels()[t];
    sh::Coefficients sum = sh::Coefficients::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      sum += static_cast<double>(texel.weights[static_cast<Eigen::Index>(k)]) * transfer[texel.vertices[k]];
    for (std::size_t c = 0; c < sh::count; ++c)
      planes[c * texels + t] = static_cast<float>(sum[static_cast<Eigen::Index>(c)]);
  }
  planes_.push_back(std::move(planes));
}

DprtTransfer DprtTransfer::Training::learned(UnetTraining options, const Progress& progress) const {
  const auto start = std::chrono::steady_clock::now();
  DprtRanges seen;
  std::size_t vertices = 0;
  for (const std::uint32_t vertex : image_.chart().source) vertices = std::max<std::size_t>(vertices, vertex + 1);
  for (std::size_t pose = 0; pose < planes_.size(); ++pose) {
    std::vector<Vec3> places;
    for (const LightSite& site : texels_[pose]) places.push_back(site.position);
    seen.add(places, planes_[pose]);
  }
  const DprtNetwork::Ranges ranges = seen.found();
  UnetImages images{image_.side(), planes_.size(), {}, {}};
  for (std::size_t pose = 0; pose < planes_.size(); ++pose) {
    const std::vector<float> image = DprtNetwork::image_of(texels_[pose], ranges);
    images.images.insert(images.images.end(), image.begin(), image.end());
    const std::vector<float> targets = dprt_targets(planes_[pose], ranges);
    images.targets.insert(images.targets.end(), targets.begin(), targets.end());
  }
  options.form = UnetForm::concatenated;
  DprtNetwork net(train_unet(images, options, progress), ranges);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {image_.chart(), vertices, std::move(net), seconds};
}

DprtTransfer::DprtTransfer(const DiskChart& chart, std::size_t vertices, DprtNetwork net, double seconds)
    : image_((check_chart(chart, vertices), chart), net.net().side()), net_(std::move(net)), seconds_(seconds) {}

Eigen::VectorXf DprtTransfer::predict(const std::vector<LightSite>& sites) const {
  return image_.at_vertices(net_.predict(texel_sites(image_, sites)), sh::count);
}

std::uint64_t DprtTransfer::memory() const {
  return net_.net().weights().size() * sizeof(float) + image_.texels().size() * sizeof(GeometryImage::Texel);
}

}  // namespace rebake
