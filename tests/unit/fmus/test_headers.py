"""Layout headers of the kernels: as the components declare, and checked by the kernels."""

import re

import numpy as np
import pytest

from components import REGISTRY
from components.flexible.modal import ModalData
from fmus import build_fmu
from fmus.native.binary_data import component_bytes
from fmus.native.headers import FOLDER, headers, layout_digest, layout_header
from fmus.native.records import RECORDS_HEADER, records_header
from tests.conformance.programs.driver import Fmu

WRITTEN = headers()
DECLARED = [kind for kind, component in REGISTRY.items() if component.example().state_layout.quantities]


def test_headers_are_those_that_the_components_declare():
    """Rule: `python -m fmus.native` was run after the last change of a declaration."""
    assert {path.name: path.read_text() for path in FOLDER.iterdir()} == WRITTEN


def test_records_are_those_that_python_declares():
    """The same of what Python and the coupling in C share."""
    assert RECORDS_HEADER.read_text() == records_header()


@pytest.mark.parametrize("kind", DECLARED)
def test_positions_are_those_of_the_flat_arrays(kind):
    """Independent path: every enumerator against the layouts by name."""
    component = REGISTRY[kind].example()
    layouts = dict(zip("PUYZ", component.layouts, strict=True)) | {"X": component.state_layout}
    own = component.ports_vary * 1
    found = re.findall(r"\b([PXUYZ])_(\w+) = (\d+)", layout_header(component))
    assert found
    for group, name, place in found:
        first = {"U": component.own_inputs, "Y": component.own_outputs}.get(group)
        layout = layouts[group]
        start = layout[first[0].name].start if own and first else 0
        assert layout[name.lower()].start - start == int(place)


@pytest.mark.parametrize("kind", DECLARED)
def test_the_digest_does_not_depend_on_the_structure(kind):
    """One kernel serves all structures of a kind."""
    component = REGISTRY[kind].example()
    if "wrench_mode" in component.structure:
        other = REGISTRY[kind](**{**component.structure, "wrench_mode": "endpoint"})
        assert layout_digest(other) == layout_digest(component)


def test_the_digest_is_that_of_bodies_with_and_without_modes():
    """The same of what the structure resizes: modes, ports, the third pulley of a guided loop."""
    body, loop, base = (REGISTRY[kind] for kind in ("body", "ccl", "fixed_base"))
    example = body.example()
    modal = ModalData.from_arrays(example.structure["modal"])
    rigid = body(
        modal=modal.keep_modes(np.zeros(0, dtype=int)).to_arrays(), ports=example.structure["ports"][:1]
    )
    assert (rigid.modes, example.modes) == (0, 4)
    assert layout_digest(rigid) == layout_digest(example)
    assert layout_digest(loop()) == layout_digest(loop(guided=True))
    assert layout_digest(base([])) == layout_digest(base.example())


@pytest.mark.parametrize("kind", DECLARED)
def test_data_of_another_layout_are_refused(kind, tmp_path, monkeypatch):
    """Two variables exchanged have the same sizes: only the digest tells."""
    component = REGISTRY[kind].example()
    monkeypatch.setattr("fmus.native.binary_data.layout_digest", lambda component: "0" * 16)
    assert layout_digest(component).encode() not in component_bytes(component, [], "token")
    path = build_fmu(component, kind, tmp_path, backend="native")
    with pytest.raises(Exception, match=r"(?i)instantiate"):
        Fmu(str(path))
