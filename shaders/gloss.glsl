// Change of the specular reflection of a rotated surface: as edited minus as baked (Gloss in mesh_ops/light).
uniform sampler2D gloss_before;  // as baked, per node of the light map: xyz normal of any length, w amount of the sky
uniform sampler2D gloss_after;   // as edited, laid out like gloss_before
uniform sampler2D gloss_suns;    // amounts of suns: r as baked, g as edited
uniform vec3 gloss_sky[16];      // coefficients of real spherical harmonics, times their normalisation constants
uniform vec3 gloss_sun_direction[GLOSS_SUNS];
uniform vec3 gloss_sun_light[GLOSS_SUNS];
uniform int gloss_sun_count;
uniform float gloss_sharpness;
in vec3 baked_ray;
in vec3 object_ray;

vec3 mirrored_sky(vec3 d) {
  vec3 s = d * d;
  vec3 sum = gloss_sky[0] + gloss_sky[1] * d.y + gloss_sky[2] * d.z + gloss_sky[3] * d.x;
  sum += gloss_sky[4] * (d.x * d.y) + gloss_sky[5] * (d.y * d.z) + gloss_sky[6] * (3.0 * s.z - 1.0) +
         gloss_sky[7] * (d.x * d.z) + gloss_sky[8] * (s.x - s.y);
  sum += gloss_sky[9] * (d.y * (3.0 * s.x - s.y)) + gloss_sky[10] * (d.x * d.y * d.z) +
         gloss_sky[11] * (d.y * (5.0 * s.z - 1.0)) + gloss_sky[12] * (d.z * (5.0 * s.z - 3.0)) +
         gloss_sky[13] * (d.x * (5.0 * s.z - 1.0)) + gloss_sky[14] * (d.z * (s.x - s.y)) +
         gloss_sky[15] * (d.x * (s.x - 3.0 * s.y));
  return max(sum, vec3(0.0));
}

vec3 mirrored(vec3 ray, vec4 surface, float suns) {
  float size = length(surface.xyz);
  if (size < 1e-6) return vec3(0.0);
  vec3 normal = surface.xyz / size;
  float along = dot(normal, ray);
  vec3 mirror = ray - 2.0 * along * normal;
  vec3 sum = surface.w * mirrored_sky(mirror);
  for (int k = 0; k < gloss_sun_count; ++k) {
    float cosine = dot(mirror, gloss_sun_direction[k]);
    if (cosine > 0.0) sum += suns * pow(cosine, gloss_sharpness) * gloss_sun_light[k];
  }
  float grazing = 1.0 - min(abs(along), 1.0), square = grazing * grazing;
  return (0.04 + 0.96 * square * square * grazing) * sum;
}

vec3 gloss_change(vec2 at, vec3 gain) {
  vec2 suns = texture(gloss_suns, at).rg;
  return mirrored(normalize(object_ray), texture(gloss_after, at), suns.g) -
         gain * mirrored(normalize(baked_ray), texture(gloss_before, at), suns.r);
}
