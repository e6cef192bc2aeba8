"""The parts of a report page: plain HTML with everything inside, for screen and print."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape
from io import BytesIO

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .scene3d.fragment import script_digest, style

_FIGURE_DPI = 120
_ALLOWED = (
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src '{script}'; base-uri 'none'; "
    "form-action 'none'"
)
"""What a browser lets the page do: nothing but what is inside it, and of scripts its own alone."""

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
@media print {
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  figure, tr { break-inside: avoid; }
  h2 { break-after: avoid; }
  @page { margin: 16mm; }
}
"""


def page(title: str, body: Iterable[str]) -> str:
    """A whole page."""
    return "\n".join(
        (
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f'<meta http-equiv="Content-Security-Policy" content="{_ALLOWED.format(script=script_digest())}">',
            f"<title>{escape(title)}</title>\n<style>{_STYLE}{style()}</style>\n</head>\n<body>",
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
    figure.set_dpi(_FIGURE_DPI)
    FigureCanvasAgg(figure).print_png(stream)  # type: ignore[no-untyped-call]  # savefig draws it twice
    words = escape(name.replace("_", " "))
    return (
        f'<figure id="{escape(name)}"><img alt="{words}" src="{_data(stream.getvalue())}">\n'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def folded(summary: str, text: str) -> str:
    """Long text that opens when asked for."""
    return f"<details><summary>{escape(summary)}</summary>\n<pre>{escape(text)}</pre></details>"


def _data(png: bytes) -> str:
    return f"data:image/png;base64,{b64encode(png).decode()}"
