layout(location = 0) in vec3 position;   // camera space
layout(location = 1) in vec4 color;
layout(location = 2) in float hidden;    // opacity where something lies in front
uniform mat4 camera_to_clip;
out vec4 line_color;
out float hidden_opacity;

void main() {
  gl_Position = camera_to_clip * vec4(position, 1.0);
  line_color = color;
  hidden_opacity = hidden;
}
