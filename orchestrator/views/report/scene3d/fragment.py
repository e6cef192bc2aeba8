"""Interactive parts of the page: elements, style sheet, data and scripts, all in the one file."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence
from functools import cache
from html import escape
from pathlib import Path

from ..animation import Frame
from .content import Content
from .numbers import safe_json

_FOLDER = Path(__file__).parent
_SCRIPTS = (
    "numbers", "algebra", "theme", "body", "solid", "gpu", "camera", "picture", "labels", "clock", "plots", "main",
)  # fmt: skip
"""In the order in which they are needed."""


def style() -> str:
    """Style sheet of the parts."""
    return _text("view.css")


def space(film: Sequence[Frame], content: Content) -> str:
    """The 3-D view; without scripts or WebGL2, still pictures."""
    pictures = "\n".join(
        f'<img alt="the structure at {frame.time:.2f} s" src="data:image/png;base64,{b64encode(frame.png).decode()}">'
        for frame in film
    )
    stress = f", {content.stress_tolerance / 1e6:.2g} MPa in stress" if content.stress_tolerance else ""
    sentences = [
        f"Animation accuracy: {1e3 * content.tolerance:.2g} mm in position{stress}, at every recorded row",
        *content.remarks,
    ]
    return f"""<figure id="animation">
<div id="view-stills" class="stills">
{pictures}
</div>
<p id="view-missing" class="warning" hidden></p>
{_text("view.html")}<figcaption>{escape(" ".join(f"{one}." for one in sentences))}</figcaption></figure>"""


def plots() -> str:
    """Plots over time, which scripts fill."""
    return _text("plots.html")


def scripts(content: Content, live: str = "") -> str:
    """The data, and what shows it; live: what runs the wing in the page, which comes before the page's start."""
    return f"""<script type="application/json" id="view-data">{safe_json(content.data)}</script>
<script>{_script(live)}</script>"""


@cache
def _script(live: str) -> str:
    shaders = {path.name: path.read_text(encoding="utf-8") for path in sorted(_FOLDER.glob("*.glsl"))}
    *parts, start = (_text(f"{name}.js") for name in _SCRIPTS)
    body = "\n".join([*parts, live, start])
    return f"""
(() => {{
"use strict";
const SHADERS = {json.dumps(shaders)};
{body}}})();
"""


def _text(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")
