// Applies gain and offset to a display colour in linear light (sRGB, IEC 61966-2-1).
vec3 relit(vec3 color, vec3 gain, vec3 offset) {
  // Without a change, the colour stays bit-identical.
  if (gain == vec3(1.0) && offset == vec3(0.0)) return color;
  vec3 light = mix(pow((color + 0.055) / 1.055, vec3(2.4)), color / 12.92, lessThanEqual(color, vec3(0.04045)));
  light = max(gain * light + offset, vec3(0.0));
  return mix(1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, 12.92 * light, lessThanEqual(light, vec3(0.0031308)));
}
