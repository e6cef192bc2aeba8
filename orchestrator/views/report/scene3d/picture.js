// The picture in space: bodies, hinges, dampers, cables, loads, trails and the ground of one or two results.

const AXIS_COLOURS = [[0.80, 0.15, 0.15], [0.10, 0.55, 0.15], [0.20, 0.35, 0.90]];
const MARK_COLOURS = { link: [0.65, 0.45, 0.05], N: [0.84, 0.37, 0], "N.m": [0.60, 0.25, 0.60], trail: [0.0, 0.55, 0.65] };
const PART_COLOURS = { spacecraft: [0.78, 0.70, 0.46], hinge: [0.55, 0.57, 0.60], damper: [0.80, 0.42, 0.12], pulley: [0.62, 0.50, 0.25] };
const SECOND = [0.90, 0.10, 0.45]; // outlines of a second result over the first
const ARROW = 0.22; // length of the largest load of a unit, of the structure's size
const BARREL = { long: 0.026, wide: 0.0042 }; // of a hinge, of the structure's size
const TUBE = 0.007; // side of a beam, of the structure's size
const TRAIL = 160; // places of a trail
const NUMBERS_A_LINE = 11;
const DEEPER = 300; // smallest steps of depth, from one body to the next
const BEHIND = 2000; // the same of the spacecraft, so that what is folded against it shows
const LIGHT_FROM = unit([-0.25, -0.45, 0.86]);

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

/** Lines between places in the world as numbers: ends, colour, widths at both ends (pixels), one after another. */
class Lines {
  constructor(scale) {
    this.scale = scale;
    this.numbers = [];
  }

  add(a, b, colour, first, last = first) {
    this.numbers.push(...a, ...b, ...colour, first * this.scale, last * this.scale);
  }
}

/** Places, marks and loads of one result. */
class Shown {
  constructor(content, colours) {
    this.label = content.label;
    let rank = 0;
    this.bodies = content.bodies.map(body => new Body(body, body.is_base ? PART_COLOURS.spacecraft : colours[rank++ % colours.length]));
    const { ports = [], axes = [], dampers = [], links = [], tips = [], frames = [], loads = [] } = content.marks;
    const point = place => new Point(place, this.bodies);
    const along = one => ({ name: one.name, axis: one.axis, point: point(one) });
    this.ports = ports.map(point);
    this.axes = axes.map(along);
    this.dampers = dampers.map(along);
    this.links = links.map(link => ({ ...link, ends: link.ends.map(point) }));
    this.tips = tips.map(point);
    this.frames = frames.map(point);
    this.loads = loads.map(load => ({
      name: load.name, unit: load.unit, peak: load.peak, point: point(load), clock: decoded(load.time), values: decoded(load.values),
    }));
    this.base = this.bodies.find(body => body.isBase);
    this.trails = new Map();
  }

  /** Largest load of a unit in the run. */
  peak(unitName) {
    return Math.max(0, ...this.loads.filter(load => load.unit === unitName).map(load => load.peak));
  }

  move(time, factor, isStressed = false) {
    for (const body of this.bodies) {
      body.move(time, factor);
      if (isStressed && body.stress) body.stress.field();
    }
  }

  /** Lines that shine through bodies: ports, cables, loads, trails, axes of the spacecraft. */
  marks(lines, options, time, size) {
    const triad = (origin, direction, reach) => AXIS_COLOURS.forEach((colour, k) => {
      const axis = [0, 1, 2].map(i => (i === k ? reach : 0));
      lines.add(origin, plus(origin, direction(axis)), colour, 2.4);
    });
    if (options.frames) for (const point of this.frames) triad(point.here(), axis => point.direction(axis), 0.05 * size);
    if (options.joints) {
      triad(this.base ? this.base.placed([0, 0, 0]) : [0, 0, 0], axis => (this.base ? turned(this.base.orientation, axis) : axis), 0.07 * size);
      for (const port of this.ports) {
        const here = port.here();
        lines.add(here, plus(here, [0, 0, 0.003 * size]), options.theme.line, 2.6);
      }
      for (const { point, axis } of this.axes) {
        const reach = times(0.03 * size, unit(point.direction(axis)));
        lines.add(minus(point.here(), reach), plus(point.here(), reach), options.theme.line, 1);
      }
    }
    if (options.links) for (const link of this.links) this.cable(link, lines);
    if (options.trails) for (const tip of this.tips) this.trail(tip, time, lines);
    if (options.loads) for (const load of this.loads) this.arrow(load, time, size, lines);
  }

  /** Both strands of a cable loop, from rim to rim of its pulleys; other links as one line. */
  cable({ ends, radii, axis }, lines) {
    const places = ends.map(end => end.here());
    for (let k = 1; k < places.length; k++) {
      const [a, b] = [places[k - 1], places[k]];
      if (!radii.length) {
        lines.add(a, b, MARK_COLOURS.link, 1.3);
        continue;
      }
      const across = unit(cross(unit(minus(b, a)), ends[0].direction(axis)));
      const radius = node => (node === 0 ? radii[0] : node === places.length - 1 ? radii[1] : 0.5 * (radii[0] + radii[1]));
      for (const side of [-1, 1]) {
        lines.add(plus(a, times(side * radius(k - 1), across)), plus(b, times(side * radius(k), across)), MARK_COLOURS.link, 1.3);
      }
    }
  }

  /** Where a tip has been up to now, fading towards the start. */
  trail(tip, time, lines) {
    const { body } = tip;
    if (!body) return;
    let found = this.trails.get(tip);
    if (!found || found.clock !== body.clock) {
      const last = body.clock[body.clock.length - 1];
      const clock = Array.from({ length: TRAIL + 1 }, (_, k) => body.clock[0] + ((last - body.clock[0]) * k) / TRAIL);
      found = { clock: body.clock, times: clock, places: clock.map(instant => body.placedAt(instant, tip.node, tip.arm)) };
      this.trails.set(tip, found);
    }
    const count = found.times.findIndex(instant => instant > time);
    const shown = found.places.slice(0, count < 0 ? undefined : count);
    shown.push(tip.here());
    for (let k = 1; k < shown.length; k++) lines.add(shown[k - 1], shown[k], MARK_COLOURS.trail, 0.5 + (1.6 * (k - 1)) / shown.length, 0.5 + (1.6 * k) / shown.length);
  }

  /** An arrow as long as its load, of the largest in the run; torques have two heads. */
  arrow(load, time, size, lines) {
    const value = interpolated(load.values, 3, between(load.clock, time), [0, 0, 0]);
    const share = length(value) / (this.peak(load.unit) || 1);
    if (share < 5e-3) return;
    const start = load.point.here();
    const along = unit(load.point.direction(value));
    const end = plus(start, times(ARROW * size * share, along));
    const colour = MARK_COLOURS[load.unit];
    const head = Math.min(0.025, 0.5 * ARROW * share) * size;
    const neck = minus(end, times(head, along));
    lines.add(start, neck, colour, 2);
    lines.add(neck, end, colour, 6, 0);
    if (load.unit === "N.m") lines.add(minus(neck, times(0.7 * head, along)), neck, colour, 6, 0);
  }

  /** Round parts: place, direction, half length and radius (m), colour. */
  *parts(options, size) {
    if (options.joints) {
      for (const { point, axis } of this.axes) {
        yield [point.here(), point.direction(axis), BARREL.long * size, BARREL.wide * size, PART_COLOURS.hinge];
      }
      for (const { point, axis } of this.dampers) {
        const direction = point.direction(axis);
        const beside = plus(point.here(), times(0.8 * BARREL.long * size, unit(direction)));
        yield [beside, direction, 0.6 * BARREL.long * size, 2.2 * BARREL.wide * size, PART_COLOURS.damper];
      }
    }
    if (!options.links) return;
    for (const { ends, radii, axis } of this.links) {
      for (const [k, radius] of radii.entries()) {
        const end = ends[k ? ends.length - 1 : 0];
        yield [end.here(), end.direction(axis), 0.003 * size, radius, PART_COLOURS.pulley];
      }
    }
  }

  /** Some places of all nodes as they are now, for the eye. */
  places(most = 24) {
    const points = [];
    for (const body of this.bodies) {
      const step = Math.max(1, Math.floor(body.count / most));
      for (let node = 0; node < body.count; node += step) points.push(body.placed(body.bent(node)));
      points.push(body.placed(body.bent(body.count - 1)));
    }
    return points;
  }

  /** The same over the run. */
  cloud(first, last) {
    return Array.from({ length: 17 }, (_, k) => {
      this.move(first + ((last - first) * k) / 16, 1);
      return this.places();
    }).flat();
  }
}

class Picture {
  /** Throws where there is no WebGL2. cloud: places over the run; size: of the structure, m. */
  constructor(canvas, results, ramp, cloud, size) {
    const gl = canvas.getContext("webgl2", { antialias: !isSoftware(), alpha: false, stencil: true });
    if (!gl) throw new Error("there is no WebGL2");
    this.gl = gl;
    this.canvas = canvas;
    this.results = results;
    this.size = size;
    this.surface = program(gl, SHADERS["surface.vert.glsl"], SHADERS["surface.frag.glsl"]);
    this.line = program(gl, SHADERS["line.glsl"] + SHADERS["mark.vert.glsl"], SHADERS["mark.frag.glsl"]);
    this.bodies = results.map(result => result.bodies.map(body => new BodyOnGpu(gl, body, TUBE * size)));
    const round = cylinder();
    this.round = new Mesh(gl, round.places, null, round.triangles, false);
    this.ramp = colourTexture(gl, ramp);
    this.lines = gl.createVertexArray();
    this.lineBuffer = gl.createBuffer();
    this.prepareLines();
    this.prepareGround(cloud);
  }

  prepareLines() {
    const { gl } = this;
    gl.bindVertexArray(this.lines);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.lineBuffer);
    [[3, 0], [3, 3], [3, 6], [2, 9]].forEach(([size, first], place) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * NUMBERS_A_LINE, 4 * first);
      gl.vertexAttribDivisor(place, 1);
    });
    gl.bindVertexArray(null);
  }

  /** A grid below all that is ever shown, in round steps. */
  prepareGround(cloud) {
    const [low, high] = [Math.min, Math.max].map(of => [0, 1, 2].map(axis => cloud.reduce((found, point) => of(found, point[axis]), of === Math.min ? Infinity : -Infinity)));
    this.ground = low[2] - 0.04 * this.size;
    const step = 10 ** Math.floor(Math.log10(0.4 * this.size)) || 1;
    this.grid = { step, first: [], last: [] };
    for (const axis of [0, 1]) {
      this.grid.first.push(Math.floor((low[axis] - 0.15 * this.size) / step) * step);
      this.grid.last.push(Math.ceil((high[axis] + 0.15 * this.size) / step) * step);
    }
  }

  /** Draw results (their numbers, and whether as outlines) into parts of the canvas: x, width in pixels. */
  draw(camera, parts, options, time) {
    const { gl, canvas } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...options.theme.sky, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE);
    for (const bodies of this.bodies) for (const body of bodies) body.upload(options.stressLimit > 0);
    for (const { x, width, shown } of parts) {
      gl.viewport(x, 0, width, canvas.height);
      this.toClip = camera.toClip(width / canvas.height);
      this.screen = [width, canvas.height];
      if (options.ground) this.drawGround(options);
      for (const { number, outlined } of shown) {
        const [result, bodies] = [this.results[number], this.bodies[number]];
        const edges = new Lines(options.scale);
        for (const one of bodies) this.edges(one, edges, outlined ? SECOND : options.theme.line, outlined ? 1.6 : 0.7);
        if (!outlined) this.drawSolids(bodies, result, camera, options);
        this.drawLines(edges, 1, outlined ? 0.5 : 0);
        if (outlined) continue;
        const marks = new Lines(options.scale);
        result.marks(marks, options, time, this.size);
        this.drawLines(marks, 1, 0.35);
      }
    }
  }

  drawGround(options) {
    const lines = new Lines(options.scale);
    const { step, first, last } = this.grid;
    for (const axis of [0, 1]) {
      for (let k = 0; first[axis] + k * step <= last[axis] + 0.5 * step; k++) {
        const ends = [first, last].map(end => {
          const place = [end[0], end[1], this.ground];
          place[axis] = first[axis] + k * step;
          return place;
        });
        lines.add(...ends, options.theme.grid, 1);
      }
    }
    this.drawLines(lines, 1, 0);
  }

  /** Edges of a body in the world. */
  edges({ solid, body }, lines, colour, width) {
    const rows = rowsOf(body.orientation);
    const [px, py, pz] = body.position;
    const { places, edges } = solid;
    const { numbers, scale } = lines;
    const put = vertex => {
      const [x, y, z] = [places[3 * vertex], places[3 * vertex + 1], places[3 * vertex + 2]];
      numbers.push(px + rows[0] * x + rows[1] * y + rows[2] * z, py + rows[3] * x + rows[4] * y + rows[5] * z, pz + rows[6] * x + rows[7] * y + rows[8] * z);
    };
    for (let k = 0; k < edges.length; k += 2) {
      put(edges[k]);
      put(edges[k + 1]);
      numbers.push(colour[0], colour[1], colour[2], width * scale, width * scale);
    }
  }

  drawSolids(bodies, result, camera, options) {
    const { gl } = this;
    const { made, uniforms } = this.surface;
    gl.useProgram(made);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.ramp);
    gl.uniform1i(uniforms.ramp, 0);
    gl.uniform3fv(uniforms.eye, camera.eye);
    gl.uniform3fv(uniforms.light, LIGHT_FROM);
    gl.uniform1f(uniforms.ground, this.ground);
    gl.uniformMatrix4fv(uniforms.toClip, false, this.toClip);
    const drawBody = one => {
      gl.uniform3fv(uniforms.position, one.body.position);
      gl.uniform4fv(uniforms.orientation, one.body.orientation);
      one.mesh.draw();
    };
    gl.uniform3f(uniforms.size, 1, 1, 1);
    if (options.ground) this.drawShadows(bodies, uniforms, options, drawBody);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    const isStressed = options.stressLimit > 0;
    for (const [rank, one] of bodies.entries()) {
      gl.polygonOffset(0, one.body.isBase ? BEHIND : DEEPER * rank); // plates that lie in each other, as folded ones may, show in one order
      const { body } = one;
      gl.uniform4fv(uniforms.colour, [...(isStressed && !body.isBase ? [0.72, 0.72, 0.72] : body.colour), 1]);
      gl.uniform1f(uniforms.stressLimit, isStressed ? (body.stress ? options.stressLimit : -1) : 0);
      gl.vertexAttrib3f(1, 0, 0, 0);
      drawBody(one);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.uniform1f(uniforms.stressLimit, 0);
    for (const [place, direction, half, radius, colour] of result.parts(options, this.size)) {
      gl.uniform4fv(uniforms.colour, [...colour, 1]);
      gl.uniform3fv(uniforms.position, place);
      gl.uniform4fv(uniforms.orientation, fromX(direction));
      gl.uniform3f(uniforms.size, 2 * half, radius, radius);
      this.round.draw();
    }
    gl.bindVertexArray(null);
  }

  /** Each place of the ground is darkened once. */
  drawShadows(bodies, uniforms, options, drawBody) {
    const { gl } = this;
    gl.uniform1i(uniforms.isShadow, 1);
    gl.uniform4fv(uniforms.colour, [0, 0, 0, options.theme.shadow]);
    gl.depthMask(false);
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    for (const one of bodies) drawBody(one);
    gl.disable(gl.STENCIL_TEST);
    gl.depthMask(true);
    gl.uniform1i(uniforms.isShadow, 0);
  }

  /** Lines; hidden: how much those behind bodies shine through. */
  drawLines({ numbers }, opacity, hidden) {
    const { gl } = this;
    if (!numbers.length) return;
    const { made, uniforms } = this.line;
    gl.useProgram(made);
    gl.uniformMatrix4fv(uniforms.toClip, false, this.toClip);
    gl.uniform2fv(uniforms.screen, this.screen);
    gl.bindVertexArray(this.lines);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.lineBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.DYNAMIC_DRAW);
    for (const [isHidden, share] of [[true, hidden], [false, 1]]) {
      if (!share) continue;
      gl.depthFunc(isHidden ? gl.GREATER : gl.LEQUAL);
      gl.depthMask(!isHidden);
      gl.uniform1f(uniforms.opacity, share * opacity);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, numbers.length / NUMBERS_A_LINE);
    }
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.bindVertexArray(null);
  }
}
