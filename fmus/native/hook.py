"""Build hook: compile the native libraries, and put the documents into a wheel."""

from __future__ import annotations

import importlib.util
import os
import tempfile
from pathlib import Path
from types import ModuleType
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

COMPILE = "fmus/native/compile.py"


class NativeBuildHook(BuildHookInterface[Any]):  # type: ignore[misc] # hatchling is there in a build only
    """Compiles the library of the components and their coupling; a wheel gets it and the documents."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """What the build needs in addition: Zig's C compiler where there is no other."""
        if _module(Path(self.root, COMPILE)).compiler() is not None:
            return []
        requirements: list[str] = self.metadata.core.optional_dependencies["platforms"]
        return requirements

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Before the build of a wheel, editable or not."""
        if version == "standard":  # an editable installation reads them from the checkout
            build_data["force_include"].update(self.config["documents"])
        root = Path(self.root)
        build = _module(root / COMPILE)
        target = root / f"fmus/native/lib/fanfold{build.suffix()}"
        target.unlink(missing_ok=True)  # one of other sources must not pass for this one
        with tempfile.TemporaryDirectory() as folder:
            # Zig's own folder may be read-only, and would grow by every build
            os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", folder)
            try:
                build.compile_library(target)
            except build.CompileError as error:
                self.app.abort(f"{target.name} was not built: {error}")
        build_data["artifacts"].append(f"/{target.relative_to(root).as_posix()}")
        build_data["pure_python"] = False
        build_data["infer_tag"] = True


def _module(path: Path) -> ModuleType:
    """A module from its file; the package around it needs more than a build has."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
