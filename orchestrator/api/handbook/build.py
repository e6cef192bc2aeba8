"""The documents as HTML pages: those that people wrote and those that are generated, by Sphinx."""

from __future__ import annotations

import logging
import shutil
from contextlib import redirect_stderr, redirect_stdout
from importlib.metadata import version
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from components import FanfoldError

from .gallery import pictures, write_examples
from .measured import performance_page, readme_section, tests_page, validation_page
from .python_page import python_page
from .recipe import recipe
from .reference import components_page, scene_page
from .snippets import run_page
from .theory import theory_page

PAGES = Path(__file__).parent / "pages"
ROOT = Path(__file__).parents[3]
_NEEDS = ("sphinx", "furo", "myst_parser", "sphinx_gallery")
_EXTENDING = "extending.md"
_RUN = ("first_hour.md",)
"""Pages whose code is run while they are built."""

GENERATED = {
    "scene_keys.md": scene_page,
    "components.md": components_page,
    "python.md": python_page,
    "theory.md": theory_page,
}
"""Pages that follow from the code, by file."""
MEASURED = {"validation.md": validation_page, "performance.md": performance_page}
"""Pages whose numbers are computed while they are built."""


def build(target: Path, gallery: bool) -> None:
    """Build all pages into a folder; FanfoldError if the extra is missing or Sphinx reports a problem.

    gallery: run the examples too, which takes some minutes; they exist only in a checkout.
    """
    missing = [name for name in _NEEDS if find_spec(name) is None]
    if missing:
        raise FanfoldError(
            f"the documents are built by Sphinx, and {', '.join(missing)} is not installed; install the extra: "
            "pip install '.[docs]' in the folder of Fanfold"
        )
    with TemporaryDirectory() as made:
        source, pages = Path(made) / "source", Path(made) / "pages"
        write_sources(source, gallery and _examples().is_dir())
        run_sphinx(source, pages, Path(made) / "doctrees")
        target.mkdir(parents=True, exist_ok=True)
        shutil.copytree(pages, target, dirs_exist_ok=True)


def write_sources(source: Path, gallery: bool, *, measure: bool = True) -> None:
    """Write everything that Sphinx reads; without `measure` nothing is simulated."""
    shutil.copytree(PAGES, source, ignore=shutil.ignore_patterns("__pycache__"))
    for name, page in GENERATED.items():
        (source / name).write_text(page(), encoding="utf-8")
    for name, measured in MEASURED.items():
        text = measured(measure) + readme_section(ROOT, name) + tests_page(ROOT, name)
        (source / name).write_text(text, encoding="utf-8")
    (source / _EXTENDING).write_text(
        (PAGES / _EXTENDING).read_text(encoding="utf-8") + recipe(_examples()), encoding="utf-8"
    )
    for name in _RUN if measure else ():
        path = source / name
        path.write_text(run_page(path.read_text(encoding="utf-8"), source, name), encoding="utf-8")
    if gallery:
        write_examples(_examples(), source / "examples")
        index = source / "index.md"
        index.write_text(
            index.read_text(encoding="utf-8").replace("glossary\n", "gallery/index\nglossary\n"),
            encoding="utf-8",
        )


def _examples() -> Path:
    return ROOT / "examples"


def _settings(source: Path) -> dict[str, Any]:
    """Sphinx's configuration, which has no file of its own."""
    extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", f"{__package__}.mathml"]
    settings: dict[str, Any] = {
        "project": "Fanfold",
        "version": version("fanfold"),
        "release": version("fanfold"),
        "html_title": f"Fanfold {version('fanfold')}",
        "html_theme": "furo",
        "html_math_renderer": "mathml",
        "html_theme_options": {"light_css_variables": {"code-font-size": "var(--font-size--small--3)"}},
        "html_show_copyright": False,
        "default_role": "code",
        "autodoc_typehints": "none",
        "autodoc_member_order": "bysource",
        "napoleon_use_ivar": True,
        "myst_heading_anchors": 3,
        "myst_enable_extensions": ["dollarmath", "deflist"],
        "exclude_patterns": ["examples/**"],
        "suppress_warnings": ["config.cache"],
    }
    if (source / "examples").is_dir():
        extensions.append("sphinx_gallery.gen_gallery")
        settings["sphinx_gallery_conf"] = {
            "examples_dirs": str(source / "examples"),
            "gallery_dirs": "gallery",
            "filename_pattern": r"\.py",
            "image_scrapers": (f"{pictures.__module__}.{pictures.__name__}",),
            "default_thumb_file": str(ROOT / "orchestrator" / "scene" / "scenes" / "amos3.png"),
            "download_all_examples": False,
            "show_signature": False,
            "abort_on_example_error": True,
        }
    return {**settings, "extensions": extensions}


def run_sphinx(source: Path, pages: Path, doctrees: Path, builder: str = "html") -> None:
    """Run Sphinx with every warning an error; FanfoldError with what it says where it finds any.

    builder: `dummy` reads everything and resolves all links without writing pages.
    """
    from sphinx.application import Sphinx
    from sphinx.errors import SphinxError
    from sphinx.util.console import nocolor
    from sphinx.util.docutils import docutils_namespace, patch_docutils

    said = StringIO()
    nocolor()
    try:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()), patch_docutils(), docutils_namespace():
            app = Sphinx(
                source, None, pages, doctrees, builder, _settings(source),
                status=None, warning=said, warningiserror=True,
            )  # fmt: skip
            app.build()
    except SphinxError as error:
        raise FanfoldError(f"the documents could not be built: {error} {said.getvalue()}") from None
    finally:
        logging.getLogger("sphinx").handlers.clear()
    if app.statuscode != 0 or said.getvalue():
        raise FanfoldError(f"the documents could not be built: {said.getvalue()}")
