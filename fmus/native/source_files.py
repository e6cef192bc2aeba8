"""The C sources of a native FMU, for platforms that this installation does not build for."""

from __future__ import annotations

from lxml.etree import Element, SubElement

from ..description.choices import FmiVersion
from ..description.xml import xml_bytes
from . import sources


def source_files(model_identifier: str, fmi: FmiVersion) -> dict[str, bytes]:
    """All sources by their path in the FMU; compiling every .c of them makes its shared library.

    FMI 3.0 lists them in a build description (section 2.5.1.4.1), FMI 2.0 in the model description.
    """
    files = {f"sources/{name}": text.encode() for name, text in sources().items()}
    if fmi == "3.0":
        names = [name for name in sources() if name.endswith(".c")]
        files["sources/buildDescription.xml"] = _build_description(model_identifier, names)
    return files


def _build_description(model_identifier: str, names: list[str]) -> bytes:
    root = Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = SubElement(root, "BuildConfiguration", {"modelIdentifier": model_identifier})
    file_set = SubElement(configuration, "SourceFileSet", {"language": "C99"})
    for name in names:
        SubElement(file_set, "SourceFile", {"name": name})
    SubElement(configuration, "Library", {"name": "m", "external": "true"})
    return xml_bytes(root)
