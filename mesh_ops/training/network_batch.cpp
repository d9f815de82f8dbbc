// Compiled for several processor levels (mesh_ops/CMakeLists.txt): GCC maps vector types to the widest registers of
// each.
#include "mesh_ops/training/network_batch.h"

#ifndef REBAKE_NETWORK_NAME
#define REBAKE_NETWORK_NAME network_kernels_baseline
#endif

#define REBAKE_INLINE [[gnu::always_inline]] inline

namespace rebake {

namespace {

using Vector = float __attribute__((vector_size(64), may_alias));
using Integers = std::int32_t __attribute__((vector_size(64), may_alias));

constexpr std::size_t lanes = network_lanes, features_count = texel_features, triangle = 36;

REBAKE_INLINE Vector& as_vector(Lanes& lane) { return reinterpret_cast<Vector&>(lane); }
REBAKE_INLINE const Vector& as_vector(const Lanes& lane) { return reinterpret_cast<const Vector&>(lane); }
REBAKE_INLINE Vector* as_vectors(Lanes* lane) { return reinterpret_cast<Vector*>(lane); }
REBAKE_INLINE const Vector* as_vectors(const Lanes* lane) { return reinterpret_cast<const Vector*>(lane); }

REBAKE_INLINE Vector least(Vector a, Vector b) { return a < b ? a : b; }
REBAKE_INLINE Vector greatest(Vector a, Vector b) { return a > b ? a : b; }
REBAKE_INLINE Vector all(float value) { return Vector{} + value; }

// Rounds numbers below 2²² to integers: floats near 1.5 · 2²³ have no fractional bits.
constexpr float shifter = 12582912;
REBAKE_INLINE Vector rounded(Vector x) { return (x + shifter) - shifter; }

REBAKE_INLINE Vector root(Vector x) {
  Vector result;
  for (std::size_t l = 0; l < lanes; ++l) result[l] = __builtin_sqrtf(x[l]);
  return result;
}

// Error of at most 2 units in the last place. Coefficients: Moshier, Cephes Mathematical Library (1989), expf.
REBAKE_INLINE Vector exponential(Vector x) {
  x = greatest(least(x, all(87.F)), all(-87.F));
  const Vector shifted = x * 1.44269504088896341F + shifter, turns = shifted - shifter;
  const Vector r = (x - turns * 0.693359375F) + turns * 2.12194440e-4F;
  const Vector p = ((((1.9875691500e-4F * r + 1.3981999507e-3F) * r + 8.3334519073e-3F) * r + 4.1665795894e-2F) * r +
                    1.6666665459e-1F) *
                       r +
                   5.0000001201e-1F;
  const Vector power = p * (r * r) + r + 1.F;
  // The low bits of `shifted` hold the power of two; they are added to the exponent.
  return __builtin_bit_cast(Vector,
                            __builtin_bit_cast(Integers, power) + (__builtin_bit_cast(Integers, shifted) << 23));
}

REBAKE_INLINE Vector logistic(Vector x) { return 1.F / (1.F + exponential(-x)); }

// The hottest loops use vectors of register size, because GCC spills wider ones to memory.
#if defined(__AVX512F__)
constexpr std::size_t register_bytes = 64;
#elif defined(__AVX__)
constexpr std::size_t register_bytes = 32;
#else
constexpr std::size_t register_bytes = 16;
#endif
using Register = float __attribute__((vector_size(register_bytes), may_alias));
constexpr std::size_t registers = sizeof(Vector) / register_bytes;  // registers per Vector
// Registers per pass: few enough that the sums of four neurons fit.
constexpr std::size_t at_once = registers < 2 ? registers : 2;

REBAKE_INLINE Register& part(Vector& v, std::size_t k) { return reinterpret_cast<Register*>(&v)[k]; }
REBAKE_INLINE const Register& part(const Vector& v, std::size_t k) { return reinterpret_cast<const Register*>(&v)[k]; }

// Evaluates `count` neurons together, so that each input is loaded once. `values`: bias and weights of the first
// neuron.
template <std::size_t count>
REBAKE_INLINE void neurons(const float* values, std::size_t inputs, const Vector* x, Vector* y) {
  for (std::size_t first = 0; first < registers; first += at_once) {
    Register sum[count][at_once];
    for (std::size_t n = 0; n < count; ++n)
      for (std::size_t k = 0; k < at_once; ++k) sum[n][k] = Register{} + values[n * (inputs + 1)];
    for (std::size_t i = 0; i < inputs; ++i)
      for (std::size_t n = 0; n < count; ++n) {
        const float weight = values[n * (inputs + 1) + i + 1];
        for (std::size_t k = 0; k < at_once; ++k) sum[n][k] += weight * part(x[i], first + k);
      }
    for (std::size_t n = 0; n < count; ++n)
      for (std::size_t k = 0; k < at_once; ++k) part(y[n], first + k) = sum[n][k];
  }
}

void layer(const float* values, std::size_t inputs, std::size_t outputs, const Vector* x, Vector* y) {
  std::size_t j = 0;
  for (; j + 4 <= outputs; j += 4) neurons<4>(values + j * (inputs + 1), inputs, x, y + j);
  for (; j < outputs; ++j) neurons<1>(values + j * (inputs + 1), inputs, x, y + j);
}

// Backpropagates slopes (derivatives of the loss) from a layer's outputs to its inputs.
void layer_back(const float* values, std::size_t inputs, std::size_t outputs, const Vector* slopes, Vector* result) {
  for (std::size_t i = 0; i < inputs; ++i) result[i] = Vector{};
  std::size_t j = 0;
  for (; j + 4 <= outputs; j += 4) {
    const float *w0 = values + j * (inputs + 1) + 1, *w1 = w0 + inputs + 1, *w2 = w1 + inputs + 1,
                *w3 = w2 + inputs + 1;
    for (std::size_t k = 0; k < registers; ++k) {
      const Register s0 = part(slopes[j], k), s1 = part(slopes[j + 1], k), s2 = part(slopes[j + 2], k),
                     s3 = part(slopes[j + 3], k);
      for (std::size_t i = 0; i < inputs; ++i)
        part(result[i], k) += (w0[i] * s0 + w1[i] * s1) + (w2[i] * s2 + w3[i] * s3);
    }
  }
  for (; j < outputs; ++j) {
    const float* w = values + j * (inputs + 1) + 1;
    for (std::size_t k = 0; k < registers; ++k) {
      const Register slope = part(slopes[j], k);
      for (std::size_t i = 0; i < inputs; ++i) part(result[i], k) += w[i] * slope;
    }
  }
}

// Adds the derivatives of the loss by a layer's biases and weights to `gradient`.
void layer_gradient(std::size_t inputs, std::size_t outputs, const Vector* x, const Vector* slopes, Vector* gradient) {
  for (std::size_t j = 0; j < outputs; ++j, gradient += inputs + 1)
    for (std::size_t k = 0; k < registers; ++k) {
      const Register slope = part(slopes[j], k);
      part(gradient[0], k) += slope;
      for (std::size_t i = 0; i < inputs; ++i) part(gradient[i + 1], k) += slope * part(x[i], k);
    }
}

// Layout of activations and slopes in the workspace.
struct Places {
  Vector *first, *second, *first_slopes, *second_slopes, *output_slopes, *input, *input_slopes;
  Places(const NetworkView& n, Vector* w)
      : first(w),
        second(first + n.hidden0),
        first_slopes(second + n.hidden1),
        second_slopes(first_slopes + n.hidden0),
        output_slopes(second_slopes + n.hidden1),
        input(output_slopes + n.outputs),
        input_slopes(input + n.inputs) {}
};

std::size_t workspace_lanes(const NetworkView& n) { return 2 * (n.hidden0 + n.hidden1 + n.inputs) + n.outputs; }
const float* second_values(const NetworkView& n) { return n.values + n.hidden0 * (n.inputs + 1); }
const float* third_values(const NetworkView& n) { return second_values(n) + n.hidden1 * (n.hidden0 + 1); }

// ReLU and its derivative: sets each lane of x to 0 unless that of `of` is above 0.
REBAKE_INLINE void rectify(Vector* x, const Vector* of, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < registers; ++k) part(x[i], k) = part(of[i], k) > 0.F ? part(x[i], k) : Register{};
}

void evaluate(const NetworkView& n, const Vector* inputs, Vector* outputs, const Places& at) {
  layer(n.values, n.inputs, n.hidden0, inputs, at.first);
  rectify(at.first, at.first, n.hidden0);
  layer(second_values(n), n.hidden0, n.hidden1, at.first, at.second);
  rectify(at.second, at.second, n.hidden1);
  layer(third_values(n), n.hidden1, n.outputs, at.second, outputs);
  for (std::size_t o = 0; o < n.outputs; ++o) outputs[o] = logistic(outputs[o]);
}

// Backpropagation from the slopes of the outputs before the logistic function.
void evaluate_back(const NetworkView& n, const Vector* inputs, const Vector* output_slopes, Vector* gradient,
                   Vector* input_slopes, const Places& at) {
  layer_back(third_values(n), n.hidden1, n.outputs, output_slopes, at.second_slopes);
  rectify(at.second_slopes, at.second, n.hidden1);
  layer_back(second_values(n), n.hidden0, n.hidden1, at.second_slopes, at.first_slopes);
  rectify(at.first_slopes, at.first, n.hidden0);
  if (input_slopes != nullptr) layer_back(n.values, n.inputs, n.hidden0, at.first_slopes, input_slopes);
  if (gradient == nullptr) return;
  layer_gradient(n.inputs, n.hidden0, inputs, at.first_slopes, gradient);
  gradient += second_values(n) - n.values;
  layer_gradient(n.hidden0, n.hidden1, at.first, at.second_slopes, gradient);
  gradient += third_values(n) - second_values(n);
  layer_gradient(n.hidden1, n.outputs, at.second, output_slopes, gradient);
}

std::size_t workspace(const NetworkView& network) { return workspace_lanes(network); }

void forward(const NetworkView& network, const Lanes* inputs, Lanes* outputs, Lanes* work) {
  evaluate(network, as_vectors(inputs), as_vectors(outputs), Places(network, as_vectors(work)));
}

void backward(const NetworkView& network, const Lanes* inputs, const Lanes* outputs, const Lanes* slopes,
              Lanes* gradient, Lanes* input_slopes, Lanes* work) {
  const Places at(network, as_vectors(work));
  for (std::size_t o = 0; o < network.outputs; ++o) {
    const Vector out = as_vector(outputs[o]);
    at.output_slopes[o] = as_vector(slopes[o]) * (out * (1.F - out));
  }
  evaluate_back(network, as_vectors(inputs), at.output_slopes, as_vectors(gradient), as_vectors(input_slopes), at);
}

// Mean features of four texels, for each used value of ViewSample::mix; index 0 holds the texels' own features.
struct Mixed {
  static constexpr std::uint32_t ways = 5;
  Vector features[ways][features_count];
  Mixed(const Vector* own, const ViewSample* view_samples, std::size_t count) {
    bool wanted[ways] = {};
    for (std::size_t k = 0; k < count; ++k)
      if (view_samples[k].mix < ways) wanted[view_samples[k].mix] = true;
    for (std::uint32_t way = 0; way < ways; ++way)
      for (std::size_t c = 0; wanted[way] && c < features_count; ++c) {
        features[way][c] = own[c];
        if (way == 0) continue;
        for (std::size_t l = 0; l < lanes; ++l) {
          const float sum =
              (own[c][l] + own[c][(l + way) % lanes]) + (own[c][(l + 2 * way) % lanes] + own[c][(l + 3 * way) % lanes]);
          features[way][c][l] = 0.25F * sum;
        }
      }
  }
};

// Decoder inputs for a view sample. `own`: features to try; `before`: the features that `mixed` was computed from.
REBAKE_INLINE void set_inputs(const ViewSample& view_sample, const Vector* own, const Vector* before,
                              const Mixed& mixed, Vector* input) {
  for (std::size_t c = 0; c < features_count; ++c) {
    Vector value = own[c];
    if (view_sample.mix != 0) value = mixed.features[view_sample.mix][c] + 0.25F * (own[c] - before[c]);
    input[c] = view_sample.coverage * value;
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    input[features_count + axis] = view_sample.coverage * as_vector(view_sample.direction[axis]);
}

// Weighted sum of squared errors over view samples and channels.
Vector error_of(const NetworkView& n, const ViewSample* view_samples, std::size_t count, const Vector* own,
                const Vector* before, const Mixed& mixed, const Places& at) {
  Vector sum{}, out[3];
  for (std::size_t k = 0; k < count; ++k) {
    set_inputs(view_samples[k], own, before, mixed, at.input);
    evaluate(n, at.input, out, at);
    Vector here{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector off = out[c] - as_vector(view_samples[k].target[c]);
      here += off * off;
    }
    sum += view_samples[k].weight * here;
  }
  return sum;
}

// Quadratic model of the error for a change e of the features: error + 2 gᵀ e + eᵀ H e. `slope` is g; `curvature` is
// the lower triangle of H, row by row.
struct Model {
  Vector error, slope[features_count], curvature[triangle];
};

void linearise(const NetworkView& n, const ViewSample* view_samples, std::size_t count, const Vector* own,
               const Mixed& mixed, const Places& at, Model& model) {
  model.error = Vector{};
  for (Vector& v : model.slope) v = Vector{};
  for (Vector& v : model.curvature) v = Vector{};
  Vector out[3];
  for (std::size_t k = 0; k < count; ++k) {
    const ViewSample& view_sample = view_samples[k];
    set_inputs(view_sample, own, own, mixed, at.input);
    evaluate(n, at.input, out, at);
    const float scale = view_sample.coverage * (view_sample.mix == 0 ? 1.F : 0.25F);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector off = out[c] - as_vector(view_sample.target[c]);
      model.error += view_sample.weight * (off * off);
      for (std::size_t o = 0; o < 3; ++o) at.output_slopes[o] = Vector{};
      at.output_slopes[c] = scale * (out[c] * (1.F - out[c]));
      evaluate_back(n, at.input, at.output_slopes, nullptr, at.input_slopes, at);
      std::size_t place = 0;
      for (std::size_t i = 0; i < features_count; ++i) {
        const Vector weighted = view_sample.weight * at.input_slopes[i];
        model.slope[i] += weighted * off;
        for (std::size_t j = 0; j <= i; ++j) model.curvature[place++] += weighted * at.input_slopes[j];
      }
    }
  }
}

constexpr std::size_t entry(std::size_t i, std::size_t j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; }

// Damped Gauss–Newton step (Levenberg 1944, Marquardt 1963), to be subtracted from the features. Features at a bound of
// [0, 1] that would leave it stay.
void step_of(const Model& model, const Vector* own, Vector damping, Vector* step) {
  Vector a[triangle], g[features_count], trace{};
  for (std::size_t i = 0; i < triangle; ++i) a[i] = model.curvature[i];
  for (std::size_t i = 0; i < features_count; ++i) trace += a[entry(i, i)];
  for (std::size_t i = 0; i < features_count; ++i) {
    a[entry(i, i)] += damping * (trace * 0.125F);
    const Integers stays = ((own[i] <= 0.F) & (model.slope[i] > 0.F)) | ((own[i] >= 1.F) & (model.slope[i] < 0.F));
    g[i] = stays ? Vector{} : model.slope[i];
    for (std::size_t j = 0; j < features_count; ++j)
      if (j != i) a[entry(i, j)] = stays ? Vector{} : a[entry(i, j)];
  }
  for (std::size_t i = 0; i < features_count; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      Vector sum = a[entry(i, j)];
      for (std::size_t k = 0; k < j; ++k) sum -= a[entry(i, k)] * a[entry(j, k)];
      // If a feature does not change the colour, any positive pivot gives a step of 0.
      a[entry(i, j)] = i == j ? root(sum > 0.F ? sum : all(1.F)) : sum / a[entry(j, j)];
    }
  for (std::size_t i = 0; i < features_count; ++i) {
    Vector sum = g[i];
    for (std::size_t k = 0; k < i; ++k) sum -= a[entry(i, k)] * step[k];
    step[i] = sum / a[entry(i, i)];
  }
  for (std::size_t i = features_count; i-- > 0;) {
    Vector sum = step[i];
    for (std::size_t k = i + 1; k < features_count; ++k) sum -= a[entry(k, i)] * step[k];
    step[i] = sum / a[entry(i, i)];
  }
}

// Number of the nearest quantisation level.
REBAKE_INLINE Vector on_level(Vector value, const FeatureLevels& level) {
  const Vector k = rounded((value - level.first) / level.step);
  return greatest(least(k, all(level.highest)), all(level.lowest));
}

// Coordinate descent over quantisation levels on the quadratic model, starting from the nearest levels.
void search_levels(const Model& model, const TexelFit& fit, const Vector* own, Vector* found) {
  Vector off[features_count];
  for (std::size_t i = 0; i < features_count; ++i) off[i] = found[i] - own[i];
  for (int sweep = 0; sweep < 3; ++sweep)
    for (std::size_t i = 0; i < features_count; ++i) {
      if ((fit.not_searched >> i & 1) != 0) continue;
      Vector slope = model.slope[i];
      for (std::size_t j = 0; j < features_count; ++j) slope += model.curvature[entry(i, j)] * off[j];
      const Vector curvature = model.curvature[entry(i, i)];
      const Vector wanted = found[i] - slope / (curvature > 0.F ? curvature : all(1.F));
      const Vector level = on_level(greatest(least(wanted, all(1.F)), Vector{}), fit.levels[i]);
      found[i] = curvature > 0.F ? fit.levels[i].first + level * fit.levels[i].step : found[i];
      off[i] = found[i] - own[i];
    }
}

void fit_texels(const NetworkView& decoder, const ViewSample* view_samples, std::size_t count, const TexelFit& fit,
                Lanes* features, Lanes* error, Lanes* work) {
  const Places at(decoder, as_vectors(work));
  Vector own[features_count], tried[features_count], step[features_count];
  for (std::size_t c = 0; c < features_count; ++c) own[c] = as_vector(features[c]);
  Model model;
  Vector damping = all(1e-3F);
  for (std::size_t iteration = 0; iteration < fit.iterations; ++iteration) {
    const Mixed mixed(own, view_samples, count);
    linearise(decoder, view_samples, count, own, mixed, at, model);
    step_of(model, own, damping, step);
    for (std::size_t c = 0; c < features_count; ++c) tried[c] = greatest(least(own[c] - step[c], all(1.F)), Vector{});
    const Integers better = error_of(decoder, view_samples, count, tried, own, mixed, at) < model.error;
    for (std::size_t c = 0; c < features_count; ++c) own[c] = better ? tried[c] : own[c];
    damping = greatest(better ? damping * 0.3F : damping * 8.F, all(1e-4F));
  }
  if (fit.levels != nullptr) {
    for (std::size_t c = 0; c < features_count; ++c)
      tried[c] = fit.levels[c].first + on_level(own[c], fit.levels[c]) * fit.levels[c].step;
    if (fit.search) {
      const Mixed mixed(own, view_samples, count);
      linearise(decoder, view_samples, count, own, mixed, at, model);
      Vector found[features_count];
      for (std::size_t c = 0; c < features_count; ++c) found[c] = tried[c];
      search_levels(model, fit, own, found);
      const Integers better = error_of(decoder, view_samples, count, found, own, mixed, at) <
                              error_of(decoder, view_samples, count, tried, own, mixed, at);
      for (std::size_t c = 0; c < features_count; ++c) tried[c] = better ? found[c] : tried[c];
    }
    for (std::size_t c = 0; c < features_count; ++c) own[c] = tried[c];
  }
  const Mixed mixed(own, view_samples, count);
  as_vector(*error) = error_of(decoder, view_samples, count, own, own, mixed, at);
  for (std::size_t c = 0; c < features_count; ++c) as_vector(features[c]) = own[c];
}

}  // namespace

extern const NetworkKernels REBAKE_NETWORK_NAME;
const NetworkKernels REBAKE_NETWORK_NAME = {workspace, forward, backward, fit_texels};

}  // namespace rebake
