"""Connections that turn one port against the other about an axis that both share: a torque about it, nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, NamedTuple

from numpy.typing import ArrayLike

from ..contract.connection import NO_PAIR, SLOPES, WRENCH, C, Connection, Inputs, P, S
from ..contract.frames import Quaternion, Vector3, nearest_turn, rotate
from ..contract.record import kept
from .relative_motion import Passage, axis_frame, conjugate_torque, pair, relative_pose, relative_rates
from .stiff_coordinate import MeanLoad

_NOWHERE: Vector3 = (0.0, 0.0, 0.0)


class Turn(NamedTuple):
    """States: how the outboard port is turned against the inboard one, and what the last step exerted."""

    angle: Annotated[float, kept("rad", "Angle of the outboard against the inboard port, unwrapped")]
    frame: Annotated[Quaternion, kept("1", "Frame of the axis on the inboard port")]
    swing: Annotated[tuple[float, float], kept("rad", "Tilt of the outboard axis")]
    wrench: Annotated[tuple[float, ...], WRENCH] = NO_PAIR
    slopes: Annotated[tuple[float, ...], SLOPES] = NO_PAIR


class Arc(NamedTuple):
    """The way from one turn to the next: change of the angle, and first moment of its rate, 0 where it is not known."""

    end: Turn
    passage: Passage
    swing: tuple[float, float]
    change: float
    moment: float

    def under(self, load: MeanLoad) -> Turn:
        """The turn at the end with the wrenches of a torque about the axis, and their slopes."""
        wrench, slopes = (self.passage.twist_wrench(t, self.swing) for t in (load.force, load.slope))
        return self.end._replace(wrench=wrench, slopes=slopes)


class AxialConnection(Connection[P, S, C]):
    """A torque about `axis`, a direction in the axes of both ports; its states have a `turn`.

    Subclasses say what the axis is, `axis_of`, and give `torque`, and `advance`, `start` and `record` on top.
    """

    axis_of: ClassVar[str]

    def __init__(self, axis: Sequence[float] = (0.0, 1.0, 0.0), wrench_mode: str = "mean") -> None:
        self._turn_about(axis, {}, wrench_mode)

    def _turn_about(self, axis: Sequence[float], structure: Mapping[str, Any], wrench_mode: str) -> None:
        """What `__init__` does; `structure`: what a subclass has beside the axis."""
        self._axis_frame = axis_frame(axis, self.axis_of)
        super().__init__({"axis": tuple(axis), **structure}, wrench_mode)

    def torque(self, c: Any, s: S, u: Inputs[C]) -> tuple[Turn, float, float]:  # noqa: ANN401
        """Turn, its rate and the torque of an instant."""
        raise self._lacking("torque")

    def _turn(self, u: Inputs[C], reference: float, aligned: float = 0.0) -> tuple[Turn, float]:
        """The turn of an instant and its rate; the angle, `aligned` where the axes are, is nearest the reference."""
        pose = relative_pose(u.motions, self._axis_frame)
        angle = nearest_turn(aligned + pose.twist, reference)
        return Turn(angle, pose.frame, pose.swing), relative_rates(u.motions, pose).twist

    @staticmethod
    def _arc(start: Turn, end: Turn, u: Inputs[C], is_paired: bool) -> Arc:
        passage = Passage(start.frame, end.frame, _NOWHERE, _NOWHERE)
        swing = (0.5 * (start.swing[0] + end.swing[0]), 0.5 * (start.swing[1] + end.swing[1]))
        moment = passage.rate_moments(u.moments, swing).twist if is_paired else 0.0
        return Arc(end, passage, swing, end.angle - start.angle, moment)

    def wrenches(self, c: Any, s: S, u: Inputs[C]) -> Sequence[float]:  # noqa: ANN401
        """Of the torque of an instant."""
        turn, _, torque = self.torque(c, s, u)
        conjugate = conjugate_torque(torque, (0.0, 0.0), turn.swing)
        return pair(_NOWHERE, rotate(turn.frame, conjugate), _NOWHERE)

    def powers(self, c: Any, s: S, u: Inputs[C]) -> Sequence[float]:  # noqa: ANN401
        """Heat (W) of a torque that only brakes."""
        _, rate, torque = self.torque(c, s, u)
        return (-torque * rate,)

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axis and mode."""
        return {**super().native_data(), "axis_frame": self._axis_frame}
