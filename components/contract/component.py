"""The contract every component fulfils; adding a component means writing one file that does.

1. Subclass `Component`, or `Connection` (`connection.py`) for what takes motion at its ports and gives wrenches, give
   it a `kind` and what people call it, its `noun`, and take its *structure* (what fixes the number of variables:
   ports, modal data, switches) as keyword arguments of `__init__`. A structure value is a number, a
   string, a tuple or list or dictionary of those, or a NumPy array; nothing else, because an exported FMU
   carries it in its resources.
2. Declare in `__init__`, by calling `self._declare`, the parameters, inputs, outputs, observations and states as
   `Quantity` tuples and the ports; a connection declares them as records (`record.py`), named tuples that it then
   reads and writes by name. What masters and views know by name or role is declared in `roles.py`. *Outputs* are what
   other components are connected to and are computed in every iteration; *observations* are outputs for people
   (energies, angles, torques) and are computed only when somebody reads them. A quantity of size n becomes the
   scalars `name[1] ... name[n]`.
3. Write five functions that keep no state of their own, all on flat `float64` arrays in declared order (a connection
   writes their twins on records, see there):

       prepare(p)          -> constants       checks the parameters, derives what steps need
       initial(c, u)       -> x               the state at the start, inputs already known
       step(c, x, u, h)    -> x               over one communication step size h; never changes x in place
       outputs(c, x, u)    -> y
       observe(c, x, u)    -> z

   The whole state is the one array x, so saving, restoring and serialising it is exact by construction.
   A component that an outer solver may integrate declares the unit of the rate of its `continuous` states and gives,
   where they differ from the defaults, four functions more (`complete`, `rates`, `indicators`, `update`).
   A body whose motion answers its wrenches alike in every configuration, in axes that turn with it, says so by
   `constant_mobility`: the master then differentiates it once, others for every step size and anew where steps fail.
4. Give `example()`: a small instance that the tests over the registry run.
5. For native FMUs write the same equations once more in C, one file in `fmus/native/kernels`; `kernel.h` beside it says
   how, and give `native_data()`; without them the component is exported as a PythonFMU. `python -m fmus.native` writes
   the header that tells the kernel where each declared variable lies.

Nothing else is to be edited: the FMU builder, the conformance tests, `fanfold list` and the component table
of the README iterate over `REGISTRY`.

World axes, SI units, radians. Quaternions are scalar first and rotate body into world coordinates.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from inspect import signature
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from .mass import RigidMass
from .ports import Port, Terminal, port_layout, slope_layout
from .quantity import ComponentError, Layout, Quantity, Vector

__all__ = [
    "REGISTRY",
    "Component",
    "ComponentError",
    "ContinuousStates",
    "Layout",
    "Port",
    "Quantity",
    "Vector",
    "port_layout",
    "slope_layout",
]


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

    @classmethod
    def of(cls, layout: Layout, indicators: int = 0) -> ContinuousStates:
        """Those states of a layout that have a unit of their rate."""
        states = [q for q in layout.quantities if q.rate_unit and q.size]
        return cls(
            tuple(states),
            tuple(q.rate_unit for q in states),
            tuple(q.nominal for q in states),
            tuple(place for q in states for place in range(layout[q.name].start, layout[q.name].stop)),
            tuple(q.name for q in states if q.quadrature),
            indicators,
        )

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
    noun: str = ""
    """What people call it, the kind in words where nothing is given."""
    order: ClassVar[Literal[2, 4]] = 4
    """Order in time, at most, of the wrenches at the ports."""
    ports_vary: ClassVar[bool] = False
    """Whether the number of ports follows from the structure."""
    scheme: ClassVar[Mapping[str, float]] = {}
    """Constants of the equations that the kernel takes from here."""
    structure: Mapping[str, Any]
    parameter_layout: Layout
    input_layout: Layout
    state_layout: Layout
    output_layout: Layout
    observation_layout: Layout
    own_inputs: Sequence[Quantity]
    own_outputs: Sequence[Quantity]
    ports: tuple[Port, ...]
    feedthrough: bool
    continuous: ContinuousStates | None = None
    constant_mobility: bool = False
    prescribed_motion: bool = False
    """Of a body, whether no wrench changes its motion."""
    observes_inputs: bool = True
    """Whether observations may follow inputs of the same instant, and not only those of steps before."""
    starts_from_inputs: bool = True
    """Whether the state at the start may follow inputs of that instant; that of a body follows its parameters."""
    terminals: tuple[Terminal, ...] = ()
    """Variables that belong together, in addition to those of each port."""
    returns_early: bool = False
    """Whether steps of a native FMU of FMI 3.0 may end at events inside of it, whatever its parameters."""

    def __init_subclass__(cls, *, registered: bool = True, **kwargs: object) -> None:
        """registered: whether the class is a kind that scenes may name."""
        super().__init_subclass__(**kwargs)
        if "kind" in cls.__dict__ and registered:
            if cls.kind in REGISTRY:
                raise TypeError(f"two components of kind {cls.kind!r}")
            REGISTRY[cls.kind] = cls
            if "noun" not in cls.__dict__:
                cls.noun = cls.kind.replace("_", " ")

    def _declare(
        self,
        structure: Mapping[str, Any],
        ports: Iterable[Port],
        parameters: Iterable[Quantity] = (),
        inputs: Iterable[Quantity] = (),
        outputs: Iterable[Quantity] = (),
        observations: Iterable[Quantity] = (),
        states: Iterable[Quantity] = (),
        feedthrough: bool = False,
    ) -> None:
        """Record the variables; those of the ports come first, in port order, those of their slopes last.

        `feedthrough` says that outputs depend on inputs of the same instant (end-point wrenches).
        """
        self.structure = dict(structure)
        self.ports = tuple(ports)
        sides, slopes = [port_layout(p) for p in self.ports], [slope_layout(p) for p in self.ports]
        own = tuple(inputs), tuple(outputs)
        self.feedthrough = feedthrough
        self.parameter_layout = Layout(parameters)
        self.input_layout, self.output_layout = (
            Layout(
                (*(q for side in sides for q in side[i]), *own[i], *(q for slope in slopes for q in slope[i]))
            )
            for i in (0, 1)
        )
        self.own_inputs, self.own_outputs = own
        self.observation_layout = Layout(observations)
        self.state_layout = Layout(states)
        Layout(q for layout in self.layouts for q in layout.quantities)  # names are unique across all four

    @property
    def layouts(self) -> tuple[Layout, Layout, Layout, Layout]:
        """Parameters, inputs, outputs, observations."""
        return (self.parameter_layout, self.input_layout, self.output_layout, self.observation_layout)

    def check_ranges(self, p: Vector) -> None:
        """Raise `ComponentError` naming the first parameter that is not finite or out of its range."""
        for quantity in self.parameter_layout.quantities:
            unit = "" if quantity.unit == "1" else f" {quantity.unit}"
            for name, value in zip(
                quantity.scalar_names(), p[self.parameter_layout[quantity.name]], strict=True
            ):
                if not np.isfinite(value):
                    raise ComponentError(f"{name} is {value}; it must be a finite number")
                if quantity.minimum is not None and value < quantity.minimum:
                    raise ComponentError(
                        f"{name} = {value:g}{unit}; it must be at least {quantity.minimum:g}"
                    )
                if quantity.maximum is not None and value > quantity.maximum:
                    raise ComponentError(f"{name} = {value:g}{unit}; it must be at most {quantity.maximum:g}")

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

    def masses(self) -> Sequence[RigidMass]:
        """Masses that its ports move; none of connections and of what moves by a law."""
        return ()

    def native_data(self) -> Mapping[str, ArrayLike] | None:
        """Arrays of numbers by name that the native kernel of this kind reads; None where there is no kernel.

        What `__init__` derived from the structure, flattened in C order; a switch is 0 or 1. The kernel takes
        parameters by name from the declared layouts, so they are not repeated here.
        """
        return None

    def native_parts(self) -> Mapping[str, bytes]:
        """What the native kernel reads beside numbers, by name: the data of components inside of this one."""
        return {}

    @classmethod
    def comes_from_outside(cls) -> bool:
        """Whether it is kept outside of this package, by a plugin."""
        return cls.__module__.partition(".")[0] != __name__.partition(".")[0]

    @classmethod
    def has_wrench_mode(cls) -> bool:
        """Whether its wrenches are means over steps or those of an end point, as its structure says."""
        return _has_wrench_mode(cls)

    @classmethod
    @abstractmethod
    def example(cls) -> Self:
        """A small instance with every kind of variable the component can have, but for those of `other_examples`."""

    @classmethod
    def other_examples(cls) -> Mapping[str, Self]:
        """Instances with variables that the example lacks, by the words of a scene or structure that make them so."""
        return {}


@cache
def _has_wrench_mode(kind: type[Component]) -> bool:
    return "wrench_mode" in signature(kind).parameters
