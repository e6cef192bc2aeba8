"""The parts of a report page: plain HTML with everything inside, for screen and print."""

from __future__ import annotations

import re
from base64 import b64encode
from collections.abc import Collection, Iterable, Mapping, Sequence
from hashlib import sha256
from html import escape
from io import BytesIO

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .live import part as live
from .scene3d.fragment import style

_FIGURE_DPI = 120
_ALLOWED = (
    "default-src 'none'; img-src data:; style-src {styles}; script-src {scripts}; worker-src blob:; base-uri 'none'; "
    "form-action 'none'"
)
"""What a browser lets the page do: nothing but what is inside it, and of scripts and styles its own alone."""
_COMPILES = "'wasm-unsafe-eval'"
"""Of a page that compiles the WebAssembly inside it; it allows no JavaScript."""

_STYLE = """
:root { color-scheme: light dark; --ink: #1a1a1a; --soft: #444; --paper: #fff; --line: #ccc; --shade: #f3f4f6;
  --good: #00734c; --bad: #b3400a; --bad-shade: #fdf0e8; --accent: #0072b2; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e8eb; --soft: #b4bac2; --paper: #14171b; --line: #3b424b; --shade: #20252b; --good: #4cc79a;
    --bad: #ff9d66; --bad-shade: #33231a; --accent: #6ab7ea; }
}
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 66rem;
  margin: 0 auto; padding: 1.2rem; }
header { border-bottom: 2px solid var(--ink); margin-bottom: .9rem; }
h1 { font-size: 1.7rem; margin: 0; }
h2 { font-size: 1.15rem; margin: 1.5rem 0 .4rem; }
p.lead { margin: 0; color: var(--soft); }
dl { display: flex; flex-wrap: wrap; gap: .2rem 1.8rem; margin: .5rem 0 .6rem; font-size: .92rem; }
dt { color: var(--soft); font-size: .8rem; }
dd { margin: 0; }
p.verdict { border-left: .35rem solid var(--good); padding: .45rem .9rem; background: var(--shade);
  font-size: 1.05rem; }
p.verdict.bad { border-color: var(--bad); background: var(--bad-shade); }
p.warning { border-left: .3rem solid var(--bad); padding: .3rem .8rem; background: var(--bad-shade); }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: .4rem 0; }
th, td { padding: .15rem .9rem .15rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
th { border-bottom: 1.5px solid var(--soft); font-weight: 600; }
td.n, th.n { text-align: right; white-space: nowrap; }
td.bad { color: var(--bad); font-weight: 600; }
figure { margin: .6rem 0 1.2rem; }
figure img { max-width: 100%; height: auto; background: #fff; }
figcaption { color: var(--soft); font-size: .9rem; }
pre { font-size: .8rem; white-space: pre-wrap; overflow-wrap: anywhere; background: var(--shade); padding: .6rem; }
code { overflow-wrap: anywhere; }
details.rest { border-top: 1px solid var(--line); padding: .45rem 0; }
details.rest > summary { cursor: pointer; font-weight: 600; }
@media print {
  :root { color-scheme: light; --ink: #1a1a1a; --soft: #444; --paper: #fff; --line: #ccc; --shade: #f3f4f6;
    --good: #00734c; --bad: #b3400a; --bad-shade: #fdf0e8; }
  body { max-width: none; padding: 0; font-size: 9.5pt; }
  figure, tr, .wide { break-inside: avoid; }
  h2 { break-after: avoid; }
  details.rest:not([open]) { display: none; }
  @page { size: A4; margin: 14mm; }
}
"""


def page(title: str, body: Iterable[str]) -> str:
    """A whole page."""
    content = "\n".join(body)
    look = f"{_STYLE}{style()}{live.style()}"
    scripts = [_digest(text) for text in re.findall(r"<script>(.*?)</script>", content, re.DOTALL)]
    if live.MARK in content:
        scripts.append(_COMPILES)
    allowed = _ALLOWED.format(styles=_digest(look), scripts=" ".join(scripts) or "'none'")
    return "\n".join(
        (
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f'<meta http-equiv="Content-Security-Policy" content="{allowed}">',
            f"<title>{escape(title)}</title>\n<style>{look}</style>\n</head>\n<body>",
            content,
            "</body>\n</html>\n",
        )
    )


def _digest(text: str) -> str:
    """SHA-256 of a script or a style sheet, as a policy of browsers names it."""
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph; kind: its class in the style sheet."""
    return f'<p class="{kind}">{escape(text)}</p>' if kind else f"<p>{escape(text)}</p>"


def heading(text: str) -> str:
    """The heading of a section."""
    return f"<h2>{escape(text)}</h2>"


def table(
    headings: Sequence[str],
    rows: Iterable[Sequence[str]],
    numeric: Sequence[int] = (),
    marked: Collection[str] = (),
) -> str:
    """A table of texts; columns of numbers, by position, are set to the right, texts in `marked` stand out."""

    def cells(tag: str, texts: Sequence[str]) -> str:
        found = []
        for k, text in enumerate(texts):
            kinds = " ".join([*["n"] * (k in numeric), *["bad"] * (text in marked)])
            found.append(
                f'<{tag} class="{kinds}">{escape(text)}</{tag}>'
                if kinds
                else f"<{tag}>{escape(text)}</{tag}>"
            )
        return f"<tr>{''.join(found)}</tr>"

    body = "\n".join(cells("td", row) for row in rows)
    head = f"<thead>{cells('th', headings)}</thead>"
    return f'<div class="wide"><table>\n{head}\n<tbody>\n{body}\n</tbody>\n</table></div>'


def picture(figure: Figure, name: str, caption: str) -> str:
    """A figure with its caption, the picture inside."""
    stream = BytesIO()
    figure.set_dpi(_FIGURE_DPI)
    FigureCanvasAgg(figure).print_png(stream)  # type: ignore[no-untyped-call]  # savefig draws it twice
    words = escape(name.replace("_", " "))
    return (
        f'<figure id="{escape(name)}"><img alt="{words}" src="{_data(stream.getvalue())}">\n'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def title_block(title: str, description: str, facts: Mapping[str, str]) -> str:
    """What the page is about, and facts by name, of which empty ones are left out."""
    rows = "".join(
        f"<div><dt>{escape(name)}</dt><dd>{escape(text)}</dd></div>" for name, text in facts.items() if text
    )
    told = paragraph(description, "lead") if description else ""
    return f"<header>\n<h1>{escape(title)}</h1>{told}\n<dl>{rows}</dl>\n</header>"


def folded(summary: str, content: str) -> str:
    """Content, as HTML, that opens when asked for."""
    return f'<details class="rest"><summary>{escape(summary)}</summary>\n{content}</details>'


def text_block(text: str) -> str:
    """Long text as it is."""
    return f"<pre>{escape(text)}</pre>"


def _data(png: bytes) -> str:
    return f"data:image/png;base64,{b64encode(png).decode()}"
