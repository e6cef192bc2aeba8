// Lit surfaces in the colour of their body, with cells on one side of a panel, or in colours of stress.
precision highp float;
uniform vec3 eye;
uniform vec4 colour;
uniform vec3 light;
uniform sampler2D ramp;
uniform float stressLimit; // Pa, where colours end; 0 for the colour of the body, -1 for it without cells
uniform bool isShadow;
in vec3 place;
in vec3 looks;
in float vonMises;
out vec4 shown;

const vec3 CELLS = vec3(0.075, 0.13, 0.33);

/** Share of a line between cells; none where they are too small to be seen. */
float between(vec2 cells) {
  vec2 width = fwidth(cells);
  vec2 off = abs(fract(cells) - 0.5);
  vec2 lines = smoothstep(0.46 - width, vec2(0.48), off) * (1.0 - smoothstep(0.15, 0.4, width));
  return max(lines.x, lines.y);
}

void main() {
  if (isShadow) {
    shown = colour;
    return;
  }
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  vec3 towards = normalize(eye - place);
  normal *= sign(dot(normal, towards));
  float lit = max(dot(normal, light), 0.0);
  vec3 base = colour.rgb;
  float shine = 0.0;
  float brightness = 0.6 + 0.08 * normal.z + 0.42 * lit;
  if (stressLimit > 0.0) {
    float last = float(textureSize(ramp, 0).x - 1);
    base = texelFetch(ramp, ivec2(int(last * min(vonMises / stressLimit, 1.0) + 0.5), 0), 0).rgb;
    brightness = 0.9 + 0.1 * lit; // so that a colour is read by its scale
  } else if (looks.z > 0.99 && stressLimit == 0.0) {
    base = mix(mix(CELLS, base, 0.1), vec3(0.62, 0.68, 0.76), 0.55 * between(looks.xy));
    shine = 0.25 * pow(max(dot(reflect(-light, normal), towards), 0.0), 18.0);
  }
  shown = vec4(base * brightness + shine, colour.a);
}
