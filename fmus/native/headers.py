"""Headers that tell kernels where declared variables lie: `python -m fmus.native` writes them.

`kernels/layouts/NAME_layout.h` belongs to the component in `components/NAME.py` and its kernel `kernels/NAME.c`. It is
committed, because kernels are compiled before anything can be imported; a test compares it with the declarations, and
the digest in it with that of the data, so that a kernel never reads one variable for another.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from hashlib import sha256
from itertools import takewhile
from pathlib import Path
from textwrap import fill

from components import LAGGED, REGISTRY, Component, Quantity, port_layout
from components.numerics import scheme

FOLDER = Path(__file__).parent / "kernels" / "layouts"
_TEXT = """/* Where variables lie: P_ parameters, X_ state, U_ own inputs, Y_ own outputs, Z_ observations.
   Written by python -m fmus.native from its declarations. */

#ifndef FANFOLD_{guard}_LAYOUT_H
#define FANFOLD_{guard}_LAYOUT_H

#define KIND "{kind}"
#define LAYOUT_DIGEST "{digest}"
{declarations}
#endif
"""

_SCHEME = """/* Numbers of the scheme: components/numerics/scheme.py, written by python -m fmus.native. */

#ifndef FANFOLD_SCHEME_H
#define FANFOLD_SCHEME_H

{numbers}

#endif
"""


def kernel_name(component: Component) -> str:
    """Name of a component's kernel: that of its module."""
    return type(component).__module__.rpartition(".")[2]


def layout_digest(component: Component) -> str:
    """What the kernel of a component and its data must agree in: 16 digits that stand for all positions."""
    return sha256(_declarations(component).encode()).hexdigest()[:16]


def layout_header(component: Component) -> str:
    """The header of a component's kernel."""
    return _TEXT.format(
        kind=component.kind,
        guard=kernel_name(component).upper(),
        digest=layout_digest(component),
        declarations=_declarations(component) + "".join(f"{line}\n" for line in _resized(component)),
    )


def _declarations(component: Component) -> str:
    """Sizes and positions that are the same for every structure of a kind, as C; resized quantities are left out."""
    before_inputs, before_outputs = (0, 0) if component.ports_vary else _port_sizes(component)
    groups = (
        ("P", "PARAMETERS", 0, component.parameter_layout.quantities),
        ("X", "STATES", 0, component.state_layout.quantities),
        ("U", "OWN_INPUTS" if component.ports_vary else "INPUTS", before_inputs, component.own_inputs),
        ("Y", "OWN_OUTPUTS" if component.ports_vary else "OUTPUTS", before_outputs, component.own_outputs),
        ("Z", "OBSERVATIONS", 0, component.observation_layout.quantities),
    )
    enums = [list(_places(prefix, end, first, quantities)) for prefix, end, first, quantities in groups]
    constants = _defined(component.scheme)
    if not component.ports_vary:
        moments = 6 * len(component.ports) * (component.order == 4)
        constants.append(f"#define MOMENTS {moments}")
    integrated = [q for q in component.state_layout.quantities if q.rate_unit]
    if not any(q.resized for q in integrated):
        places = [f"X_{_name(q)} + {i}" if i else f"X_{_name(q)}" for q in integrated for i in range(q.size)]
        constants.append(f"#define CONTINUOUS {len(places)}")
        constants.append(f"#define CONTINUOUS_PLACES {{{', '.join(places) or '0'}}}")
    wrapped = [fill(f"enum {{ {', '.join(enum)} }};", 116, subsequent_indent="       ") for enum in enums]
    return "\n".join((*constants, "", *wrapped, "")).replace("=", " = ")


def _port_sizes(component: Component) -> tuple[int, int]:
    """Numbers of inputs and of outputs that the ports have, without slopes."""
    sides = [port_layout(port) for port in component.ports]
    inputs, outputs = (sum(q.size for side in sides for q in side[i]) for i in (0, 1))
    return inputs, outputs


def _places(prefix: str, end: str, position: int, quantities: Iterable[Quantity]) -> Iterator[str]:
    """Enumerators of a group, without what the structure resizes, which comes behind all else."""
    for quantity in takewhile(lambda q: not q.resized, quantities):
        yield f"{prefix}_{_name(quantity)}={position}"
        position += quantity.size
    yield f"{end}={position}"


def _resized(component: Component) -> Iterator[str]:
    """Where resized quantities lie in the example: the first, and those whose sizes before them are fixed."""
    groups = (
        ("P", "PARAMETERS", component.parameter_layout),
        ("X", "STATES", component.state_layout),
        ("Z", "OBSERVATIONS", component.observation_layout),
    )
    for prefix, end, layout in groups:
        resized = [q for q in layout.quantities if q.resized]
        lagged = [q for q in resized if q.name.endswith(LAGGED) and not component.ports_vary]
        place = 0
        for quantity in lagged or resized[:1]:
            where = f"({end} + {place})" if place else end
            yield f"#define {prefix}_{_name(quantity)} {where}"
            place += quantity.size
    if not component.ports_vary:
        lagged = [q for q in component.observation_layout.quantities if q.resized]
        yield f"#define LAGGED_LOADS {sum(q.size for q in lagged)}"


def _name(quantity: Quantity) -> str:
    return quantity.name.replace(".", "_").upper()


def scheme_header() -> str:
    """The numbers that all kernels share."""
    numbers = {name: value for name, value in vars(scheme).items() if name.isupper()}
    return _SCHEME.format(numbers="\n".join(_defined(numbers)))


def _defined(constants: Mapping[str, float]) -> list[str]:
    return [f"#define {name} {value!r}" for name, value in constants.items()]


def headers() -> dict[str, str]:
    """All written headers by file name."""
    components = [kind.example() for kind in REGISTRY.values()]
    native = [c for c in components if c.native_data() is not None and c.state_layout.quantities]
    layouts = {f"{kernel_name(c)}_layout.h": layout_header(c) for c in native}
    return {**layouts, "scheme.h": scheme_header()}
