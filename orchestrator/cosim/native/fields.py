"""The fields of C structures for ctypes, read from the headers that declare them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from ctypes import Structure, c_double, c_int, c_size_t, c_ssize_t, c_void_p
from functools import cache
from pathlib import Path
from typing import Any

import fmus

_HEADERS = Path(fmus.__file__).parent / "native" / "coupling"
_NUMBERS = {"double": c_double, "int": c_int, "size_t": c_size_t, "ptrdiff_t": c_ssize_t}
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_STRUCTURE = re.compile(r"typedef struct \{([^}]*)\} (\w+);")
_ENUMERATION = re.compile(r"enum \{([^}]*)\};")
_DECLARATION = re.compile(r"(?:const )?(\w+)\b(.*)", re.DOTALL)
_DECLARATOR = re.compile(r"(?P<pointer>[*\s]|\bconst\b)*(?P<name>\w+)(?:\[(?P<length>\w+)\])?\s*")

Fields = list[tuple[str, Any]]


def fields(structure: str, **members: type[Structure]) -> Fields:
    """Names and types of a structure's fields, pointers as addresses; members: structures that it contains, by name."""
    body = _declared()[0][structure]
    return [
        field for one in body.split(";") if one.strip() for field in _of_declaration(one.strip(), members)
    ]


def _of_declaration(declaration: str, members: dict[str, type[Structure]]) -> Iterator[tuple[str, Any]]:
    """Fields of one declaration, such as `const double *a, b[3]`."""
    found = _DECLARATION.fullmatch(declaration)
    assert found is not None, declaration
    for declarator in found[2].split(","):
        part = _DECLARATOR.fullmatch(declarator)
        assert part is not None, declaration
        if "*" in declarator:
            yield part["name"], c_void_p
            continue
        kind: Any = members.get(found[1]) or _NUMBERS[found[1]]
        yield part["name"], kind * _length(part["length"]) if part["length"] else kind


def _length(text: str) -> int:
    return int(text) if text.isdigit() else constant(text)


def constant(name: str) -> int:
    """An enumerator of the headers."""
    return _declared()[1][name]


@cache
def _declared() -> tuple[dict[str, str], dict[str, int]]:
    """Bodies of all structures, and all enumerators."""
    texts = [_COMMENT.sub("", path.read_text(encoding="utf-8")) for path in sorted(_HEADERS.glob("*.h"))]
    structures = {name: body for text in texts for body, name in _STRUCTURE.findall(text)}
    return structures, {
        name: value for text in texts for body in _ENUMERATION.findall(text) for name, value in _counted(body)
    }


def _counted(body: str) -> Iterator[tuple[str, int]]:
    """Enumerators with their values."""
    value = -1
    for one in filter(None, map(str.strip, body.split(","))):
        name, _, given = one.partition("=")
        value = int(given) if given else value + 1
        yield name.strip(), value
