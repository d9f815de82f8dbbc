#include "unpack.glsl"
#if DECODER_BUFFER
#include "decoder_buffer.glsl"
#endif
uniform usampler2D features;
#if WRITES_FRAME
uniform usampler2D frames;
// 4 entries per frame: columns of camera_to_fed; decoder, alpha factor, alpha offset
#if FRAME_TEXTURE
uniform sampler2D frame_table;  // a row per frame
vec4 frame_entry(int k) { return texelFetch(frame_table, ivec2(k & 3, k >> 2), 0); }
#else
uniform samplerBuffer frame_table;
vec4 frame_entry(int k) { return texelFetch(frame_table, k); }
#endif
uniform float decoder_count;
#else
uniform mat3 camera_to_fed;
uniform vec2 alpha_code;
#endif
#if WRITES_RAY
uniform sampler2D rays;
#endif
#if WRITES_LIGHT
#include "relight.glsl"
uniform sampler2D light_gain;
uniform sampler2D light_offset;
#endif
uniform vec2 ray_scale;   // camera-space ray of a sample = (sample + 0.5) * ray_scale + ray_offset, z = -1
uniform vec2 ray_offset;
uniform vec4 background;  // alpha 0: transparent, with premultiplied colours
out vec4 picture;

const float samples = float(SIDE * SIDE);

// Sums of gain and offset over covered samples.
#if WRITES_LIGHT
struct LightSum {
  vec3 gain;
  vec3 offset;
};
void add_light(inout LightSum sum, ivec2 at) {
  sum.gain += texelFetch(light_gain, at, 0).rgb;
#if WRITES_LIGHT > 1
  sum.offset += texelFetch(light_offset, at, 0).rgb;
#endif
}
vec3 relit_by(LightSum sum, float count, vec3 color) { return relit(color, sum.gain / count, sum.offset / count); }
#endif

vec3 fed_ray(ivec2 at, mat3 to_fed) {
#if WRITES_RAY
  vec3 turned = texelFetch(rays, at, 0).xyz;
  if (turned != vec3(0.0)) return turned;
#endif
  return to_fed * normalize(vec3((vec2(at) + 0.5) * ray_scale + ray_offset, -1.0));
}

#if !WRITES_FRAME
Sums sums = Sums(uvec4(0u), 0u);
vec3 ray = vec3(0.0);       // sum of the rays of covered samples
vec2 position = vec2(0.0);  // sum of the positions of covered samples within the pixel, in samples
#if WRITES_LIGHT
LightSum light = LightSum(vec3(0.0), vec3(0.0));
#endif

void add_sample(ivec2 base, ivec2 offset, uvec2 texel) {
  if (texel.r == 0u) return;
  add(sums, texel);
#if WRITES_LIGHT
  add_light(light, base + offset);
#endif
#if WRITES_RAY
  ray += fed_ray(base + offset, camera_to_fed);
#elif RAY_PER_SAMPLE
  ray += normalize(vec3((vec2(base + offset) + 0.5) * ray_scale + ray_offset, -1.0));
#else
  position += vec2(offset);
#endif
}

// Common corner of the k-th 2×2 samples of a pixel, in texture coordinates.
vec2 middle(ivec2 base, int k) {
  const int quads = max(SIDE / 2, 1);
  return vec2(base + ivec2(k % quads, k / quads) * 2 + 1) / vec2(textureSize(features, 0));
}

void main() {
  ivec2 base = ivec2(gl_FragCoord.xy) * SIDE;
#if GATHERS && SIDE > 1
  const int quads = SIDE / 2;
  uvec4 red[quads * quads];
  uint any = 0u;
  for (int k = 0; k < quads * quads; ++k) {
    red[k] = textureGather(features, middle(base, k), 0);
    any |= red[k].x | red[k].y | red[k].z | red[k].w;
  }
  // Early exit of uncovered pixels, before all other work.
  if (any == 0u) discard;
  for (int k = 0; k < quads * quads; ++k) {
    uvec4 green = textureGather(features, middle(base, k), 1);
    ivec2 first = ivec2(k % quads, k / quads) * 2;
    add_sample(base, first + ivec2(0, 1), uvec2(red[k].x, green.x));
    add_sample(base, first + ivec2(1, 1), uvec2(red[k].y, green.y));
    add_sample(base, first + ivec2(1, 0), uvec2(red[k].z, green.z));
    add_sample(base, first, uvec2(red[k].w, green.w));
  }
#else
  for (int y = 0; y < SIDE; ++y)
    for (int x = 0; x < SIDE; ++x) add_sample(base, ivec2(x, y), texelFetch(features, base + ivec2(x, y), 0).rg);
  if (sums.count == 0u) discard;
#endif
  vec4 low, high;
  average(sums, samples, alpha_code, low, high);
#if !WRITES_RAY
#if !RAY_PER_SAMPLE
  float count = float(sums.count);
  ray = count * normalize(vec3((vec2(base) + position / count + 0.5) * ray_scale + ray_offset, -1.0));
#endif
  ray = camera_to_fed * ray;
#endif
  float coverage = float(sums.count) / samples;
  vec3 color = decode(0, low, high, ray / samples);
#if WRITES_LIGHT
  color = relit_by(light, float(sums.count), color);
#endif
  picture = vec4(color * coverage, coverage) + (1.0 - coverage) * background;
}
#else
// Evaluates each decoder once, with the average of its own samples; all others count as uncovered.
void main() {
  ivec2 base = ivec2(gl_FragCoord.xy) * SIDE;
  vec3 color = vec3(0.0);
  float coverage = 0.0;
  for (int k = 0; k < int(decoder_count); ++k) {
    // Halved and plain alpha are decoded differently, so they are summed separately.
    Sums halved = Sums(uvec4(0u), 0u);
    Sums plain = Sums(uvec4(0u), 0u);
    vec3 ray = vec3(0.0);
#if WRITES_LIGHT
    LightSum light = LightSum(vec3(0.0), vec3(0.0));
#endif
    for (int y = 0; y < SIDE; ++y) {
      for (int x = 0; x < SIDE; ++x) {
        ivec2 at = base + ivec2(x, y);
        uvec2 texel = texelFetch(features, at, 0).rg;
        if (texel.r == 0u) continue;
        int frame = int(texelFetch(frames, at, 0).r) * 4;
        vec4 info = frame_entry(frame + 3);
        if (int(info.x) != k) continue;
        if (info.y == 2.0) add(halved, texel); else add(plain, texel);
#if WRITES_LIGHT
        add_light(light, at);
#endif
        ray += fed_ray(at, mat3(frame_entry(frame).xyz, frame_entry(frame + 1).xyz, frame_entry(frame + 2).xyz));
      }
    }
    uint count = halved.count + plain.count;
    if (count == 0u) continue;
    vec4 low, high, plain_low, plain_high;
    average(halved, samples, vec2(2.0, -1.0), low, high);
    average(plain, samples, vec2(1.0, 0.0), plain_low, plain_high);
    float share = float(count) / samples;
    vec3 own = decode(k, low + plain_low, high + plain_high, ray / samples);
#if WRITES_LIGHT
    own = relit_by(light, float(count), own);
#endif
    color += share * own;
    coverage += share;
  }
  if (coverage == 0.0) discard;
  picture = vec4(color, coverage) + (1.0 - coverage) * background;
}
#endif
