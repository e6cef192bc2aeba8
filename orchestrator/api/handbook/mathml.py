"""Equations as MathML, which browsers show by themselves: pages need no network. An extension of Sphinx."""

from __future__ import annotations

from typing import Any

_FONTS = "'STIX Two Math', 'Cambria Math', 'Latin Modern Math', 'DejaVu Math TeX Gyre', math"
"""Without a font for it browsers neither stretch brackets nor place accents."""


def mathml(equation: str, block: bool) -> str:
    """LaTeX as MathML, by docutils; ValueError or SyntaxError where it does not know a command.

    An accent below an index needs `{}` between both.
    """
    from docutils.utils.math.latex2mathml import tex2mathml

    made = str(tex2mathml(equation, as_block=block))
    return made.replace("<math ", f'<math style="font-family: {_FONTS}" ', 1)


def setup(app: Any) -> dict[str, bool]:  # noqa: ANN401 - Sphinx is optional
    """What Sphinx calls."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(writer: Any, node: Any) -> None:  # noqa: ANN401 - those of docutils
    _show(writer, node, False)


def _block(writer: Any, node: Any) -> None:  # noqa: ANN401 - those of docutils
    _show(writer, node, True)


def _show(writer: Any, node: Any, block: bool) -> None:  # noqa: ANN401 - those of docutils
    from docutils.nodes import SkipNode

    writer.body.append(mathml(node.astext(), block))
    raise SkipNode
