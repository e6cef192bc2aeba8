// WebGL2: programs, a texture of colours, and buffers of solids on the graphics processor.

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

/** A texture of colours in a row. */
const colourTexture = (gl, colours) => {
  const texels = Uint8Array.from(colours.flatMap(colour => [...colour.map(part => Math.round(255 * part)), 255]));
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, colours.length, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return texture;
};

/** Buffers of triangles: places, looks and stresses of their corners. */
class Mesh {
  constructor(gl, places, looks, triangles, stressed) {
    this.gl = gl;
    this.count = triangles.length;
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    this.places = this.attribute(0, 3, places, gl.DYNAMIC_DRAW);
    if (looks) this.attribute(1, 3, Float32Array.from(looks), gl.STATIC_DRAW);
    if (stressed) this.stresses = this.attribute(2, 1, new Float32Array(places.length / 3), gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, Uint32Array.from(triangles), gl.STATIC_DRAW);
    gl.bindVertexArray(null);
  }

  attribute(place, size, values, usage) {
    const { gl } = this;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, usage);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, gl.FLOAT, false, 0, 0);
    return buffer;
  }

  put(buffer, values) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, values);
  }

  draw() {
    const { gl } = this;
    gl.bindVertexArray(this.array);
    gl.drawElements(gl.TRIANGLES, this.count, gl.UNSIGNED_INT, 0);
  }
}

/** A body on the graphics processor. */
class BodyOnGpu {
  constructor(gl, body, tube) {
    this.body = body;
    this.solid = new Solid(body, tube);
    this.mesh = new Mesh(gl, this.solid.places, this.solid.looks, this.solid.triangles, body.stress);
    this.stresses = new Float32Array(this.solid.nodes.length);
  }

  /** Places of now, and stresses where they are shown. */
  upload(isStressed) {
    const { body, solid, mesh } = this;
    if (body.formCount) {
      solid.follow();
      mesh.put(mesh.places, solid.places);
    }
    if (isStressed && body.stress) {
      solid.nodes.forEach((node, k) => { this.stresses[k] = body.stress.vonMises[node]; });
      mesh.put(mesh.stresses, this.stresses);
    }
  }
}
