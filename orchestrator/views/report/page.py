"""The parts of a report page: plain HTML with everything inside, for screen and print."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape
from io import BytesIO

from matplotlib.figure import Figure

from .animation import Frame

_FIGURE_DPI = 120

_STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, sans-serif; color: #1a1a1a; background: #fff; max-width: 60rem;
  margin: 0 auto; padding: 1.5rem; }
h1 { font-size: 1.6rem; margin: 0 0 .2rem; }
h2 { font-size: 1.2rem; margin: 2rem 0 .6rem; border-bottom: 1px solid #999; }
p.lead { margin: 0; color: #444; }
p.warning { border-left: .3rem solid #d55e00; padding: .3rem .8rem; background: #fdf0e8; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: .5rem 0; }
th, td { padding: .15rem .8rem .15rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid #ddd; }
th { border-bottom: 1.5px solid #555; }
td.n, th.n { text-align: right; }
figure { margin: 1rem 0 1.6rem; }
figure img { max-width: 100%; height: auto; }
figcaption { color: #333; font-size: .92rem; }
pre { font-size: .8rem; white-space: pre-wrap; overflow-wrap: anywhere; background: #f5f5f5; padding: .6rem; }
code { overflow-wrap: anywhere; }
.controls { display: flex; gap: .8rem; align-items: center; flex-wrap: wrap; max-width: 40rem; }
.controls input[type=range] { flex: 1; min-width: 10rem; }
.controls output { min-width: 5.5rem; text-align: right; font-variant-numeric: tabular-nums; }
@media print {
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  .controls { display: none; }
  figure, tr { break-inside: avoid; }
  h2 { break-after: avoid; }
  @page { margin: 16mm; }
}
"""

_PLAYER = """
(() => {
  const film = JSON.parse(document.getElementById("film").textContent);
  const [picture, button, slider, speed, clock] =
    ["picture", "play", "slider", "speed", "clock"].map(id => document.getElementById(id));
  const last = film.length - 1;
  let timer = null;
  const show = k => {
    slider.value = k;
    picture.src = "data:image/png;base64," + film[k].png;
    clock.value = film[k].time.toFixed(2) + " s";
  };
  const stop = () => { clearTimeout(timer); timer = null; button.textContent = "Play"; };
  const next = () => {
    const k = Number(slider.value);
    if (k >= last) { stop(); return; }
    timer = setTimeout(() => { show(k + 1); next(); },
      1000 * (film[k + 1].time - film[k].time) / Number(speed.value));
  };
  button.addEventListener("click", () => {
    if (timer !== null) { stop(); return; }
    if (Number(slider.value) >= last) show(0);
    button.textContent = "Pause";
    next();
  });
  slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
  addEventListener("beforeprint", stop);
  show(0);
})();
"""


def page(title: str, body: Iterable[str]) -> str:
    """A whole page."""
    return "\n".join(
        (
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>",
            *body,
            "</body>\n</html>\n",
        )
    )


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph; kind: its class in the style sheet."""
    return f'<p class="{kind}">{escape(text)}</p>' if kind else f"<p>{escape(text)}</p>"


def heading(text: str) -> str:
    """The heading of a section."""
    return f"<h2>{escape(text)}</h2>"


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], numeric: Sequence[int] = ()) -> str:
    """A table of texts; columns of numbers, by position, are set to the right."""

    def cells(tag: str, texts: Sequence[str]) -> str:
        marked = (
            f'<{tag} class="n">{escape(text)}</{tag}>' if k in numeric else f"<{tag}>{escape(text)}</{tag}>"
            for k, text in enumerate(texts)
        )
        return f"<tr>{''.join(marked)}</tr>"

    body = "\n".join(cells("td", row) for row in rows)
    return f"<table>\n<thead>{cells('th', headings)}</thead>\n<tbody>\n{body}\n</tbody>\n</table>"


def picture(figure: Figure, name: str, caption: str) -> str:
    """A figure with its caption, the picture inside."""
    stream = BytesIO()
    figure.savefig(stream, format="png", dpi=_FIGURE_DPI)
    words = escape(name.replace("_", " "))
    return (
        f'<figure id="{escape(name)}"><img alt="{words}" src="{_data(stream.getvalue())}">\n'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def folded(summary: str, text: str) -> str:
    """Long text that opens when asked for."""
    return f"<details><summary>{escape(summary)}</summary>\n<pre>{escape(text)}</pre></details>"


def player(film: Sequence[Frame], caption: str) -> str:
    """Pictures with play, pause, a slider and a choice of speed; without scripts, and in print, the last picture."""
    content = [{"time": frame.time, "png": b64encode(frame.png).decode()} for frame in film]
    speeds = "".join(
        f'<option value="{v:g}"{" selected" if v == 1.0 else ""}>{v:g} x</option>'
        for v in (0.25, 0.5, 1.0, 2.0)
    )
    return f"""<figure id="animation"><img id="picture" alt="the structure" src="{_data(film[-1].png)}">
<div class="controls"><button id="play" type="button">Play</button>
<input id="slider" type="range" min="0" max="{len(film) - 1}" step="1" value="0" aria-label="instant">
<output id="clock"></output><label>speed <select id="speed">{speeds}</select></label></div>
<figcaption>{escape(caption)}</figcaption></figure>
<script type="application/json" id="film">{json.dumps(content)}</script>
<script>{_PLAYER}</script>"""


def _data(png: bytes) -> str:
    return f"data:image/png;base64,{b64encode(png).decode()}"
