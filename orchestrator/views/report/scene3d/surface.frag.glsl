// Plates in the colour of their body or of their stress, lit from the eye, both sides alike.
precision highp float;
uniform vec3 eye;
uniform vec4 colour;
uniform sampler2D ramp;
uniform float stressLimit; // Pa, where colours end; 0 for the colour of the body
in vec3 place;
in float vonMises;
out vec4 shown;

void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float facing = abs(dot(normal, normalize(eye - place)));
  vec3 base = colour.rgb;
  float light = 0.7 + 0.3 * facing;
  if (stressLimit > 0.0) {
    float last = float(textureSize(ramp, 0).x - 1);
    base = texelFetch(ramp, ivec2(int(last * min(vonMises / stressLimit, 1.0) + 0.5), 0), 0).rgb;
    light = 0.9 + 0.1 * facing; // so that a colour is read by its scale
  }
  shown = vec4(base * light, colour.a);
}
