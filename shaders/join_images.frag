// The texels of two feature images in one integer texture, for the web page, where images are decoded by the browser.
uniform sampler2D image0;
uniform sampler2D image1;
layout(location = 0) out uvec2 texel;

uint joined(vec4 channels) {
  uvec4 bytes = uvec4(round(channels * 255.0));
  return bytes.r | bytes.g << 8 | bytes.b << 16 | bytes.a << 24;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  texel = uvec2(joined(texelFetch(image0, at, 0)), joined(texelFetch(image1, at, 0)));
}
