"""The base of all connections: components that take the motion of their ports and give wrenches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Generic, NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from .component import Component, ComponentError, ContinuousStates, Port, Quantity, Vector
from .ports import MOTION_SIZE, WRENCH_SIZE, PortMoments, PortMotion
from .record import Record
from .roles import IMPULSE

P = TypeVar("P", bound=tuple[Any, ...])
S = TypeVar("S", bound=tuple[Any, ...])
C = TypeVar("C", bound=tuple[Any, ...])

HEAT = Quantity("heat", "J", "Energy dissipated since the start", rate_unit="W", quadrature=True)
WRENCH = Quantity("wrench", "N", "Mean wrenches on all ports over the last step (N, N.m)", 2 * WRENCH_SIZE)
SLOPES = Quantity("slopes", "N", "Slopes of the wrenches over the last step (N, N.m)", 2 * WRENCH_SIZE)
"""States that connections have in common; their sizes are those of two ports."""
NO_PAIR: tuple[float, ...] = (0.0,) * (2 * WRENCH_SIZE)


class Impulse(NamedTuple):
    """The one command of connections without switches."""

    impulse: Annotated[float, IMPULSE]


class Inputs(NamedTuple, Generic[C]):
    """Motions of the ports in order, commands, and first moments of the ports' motions, none at order 2."""

    motions: tuple[PortMotion, ...]
    commands: C
    moments: tuple[PortMoments, ...]


class Connection(Component, Generic[P, S, C]):
    """A component whose ports take motion and give wrenches, which are zero in sum about any point.

    Wrench mode "mean": wrenches are means over a step, from the motion at both its ends, of `order` 2 or 4 in time; the
    master solves for them. "endpoint": wrenches are those of the present inputs, for hosts that step explicitly.

    Subclasses declare their variables as records: `parameters` P, `states` S with the fields `wrench` and, at order 4,
    `slopes`, `commands` C, `observations`, and `own_outputs` beside the wrenches. They compute on these by name:

        start(c, u)         -> S               the state at the start
        advance(c, s, u, h) -> S               over a step of size h
        wrenches(c, s, u)   -> wrenches        of all ports at the present inputs
        own(c, s)           -> own outputs     that come after them
        record(c, s, u)     -> observations
        powers(c, s, u)     -> rates           of the states that have them, in their order
        follow(c, s, u, at_event) -> S         what a state remembers of a solver's step, and what happens at an event
        indicate(c, s, u)   -> indicators      that change their sign at events, `indicator_count` of them
        led(before, now)    -> start values    of one that starts elsewhere than where its springs are free

    where c is what `prepare` returns, the parameters by name unless a subclass has more to derive.
    """

    port_names: Sequence[str] = ("inboard", "outboard")
    parameters: Record[P]
    states: Record[S]
    commands: Record[C]
    observations: Record[Any]
    own_outputs: Sequence[Quantity] = ()
    indicator_count: int = 0

    def __init__(self, structure: Mapping[str, Any], wrench_mode: str) -> None:
        if wrench_mode not in ("mean", "endpoint"):
            raise ComponentError(f"wrench_mode is {wrench_mode!r}; it must be mean or endpoint")
        for name in ("parameters", "states", "commands", "observations"):
            if not isinstance(getattr(self, name, None), Record):
                raise ComponentError(
                    f"{type(self).__name__} declares no {name}; give it {name} = Record(...)"
                )
        self.endpoint = wrench_mode == "endpoint"
        order = 2 if self.endpoint else self.order
        self._declare(
            {**structure, "wrench_mode": wrench_mode},
            [Port(name, "connection", order) for name in self.port_names],
            self.parameters.quantities,
            self.commands.quantities,
            self.own_outputs,
            self.observations.quantities,
            self.states.quantities,
            feedthrough=self.endpoint,
        )
        if self.endpoint:
            self.continuous = ContinuousStates.of(self.state_layout, self.indicator_count)

    def led(self, before: Sequence[PortMotion], now: Sequence[PortMotion]) -> Mapping[str, Sequence[float]]:
        """Start values of parameters, for ports that start now where a scene's equilibrium led them from before.

        None where nothing counts from where ports start.
        """
        return {}

    def prepare(self, p: Vector) -> Any:  # noqa: ANN401 - of the component's own kind
        """The checked parameters by name."""
        return self._checked(p)

    def _checked(self, p: Vector) -> P:
        """Parameters by name; ComponentError where one is out of its range or the order is between 2 and 4."""
        self.check_ranges(p)
        if "order" in self.parameter_layout:
            (order,) = p[self.parameter_layout["order"]]
            if order not in (2.0, 4.0):
                raise ComponentError(f"order = {order:g}; it must be 2 or 4")
        return self.parameters.read(p)

    def _is_paired(self, order: float) -> bool:
        """Whether wrenches are of order 4."""
        return order == 4.0 and not self.endpoint

    def inputs(self, u: Vector) -> Inputs[C]:
        """The inputs by name."""
        v: list[float] = u.tolist()
        ends = range(MOTION_SIZE, MOTION_SIZE * (len(self.ports) + 1), MOTION_SIZE)
        own = MOTION_SIZE * len(self.ports)
        first = own + self.commands.size
        return Inputs(
            tuple(PortMotion.read(v[end - MOTION_SIZE : end]) for end in ends),
            self.commands.read(u[own:first]),
            tuple(PortMoments.read(v[i : i + WRENCH_SIZE]) for i in range(first, len(v), WRENCH_SIZE)),
        )

    def start(self, c: Any, u: Inputs[C]) -> S:  # noqa: ANN401
        """State at the start."""
        raise self._lacking("start")

    def advance(self, c: Any, s: S, u: Inputs[C], h: float) -> S:  # noqa: ANN401
        """State after one step."""
        raise self._lacking("advance")

    def wrenches(self, c: Any, s: S, u: Inputs[C]) -> Sequence[float]:  # noqa: ANN401
        """End-point wrenches on all ports."""
        raise self._lacking("wrenches")

    def own(self, c: Any, s: S) -> Sequence[float]:  # noqa: ANN401
        """Own outputs."""
        return ()

    def record(self, c: Any, s: S, u: Inputs[C]) -> tuple[Any, ...]:  # noqa: ANN401
        """Observations."""
        raise self._lacking("record")

    def powers(self, c: Any, s: S, u: Inputs[C]) -> Sequence[float]:  # noqa: ANN401
        """Rates of the states that have them."""
        raise self._lacking("powers")

    def follow(self, c: Any, s: S, u: Inputs[C], at_event: bool) -> S:  # noqa: ANN401
        """What a state remembers of an accepted step of the solver."""
        return s

    def indicate(self, c: Any, s: S, u: Inputs[C]) -> Sequence[float]:  # noqa: ANN401
        """Event indicators."""
        return ()

    def _lacking(self, name: str) -> NotImplementedError:
        return NotImplementedError(f"{type(self).__name__} has no function {name!r}")

    def initial(self, c: Any, u: Vector) -> Vector:  # noqa: ANN401
        """State at the start."""
        return self.states.write(self.start(c, self.inputs(u)))

    def step(self, c: Any, x: Vector, u: Vector, h: float) -> Vector:  # noqa: ANN401
        """State after one step."""
        return self.states.write(self.advance(c, self.states.read(x), self.inputs(u), h))

    def outputs(self, c: Any, x: Vector, u: Vector) -> Vector:  # noqa: ANN401
        """Wrenches on all ports, own outputs, of order 4 slopes of the wrenches."""
        own = self.own(c, self.states.read(x)) if self.own_outputs else ()
        if self.endpoint:
            return np.array((*self.wrenches(c, self.states.read(x), self.inputs(u)), *own))
        wrench, *slopes = (x[self.state_layout[name]] for name in ("wrench", "slopes")[: self.order // 2])
        return np.concatenate([wrench, own, *slopes])

    def observe(self, c: Any, x: Vector, u: Vector) -> Vector:  # noqa: ANN401
        """Observations."""
        return self.observations.write(self.record(c, self.states.read(x), self.inputs(u)))

    def rates(self, c: Any, x: Vector, u: Vector) -> Vector:  # noqa: ANN401
        """Rates of the continuous states."""
        return np.array(self.powers(c, self.states.read(x), self.inputs(u)))

    def update(self, c: Any, x: Vector, u: Vector, at_event: bool) -> Vector:  # noqa: ANN401
        """What a state remembers of an accepted step of the solver and, at an event, what happens there."""
        return self.states.write(self.follow(c, self.states.read(x), self.inputs(u), at_event))

    def indicators(self, c: Any, x: Vector, u: Vector) -> Vector:  # noqa: ANN401
        """Numbers that change their sign at events."""
        return np.array(self.indicate(c, self.states.read(x), self.inputs(u)))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """The wrench mode; subclasses add what they derive from their structure."""
        return {"endpoint": self.endpoint}

    @classmethod
    def example(cls) -> Self:
        """One with its defaults."""
        return cls()  # type: ignore[call-arg] # structure of kinds has defaults
