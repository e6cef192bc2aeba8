"""The contract every component fulfils; adding a component means writing one file that does.

1. Subclass `Component`, give it a `kind`, and take its *structure* (what fixes the number of variables:
   ports, modal data, switches) as keyword arguments of `__init__`. A structure value is a number, a
   string, a tuple or list or dictionary of those, or a NumPy array; nothing else, because an exported FMU
   carries it in its resources.
2. Declare in `__init__`, by calling `self._declare`, the parameters, inputs, outputs and observations as
   `Quantity` tuples and the ports. *Outputs* are what other components are connected to and are computed in
   every iteration; *observations* are outputs for people (energies, angles, torques) and are computed only
   when somebody reads them. A quantity of size n becomes the scalars `name[1] ... name[n]`.
3. Write five functions that keep no state of their own, all on flat `float64` arrays in declared order:

       prepare(p)          -> constants       checks the parameters, derives what steps need
       initial(c, u)       -> x               the state at the start, inputs already known
       step(c, x, u, h)    -> x               over one communication step size h; never changes x in place
       outputs(c, x, u)    -> y
       observe(c, x, u)    -> z

   The whole state is the one array x, so saving, restoring and serialising it is exact by construction.
   A component that an outer solver may integrate also gives its `continuous` states and, where they differ
   from the defaults, four functions more (`complete`, `rates`, `indicators`, `update`).
   A body whose motion answers its wrenches alike in every configuration, in axes that turn with it, says so by
   `constant_mobility`: the master then differentiates it once for every step size, others again and again.
4. Give `example()`: a small instance that the tests over the registry run.
5. For native FMUs write the same equations once more in C, one file in `fmus/native/kernels`; `kernel.h` beside it says
   how, and give `native_data()`; without them the component is exported as a PythonFMU.

Nothing else is to be edited: the FMU builder, the conformance tests, `fanfold list` and the component table
of the README iterate over `REGISTRY`.

World axes, SI units, radians. Quaternions are scalar first and rotate body into world coordinates.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import FanfoldError

Vector = NDArray[np.float64]

KINETIC_ENERGY = "kinetic_energy"
POTENTIAL_ENERGY = "potential_energy"
DISSIPATED_ENERGY = "dissipated_energy"
NUMERICAL_DISSIPATION = "numerical_dissipation"
SUPPLIED_ENERGY = "supplied_energy"
"""Observations (J) that the energy balance of a scene adds up; dissipation is never found by difference.

Kinetic, potential, dissipated energy and numerical dissipation change together by what is supplied from outside,
such as the work of a drive. Dissipated energy is the heat of dampers, friction and latches alone; numerical
dissipation is what the scheme takes away besides, and it may give back a part that it stored.
"""

LAGGED = "_lagged"
"""Ending of an observation that tells the one named before it once more, for the communication point one step earlier.

What a load was there is known better once both steps beside that point are. Such observations are declared last.
"""


class ComponentError(FanfoldError):
    """A sentence for the user: what is wrong with a value, and what it must be."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """One declared variable: the single place where its unit, range, start value and meaning stand.

    `size` scalars of `unit` (FMI unit syntax; "1" for none). `start` is one number for all or one per
    scalar. `minimum` and `maximum` bound every scalar, inclusive. `variability` only matters for
    parameters ("fixed" before the start only, "tunable" between steps) and inputs ("continuous",
    "discrete").
    """

    name: str
    unit: str
    description: str
    size: int = 1
    start: float | tuple[float, ...] = 0.0
    minimum: float | None = None
    maximum: float | None = None
    variability: Literal["fixed", "tunable", "continuous", "discrete"] = "continuous"

    def scalar_names(self) -> tuple[str, ...]:
        """Names of the scalars, `name` itself when there is one, else `name[1]`, ..."""
        if self.size == 1:
            return (self.name,)
        return tuple(f"{self.name}[{i}]" for i in range(1, self.size + 1))

    def start_values(self) -> Vector:
        """Start values, shape (size,)."""
        return np.broadcast_to(np.asarray(self.start, dtype=float), (self.size,)).copy()


def lagged(quantity: Quantity) -> Quantity:
    """The observation that tells a quantity for the communication point one step earlier."""
    text = f"{quantity.description}, one step earlier; of order 4, after two steps"
    return replace(quantity, name=quantity.name + LAGGED, description=text)


@dataclass(frozen=True, slots=True)
class Port:
    """A place where mechanical power flows.

    side "body": gives `position, orientation, velocity, angular_velocity`, takes `force, torque`.
    side "connection": the other way round. All in world axes, torque about the port's origin.
    order: 2 where wrenches are held over a step, 4 where they are linear in time, see `slope_layout`.
    """

    name: str
    side: Literal["body", "connection"]
    order: Literal[2, 4] = 2


class Layout:
    """Where each quantity sits in a flat array: `layout["name"]` is its slice, `size` the total length."""

    def __init__(self, quantities: Iterable[Quantity]) -> None:
        self.quantities = tuple(quantities)
        self._slices: dict[str, slice] = {}
        position = 0
        for quantity in self.quantities:
            if quantity.name in self._slices:
                raise ComponentError(f"variable {quantity.name!r} is declared twice")
            self._slices[quantity.name] = slice(position, position + quantity.size)
            position += quantity.size
        self.size = position

    def __getitem__(self, name: str) -> slice:
        """Slice of the named quantity; KeyError if there is none."""
        return self._slices[name]

    def __contains__(self, name: str) -> bool:
        """Whether the quantity is declared here."""
        return name in self._slices

    def start_values(self) -> Vector:
        """Start values of all quantities, shape (size,)."""
        return np.concatenate([np.zeros(0), *(q.start_values() for q in self.quantities)])

    def scalar_names(self) -> tuple[str, ...]:
        """Names of all scalars in order."""
        return tuple(name for q in self.quantities for name in q.scalar_names())


def port_layout(port: Port) -> tuple[tuple[Quantity, ...], tuple[Quantity, ...]]:
    """Inputs and outputs of a port, each in the order they take in flat arrays (13 and 6 scalars)."""
    n = port.name
    motion = (
        Quantity(f"{n}.position", "m", f"Position of port {n}, world axes", 3),
        Quantity(f"{n}.orientation", "1", f"Quaternion of port {n}, scalar first", 4, (1.0, 0.0, 0.0, 0.0)),
        Quantity(f"{n}.velocity", "m/s", f"Velocity of port {n}, world axes", 3),
        Quantity(f"{n}.angular_velocity", "rad/s", f"Angular velocity of port {n}, world axes", 3),
    )
    wrench = (
        Quantity(f"{n}.force", "N", f"Force on the body at port {n}, world axes", 3),
        Quantity(f"{n}.torque", "N.m", f"Torque on the body about the origin of port {n}, world axes", 3),
    )
    return (wrench, motion) if port.side == "body" else (motion, wrench)


def slope_layout(port: Port) -> tuple[tuple[Quantity, ...], tuple[Quantity, ...]]:
    """Inputs and outputs that make a port of order 4, each in the order they take in flat arrays (6 scalars each).

    Over a step of size h a wrench is u + u_slope P1(t), P1 = 2 t / h - 1, with `force` and `torque` its mean u. The
    moment of a velocity is the integral of P1 v dt, so that slope times moment is work. Empty for a port of order 2.
    """
    if port.order == 2:
        return ((), ())
    n = port.name
    moments = (
        Quantity(
            f"{n}.velocity_moment", "m", f"First moment of the velocity of port {n} over the last step", 3
        ),
        Quantity(
            f"{n}.angular_velocity_moment",
            "rad",
            f"First moment of the angular velocity of port {n} over the last step",
            3,
        ),
    )
    slopes = (
        Quantity(f"{n}.force_slope", "N", f"Half the change of the force at port {n} over the step", 3),
        Quantity(f"{n}.torque_slope", "N.m", f"Half the change of the torque at port {n} over the step", 3),
    )
    return (slopes, moments) if port.side == "body" else (moments, slopes)


@dataclass(frozen=True, slots=True)
class ContinuousStates:
    """The part of a state that an outer solver may integrate, as the quantities that model exchange shows.

    Each of `quantities` has a unit of its rate in `rate_units` and a typical size of its scalars in `nominal`;
    `places` are the positions of all scalars in the state array. Nothing but observations depends on those
    named in `quadratures`. `indicators` is the number of event indicators.
    """

    quantities: tuple[Quantity, ...]
    rate_units: tuple[str, ...]
    nominal: tuple[ArrayLike, ...]
    places: tuple[int, ...]
    quadratures: tuple[str, ...] = ()
    indicators: int = 0

    def nominals(self) -> Vector:
        """Typical size of every scalar, shape (len(places),)."""
        sizes = zip(self.nominal, self.quantities, strict=True)
        parts = [np.broadcast_to(np.asarray(n, dtype=float), (q.size,)) for n, q in sizes]
        return np.concatenate([np.zeros(0), *parts])


REGISTRY: dict[str, type[Component]] = {}
"""Every component by kind, filled by the class definitions themselves."""


class Component(ABC):
    """A mechanical component: declared variables and pure functions on a flat state. See the module."""

    kind: ClassVar[str]
    structure: Mapping[str, Any]
    parameter_layout: Layout
    input_layout: Layout
    output_layout: Layout
    observation_layout: Layout
    ports: tuple[Port, ...]
    feedthrough: bool
    continuous: ContinuousStates | None = None
    constant_mobility: bool = False

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        if "kind" in cls.__dict__:
            if cls.kind in REGISTRY:
                raise TypeError(f"two components of kind {cls.kind!r}")
            REGISTRY[cls.kind] = cls

    def _declare(
        self,
        structure: Mapping[str, Any],
        ports: Iterable[Port],
        parameters: Iterable[Quantity] = (),
        inputs: Iterable[Quantity] = (),
        outputs: Iterable[Quantity] = (),
        observations: Iterable[Quantity] = (),
        feedthrough: bool = False,
    ) -> None:
        """Record the variables; those of the ports come first, in port order, those of their slopes last.

        `feedthrough` says that outputs depend on inputs of the same instant (end-point wrenches).
        """
        self.structure = dict(structure)
        self.ports = tuple(ports)
        sides, slopes = [port_layout(p) for p in self.ports], [slope_layout(p) for p in self.ports]
        self.feedthrough = feedthrough
        self.parameter_layout = Layout(parameters)
        self.input_layout, self.output_layout = (
            Layout(
                (*(q for side in sides for q in side[i]), *own, *(q for slope in slopes for q in slope[i]))
            )
            for i, own in enumerate((tuple(inputs), tuple(outputs)))
        )
        self.observation_layout = Layout(observations)
        Layout(q for layout in self.layouts for q in layout.quantities)  # names are unique across all four

    @property
    def layouts(self) -> tuple[Layout, Layout, Layout, Layout]:
        """Parameters, inputs, outputs, observations."""
        return (self.parameter_layout, self.input_layout, self.output_layout, self.observation_layout)

    def check_ranges(self, p: Vector) -> None:
        """Raise `ComponentError` naming the first parameter that is not finite or out of its range."""
        for quantity in self.parameter_layout.quantities:
            for name, value in zip(
                quantity.scalar_names(), p[self.parameter_layout[quantity.name]], strict=True
            ):
                if not np.isfinite(value):
                    raise ComponentError(f"{name} is {value}; it must be a finite number")
                if quantity.minimum is not None and value < quantity.minimum:
                    raise ComponentError(
                        f"{name} = {value:g} {quantity.unit}; it must be at least {quantity.minimum:g}"
                    )
                if quantity.maximum is not None and value > quantity.maximum:
                    raise ComponentError(
                        f"{name} = {value:g} {quantity.unit}; it must be at most {quantity.maximum:g}"
                    )

    @abstractmethod
    def prepare(self, p: Vector) -> Any:  # noqa: ANN401 - opaque to everybody but the component
        """Check parameters (`ComponentError` with a sentence) and derive what the other functions need."""

    @abstractmethod
    def initial(self, c: Any, u: Vector) -> Vector:  # noqa: ANN401
        """State at the start; the inputs hold their values of that instant."""

    @abstractmethod
    def step(self, c: Any, x: Vector, u: Vector, h: float) -> Vector:  # noqa: ANN401
        """State after one communication step of size h (s); returns a new array."""

    @abstractmethod
    def outputs(self, c: Any, x: Vector, u: Vector) -> Vector:  # noqa: ANN401
        """Outputs in declared order, shape (output_layout.size,)."""

    @abstractmethod
    def observe(self, c: Any, x: Vector, u: Vector) -> Vector:  # noqa: ANN401
        """Observations in declared order, shape (observation_layout.size,)."""

    def complete(self, c: Any, x: Vector) -> Vector:  # noqa: ANN401
        """The state whose dependent part fits the continuous states that a solver put into x."""
        return x

    def rates(self, c: Any, x: Vector, u: Vector) -> Vector:  # noqa: ANN401
        """Rates of the continuous states in their order, of a state that needs no completion before."""
        raise NotImplementedError(f"{self.kind} has no continuous states")

    def indicators(self, c: Any, x: Vector, u: Vector) -> Vector:  # noqa: ANN401
        """Numbers that change their sign at events, of a completed state."""
        return np.zeros(0)

    def update(self, c: Any, x: Vector, u: Vector, at_event: bool) -> Vector:  # noqa: ANN401
        """What a state remembers of an accepted step of the solver and, at an event, what happens there."""
        return x

    def native_data(self) -> Mapping[str, ArrayLike] | None:
        """Arrays of numbers by name that the native kernel of this kind reads; None where there is no kernel.

        What `__init__` derived from the structure, flattened in C order; a switch is 0 or 1. The kernel takes
        parameters by name from the declared layouts, so they are not repeated here.
        """
        return None

    @classmethod
    @abstractmethod
    def example(cls) -> Self:
        """A small instance with every kind of variable the component can have."""
