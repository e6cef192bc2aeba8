"""Functions of FMI 2.0 that read and write variables of all types as numbers, for FMUs that do not do so themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes import CFUNCTYPE, POINTER, c_double, c_int, c_size_t, c_uint32, c_void_p, cast
from functools import partial
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from components import Layout
from components.contract.quantity import Kind
from fmus.description import choices

from .participant import ERROR, OK, WARNING

TYPES: Mapping[str, Kind] = {name: kind for kind, name in choices.TYPES["2.0"].items()}
"""Kinds of quantities by types of FMI 2.0."""
Group = tuple[Layout, Sequence[int]]
"""Quantities, and the value references of their scalars."""
Groups = tuple[Group, Group, Group, Group]
"""Parameters, inputs, outputs, observations."""
References = tuple[Sequence[int], Sequence[int], Sequence[int], Sequence[int]]
_CALL = CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, c_void_p)


class TypedFunctions:
    """The functions of an FMU, of which fmi2SetReal and fmi2GetReal call those of every type.

    variables: kind and value reference of each; a caller has their positions in this list as value references, because
    those of FMI 2.0 are unique within a type only. A Boolean is set where its number is above 0.5.
    """

    def __init__(self, functions: Any, variables: Sequence[tuple[Kind, int]]) -> None:  # noqa: ANN401 - of ctypes
        self._functions = functions
        self._kinds = np.array([kind for kind, _ in variables])
        self._references = np.array([reference for _, reference in variables], dtype=np.uint32)
        self.fmi2SetReal = _CALL(partial(self._exchange, "Set"))
        self.fmi2GetReal = _CALL(partial(self._exchange, "Get"))

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - of ctypes
        """Every other function is the FMU's own."""
        return getattr(self._functions, name)

    def _exchange(self, verb: str, component: int, references: int, count: int, values: int) -> int:
        """Set or get values, type by type; the first status that is no good."""
        given = np.ctypeslib.as_array(cast(references, POINTER(c_uint32)), (count,))
        numbers = np.ctypeslib.as_array(cast(values, POINTER(c_double)), (count,))
        kinds = self._kinds[given]
        worst = OK
        for name, kind in TYPES.items():
            places = np.flatnonzero(kinds == kind)
            if not places.size:
                continue
            chosen, found = self._references[given[places]], numbers[places]
            if kind != "real":
                found = np.rint(found > 0.5 if kind == "boolean" else found).astype(np.intc)
            element = c_double if kind == "real" else c_int
            status = getattr(self._functions, f"fmi2{verb}{name}")(
                component,
                chosen.ctypes.data_as(POINTER(c_uint32)),
                places.size,
                found.ctypes.data_as(POINTER(element)),
            )
            if status > WARNING:
                return int(status) if status >= OK else ERROR
            worst = max(worst, status)
            if verb == "Get":
                numbers[places] = found
        return worst


def references_of(groups: Groups) -> References:
    """Value references by group."""
    parameters, inputs, outputs, observations = (references for _, references in groups)
    return parameters, inputs, outputs, observations


def as_numbers(functions: Any, groups: Groups) -> tuple[Any, References]:  # noqa: ANN401 - of ctypes
    """Functions of which those for real variables take all variables of an FMU, and the references for them."""
    variables = [
        (quantity.kind, reference)
        for layout, references in groups
        for quantity, reference in zip(
            (q for q in layout.quantities for _ in range(q.size)), references, strict=True
        )
    ]
    if all(kind == "real" for kind, _ in variables):
        return functions, references_of(groups)
    ends = accumulate((layout.size for layout, _ in groups), initial=0)
    parameters, inputs, outputs, observations = (range(first, end) for first, end in pairwise(ends))
    return TypedFunctions(functions, variables), (parameters, inputs, outputs, observations)
