"""The page of the Python face: everything that `import orchestrator` has, for Sphinx's autodoc."""

from __future__ import annotations

from inspect import isclass


def python_page() -> str:
    """One entry for each name, functions first."""
    import orchestrator

    found = {name: getattr(orchestrator, name) for name in sorted(orchestrator.__all__, key=str.lower)}
    lines = ["# Python", "", _HEAD]
    for title, classes in (("Functions", False), ("Classes and errors", True)):
        lines += [f"## {title}", ""]
        for name, one in found.items():
            if isclass(one) is classes:
                directive = "autoclass" if classes else "autofunction"
                members = ["   :members:", "   :inherited-members: object, Exception"] if classes else []
                lines += ["```{eval-rst}", f".. {directive}:: orchestrator.{name}", *members, "```", ""]
    return "\n".join(lines) + "\n"


_HEAD = """Everything stands in one module, which is imported under the name that these pages use:

```python
import orchestrator as fanfold
```
"""
