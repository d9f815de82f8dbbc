#include "mesh_ops/light/learned/unet.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/base/processor.h"
#include "mesh_ops/light/learned/convolution.h"

namespace rebake {

namespace {

ConvolveRow convolve_row() {
#ifdef REBAKE_WIDE_VECTORS
  static const ConvolveRow best = processor_has_v3() ? convolve_row_v3 : convolve_row_baseline;
  return best;
#else
  return convolve_row_baseline;
#endif
}

// Square planes with a zero border, as in PlaneLayout.
struct Planes {
  int count, side;
  PlaneLayout layout;
  std::vector<float> values;

  Planes(int planes, int width)
      : count(planes), side(width), layout{static_cast<std::size_t>(width + 1 + convolution_lanes), 0} {
    layout.plane = layout.pitch * static_cast<std::size_t>(width + 2);
    values.assign(static_cast<std::size_t>(planes) * layout.plane + convolution_lanes, 0.0F);
  }
  float* row(int plane, int y) {
    return values.data() + static_cast<std::size_t>(plane) * layout.plane +
           static_cast<std::size_t>(y + 1) * layout.pitch + 1;
  }
  const float* row(int plane, int y) const { return const_cast<Planes*>(this)->row(plane, y); }
};

enum class After { nothing, ramp };

Planes convolved(const Planes& in, const UnetLayer& layer, const std::vector<float>& weights,
                 const std::vector<float>& bias, After after, const Planes* added = nullptr) {
  Planes out(layer.outputs, in.side / layer.stride);
  const Convolution convolution{layer.inputs, layer.outputs, layer.kernel, weights.data(), bias.data()};
  const int blocks = layer.outputs / convolution_lanes;
  // Rows narrower than a vector are computed with their zero border.
  const int width = (in.side + convolution_lanes - 1) / convolution_lanes * convolution_lanes;
  tbb::parallel_for(0, out.side * blocks, [&](int task) {
    const int y = task / blocks, block = task % blocks;
    std::vector<float> sums(static_cast<std::size_t>(width * convolution_lanes));
    convolve_row()(convolution, in.row(0, 0), in.layout, width, y * layer.stride, block, sums.data());
    for (int o = 0; o < convolution_lanes; ++o) {
      const int plane = block * convolution_lanes + o;
      float* to = out.row(plane, y);
      const float *from = sums.data() + o * width, *more = added != nullptr ? added->row(plane, y) : nullptr;
      for (int x = 0; x < out.side; ++x) {
        float value = from[x * layer.stride] + (more != nullptr ? more[x] : 0.0F);
        if (after == After::ramp) value = std::max(0.0F, value);
        to[x] = value;
      }
    }
  });
  return out;
}

Planes doubled(const Planes& in) {
  Planes out(in.count, 2 * in.side);
  for (int plane = 0; plane < in.count; ++plane)
    for (int y = 0; y < out.side; ++y) {
      float* to = out.row(plane, y);
      const float* from = in.row(plane, y / 2);
      for (int x = 0; x < out.side; ++x) to[x] = from[x / 2];
    }
  return out;
}

// The planes of both images.
Planes together(const Planes& a, const Planes& b) {
  Planes out(a.count + b.count, a.side);
  std::copy_n(a.values.begin(), static_cast<std::size_t>(a.count) * a.layout.plane, out.values.begin());
  std::copy_n(b.values.begin(), static_cast<std::size_t>(b.count) * b.layout.plane,
              out.values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(a.count) * a.layout.plane));
  return out;
}

}  // namespace

Unet::Unet(UnetForm form, int side, int channels, std::vector<float> weights)
    : form_(form), side_(side), channels_(channels), weights_(std::move(weights)) {
  if (const int step = unet_side_step(form); side < step || side % step != 0)
    throw std::invalid_argument("the side must be a positive multiple of " + std::to_string(step));
  if (weights_.size() != unet_weight_count(form, channels))
    throw std::invalid_argument("the number of weights does not match the number of channels");
  const float* next = weights_.data();
  for (const UnetLayer& layer : unet_layers(form, channels)) {
    Packed packed{layer, {}, {}};
    const auto taps = static_cast<std::size_t>(layer.inputs * layer.kernel * layer.kernel);
    packed.weights.resize(taps * static_cast<std::size_t>(layer.outputs));
    for (std::size_t o = 0; o < static_cast<std::size_t>(layer.outputs); ++o)
      for (std::size_t t = 0; t < taps; ++t)
        packed.weights[(o / convolution_lanes * taps + t) * convolution_lanes + o % convolution_lanes] =
            next[o * taps + t];
    next += packed.weights.size();
    packed.bias.assign(next, next + layer.outputs);
    next += layer.outputs;
    packed_.push_back(std::move(packed));
  }
}

std::vector<float> Unet::run(std::span<const float> image) const {
  const auto texels = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  if (image.size() != unet_inputs * texels)
    throw std::invalid_argument("the size of the image does not match the network");
  Planes x(unet_inputs, side_);
  for (int plane = 0; plane < unet_inputs; ++plane)
    for (int y = 0; y < side_; ++y)
      std::copy_n(image.data() + static_cast<std::size_t>(plane * side_ + y) * static_cast<std::size_t>(side_), side_,
                  x.row(plane, y));
  std::size_t next = 0;
  const auto apply = [&](const Planes& in, After after, const Planes* added = nullptr) {
    const Packed& p = packed_[next++];
    return convolved(in, p.layer, p.weights, p.bias, after, added);
  };
  const auto residual = [&](const Planes& in) {
    const Planes inner = apply(in, After::ramp);
    return apply(inner, After::ramp, &in);
  };
  x = apply(x, After::ramp);
  std::vector<Planes> skipped;
  const int levels = unet_levels(form_);
  for (int l = 0; l < levels; ++l) {
    skipped.push_back(residual(x));
    x = apply(skipped.back(), After::ramp);
  }
  x = residual(x);
  for (int l = levels - 1; l >= 0; --l) {
    const Planes& skip = skipped[static_cast<std::size_t>(l)];
    x = form_ == UnetForm::concatenated ? apply(together(doubled(x), skip), After::ramp)
                                        : apply(doubled(x), After::ramp, &skip);
    x = residual(x);
  }
  x = apply(x, After::nothing);
  std::vector<float> result;
  for (int plane = 0; plane < unet_outputs; ++plane)
    for (int y = 0; y < side_; ++y) result.insert(result.end(), x.row(plane, y), x.row(plane, y) + side_);
  if (form_ == UnetForm::concatenated)
    for (float& value : result) value = static_cast<float>(1 / (1 + elementary::exp(-static_cast<double>(value))));
  return result;
}

}  // namespace rebake
