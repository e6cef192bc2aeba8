"""Rows that wait for what is known one step later, in C: what is corrected, what stands, and when it is handed on."""

import numpy as np
import pytest

from components import Layout, Quantity
from fmus import native_library
from orchestrator.cosim.rows import recorded_layout
from tests.references.coupling_parts import call

needs_c = pytest.mark.skipif(native_library() is None, reason="no C compiler")


class Rows:
    """Of a load, an energy and an angle, the load corrected by what is observed of it one step later."""

    def __init__(self, *, corrects=True):
        self._table = call("new_table", corrects)

    def observe(self, *values):
        call("observe", self._table, np.array(values, dtype=float))

    def hold(self, time, *, continues):
        call("hold", self._table, time, continues)

    def __getattr__(self, name):
        return lambda *arguments: call(name, self._table, *arguments)

    @property
    def load(self):
        return call("observed", self._table)

    @property
    def told(self):
        rows = np.zeros((8, 4))
        return rows[: call("table", self._table, rows)].tolist()

    def __del__(self):
        call("discard", self._table)


def test_lagged_observations_are_not_recorded():
    found = recorded_layout(Layout(Quantity(name, "N", "") for name in ("load", "energy", "load_lagged")))
    assert [quantity.name for quantity in found.quantities] == ["load", "energy"]


@needs_c
def test_what_is_coupled_at_order_2_is_right_at_once():
    """Beside a body of order 2 a hinge keeps no means of steps before. Regression: its loads were 0."""
    rows = Rows(corrects=False)
    rows.observe(1, 3, 4, 0)
    rows.hold(0.1, continues=False)
    rows.hold(0.2, continues=True)
    assert rows.told == [[0.1, 1, 3, 4]]


@needs_c
def test_a_step_corrects_the_row_before():
    """Loads of the first row are those that the second one tells; everything else stays as it was."""
    rows = Rows()
    rows.observe(1, 3, 4, 0)
    rows.hold(0.1, continues=False)
    assert rows.told == []
    rows.observe(6, 8, 9, 1.5)
    rows.hold(0.2, continues=True)
    assert rows.told == [[0.1, 1.5, 3, 4]]
    for _ in range(2):
        rows.hand_on()
        assert rows.told == [[0.1, 1.5, 3, 4], [0.2, 6, 8, 9]]


@needs_c
@pytest.mark.parametrize(("jumped", "told"), [(11.75, 11.0), (0.0, 0.0)])
def test_a_jump_of_loads_is_that_of_the_event(jumped, told):
    """Ten more; zero is of a joint that has let go. What is held back of another time tells nothing.

    Regression: an instant finds joints anywhere in their ringing, which made spikes of loads after a latch-up.
    """
    for time, expected in ((0.1, told), (0.2, jumped)):
        rows = Rows()
        rows.observe(1, 3, 4, 0)
        rows.hold(0.1, continues=False)
        rows.observe(1.75, 3, 4, 0)
        rows.note_roughness(time, 2)
        rows.observe(jumped, 3, 4, 0)
        rows.smooth()
        assert rows.load == expected


@needs_c
def test_after_one_step_alone_the_instant_tells():
    """Its means reach back before the last event. Regression: loads between two close events were extrapolated so."""
    rows = Rows()
    rows.observe(1, 3, 4, 0)
    rows.hold(0.1, continues=False)
    rows.observe(1.75, 3, 4, 0)
    rows.note_roughness(0.1, 1)
    rows.smooth()
    rows.hand_on()
    assert (rows.load, rows.told) == (1.75, [[0.1, 1.75, 3, 4]])


@needs_c
def test_rows_beside_an_event_stand():
    """The row before an event, that of the event and the first one after it are those that were given, in order."""
    rows = Rows()
    for k, (time, put) in enumerate(((0.1, False), (0.1, True), (0.2, False)), start=1):
        rows.observe(k, k, k, 0)
        rows.add(time) if put else rows.hold(time, continues=False)
    rows.hand_on()
    assert rows.told == [[0.1, 1, 1, 1], [0.1, 2, 2, 2], [0.2, 3, 3, 3]]
