// Colours of what is drawn on canvases: those of the screen, light or dark, and light ones for paper.

const LIGHT = {
  ink: "#1a1a1a", soft: "#444444", faint: "#dddddd", paper: "#ffffff",
  sky: [0.955, 0.965, 0.975], grid: [0.80, 0.82, 0.84], line: [0.1, 0.1, 0.1], shadow: 0.16,
};
const DARK = {
  ink: "#e6e8eb", soft: "#b4bac2", faint: "#333a42", paper: "#14171b",
  sky: [0.105, 0.120, 0.140], grid: [0.24, 0.27, 0.30], line: [0.75, 0.78, 0.80], shadow: 0.45,
};

/** The colours of now, and a call when they change. */
class Theme {
  constructor() {
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.isPaper = false;
    this.listeners = [];
    this.dark.addEventListener("change", () => this.tell());
    addEventListener("beforeprint", () => this.paper(true));
    addEventListener("afterprint", () => this.paper(false));
  }

  get now() {
    return this.dark.matches && !this.isPaper ? DARK : LIGHT;
  }

  /** A colour of figures, which are on white: black and dark ones are not seen on black. */
  shown(colour) {
    return this.now === DARK && colour.every(part => part < 0.2) ? [0.9, 0.9, 0.9] : colour;
  }

  paper(isPaper) {
    this.isPaper = isPaper;
    this.tell();
  }

  listen(act) {
    this.listeners.push(act);
  }

  tell() {
    for (const act of this.listeners) act();
  }
}

const css = colour => `rgb(${colour.map(part => Math.round(255 * part)).join(",")})`;
