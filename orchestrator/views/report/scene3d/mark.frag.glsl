precision highp float;
uniform float opacity;
in vec3 tinted;
out vec4 shown;

void main() {
  shown = vec4(tinted, opacity);
}
