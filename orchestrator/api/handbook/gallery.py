"""The gallery: the programs of `examples` with what they print and the pictures that they write."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

_TESTS = "test_"
_HERE = {"Path(__file__).parent": "Path.cwd()"}
"""Sphinx-gallery runs programs in their folder, without `__file__`."""


def write_examples(examples: Path, folder: Path) -> None:
    """Copy the examples into a folder, each with its name as the title of its page above what it says it does."""
    shutil.copytree(examples, folder, ignore=shutil.ignore_patterns(f"{_TESTS}*", "__pycache__"))
    for path in folder.glob("*.py"):
        title = path.stem.replace("_", " ").capitalize()
        sentence, rest = path.read_text(encoding="utf-8").removeprefix('"""').split('"""', 1)
        for there, here in _HERE.items():
            rest = rest.replace(there, here)
        path.write_text(f'"""\n{title}\n{"=" * len(title)}\n\n{sentence}\n"""{rest}', encoding="utf-8")
    text = "Gallery\n=======\n\nPrograms of ``examples``, run while these pages were built.\n"
    (folder / "GALLERY_HEADER.rst").write_text(text, encoding="utf-8")


def pictures(block: Any, variables: dict[str, Any], settings: dict[str, Any]) -> str:  # noqa: ANN401 - its protocol
    """The pictures that a program has written, as sphinx-gallery shows them."""
    from sphinx_gallery.scrapers import figure_rst

    folder, found = Path(variables["src_file"]).parent, []
    for picture in sorted(folder.rglob("*.png")):
        target = next(variables["image_path_iterator"])
        shutil.move(picture, target)
        found.append(target)
    text: str = figure_rst(found, settings["src_dir"])
    return text
