// WebGL2: programs, textures of numbers, and bodies on the graphics processor.

const TEXTURE_WIDTH = 2048;

const compiled = (gl, kind, text) => {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, `#version 300 es\n${text}`);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
};

/** A program and its uniforms by name. */
const program = (gl, vertex, fragment) => {
  const made = gl.createProgram();
  gl.attachShader(made, compiled(gl, gl.VERTEX_SHADER, vertex));
  gl.attachShader(made, compiled(gl, gl.FRAGMENT_SHADER, fragment));
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  const uniforms = {};
  const count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS);
  for (let k = 0; k < count; k++) {
    const { name } = gl.getActiveUniform(made, k);
    uniforms[name] = gl.getUniformLocation(made, name);
  }
  return { made, uniforms };
};

/** A texture of vectors (x, y, z) from a function of their number, in rows of TEXTURE_WIDTH. */
const vectorTexture = (gl, count, vector) => {
  const rows = Math.max(1, Math.ceil(count / TEXTURE_WIDTH));
  const width = Math.min(Math.max(count, 1), TEXTURE_WIDTH);
  const texels = new Float32Array(4 * width * rows);
  for (let k = 0; k < count; k++) vector(k, texels, 4 * k);
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, rows, 0, gl.RGBA, gl.FLOAT, texels);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return texture;
};

const indexBuffer = (gl, target, values) => {
  const buffer = gl.createBuffer();
  gl.bindBuffer(target, buffer);
  gl.bufferData(target, values, gl.STATIC_DRAW);
  return buffer;
};

/** Textures and buffers of a body; only `state` changes from picture to picture. */
class BodyOnGpu {
  constructor(gl, body) {
    this.gl = gl;
    this.body = body;
    const { count, formCount, stress } = body;
    this.nodes = vectorTexture(gl, count, (k, texels, at) => {
      for (let axis = 0; axis < 3; axis++) texels[at + axis] = body.nodes[3 * k + axis];
    });
    this.forms = vectorTexture(gl, formCount * count, (k, texels, at) => {
      const form = Math.floor(k / count);
      const node = k % count;
      for (let axis = 0; axis < 3; axis++) texels[at + axis] = body.forms[(3 * node + axis) * formCount + form];
    });
    this.columns = stress ? stress.columns : 0;
    this.stresses = vectorTexture(gl, 2 * this.columns * count, (k, texels, at) => {
      const node = k % count;
      const face = Math.floor(k / count) % 2;
      const column = Math.floor(k / (2 * count));
      for (let part = 0; part < 3; part++) texels[at + part] = stress.rows[(6 * node + 3 * face + part) * this.columns + column];
    });
    this.stateSize = Math.min(Math.max(1, formCount + this.columns), TEXTURE_WIDTH);
    this.values = new Float32Array(4 * this.stateSize);
    this.state = vectorTexture(gl, this.stateSize, () => {});
    this.triangles = indexBuffer(gl, gl.ELEMENT_ARRAY_BUFFER, body.triangles);
    this.lines = indexBuffer(gl, gl.ARRAY_BUFFER, body.lines);
    this.outline = indexBuffer(gl, gl.ARRAY_BUFFER, body.outline);
  }

  /** Amplitudes and coordinates of the body as they are now. */
  upload() {
    const { gl, body, values } = this;
    for (let k = 0; k < body.formCount; k++) values[4 * k] = body.amplitudes[k];
    for (let k = 0; k < this.columns; k++) values[4 * (body.formCount + k)] = body.stress.coordinates[k];
    gl.bindTexture(gl.TEXTURE_2D, this.state);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, this.stateSize, 1, gl.RGBA, gl.FLOAT, values);
  }

  /** Uniforms that place nodes, for a program in use. */
  bind(uniforms, toClip) {
    const { gl, body } = this;
    const textures = { nodes: this.nodes, forms: this.forms, state: this.state, stresses: this.stresses };
    Object.entries(textures).forEach(([name, texture], unitNumber) => {
      if (!uniforms[name]) return;
      gl.activeTexture(gl.TEXTURE0 + unitNumber);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.uniform1i(uniforms[name], unitNumber);
    });
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1i(uniforms.nodeCount, body.count);
    gl.uniform1i(uniforms.formCount, body.formCount);
    gl.uniform3fv(uniforms.position, body.position);
    gl.uniform4fv(uniforms.orientation, body.orientation);
    gl.uniformMatrix4fv(uniforms.toClip, false, toClip);
  }
}
