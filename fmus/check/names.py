"""Names of variables by the structured naming convention, FMI 2.0 section 2.2.9 and FMI 3.0 section 2.4.7.5.1."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

_QUOTED = r"""'(?:[\w!#$%&()*+,\-./:;<>=?@\[\]^{}|~ ]|\\['"?\\abfnrtv])+'"""
_PART = rf"(?:[A-Za-z_]\w*|{_QUOTED})(?:\[\d+(?:,\d+)*\])?"
_NAME = re.compile(rf"{_PART}(?:\.{_PART})*|der\({_PART}(?:\.{_PART})*(?:,\d+)?\)", re.ASCII)


def name_problems(names: Iterable[str]) -> Iterator[str]:
    """A sentence for each name that the convention does not know."""
    for name in names:
        if not _NAME.fullmatch(name):
            yield f"{name!r} is no name of the structured naming convention, such as root.position[1] or der(angle)"
