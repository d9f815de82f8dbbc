layout(location = 0) in vec2 corner;  // in pixels, y up
uniform vec2 picture_size;

void main() { gl_Position = vec4(corner / picture_size * 2.0 - 1.0, 0.0, 1.0); }
