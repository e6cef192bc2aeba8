// The picture in space: bodies, marks and loads of one or two results.

const AXIS_COLOURS = [[0.75, 0, 0], [0, 0.45, 0], [0, 0, 0.75]];
const MARK_COLOURS = { axis: [0, 0, 0], link: [0.55, 0.35, 0], port: [0.25, 0.25, 0.25], N: [0.84, 0.37, 0], "N.m": [0.45, 0.1, 0.45] };
const ARROW = 0.22; // length of the largest load of a unit, of the structure's size
const NUMBERS_A_MARK = 11;
const DEEPER = 2000; // smallest steps of depth, from one body to the next

/** Whether there is no graphics processor, so that smooth edges would cost half of the pictures a second. */
const isSoftware = () => {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  const name = gl.getParameter(gl.RENDERER);
  const found = /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  const loss = gl.getExtension("WEBGL_lose_context");
  if (loss) loss.loseContext();
  return found;
};

/** Places, marks and loads of one result. */
class Shown {
  constructor(content, colours) {
    this.label = content.label;
    this.bodies = content.bodies.map((body, k) => new Body(body, colours[k % colours.length]));
    const point = place => new Point(place, this.bodies);
    this.ports = content.marks.ports.map(point);
    this.axes = content.marks.axes.map(axis => ({ name: axis.name, axis: axis.axis, point: point(axis) }));
    this.links = content.marks.links.map(link => ({ name: link.name, ends: link.ends.map(point) }));
    this.loads = content.marks.loads.map(load => ({
      name: load.name, unit: load.unit, peak: load.peak, point: point(load), clock: decoded(load.time), values: decoded(load.values),
    }));
    this.peaks = { N: 0, "N.m": 0 };
    for (const load of this.loads) this.peaks[load.unit] = Math.max(this.peaks[load.unit], load.peak);
  }

  move(time, factor) {
    for (const body of this.bodies) body.move(time, factor);
  }

  /** Marks as numbers: ends, colour, widths at both ends (pixels), one after another. */
  marks(options, time, size, scale) {
    const found = [];
    const line = (a, b, colour, first, last = first) => found.push(...a, ...b, ...colour, first * scale, last * scale);
    if (options.joints) {
      for (const { point, axis } of this.axes) {
        const along = times(0.03 * size, unit(point.direction(axis)));
        line(minus(point.here(), along), plus(point.here(), along), MARK_COLOURS.axis, 2.2);
      }
      for (const port of this.ports) {
        const here = port.here();
        line(here, plus(here, [0, 0, 0.004 * size]), MARK_COLOURS.port, 3);
      }
    }
    if (options.links) for (const { ends } of this.links) line(ends[0].here(), ends[1].here(), MARK_COLOURS.link, 1.2);
    if (options.loads) for (const load of this.loads) this.arrow(load, time, size, line);
    return found;
  }

  /** An arrow as long as its load, of the largest in the run; torques have two heads. */
  arrow(load, time, size, line) {
    const value = interpolated(load.values, 3, between(load.clock, time), [0, 0, 0]);
    const share = length(value) / (this.peaks[load.unit] || 1);
    if (share < 5e-3) return;
    const start = load.point.here();
    const along = unit(load.point.direction(value));
    const end = plus(start, times(ARROW * size * share, along));
    const colour = MARK_COLOURS[load.unit];
    const head = Math.min(0.025, 0.5 * ARROW * share) * size;
    const neck = minus(end, times(head, along));
    line(start, neck, colour, 1.8);
    line(neck, end, colour, 5.5, 0);
    if (load.unit === "N.m") line(minus(neck, times(0.7 * head, along)), neck, colour, 5.5, 0);
  }

  /** Some places of all nodes over the run, for the eye. */
  cloud(first, last) {
    const points = [];
    for (let k = 0; k <= 16; k++) {
      this.move(first + ((last - first) * k) / 16, 1);
      for (const body of this.bodies) {
        const step = Math.max(1, Math.floor(body.count / 24));
        for (let node = 0; node < body.count; node += step) points.push(body.placed(body.bent(node)));
        points.push(body.placed(body.bent(body.count - 1)));
      }
    }
    return points;
  }
}

class Picture {
  /** Throws where there is no WebGL2. */
  constructor(canvas, results, ramp) {
    const gl = canvas.getContext("webgl2", { antialias: !isSoftware(), alpha: false });
    if (!gl) throw new Error("there is no WebGL2");
    this.gl = gl;
    this.canvas = canvas;
    this.results = results;
    const shader = SHADERS;
    this.surface = program(gl, shader["body.glsl"] + shader["surface.vert.glsl"], shader["surface.frag.glsl"]);
    this.edge = program(gl, shader["body.glsl"] + shader["line.glsl"] + shader["edge.vert.glsl"], shader["edge.frag.glsl"]);
    this.mark = program(gl, shader["line.glsl"] + shader["mark.vert.glsl"], shader["mark.frag.glsl"]);
    this.bodies = results.map(result => result.bodies.map(body => new BodyOnGpu(gl, body)));
    this.ramp = vectorTexture(gl, ramp.length, (k, texels, at) => texels.set(ramp[k], at));
    this.edges = gl.createVertexArray();
    this.marks = gl.createVertexArray();
    this.markBuffer = gl.createBuffer();
    this.prepareMarks();
  }

  prepareMarks() {
    const { gl } = this;
    gl.bindVertexArray(this.marks);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.markBuffer);
    [[3, 0], [3, 3], [3, 6], [2, 9]].forEach(([size, first], place) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * NUMBERS_A_MARK, 4 * first);
      gl.vertexAttribDivisor(place, 1);
    });
    gl.bindVertexArray(null);
  }

  /** Draw results (their numbers, opacities) into parts of the canvas: x, width in pixels. */
  draw(camera, parts, options, time) {
    const { gl, canvas } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE);
    for (const bodies of this.bodies) for (const body of bodies) body.upload();
    for (const { x, width, shown } of parts) {
      gl.viewport(x, 0, width, canvas.height);
      const toClip = camera.toClip(width / canvas.height);
      const screen = [width, canvas.height];
      for (const { number, opacity } of shown) {
        gl.depthMask(opacity === 1);
        this.drawBodies(this.bodies[number], toClip, screen, camera, options, opacity);
        gl.depthMask(true);
        this.drawMarks(this.results[number].marks(options, time, camera.size, options.scale), toClip, screen, opacity);
      }
    }
  }

  drawBodies(bodies, toClip, screen, camera, options, opacity) {
    const { gl } = this;
    gl.useProgram(this.surface.made);
    const { uniforms } = this.surface;
    gl.bindVertexArray(null);
    gl.activeTexture(gl.TEXTURE4);
    gl.bindTexture(gl.TEXTURE_2D, this.ramp);
    gl.uniform1i(uniforms.ramp, 4);
    gl.uniform3fv(uniforms.eye, camera.eye);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    for (const [rank, one] of bodies.entries()) {
      if (!one.body.triangles.length) continue;
      gl.polygonOffset(0, DEEPER * rank); // plates that lie in each other, as folded ones may, show in one order
      one.bind(uniforms, toClip);
      const isStressed = options.stressLimit > 0;
      const tint = isStressed ? [0.8, 0.8, 0.8] : one.body.colour;
      gl.uniform4fv(uniforms.colour, [...tint, opacity]);
      gl.uniform1f(uniforms.stressLimit, one.columns && isStressed ? options.stressLimit : 0);
      gl.uniform1i(uniforms.coordinateCount, isStressed ? one.columns : 0);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, one.triangles);
      gl.drawElements(gl.TRIANGLES, one.body.triangles.length, gl.UNSIGNED_INT, 0);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    this.drawEdges(bodies, toClip, screen, options, opacity);
  }

  drawEdges(bodies, toClip, screen, options, opacity) {
    const { gl } = this;
    const { made, uniforms } = this.edge;
    gl.useProgram(made);
    gl.uniform2fv(uniforms.screen, screen);
    gl.bindVertexArray(this.edges);
    for (const one of bodies) {
      one.bind(uniforms, toClip);
      const beams = [one.lines, one.body.lines, options.stressLimit > 0 ? [0.45, 0.45, 0.45] : one.body.colour, 2.6, 0];
      const outline = [one.outline, one.body.outline, [0, 0, 0], 0.8, 2e-4];
      for (const [buffer, ends, colour, width, nearer] of [beams, outline]) {
        if (!ends.length) continue;
        gl.uniform4fv(uniforms.colour, [...colour, opacity]);
        gl.uniform1f(uniforms.width, width * options.scale);
        gl.uniform1f(uniforms.nearer, nearer);
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.enableVertexAttribArray(0);
        gl.vertexAttribIPointer(0, 2, gl.UNSIGNED_INT, 8, 0);
        gl.vertexAttribDivisor(0, 1);
        gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, ends.length / 2);
      }
    }
    gl.bindVertexArray(null);
  }

  /** Marks behind bodies shine through. */
  drawMarks(numbers, toClip, screen, opacity) {
    const { gl } = this;
    if (!numbers.length) return;
    const { made, uniforms } = this.mark;
    gl.useProgram(made);
    gl.uniformMatrix4fv(uniforms.toClip, false, toClip);
    gl.uniform2fv(uniforms.screen, screen);
    gl.bindVertexArray(this.marks);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.markBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.DYNAMIC_DRAW);
    for (const [isHidden, share] of [[true, 0.35], [false, 1]]) {
      gl.depthFunc(isHidden ? gl.GREATER : gl.LEQUAL);
      gl.depthMask(!isHidden);
      gl.uniform1f(uniforms.opacity, share * opacity);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, numbers.length / NUMBERS_A_MARK);
    }
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.bindVertexArray(null);
  }
}
