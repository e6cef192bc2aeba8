"""Rows that wait for what is known one step later: what is corrected, what stands, and when each is handed on."""

from types import SimpleNamespace

import numpy as np

from components import Layout, Quantity
from orchestrator.cosim.rows import Rows, recorded_layout

BASE = Layout(
    [Quantity("load", "N", "", 2), Quantity("energy", "J", ""), Quantity("load_lagged", "N", "", 2)]
)
HINGE = Layout([Quantity("angle", "rad", "")])


class Recorder:
    def __init__(self):
        self.times, self.rows = [], []

    def append(self, time, values):
        self.times.append(time)
        self.rows.append([value.tolist() for value in values])


def rows(coarse=()):
    recorder, observations, scene = Recorder(), np.zeros(7), np.zeros(1)
    participants = [
        SimpleNamespace(name=name, observation_layout=layout)
        for name, layout in (("base", BASE), ("hinge", HINGE))
    ]
    return recorder, observations, scene, Rows(recorder, participants, observations, scene, coarse)


def test_lagged_observations_are_not_recorded():
    assert [q.name for q in recorded_layout(BASE).quantities] == ["load", "energy"]


def test_what_is_coupled_at_order_2_is_right_at_once():
    """PerturbedRuns a body of order 2 a hinge keeps no means of steps before. Regression: its loads were 0."""
    recorder, observations, scene, held = rows({"base"})
    observations[:], scene[:] = (1, 2, 3, 0, 0, 4, 0), 5
    held.hold(0.1, continues=False)
    held.hold(0.2, continues=True)
    assert recorder.rows == [[[1, 2, 3], [4], [5]]]


def test_a_step_corrects_the_row_before():
    """Loads of the first row are those that the second one tells; everything else stays as it was."""
    recorder, observations, scene, held = rows()
    observations[:], scene[:] = (1, 2, 3, 0, 0, 4, 0), 5
    held.hold(0.1, continues=False)
    assert not recorder.times
    observations[:], scene[:] = (6, 7, 8, 1.5, 2.5, 9, 0), 10
    held.hold(0.2, continues=True)
    assert (recorder.times, recorder.rows) == ([0.1], [[[1.5, 2.5, 3], [4], [5]]])
    held.release()
    assert (recorder.times, recorder.rows[1:]) == ([0.1, 0.2], [[[6, 7, 8], [9], [10]]])
    held.release()
    assert len(recorder.times) == 2


def test_a_jump_of_loads_is_that_of_the_event():
    """Regression: an instant finds joints anywhere in their ringing, which made spikes of loads after a latch-up."""
    _, observations, _, held = rows()
    observations[:] = (1, 2, 3, 0, 0, 4, 0)
    held.hold(0.1, continues=False)
    observations[:2] = 1.75, 2.5
    roughness = held.roughness(0.1, 2)
    observations[:2] = 11.75, 0.0  # ten more, and of a joint that has let go
    held.smooth(roughness)
    assert observations[:2].tolist() == [11.0, 0.0]
    assert held.roughness(0.2, 2) is None  # what is held back is not of this time


def test_after_one_step_alone_the_instant_tells():
    """Its means reach back before the last event. Regression: loads between two close events were extrapolated so."""
    recorder, observations, _, held = rows()
    observations[:] = (1, 2, 3, 0, 0, 4, 0)
    held.hold(0.1, continues=False)
    observations[:2] = 1.75, 2.5
    assert held.roughness(0.1, 1) is None
    held.release()
    assert recorder.rows[0][0] == [1.75, 2.5, 3]


def test_rows_beside_an_event_stand():
    """The row before an event, that of the event and the first one after it are those that were given, in order."""
    recorder, observations, _, held = rows()
    for time, put in ((0.1, False), (0.1, True), (0.2, False)):
        observations[:] += 1.0
        if put:
            held.add(time)
        else:
            held.hold(time, continues=False)
    held.release()
    assert recorder.times == [0.1, 0.1, 0.2]
    assert [row[0] for row in recorder.rows] == [[1.0] * 3, [2.0] * 3, [3.0] * 3]
