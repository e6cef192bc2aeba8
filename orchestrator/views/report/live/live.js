// A run in the page: sliders, the worker with the wing as one FMU, and what the picture, plots and numbers show of it.

/** Bytes of a base64 text that zlib has compressed. */
const inflated = async text => {
  const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

/** A number rounded to its error, with eight digits at most; without one to four digits. */
const toError = (value, error) => {
  if (!error) return String(Number(value.toPrecision(4)));
  const size = value ? Math.floor(Math.log10(Math.abs(value))) : 0;
  const decimals = Math.min(-Math.floor(Math.log10(Number(error.toPrecision(1)))), 7 - size);
  return decimals < 0 ? String(Number(value.toPrecision(Math.max(size + decimals + 1, 1)))) : value.toFixed(decimals);
};

/** A key of the scene between two values, and the numbers in the FMU's data that it moves. */
class Slider {
  constructor(content) {
    Object.assign(this, content);
    this.offsets = decoded(content.offsets);
    this.values = decoded(content.values);
    this.count = content.values.shape[0];
    this.value = this.start;
  }

  node(k) {
    return this.low + (this.high - this.low) * (0.5 + 0.5 * Math.cos((Math.PI * k) / (this.count - 1)));
  }

  /** Its numbers at a value: barycentric interpolation between Chebyshev nodes (Berrut and Trefethen 2004). */
  at(value) {
    const weights = Array.from({ length: this.count }, (_, k) => {
      const end = k === 0 || k === this.count - 1 ? 0.5 : 1;
      return ((k % 2 ? -1 : 1) * end) / (value - this.node(k));
    });
    const node = weights.findIndex(weight => !Number.isFinite(weight));
    const shares = node < 0 ? weights : weights.map((_, k) => (k === node ? 1 : 0));
    const sum = shares.reduce((a, b) => a + b, 0);
    const found = new Float64Array(this.offsets.length);
    shares.forEach((share, k) => {
      for (let i = 0; i < found.length; i++) found[i] += (share / sum) * this.values[k * found.length + i];
    });
    return found;
  }

  /** Move the numbers in the data; products: places of those that several sliders multiply. */
  move(data, products) {
    if (this.value === this.start) return;
    const [here, start] = [this.at(this.value), this.at(this.start)];
    this.offsets.forEach((place, i) => {
      const before = data.getFloat64(place, true);
      data.setFloat64(place, products.has(place) ? (before * here[i]) / start[i] : before + here[i] - start[i], true);
    });
  }
}

/** Rows of a run, as the picture and the plots need them. */
class LiveRun {
  constructor(content, rows, name) {
    this.name = name;
    this.width = content.width;
    this.rows = rows;
    this.clock = Float64Array.from({ length: content.points + 1 }, (_, k) => (k * content.until) / content.points);
    this.end = rows.subarray(content.points * this.width);
    this.numbers = content.numbers.map(number => this.end[number.column]);
    this.events = content.lines.filter(line => this.end[line.time] >= 0)
      .map(line => ({ time: this.end[line.time], component: line.name, text: line.event }))
      .sort((a, b) => a.time - b.time);
  }

  /** Sums (rows, columns) of weighted columns: each a list of [column, factor]; fromStart: less their first row. */
  sums(columns, fromStart = false) {
    const found = new Float32Array(this.clock.length * columns.length);
    columns.forEach((terms, k) => {
      const first = fromStart ? terms.reduce((sum, [column, factor]) => sum + factor * this.rows[column], 0) : 0;
      for (let row = 0; row < this.clock.length; row++) {
        let sum = -first;
        for (const [column, factor] of terms) sum += factor * this.rows[row * this.width + column];
        found[row * columns.length + k] = sum;
      }
    });
    return found;
  }

  /** Poses and amplitudes of a body; quaternions each of the sign nearer to the one before. */
  motion(body) {
    const plain = (first, count) => Array.from({ length: count }, (_, k) => [[first + k, 1]]);
    const still = (values) => {
      const found = new Float32Array(values.length * this.clock.length);
      for (let row = 0; row < this.clock.length; row++) found.set(values, row * values.length);
      return found;
    };
    const moves = body.position !== null;
    const orientations = moves ? this.sums(plain(body.orientation, 4)) : still([1, 0, 0, 0]);
    for (let row = 4; row < orientations.length; row += 4) {
      let product = 0;
      for (let k = 0; k < 4; k++) product += orientations[row + k] * orientations[row - 4 + k];
      if (product < 0) for (let k = 0; k < 4; k++) orientations[row + k] *= -1;
    }
    return {
      clock: this.clock,
      positions: moves ? this.sums(plain(body.position, 3)) : still([0, 0, 0]),
      orientations,
      amplitudeRows: this.sums(body.amplitudes.map(term => [term])),
    };
  }

  /** What goes into a picture and plots in place of what is there. */
  shown(content) {
    const part = (columns, fromStart) => ({ clock: this.clock, values: this.sums(columns, fromStart) });
    const load = columns => {
      const { clock, values } = part(columns);
      let peak = 0;
      for (let row = 0; row < values.length; row += 3) peak = Math.max(peak, Math.hypot(values[row], values[row + 1], values[row + 2]));
      return { clock, values, peak };
    };
    return {
      bodies: content.bodies.map(body => this.motion(body)),
      loads: content.loads.map(load),
      curves: content.curves.map(curve => part([curve.terms], curve.from_start)),
      events: this.events,
      clock: this.clock,
    };
  }
}

const BODY_PARTS = ["clock", "positions", "orientations", "amplitudeRows"];
const picked = (from, names) => Object.fromEntries(names.map(name => [name, from[name]]));

class Live {
  constructor(content, view, plots, clock) {
    this.content = content;
    this.view = view;
    this.plots = plots;
    this.clock = clock;
    this.sliders = content.sliders.map(one => new Slider(one));
    this.products = new Set(content.products);
    this.number = 0;
    this.kept = [{ letter: "stored", name: "Stored result", numbers: content.numbers.map(one => one.value), verdict: content.verdict, shown: this.taken(1) }];
    this.reference = this.kept[0];
    this.rows = content.numbers.map(number => this.row(number));
    this.judged = content.requirements.map(one => this.requirementRow(one));
    byId("live-requirements").hidden = !content.requirements.length;
    this.sliders.forEach(one => this.control(one));
    byId("live-reset").addEventListener("click", () => this.reset());
    byId("live-keep").addEventListener("click", () => this.keep());
    byId("live-reference").addEventListener("change", event => this.compare(this.kept[Number(event.target.value)]));
    byId("live").hidden = byId("live-tables").hidden = false;
  }

  /** Begin: the library and the data, then a run with the values of the scene. */
  async start() {
    const [library, data] = await Promise.all([inflated(this.content.library), inflated(this.content.data)]);
    this.data = data;
    this.worker = new Worker(URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" })));
    this.worker.onmessage = ({ data: said }) => this.hear(said);
    this.worker.onerror = event => this.tell(event.message);
    this.worker.postMessage({ library });
    this.run();
  }

  control(slider) {
    const place = byId("live-sliders");
    const label = element("label", place, slider.title);
    label.title = slider.name;
    const [range, exact] = ["range", "number"].map(kind => {
      const input = element("input", place);
      Object.assign(input, { type: kind, min: slider.low, max: slider.high, step: "any", value: slider.start });
      input.setAttribute("aria-label", `${slider.title}${slider.unit && `, ${slider.unit}`}`);
      return input;
    });
    range.id = `live-${slider.name}`;
    label.htmlFor = range.id;
    element("span", place, slider.unit);
    const follow = value => {
      slider.value = Math.min(Math.max(value, slider.low), slider.high);
      [range.value, exact.value] = [slider.value, Number(slider.value.toPrecision(5))];
    };
    slider.follow = follow;
    range.addEventListener("input", () => { exact.value = Number(Number(range.value).toPrecision(5)); });
    range.addEventListener("change", () => this.change(follow, Number(Number(range.value).toPrecision(5))));
    exact.addEventListener("change", () => this.change(follow, exact.value === "" ? slider.value : Number(exact.value)));
  }

  change(follow, value) {
    follow(value);
    this.run();
  }

  reset() {
    for (const slider of this.sliders) slider.follow(slider.start);
    this.run();
  }

  /** Run with the present values; what comes meanwhile waits, and only the last of it is run. */
  run() {
    this.wanted = true;
    if (this.busy) return;
    this.wanted = false;
    this.busy = true;
    const bytes = this.data.slice();
    const view = new DataView(bytes.buffer);
    for (const slider of this.sliders) slider.move(view, this.products);
    this.settings = this.sliders.filter(one => one.value !== one.start).map(one => `${one.title} ${written(one.value)} ${one.unit}`.trim());
    this.tell("running");
    this.number += 1;
    this.worker.postMessage({ number: this.number, bytes, ...picked(this.content, ["token", "first", "width", "until", "points"]) });
  }

  hear(said) {
    if (said.share !== undefined) {
      byId("live-progress").value = said.share;
      return;
    }
    this.busy = false;
    byId("live-progress").value = said.error ? 0 : 1;
    if (said.error) this.tell(said.error);
    else this.take(said);
    if (this.wanted) this.run();
  }

  tell(words) {
    byId("live-state").textContent = words;
  }

  take({ rows, seconds }) {
    this.last = new LiveRun(this.content, rows, this.settings.join(", ") || "values of the scene");
    this.last.shown = this.last.shown(this.content);
    this.last.verdict = this.verdict(this.last);
    this.put(0, this.last.shown);
    byId("live-keep").disabled = false;
    byId("live-name").textContent = `This run: ${this.last.name}`;
    const verdict = byId("live-verdict");
    verdict.textContent = this.last.verdict;
    verdict.classList.toggle("bad", / not (latched|met)/.test(this.last.verdict));
    this.fill();
    this.tell(`run in ${seconds.toFixed(2)} s`);
    byId("live").dataset.run = this.number;
  }

  keep() {
    const number = this.kept.length;
    Object.assign(this.last, { letter: `kept ${number}`, name: `Kept run ${number}: ${this.last.name}` });
    this.kept.push(this.last);
    element("option", byId("live-reference"), this.last.name).value = number;
    byId("live-reference").value = number;
    byId("live-keep").disabled = true;
    this.compare(this.last);
  }

  compare(reference) {
    this.reference = reference;
    this.plots.call(1, reference.letter);
    if (this.view) this.view.shown[1].label = this.referenceName();
    this.put(1, reference.shown);
    this.fill();
  }

  /** What a picture and plots show now of one of the two results. */
  taken(which) {
    const shown = this.view ? this.view.shown[which] : { bodies: [], loads: [] };
    return {
      bodies: shown.bodies.map(body => picked(body, BODY_PARTS)),
      loads: shown.loads.map(load => picked(load, ["clock", "values", "peak"])),
      curves: this.curves(which).map(curve => picked(curve, ["clock", "values"])),
      events: this.plots.results[which].events,
    };
  }

  /** Curves of a result in the order of the content. */
  curves(which) {
    return this.content.curves.map(({ title, label }) => this.plots.list.find(plot => plot.title === title)
      .curves.find(curve => curve.result === which && curve.name === label));
  }

  /** Show motion, loads and curves in place of those of one of the two results. */
  put(which, found) {
    if (this.view) {
      const shown = this.view.shown[which];
      shown.bodies.forEach((body, k) => Object.assign(body, found.bodies[k]));
      shown.loads.forEach((load, k) => Object.assign(load, found.loads[k]));
      this.view.due();
    }
    this.curves(which).forEach((curve, k) => Object.assign(curve, found.curves[k]));
    this.plots.results[which].events = found.events;
    if (this.view) prepareEvents(this.clock, this.plots.results);
    this.plots.draw();
  }

  /** Cells of a row, its texts on the left of `count` numbers. */
  cells(table, texts, count) {
    const row = element("tr", byId(table).tBodies[0]);
    for (const text of texts) element("td", row, text);
    return Array.from({ length: count }, () => {
      const cell = element("td", row);
      cell.className = "n";
      return cell;
    });
  }

  row(number) {
    const cells = this.cells(number.is_main ? "live-numbers" : "live-others", [number.quantity, number.of], 4);
    element("td", cells[0].parentElement, number.unit);
    return cells;
  }

  requirementRow(one) {
    const cells = this.cells("live-requirements", [one.text], 3);
    return [...cells, element("td", cells[0].parentElement)];
  }

  /** Numbers of the run and of what it is compared with, rounded to the error; titles of cells have more digits. */
  fill() {
    for (const cell of document.querySelectorAll(".live-reference-name")) cell.textContent = this.referenceName();
    byId("live-reference-verdict").textContent = `${this.reference.name}. ${this.reference.verdict}`;
    this.content.numbers.forEach((number, k) => {
      const { factor, is_time: isTime } = number;
      const error = factor * (number.error || 0);
      const [stored, run] = [this.reference.numbers[k], this.last.numbers[k]];
      const text = value => (isTime && value < 0 ? "not latched" : toError(factor * value, error));
      const isThere = !isTime || (stored >= 0 && run >= 0);
      const off = factor * (run - stored);
      const told = Math.abs(off) <= error ? "within the error" : `${off > 0 ? "+" : ""}${toError(off, error)}`;
      const texts = [text(stored), text(run), isThere ? told : "", error ? String(Number(error.toPrecision(1))) : ""];
      texts.forEach((words, column) => { this.rows[k][column].textContent = words; });
      [stored, run].forEach((value, column) => { this.rows[k][column].title = written(factor * value); });
    });
    const stored = this.requirements(this.reference);
    this.requirements(this.last).forEach(({ value, margin, state }, k) => {
      const reference = this.reference === this.kept[0] ? this.content.requirements[k].stored : stored[k].value;
      const texts = [reference, value, margin, state];
      texts.forEach((words, column) => { this.judged[k][column].textContent = words; });
      this.judged[k][3].classList.toggle("bad", state === "not met");
    });
  }

  referenceName() {
    return this.reference === this.kept[0] ? "stored result" : this.reference.letter;
  }

  /** Every requirement on a number of a run: value, margin and state, as the report has them. */
  requirements(run) {
    return this.content.requirements.map(one => {
      const k = this.content.numbers.findIndex(number => number.id === one.id);
      const number = this.content.numbers[k];
      const found = number ? run.numbers[k] : 0;
      if (!number || (number.is_time && found < 0)) return { ...one, value: "-", margin: "-", state: number ? "not met" : "only in the stored result" };
      const error = one.factor * (number.error || 0);
      const left = one.factor * (one.sign === "<" ? one.limit - found : found - one.limit);
      const state = Math.abs(left) < error ? "within the error" : left > 0 ? "met" : "not met";
      const text = value => `${toError(value, error)} ${one.unit}`.trim();
      return { ...one, value: text(one.factor * found), margin: text(left), state };
    });
  }

  /** How many requirements a run meets, and which it does not. */
  judgement(run) {
    const every = this.requirements(run).filter(one => one.state !== "only in the stored result");
    const missed = every.filter(one => one.state !== "met");
    if (!every.length) return "";
    if (!missed.length) return every.length === 1 ? " The requirement is met." : ` All ${every.length} requirements are met.`;
    const named = missed.map(one => `${one.text} (${one.value})`).join(", ");
    return ` ${missed.length} of ${every.length} requirements ${missed.length === 1 ? "is" : "are"} not met: ${named}.`;
  }

  /** What became of a run, in a few sentences. */
  verdict(run) {
    const four = value => String(Number(value.toPrecision(4)));
    const { lines, base } = this.content;
    const latched = lines.filter(line => run.end[line.time] >= 0);
    const standing = lines.filter(line => !latched.includes(line));
    const told = standing.map(line => `${line.name} has not latched: it stands at ${(run.end[line.angle] / RADIAN).toFixed(2)} deg.`);
    if (latched.length) {
      const last = latched.reduce((a, b) => (run.end[b.time] > run.end[a.time] ? b : a));
      const count = standing.length ? `${latched.length}` : latched.length === 2 ? "Both" : `All ${latched.length}`;
      const when = `at ${four(run.end[last.time])} s.`;
      told.push(latched.length === 1 ? `${last.name} latched ${when}` : `${count} lines latched, the last (${last.name}) ${when}`);
      const highest = latched.reduce((a, b) => (run.end[b.torque] > run.end[a.torque] ? b : a));
      told.push(`Highest latch torque ${four(run.end[highest.torque])} N.m (${highest.name}).`);
    }
    if (!lines.length) told.push(`The run reached its end at ${four(this.content.until)} s.`);
    const loads = base.map(one => `${four(run.end[one.column])} ${one.unit}`);
    if (base.some(one => run.end[one.column] > 0)) told.push(`Largest load on the spacecraft ${loads.join(", ")}.`);
    return told.join(" ") + this.judgement(run);
  }
}

/** The page's results with one more in front, which has what the first one has until the page has run. */
const withRun = results => [
  { ...results[0], letter: "run", label: "this run" },
  { ...results[0], letter: "stored", label: "stored result" },
];

const startLive = (view, plots, clock) => {
  const live = new Live(JSON.parse(byId("live-data").textContent), view, plots, clock);
  live.start().catch(error => {
    byId("live").hidden = true;
    byId("live-missing").hidden = false;
    document.querySelector("details.rest").open = true; // the stored result
    byId("live-missing").textContent = `The wing does not run in this browser: ${error.message}.`;
  });
};
