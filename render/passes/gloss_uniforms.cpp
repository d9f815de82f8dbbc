#include "render/passes/gloss_uniforms.h"

namespace rebake {

namespace {

// Normalisation constants of real spherical harmonics, which the polynomials in gloss.glsl omit.
constexpr std::array<double, sh::count> harmonic_constants{
    0.28209479177387814, 0.4886025119029199, 0.4886025119029199,  0.4886025119029199,
    1.0925484305920792,  1.0925484305920792, 0.31539156525252005, 1.0925484305920792,
    0.5462742152960396,  0.5900435899266435, 2.890611442640554,   0.4570457994644658,
    0.3731763325901154,  0.4570457994644658, 1.445305721320277,   0.5900435899266435};

}  // namespace

GlossUniforms gloss_uniforms(const Gloss& gloss) {
  GlossUniforms uniforms;
  for (std::size_t k = 0; k < uniforms.sky.size(); ++k)
    for (int c = 0; c < 3; ++c)
      uniforms.sky[k][c] = static_cast<float>(harmonic_constants[k] *
                                              gloss.sky[static_cast<std::size_t>(c)][static_cast<Eigen::Index>(k)]);
  uniforms.directions.fill(Eigen::Vector3f::Zero());
  uniforms.lights.fill(Eigen::Vector3f::Zero());
  for (std::size_t k = 0; k < gloss.suns.size(); ++k) {
    uniforms.directions[k] = gloss.suns[k].direction.cast<float>();
    uniforms.lights[k] = gloss.suns[k].irradiance.cast<float>();
  }
  uniforms.suns = static_cast<int>(gloss.suns.size());
  uniforms.sharpness = static_cast<float>(gloss.sharpness);
  return uniforms;
}

}  // namespace rebake
