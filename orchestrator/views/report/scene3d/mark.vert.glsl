// Lines between places in the world, each with a colour and a width at either end.
precision highp float;
layout(location = 0) in vec3 first;
layout(location = 1) in vec3 last;
layout(location = 2) in vec3 tint;
layout(location = 3) in vec2 widths;
uniform mat4 toClip;
out vec3 tinted;
// widened() comes from line.glsl

void main() {
  tinted = tint;
  gl_Position = widened(toClip * vec4(first, 1.0), toClip * vec4(last, 1.0), widths, 2e-5);
}
