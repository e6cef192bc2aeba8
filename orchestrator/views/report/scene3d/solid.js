// Bodies as solids: plates with two faces and their sides, beams as square tubes, and round parts of unit size.

const CELL = 0.1; // m, about, of the cells on a panel

const corner = (body, node) => [body.nodes[3 * node], body.nodes[3 * node + 1], body.nodes[3 * node + 2]];

/** Unit normals (3 a node) of a plate at rest, all towards the side of z. */
const normalsOf = body => {
  const found = new Float32Array(3 * body.count);
  const { triangles } = body;
  for (let k = 0; k < triangles.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map(i => corner(body, triangles[k + i]));
    const normal = cross(minus(b, a), minus(c, a));
    const sign = normal[2] < 0 ? -1 : 1;
    for (let i = 0; i < 3; i++) for (let axis = 0; axis < 3; axis++) found[3 * triangles[k + i] + axis] += sign * normal[axis];
  }
  for (let node = 0; node < body.count; node++) {
    const size = Math.hypot(found[3 * node], found[3 * node + 1], found[3 * node + 2]) || 1;
    for (let axis = 0; axis < 3; axis++) found[3 * node + axis] /= size;
  }
  return found;
};

/** Vertices of a body: the node of each, its place beside it (m), coordinates in cells and face; triangles; edges. */
class Solid {
  constructor(body, tube) {
    this.body = body;
    this.nodes = [];
    this.offsets = [];
    this.looks = [];
    this.triangles = [];
    this.edges = [];
    if (body.triangles.length) this.plate();
    for (let k = 0; k < body.lines.length; k += 2) this.tube(body.lines[k], body.lines[k + 1], tube);
    this.places = new Float32Array(3 * this.nodes.length);
    this.offsets = Float32Array.from(this.offsets);
    this.follow();
  }

  vertex(node, offset, look) {
    this.nodes.push(node);
    this.offsets.push(...offset);
    this.looks.push(...look);
    return this.nodes.length - 1;
  }

  plate() {
    const { body } = this;
    const { count, thickness, outline } = body;
    const used = Array.from(body.triangles);
    const span = axis => {
      const values = used.map(node => body.nodes[3 * node + axis]);
      const low = values.reduce((a, b) => Math.min(a, b));
      const size = values.reduce((a, b) => Math.max(a, b)) - low || 1;
      return { low, size: size / Math.max(Math.round(size / CELL), 1) };
    };
    const [x, y] = [span(0), span(1)];
    const normals = normalsOf(body);
    const faces = thickness > 0 ? [1, -1] : [0];
    for (const [rank, face] of faces.entries()) {
      for (let node = 0; node < count; node++) {
        const normal = [normals[3 * node], normals[3 * node + 1], normals[3 * node + 2]];
        const at = corner(body, node);
        this.vertex(node, times(0.5 * thickness * face, normal), [(at[0] - x.low) / x.size, (at[1] - y.low) / y.size, face]);
      }
      for (const node of used) this.triangles.push(rank * count + node);
      for (const node of outline) this.edges.push(rank * count + node);
    }
    if (faces.length === 1) {
      if (!outline.length) this.edges.push(...boxEdges(body));
      return;
    }
    for (let k = 0; k < outline.length; k += 2) {
      const [a, b] = [outline[k], outline[k + 1]];
      this.triangles.push(a, b, count + b, a, count + b, count + a);
    }
  }

  tube(first, last, width) {
    const [a, b] = [corner(this.body, first), corner(this.body, last)];
    const along = unit(minus(b, a));
    const across = unit(cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    const [u, v] = [times(0.5 * width, across), times(0.5 * width, cross(along, across))];
    const ring = [plus(u, v), minus(v, u), times(-1, plus(u, v)), minus(u, v)];
    const at = [first, last].map(node => ring.map(offset => this.vertex(node, offset, [0, 0, 0])));
    for (let k = 0; k < 4; k++) {
      const next = (k + 1) % 4;
      this.triangles.push(at[0][k], at[1][k], at[1][next], at[0][k], at[1][next], at[0][next]);
    }
  }

  /** Vertices to where the nodes are now, in the axes of the body. */
  follow() {
    const { places, nodes, offsets } = this;
    const { spots } = this.body;
    for (let k = 0, at = 0; k < nodes.length; k++) {
      const row = 3 * nodes[k];
      places[at] = spots[row] + offsets[at++];
      places[at] = spots[row + 1] + offsets[at++];
      places[at] = spots[row + 2] + offsets[at++];
    }
  }
}

/** Edges of a closed body where its sides meet at an angle. */
const boxEdges = body => {
  const sides = new Map();
  const { triangles } = body;
  for (let k = 0; k < triangles.length; k += 3) {
    const nodes = [0, 1, 2].map(i => triangles[k + i]);
    const [a, b, c] = nodes.map(node => corner(body, node));
    const normal = unit(cross(minus(b, a), minus(c, a)));
    for (let i = 0; i < 3; i++) {
      const key = [nodes[i], nodes[(i + 1) % 3]].sort((p, q) => p - q).join();
      sides.set(key, [...(sides.get(key) || []), normal]);
    }
  }
  const bends = ([, normals]) => normals.length < 2 || Math.abs(dot(normals[0], normals[1])) < 0.9;
  return [...sides].filter(bends).flatMap(([key]) => key.split(",").map(Number));
};

/** A cylinder along x, of unit length and radius. */
const cylinder = () => {
  const COUNT = 14;
  const [places, triangles] = [[], []];
  for (const x of [-0.5, 0.5]) {
    for (let k = 0; k < COUNT; k++) places.push(x, Math.cos((2 * Math.PI * k) / COUNT), Math.sin((2 * Math.PI * k) / COUNT));
  }
  for (let k = 0; k < COUNT; k++) {
    const next = (k + 1) % COUNT;
    triangles.push(k, next, COUNT + next, k, COUNT + next, COUNT + k);
    if (k > 1) triangles.push(0, k - 1, k, COUNT, COUNT + k - 1, COUNT + k);
  }
  triangles.push(0, COUNT - 2, COUNT - 1, COUNT, 2 * COUNT - 2, 2 * COUNT - 1);
  return { places: Float32Array.from(places), triangles: Uint32Array.from(triangles) };
};
