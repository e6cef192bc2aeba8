"""The pages of `docs` as HTML by Sphinx, with references from the code and figures of this machine."""

from __future__ import annotations

import logging
import re
import shutil
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from importlib.metadata import version
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from components import FanfoldError

from .gallery import pictures, write_examples
from .measured import performance, validation
from .reference import components_page, scene_page

_PACKAGED = Path(__file__).parent / "packaged"
ROOT = _PACKAGED if _PACKAGED.is_dir() else Path(__file__).parents[3]
"""Folder of `docs` and `examples`: the wheel has them next to this file, a checkout at its top."""
_TOP = ("CONTRIBUTING", "CHANGELOG")
"""Pages at the top of the repository that others link to; they become neighbours of those in `docs`."""
_NEEDS = ("sphinx", "furo", "myst_parser", "sphinx_click", "sphinx_gallery")
_GALLERY = "gallery"

GENERATED: dict[str, Callable[[], str]] = {
    "scene_keys": scene_page,
    "components": components_page,
    "command_line": lambda: _COMMAND_LINE,
    "functions": lambda: _FUNCTIONS,
}
"""Reference pages, by file."""
MEASURED = {"validation": validation, "performance": performance}
"""Sections that pages get at their end, with figures of this machine."""

_COMMAND_LINE = """# Command line

```{eval-rst}
.. click:: orchestrator.cli.main:main
   :prog: fanfold
   :nested: full
```
"""
_FUNCTIONS = """# Functions of Python

All names of `import orchestrator as fanfold`. [Python](python.md) shows how to use them.

```{eval-rst}
.. automodule:: orchestrator
   :members:
   :inherited-members: object
   :exclude-members: add_note, with_traceback
   :member-order: groupwise
```
"""
_FONTS = "'STIX Two Math', 'Cambria Math', 'Latin Modern Math', 'DejaVu Math TeX Gyre', math"
"""Without a font for mathematics browsers neither stretch brackets nor place accents."""


def build(target: Path, gallery: bool) -> None:
    """Build all pages into a folder.

    Parameters
    ----------
    target
        Folder of the HTML pages.
    gallery
        Whether to run the examples too, which takes a minute.

    Raises
    ------
    FanfoldError
        If the extra `docs` is missing, or Sphinx reports anything wrong.
    """
    missing = [name for name in _NEEDS if find_spec(name) is None]
    if missing:
        raise FanfoldError(
            f"the documents are built by Sphinx, and {', '.join(missing)} is not installed; install the extra: "
            "pip install '.[docs]' in the folder of Fanfold"
        )
    with TemporaryDirectory() as made:
        source, pages = Path(made) / "docs", Path(made) / "pages"
        write_sources(source, gallery=gallery)
        run_sphinx(source, pages, Path(made) / "doctrees")
        target.mkdir(parents=True, exist_ok=True)
        shutil.copytree(pages, target, dirs_exist_ok=True)


def write_sources(source: Path, *, gallery: bool, measure: bool = True) -> None:
    """Write what Sphinx reads into a folder, and next to it the programs that pages link to; `measure` runs scenes."""
    shutil.copytree(ROOT / "docs", source, ignore=shutil.ignore_patterns("__pycache__", "*.py"))
    shutil.copytree(
        ROOT / "examples", source.parent / "examples", ignore=shutil.ignore_patterns("__pycache__")
    )
    for name in _TOP:
        shutil.copy(ROOT / f"{name}.md", source)
    for path in source.glob("*.md"):
        text = re.sub(r"\]\((?:\.\./|docs/)(\w+\.md)", r"](\1", path.read_text(encoding="utf-8"))
        if measure and path.stem in MEASURED:
            text += f"\n{MEASURED[path.stem]()}"
        path.write_text(text, encoding="utf-8")
    for name, page in GENERATED.items():
        (source / f"{name}.md").write_text(page(), encoding="utf-8")
    if gallery:
        write_examples(ROOT / "examples", source / "examples")
    index = source / "index.md"
    index.write_text(_with_contents(index.read_text(encoding="utf-8"), gallery), encoding="utf-8")


def _with_contents(index: str, gallery: bool) -> str:
    """The first page with a table of contents: its links in their order, and the references."""
    pages = [*re.findall(r"\]\((\w+)\.md\)", index), *_TOP]
    references = [*GENERATED, *([f"{_GALLERY}/index"] if gallery else [])]
    for caption, names in (("Pages", pages), ("Reference", references)):
        index += "\n".join(("", "```{toctree}", f":caption: {caption}", ":hidden:", "", *names, "```", ""))
    return index


def _settings(source: Path) -> dict[str, Any]:
    """Sphinx's configuration, which has no file of its own."""
    settings: dict[str, Any] = {
        "extensions": ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_click", __name__],
        "project": "Fanfold",
        "version": version("fanfold"),
        "release": version("fanfold"),
        "html_title": f"Fanfold {version('fanfold')}",
        "html_theme": "furo",
        "html_math_renderer": "mathml",
        "html_theme_options": {"light_css_variables": {"code-font-size": "var(--font-size--small--3)"}},
        "html_show_copyright": False,
        "default_role": "code",
        "smartquotes": False,
        "autodoc_typehints": "none",
        "myst_heading_anchors": 3,
        "myst_enable_extensions": ["dollarmath"],
        "exclude_patterns": ["examples/**"],
        "suppress_warnings": ["config.cache"],
    }
    if (source / "examples").is_dir():
        settings["extensions"].append("sphinx_gallery.gen_gallery")
        settings["sphinx_gallery_conf"] = {
            "examples_dirs": str(source / "examples"),
            "gallery_dirs": _GALLERY,
            "filename_pattern": r"\.py",
            "image_scrapers": (f"{pictures.__module__}.{pictures.__name__}",),
            "default_thumb_file": str(Path(__file__).parents[2] / "scene" / "scenes" / "amos3.png"),
            "download_all_examples": False,
            "show_signature": False,
            "abort_on_example_error": True,
        }
    return settings


def setup(app: Any) -> dict[str, bool]:  # noqa: ANN401 - Sphinx is optional
    """Extend Sphinx by equations that browsers show without a network: LaTeX as MathML, by docutils."""
    from docutils.nodes import SkipNode
    from docutils.utils.math.latex2mathml import tex2mathml
    from sphinx.errors import SphinxError

    def show(writer: Any, node: Any) -> None:  # noqa: ANN401 - those of docutils
        try:
            made = str(tex2mathml(node.astext(), as_block=node.tagname == "math_block"))
        except Exception as error:  # of any kind where docutils does not know the LaTeX
            raise SphinxError(f"{writer.builder.current_docname}: {node.astext()}: {error}") from None
        writer.body.append(made.replace("<math ", f'<math style="font-family: {_FONTS}" ', 1))
        raise SkipNode

    app.add_html_math_renderer("mathml", (show, None), (show, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def run_sphinx(source: Path, pages: Path, doctrees: Path, builder: str = "html") -> None:
    """Run Sphinx; FanfoldError with every warning that it reports.

    builder: `dummy` reads everything and resolves all links without writing pages.
    """
    from sphinx.application import Sphinx
    from sphinx.errors import SphinxError
    from sphinx.util.console import nocolor
    from sphinx.util.docutils import docutils_namespace, patch_docutils

    reported = StringIO()
    nocolor()
    try:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()), patch_docutils(), docutils_namespace():
            app = Sphinx(
                source, None, pages, doctrees, builder, _settings(source),
                status=None, warning=reported, warningiserror=True,
            )  # fmt: skip
            app.build()
    except SphinxError as error:
        raise FanfoldError(f"the documents could not be built: {error} {reported.getvalue()}") from None
    finally:
        logging.getLogger("sphinx").handlers.clear()
    if app.statuscode != 0 or reported.getvalue():
        raise FanfoldError(f"the documents could not be built: {reported.getvalue()}")
