"""Records: named tuples and flat arrays, one declaration for both."""

from typing import Annotated, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from components import REGISTRY, ComponentError
from components.contract.connection import Connection
from components.contract.frames import Vector3
from components.contract.record import Record, integrated, kept
from components.contract.roles import HOLD, IMPULSE

NUMBER = st.floats(-1e9, 1e9)


class Pair(NamedTuple):
    first: float
    second: float


class Common(NamedTuple):
    place: Annotated[Vector3, kept("m", "A place")]
    wrench: Annotated[tuple[float, ...], kept("N", "As many as the structure says")]


class State(NamedTuple):
    common: Common
    heat: Annotated[float, integrated("J", "W", "Heat")]
    pairs: Annotated[tuple[Pair, Pair], kept("1", "Two pairs")]


def test_a_record_declares_names_units_and_sizes():
    """Rule: fields in order, those of a record in a record under their own names."""
    record = Record(State, wrench=2)
    declared = [(q.name, q.unit, q.size, q.rate_unit, q.resized) for q in record.quantities]
    assert declared == [
        ("place", "m", 3, "", False),
        ("wrench", "N", 2, "", True),
        ("heat", "J", 1, "W", False),
        ("pairs", "1", 4, "", False),
    ]
    assert record.size == 10


@given(st.lists(NUMBER, min_size=10, max_size=10))
def test_reading_and_writing_are_inverse(numbers):
    record = Record(State, wrench=2)
    state = record.read(np.array(numbers))
    assert state.pairs[1] == Pair(numbers[8], numbers[9])
    assert state.common.wrench == tuple(numbers[3:5])
    assert (type(state), type(state.common), type(state.pairs[0])) == (State, Common, Pair)
    assert record.write(state).tolist() == numbers


def test_a_field_of_another_size_is_refused():
    record = Record(State, wrench=2)
    state = record.read(np.zeros(10))
    with pytest.raises(ValueError, match="State has 11 numbers; 10 are declared"):
        record.write(state._replace(common=Common((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))))
    with pytest.raises(ValueError, match="State has 10 numbers; 9 are given"):
        record.read(np.zeros(9))


def test_what_a_function_forgot_to_return_is_told():
    """Bad plugin. Regression: "TypeError: 'NoneType' object is not iterable"."""
    with pytest.raises(ComponentError, match=r"None .*State"):
        Record(State).write(None)


def test_a_role_keeps_its_name():
    """What a master knows by its name cannot be declared under another."""

    class Commands(NamedTuple):
        hold: Annotated[float, HOLD]
        push: Annotated[float, IMPULSE]

    with pytest.raises(TypeError, match=r"push .*impulse"):
        Record(Commands)


@pytest.mark.parametrize(
    "kind", [kind for kind, component in REGISTRY.items() if issubclass(component, Connection)]
)
def test_states_of_connections_are_read_back(kind):
    """Over the registry: the state at the start survives being read by name and written again."""
    component = REGISTRY[kind].example()
    u = component.input_layout.start_values()
    for k, port in enumerate(component.ports):
        u[component.input_layout[f"{port.name}.position"]] = (0.5 * k, 0.1, 0.0)
    x = component.initial(component.prepare(component.parameter_layout.start_values()), u)
    assert x.shape == (component.state_layout.size,)
    assert component.states.write(component.states.read(x)).tolist() == x.tolist()
