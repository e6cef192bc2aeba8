"""Results by which an importer checks itself, as the layered standard fmi-ls-ref (1.0.0-alpha.1) has them in an FMU."""

from __future__ import annotations

from collections.abc import Sequence

from lxml.etree import Element, SubElement

from components.contract.quantity import Vector

from .xml import xml_bytes

_STANDARD = "org.fmi-standard.fmi-ls-ref"
_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
_ATTRIBUTES = {
    "name": _STANDARD,
    "version": "1.0.0-alpha.1",
    "description": "Layered Standard providing information on related files included in an FMU.",
}
"""Of the manifest; the standard demands these texts."""
_DIGITS = 12


def reference_files(
    name: str, variables: Sequence[str], times: Sequence[float], rows: Vector, words: str
) -> dict[str, bytes]:
    """Files by their path in an FMU: a manifest, a table (CSV), and words (one paragraph) for people.

    variables: names of scalars. times: s. rows: (times, variables).
    """
    table = f"{name}_out.csv"
    root = Element("fmiReferences", nsmap={"fmi-ls": _NAMESPACE})
    for attribute, text in _ATTRIBUTES.items():
        root.set(f"{{{_NAMESPACE}}}fmi-ls-{attribute}", text)
    SubElement(
        root,
        "Related",
        type="text/csv",
        source=table,
        role="result",
        description="Output of the default experiment",
    )
    lines = [",".join(("time", *variables))]
    lines += [
        ",".join(f"{value:.{_DIGITS}g}" for value in (time, *row))
        for time, row in zip(times, rows.tolist(), strict=True)
    ]
    return {
        f"extra/{_STANDARD}/fmi-ls-manifest.xml": xml_bytes(root),
        f"extra/{_STANDARD}/{table}": ("\n".join(lines) + "\n").encode(),
        "documentation/fmi-ls-ref.txt": f"{words}\n".encode(),
    }
