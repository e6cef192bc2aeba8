// The page's controls, joined to the picture and the plots.

const byId = name => document.getElementById(name);

/** The picture in space with its controls; nothing of it where the page has none or the browser no WebGL2. */
class View {
  constructor(content, clock, theme) {
    this.clock = clock;
    this.theme = theme;
    this.content = content;
    this.canvas = byId("view-space");
    this.shown = content.results.map(result => new Shown(result, content.body_colours));
    const cloud = this.shown.flatMap(one => one.cloud(clock.first, clock.last));
    this.camera = new Camera(cloud, content.low, content.high);
    this.picture = new Picture(this.canvas, this.shown, content.ramp, cloud, this.camera.size);
    this.labels = new Labels(byId("view-names"), content.ramp);
    this.isDue = false;
    this.steps = [...new Set(this.shown.flatMap(one => one.bodies.flatMap(body => Array.from(body.clock))))].sort((a, b) => a - b);
    this.prepareOptions();
    this.prepareEye();
    clock.listen(() => this.due());
    theme.listen(() => this.due());
    byId("view").hidden = false;
    byId("view-stills").hidden = true;
    this.resize();
    new ResizeObserver(() => this.resize()).observe(byId("stage"));
    addEventListener("beforeprint", () => this.print());
  }

  prepareOptions() {
    const stresses = this.shown.flatMap(one => one.bodies).filter(body => body.stress).map(body => body.stress);
    for (const name of ["colour", "factor", "arrangement", "names-shown", "joints", "links", "loads", "trails", "ground", "frames"]) {
      byId(`view-${name}`).addEventListener("change", () => this.due());
    }
    byId("view-factor").addEventListener("input", () => this.due());
    for (const [name, isThere] of Object.entries({ loads: one => one.loads.length, frames: one => one.frames.length, links: one => one.links.length, trails: one => one.tips.length })) {
      byId(`view-${name}`).parentElement.hidden = !this.shown.some(isThere);
    }
    byId("view-frames").checked = this.clock.unit !== "s";
    byId("view-factor").parentElement.hidden = !this.shown.some(one => one.bodies.some(body => body.formCount));
    byId("view-note").hidden = !this.shown.some(one => one.loads.length);
    byId("view-arrangement-label").hidden = this.shown.length < 2;
    byId("view-colour").parentElement.hidden = stresses.length === 0;
    byId("view-limit").addEventListener("input", () => this.due());
    const shownPeak = Math.max(0, ...stresses.map(stress => stress.shownPeak));
    byId("view-limit").value = Number((shownPeak / 1e6).toPrecision(2));
  }

  prepareEye() {
    const { canvas, camera } = this;
    const act = (change, ...values) => () => {
      camera[change](...values);
      this.due();
    };
    const look = (azimuth, elevation) => act("look", azimuth, elevation);
    const all = () => {
      camera.follows = false;
      camera.fit(this.aspect());
      this.due();
    };
    const fit = () => {
      camera.follows = true;
      this.due();
    };
    const shiftKeys = { ArrowLeft: act("shift", -0.05, 0), ArrowRight: act("shift", 0.05, 0), ArrowUp: act("shift", 0, 0.05), ArrowDown: act("shift", 0, -0.05) };
    const keys = {
      ArrowLeft: act("turn", -5 * RADIAN, 0), ArrowRight: act("turn", 5 * RADIAN, 0),
      ArrowUp: act("turn", 0, 5 * RADIAN), ArrowDown: act("turn", 0, -5 * RADIAN),
      "+": act("zoom", 0.85), "-": act("zoom", 1 / 0.85), 0: act("reset"), f: fit, a: all,
      x: look(0, 0), y: look(-90, 0), z: look(-90, 90),
      " ": () => this.clock.toggle(), ",": () => this.step(-1), ".": () => this.step(1),
    };
    Object.entries({ all, fit, x: keys.x, y: keys.y, z: keys.z }).forEach(([name, turn]) => byId(`view-${name}`).addEventListener("click", turn));
    canvas.addEventListener("keydown", event => {
      const found = (event.shiftKey && shiftKeys[event.key]) || keys[event.key];
      if (!found || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      found();
    });
    this.preparePointers();
  }

  /** One pointer turns, with Shift it shifts; two zoom. */
  preparePointers() {
    const { canvas, camera } = this;
    const pointers = new Map();
    const apart = () => {
      const [a, b] = [...pointers.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    canvas.addEventListener("pointerdown", event => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    });
    canvas.addEventListener("pointermove", event => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const size = pointers.size === 2 ? apart() : 0;
      const [dx, dy] = [event.offsetX - before.x, event.offsetY - before.y];
      pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
      if (pointers.size === 2) camera.zoom(size / Math.max(apart(), 1));
      else if (event.shiftKey || event.buttons > 1) camera.shift(-dx / canvas.clientHeight, dy / canvas.clientHeight);
      else camera.turn(-dx * 0.4 * RADIAN, dy * 0.4 * RADIAN);
      this.due();
    });
    for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, event => pointers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    canvas.addEventListener("wheel", event => {
      if (document.activeElement !== canvas) return;
      event.preventDefault();
      camera.zoom(Math.exp(0.0015 * event.deltaY));
      this.due();
    }, { passive: false });
  }

  /** To the next or the last of the times at which the picture has numbers of its own. */
  step(way) {
    const { left } = between(this.steps, this.clock.time);
    const back = this.steps[left] < this.clock.time ? left : left - 1;
    this.clock.set(this.steps[Math.min(Math.max(way > 0 ? left + 1 : back, 0), this.steps.length - 1)]);
  }

  aspect() {
    const width = this.arrangement() === "beside" ? 0.5 : 1;
    return (width * this.canvas.clientWidth) / Math.max(this.canvas.clientHeight, 1);
  }

  arrangement() {
    return this.shown.length < 2 ? "first" : byId("view-arrangement").value;
  }

  resize() {
    this.scale = Math.min(devicePixelRatio || 1, 2);
    for (const canvas of [this.canvas, byId("view-names")]) {
      canvas.width = Math.max(1, Math.round(this.canvas.clientWidth * this.scale));
      canvas.height = Math.max(1, Math.round(this.canvas.clientHeight * this.scale));
    }
    this.draw();
  }

  /** Draw once before the next picture of the screen, however much changes until then. */
  due() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => { if (this.isDue) this.draw(); });
  }

  parts() {
    const { width } = this.canvas;
    const half = Math.floor(width / 2);
    const [a, b] = this.shown.map(one => one.label);
    const one = number => [{ number, outlined: false }];
    return {
      first: [{ x: 0, width, shown: one(0), caption: b ? a : "" }],
      second: [{ x: 0, width, shown: one(1), caption: b }],
      beside: [{ x: 0, width: half, shown: one(0), caption: a }, { x: half, width: half, shown: one(1), caption: b }],
      over: [{ x: 0, width, shown: [...one(0), { number: 1, outlined: true }], caption: `${a}; outlines: ${b}` }],
    }[this.arrangement()];
  }

  draw() {
    this.isDue = false;
    const isStressed = byId("view-colour").value === "stress";
    const factor = Math.max(0, Number(byId("view-factor").value) || 0);
    for (const one of this.shown) one.move(this.clock.time, factor, isStressed);
    const parts = this.parts();
    if (this.camera.follows) this.camera.fit(this.aspect(), parts.flatMap(part => part.shown.flatMap(({ number }) => this.shown[number].places())));
    const limit = Number(byId("view-limit").value) * 1e6;
    const isOn = name => byId(`view-${name}`).checked;
    const options = {
      stressLimit: isStressed ? Math.max(limit, 1) : 0,
      names: isOn("names-shown"), joints: isOn("joints"), links: isOn("links"), loads: isOn("loads"),
      trails: isOn("trails"), ground: isOn("ground"), frames: isOn("frames"), scale: this.scale, theme: this.theme.now,
    };
    this.picture.draw(this.camera, parts, options, this.clock.time);
    this.labels.draw(this.camera, parts, this.shown, options);
    byId("view-limit-label").hidden = !isStressed;
    const told = this.reading(isStressed);
    if (byId("view-reading").textContent !== told) byId("view-reading").textContent = told;
  }

  /** Largest stresses and loads of now, in words. */
  reading(isStressed) {
    const told = [];
    for (const one of this.shown) {
      const found = isStressed ? one.bodies.filter(body => body.stress).map(({ name, stress, nodes }) => {
        const [x, y] = [0, 1].map(axis => digits(nodes[3 * stress.where + axis], 3));
        return `${name} ${digits(stress.largest / 1e6, 3)} MPa at x ${x} m, y ${y} m`;
      }) : [];
      const words = found.length ? [`largest stress: ${found.join(", ")}`] : [];
      if (byId("view-loads").checked && one.loads.length) {
        const now = load => length(interpolated(load.values, 3, between(load.clock, this.clock.time), [0, 0, 0]));
        const isSeen = load => now(load) > 1e-3 * one.peak(load.unit);
        const loads = one.loads.filter(isSeen).map(load => `${load.name} ${digits(now(load), 3)} ${load.unit}`);
        if (loads.length) words.push(`loads on the spacecraft: ${loads.join(", ")}`);
      }
      if (words.length) told.push(`${this.shown.length > 1 ? `${one.label}: ` : ""}${words.join("; ")}`);
    }
    return told.join(". ");
  }

  /** What the reader sees, as a picture for paper. */
  print() {
    this.draw();
    const paper = document.createElement("canvas");
    [paper.width, paper.height] = [this.canvas.width, this.canvas.height];
    const pen = paper.getContext("2d");
    pen.drawImage(this.canvas, 0, 0);
    pen.drawImage(byId("view-names"), 0, 0);
    const image = document.createElement("img");
    image.src = paper.toDataURL("image/png");
    image.alt = `the structure at ${this.clock.written(2)}`;
    byId("view-printed").replaceChildren(image, `At ${this.clock.written(2)}`);
  }
}

/** Play, scrub and speed. */
const prepareClock = clock => {
  const [play, slider, told] = [byId("view-play"), byId("view-time"), byId("view-clock")];
  [slider.min, slider.max] = [clock.first, clock.last];
  const follow = () => {
    slider.value = clock.time;
    told.value = clock.written(3);
    const word = clock.isPlaying ? "Pause" : "Play";
    if (play.textContent !== word) play.textContent = word;
  };
  clock.listen(follow);
  play.addEventListener("click", () => clock.toggle());
  slider.addEventListener("input", () => clock.set(Number(slider.value)));
  byId("view-speed").addEventListener("change", event => { clock.speed = Number(event.target.value); });
  byId("view-speed").parentElement.hidden = clock.unit !== "s";
  addEventListener("beforeprint", () => clock.stop());
  follow();
};

/** Buttons that go to the events of all results. */
const prepareEvents = (clock, results) => {
  const events = results.flatMap(result => result.events.map(event => ({
    ...event, text: results.length > 1 ? `${result.letter}: ${event.text}` : event.text,
  })));
  byId("view-events").replaceChildren();
  for (const event of events.sort((a, b) => a.time - b.time).slice(0, 24)) {
    const button = element("button", byId("view-events"), `${event.text}, ${event.time.toFixed(3)} s`);
    button.type = "button";
    button.addEventListener("click", () => clock.set(event.time));
  }
};

const preparePlots = plots => {
  const middle = () => {
    const [first, last] = plots.range;
    return plots.clock.time >= first && plots.clock.time <= last ? plots.clock.time : 0.5 * (first + last);
  };
  const buttons = {
    in: () => plots.zoom(0.5, middle()), out: () => plots.zoom(2, middle()), all: () => plots.show(...plots.whole),
    left: () => plots.pan(-0.25), right: () => plots.pan(0.25),
  };
  for (const [name, act] of Object.entries(buttons)) byId(`plots-${name}`).addEventListener("click", act);
};

/** Still pictures in place of the view, and why. */
const showStills = reason => {
  byId("view-stills").hidden = byId("view-missing").hidden = false;
  byId("view").hidden = true;
  byId("view-missing").textContent = `No 3-D view: ${reason}.`;
};

const start = () => {
  const content = JSON.parse(byId("view-data").textContent);
  const isLive = byId("live-data") !== null;
  if (isLive) {
    content.results = withRun(content.results);
    byId("view-arrangement").value = "over";
    [...byId("view-arrangement").options].slice(2).forEach((option, k) => { option.text = ["this run", "what it is compared with"][k]; });
  }
  const clocks = content.results.map(result => decoded(result.clock));
  const theme = new Theme();
  const clock = new Clock(Math.min(...clocks.map(one => one[0])), Math.max(...clocks.map(one => one[one.length - 1])), content.unit);
  let view = null;
  if (byId("view")) {
    try {
      view = new View(content, clock, theme);
      view.canvas.addEventListener("webglcontextlost", () => showStills("the browser has freed its memory"));
      prepareClock(clock);
      prepareEvents(clock, content.results);
    } catch (error) {
      showStills(error.message);
    }
  }
  if (!byId("plots")) return;
  byId("plots").hidden = byId("view-help").hidden = false;
  const plots = new Plots(byId("plots-list"), content, clock, theme);
  preparePlots(plots);
  if (isLive) startLive(view, plots, clock);
};

start();
