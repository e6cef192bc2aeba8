// Names over the picture in space, drawn as text on a canvas of their own, and the world's axes in a corner.

class Labels {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
  }

  draw(camera, parts, results, options) {
    const { canvas, pen } = this;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.setTransform(options.scale, 0, 0, options.scale, 0, 0);
    pen.font = "12px system-ui, sans-serif";
    pen.textBaseline = "middle";
    this.taken = [];
    const height = canvas.height / options.scale;
    for (const part of parts) {
      const [x, width] = [part.x / options.scale, part.width / options.scale];
      if (part.caption) this.text(part.caption, x + 10, 16, "left");
      if (!options.names) continue;
      const toClip = camera.toClip(width / height);
      for (const { number } of part.shown.slice(0, 1)) {
        for (const [name, place] of this.places(results[number])) this.name(name, place, toClip, x, width, height);
      }
    }
    this.triad(camera, 40, height - 40);
  }

  /** Names and places: of hinge lines in the middle of their hinges, of bodies in the middle of their nodes. */
  places(result) {
    const lines = new Map();
    for (const { name, point } of result.axes) lines.set(name, [...(lines.get(name) || []), point.here()]);
    const middle = points => times(1 / points.length, points.reduce(plus));
    const found = [...lines].map(([name, points]) => [name, middle(points)]);
    for (const body of result.bodies) {
      if (body.triangles.length + body.lines.length === 0) continue;
      const some = [0, 0.25, 0.5, 0.75, 1].map(share => body.placed(body.bent(Math.round(share * (body.count - 1)))));
      found.push([body.name, middle(some)]);
    }
    return found;
  }

  name(name, place, toClip, x, width, height) {
    const [cx, cy, , cw] = [0, 1, 2, 3].map(row => toClip[row] * place[0] + toClip[4 + row] * place[1] + toClip[8 + row] * place[2] + toClip[12 + row]);
    if (cw <= 0) return;
    const across = x + (0.5 + (0.5 * cx) / cw) * width;
    if (across > x && across < x + width) this.text(name, across, (0.5 - (0.5 * cy) / cw) * height, "center");
  }

  /** A text where nothing is written yet, beside its place if need be, and nowhere if all is full. */
  text(text, x, y, align) {
    const { pen } = this;
    const shown = text.length > 40 ? `${text.slice(0, 39)}…` : text;
    const half = 0.5 * pen.measureText(shown).width + 2;
    const left = align === "center" ? x - half : x;
    for (const shift of [0, -15, 15, -30, 30, -45, 45, -60, 60]) {
      const box = [left, y + shift - 8, left + 2 * half, y + shift + 8];
      if (this.taken.some(other => box[0] < other[2] && box[2] > other[0] && box[1] < other[3] && box[3] > other[1])) continue;
      this.taken.push(box);
      pen.textAlign = align;
      pen.lineWidth = 4;
      pen.lineJoin = "round";
      pen.strokeStyle = "#ffffff";
      pen.strokeText(shown, x, y + shift);
      pen.fillStyle = "#1a1a1a";
      pen.fillText(shown, x, y + shift);
      return;
    }
  }

  triad(camera, x, y) {
    const { pen } = this;
    const { right, up } = camera.axes();
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, k) => {
      const [dx, dy] = [26 * dot(axis, right), -26 * dot(axis, up)];
      const colour = `rgb(${AXIS_COLOURS[k].map(part => Math.round(255 * part)).join(",")})`;
      pen.strokeStyle = colour;
      pen.fillStyle = colour;
      pen.lineWidth = 2;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(x + dx, y + dy);
      pen.stroke();
      pen.textAlign = "center";
      if (Math.hypot(dx, dy) > 6) pen.fillText("xyz"[k], x + 1.35 * dx, y + 1.35 * dy);
    });
  }
}
