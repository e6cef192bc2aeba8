"""What the page on components of one's own ends with: the contract as the code states it, and a whole plugin."""

from __future__ import annotations

import ast
from inspect import cleandoc, getdoc
from pathlib import Path

from components.contract import component
from components.contract.connection import Connection

_PLUGIN = Path("plugins") / "tape_spring.py"


def recipe(examples: Path) -> str:
    """Markdown; the plugin only where the examples are."""
    lines = ["", "## The contract", "", cleandoc(component.__doc__ or ""), ""]
    lines += ["## Connections", "", getdoc(Connection) or "", ""]
    plugin = examples / _PLUGIN
    if plugin.is_file():
        text = plugin.read_text(encoding="utf-8")
        told = ast.get_docstring(ast.parse(text)) or ""
        lines += ["## A whole plugin", "", told.split("\n", 1)[0], "", "```python", text.rstrip(), "```", ""]
    return "\n".join(lines)
