"""XML files, and the names of what Fanfold adds to those of the standard."""

from __future__ import annotations

from lxml.etree import _Element, indent, tostring

VENDOR = "org.fanfold"


def xml_bytes(root: _Element) -> bytes:
    """An XML file with this root element."""
    indent(root)
    text: str = tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()
