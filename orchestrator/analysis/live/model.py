"""A wing as one FMU with the numbers in its data that sliders move.

Every number of an FMU's data follows from its scene by the assembly, which is asked at a few values of each slider and
interpolated in between. So all that the assembly makes of a key moves with it: parameters of several components, the
static equilibrium of a scene with preload, the reference load of step control.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components import FanfoldError
from components.contract.component import Vector
from fmus.compiled import component_data, run_through
from fmus.native.binary_data import arrays_in

from ...results.energy_ledger import tolerance_asked, tolerance_taken
from ...results.key_figures import Headline
from ...results.parts import json_of
from ...results.result import Result
from ...run.as_one.component import AssembledScene
from ...run.as_one.initial_equilibrium import REST
from ...run.simulation import Options
from ...scene.layers import Layers
from ...scene.reader import check_layers
from ..sampling.varied import Settings
from ..stress.model import scene_tree
from .sliders import LiveError, Slider, sliders

_NODES = 2, 3, 5, 9, 17, 33
"""Values of a slider at which the scene is assembled: Chebyshev nodes, each set within the next."""
_FALLS = 0.5
"""Largest ratio of the interpolation error of a smooth function to that with half as many intervals."""
_NARROWED = 3
"""Times that an end of a usual range moves half the way to the value of the scene, where the scene refuses it."""
_GOLDEN = 0.618034
"""Multiples of it, modulo 1, are spread evenly: shares of all ranges at which the model is checked."""
_LARGEST = 40_000
"""Numbers that a slider may move, so that the page stays small."""

_TOLERANCE = 1e-4
"""Of results of earlier versions, which do not name theirs."""

Places = NDArray[np.int64]


class FormError(LiveError):
    """A value that changes the form of the model."""


class Moved(NamedTuple):
    """What a slider moves: indices (M,) of numbers, and these (nodes, M) at its Chebyshev nodes."""

    places: Places
    values: Vector


@dataclass(frozen=True)
class LiveModel:
    """Data of one FMU of a scene and what its sliders move in them.

    scene: the component, with its variables. offsets (N,): places of all numbers in the data, bytes. products: indices
    of numbers that several sliders multiply; of others their changes add up. end: of a run, s. dropped: sentences on
    usual sliders that this scene does not allow.
    """

    scene: AssembledScene
    data: bytes
    offsets: Places
    sliders: tuple[Slider, ...]
    moved: tuple[Moved, ...]
    products: frozenset[int]
    end: float
    dropped: tuple[str, ...] = ()

    @cached_property
    def numbers(self) -> Vector:
        """All numbers (N,) of the data."""
        return numbers_at(self.data, self.offsets)

    def data_at(self, values: Sequence[float]) -> bytes:
        """The data with a value of each slider."""
        found = self.numbers.copy()
        multiplied = np.zeros(found.size, dtype=bool)
        multiplied[list(self.products)] = True
        for one, moved, value in zip(self.sliders, self.moved, values, strict=True):
            here, start = (weights(one, moved, x) @ moved.values for x in (value, one.start))
            own = multiplied[moved.places]
            found[moved.places[own]] *= here[own] / start[own]
            found[moved.places[~own]] += (here - start)[~own]
        content = np.frombuffer(self.data, np.uint8).copy()
        content[self.offsets[:, None] + np.arange(8)] = found.astype("<f8").view(np.uint8).reshape(-1, 8)
        return content.tobytes()

    def outputs(self, data: bytes) -> dict[str, float]:
        """Outputs by name at the end of a run with such data."""
        _, _, layout, _ = self.scene.layouts
        first = self.first_output
        values = run_through(data, (self.end,), range(first, first + layout.size))[0]
        return dict(zip(layout.scalar_names(), values.tolist(), strict=True))

    @property
    def first_output(self) -> int:
        """Value reference of the first output; observations follow them."""
        parameters, inputs, _, _ = self.scene.layouts
        return parameters.size + inputs.size


def nodes(slider: Slider, count: int) -> Vector:
    """Chebyshev nodes (count,) of a slider's range, from high to low."""
    share = 0.5 + 0.5 * np.cos(np.pi * np.arange(count) / (count - 1))
    found: Vector = slider.low + (slider.high - slider.low) * share
    found[[0, -1]] = slider.high, slider.low
    return found


def weights(slider: Slider, moved: Moved, value: float) -> Vector:
    """Weights (nodes,) of the nodes for a value: barycentric interpolation (Berrut and Trefethen 2004)."""
    count = len(moved.values)
    away = value - nodes(slider, count)
    if not away.all():
        return np.where(away == 0.0, 1.0, 0.0)
    found = np.where(np.arange(count) % 2, -1.0, 1.0) / away
    found[[0, -1]] *= 0.5
    return np.asarray(found / found.sum())


def numbers_at(data: bytes, offsets: Places) -> Vector:
    """Numbers (N,) at places of the data."""
    content = np.frombuffer(data, np.uint8)
    found: Vector = content[offsets[:, None] + np.arange(8)].view("<f8").ravel()
    return found


class Maker:
    """Makes the data of the one FMU of a result's scene, at other values of its keys."""

    def __init__(self, result: Result) -> None:
        known = result.provenance
        self.name, self.tree = result.name, scene_tree(result)
        self.tolerance = tolerance_taken(result) or tolerance_asked(result) or _TOLERANCE
        self.end = float(result.time[-1])
        self._flexible, self._large = (
            _names(known.get(kind, "[]")) for kind in ("flexible", "large_deformation")
        )
        if "step" in known or known.get("master", "implicit") != "implicit":
            raise LiveError(
                f"{self.name}: a run with a constant step or an explicit master is not live; run the scene without them"
            )
        if not result.complete:
            raise LiveError(f"{self.name}: the run was interrupted; `fanfold resume` completes it")

    def scene(self, values: Settings) -> AssembledScene:
        """The scene with values of keys, as one component; FanfoldError where it refuses them."""
        layers = Layers(self.name, self.tree, {}, frozenset())
        checked = check_layers(layers, (), list(values.items()), of_result=True)
        if checked.fmus:
            raise LiveError(
                f"{self.name}: FMUs of other tools do not run in a page; leave {checked.fmus[0].name} out of the scene"
            )
        names = {body.name for body in checked.bodies}
        flexible, large = self._flexible & names, self._large & names
        options = Options(names - flexible - large, flexible, large, tolerance=self.tolerance)
        assembly = options.assemble(checked)
        return AssembledScene(assembly, replace(options.settings(assembly), driving=assembly.driving))

    def data(self, values: Settings) -> bytes:
        """The data of that component."""
        scene = self.scene(values)
        return component_data(scene, scene.start())


def _names(text: str) -> set[str]:
    found = json_of(text)
    return {str(name) for name in found} if isinstance(found, list) else set()


def live_model(
    result: Result,
    headline: Headline,
    texts: Sequence[str] = (),
    watch: Callable[[str], object] = lambda name: None,
) -> LiveModel:
    """The one FMU of a result's scene with sliders, texts such as "friction.coefficient=0.05..0.2" or the usual ones.

    LiveError where the scene, or a slider that is named, does not allow it. watch: called with each slider's name.
    """
    maker = Maker(result)
    scene = maker.scene({})
    data = component_data(scene, scene.start())
    form = _Form(data)
    kept, moved, dropped = list[Slider](), list[Moved](), list[str]()
    for one in sliders(texts, maker.tree):
        watch(one.name)
        try:
            samples = _Samples(maker, one, form)
            if not one.is_chosen:
                samples.narrow()
            changed = _moved(samples, maker.tolerance)
        except FanfoldError as error:
            if one.is_chosen:
                raise
            dropped.append(str(error))
        else:
            kept.append(samples.slider)
            moved.append(changed)
    if not kept:
        raise LiveError(
            "\n".join(
                [f"{maker.name}: nothing of the scene slides by default; name a key by --slider", *dropped]
            )
        )
    model = LiveModel(
        scene, data, form.offsets, tuple(kept), tuple(moved), frozenset(), maker.end, tuple(dropped)
    )
    watch("check")
    return _verified(model, maker, headline)


class _Form:
    """Places of all numbers in data, and what else is in them."""

    def __init__(self, data: bytes) -> None:
        arrays = list(arrays_in(data))
        self.offsets: Places = np.concatenate([place + 8 * np.arange(count) for _, place, count in arrays])
        self.numbers = numbers_at(data, self.offsets)
        self.is_iterated = np.concatenate([np.full(count, name in REST) for name, _, count in arrays])
        self._rest = self._without(data)

    def fits(self, data: bytes) -> bool:
        """Whether other data differ by numbers alone."""
        return len(data) == len(self._rest) and self._without(data) == self._rest

    def _without(self, data: bytes) -> bytes:
        content = np.frombuffer(data, np.uint8).copy()
        content[self.offsets[:, None] + np.arange(8)] = 0
        return content.tobytes()


class _Samples:
    """Numbers (N,) of the data at values of a slider, each assembled once; those of the scene are known."""

    def __init__(self, maker: Maker, slider: Slider, form: _Form) -> None:
        self._maker, self.slider, self.form = maker, slider, form
        self._rows: dict[float, Vector] = {
            slider.start: np.nan_to_num(form.numbers, nan=0.0, posinf=0.0, neginf=0.0)
        }

    def at(self, value: float) -> Vector:
        """LiveError where the scene refuses a value, or has another form there."""
        if value not in self._rows:
            self._rows[value] = _numbers(self._maker, self.slider, self.form, value)
        return self._rows[value]

    def narrow(self) -> None:
        """Bring the ends of a usual slider to values that the scene accepts; LiveError where there are none."""
        one = self.slider
        low, high = self._end(one.low), self._end(one.high)
        if low == high:
            raise LiveError(f"{one.label}: the scene accepts no other values near {one.text(one.start)}")
        self.slider = one.between(low, high)

    def _end(self, end: float) -> float:
        for _ in range(_NARROWED):
            with suppress(LiveError):
                self.at(end)
                return end
            end = 0.5 * (end + self.slider.start)
        return self.slider.start


def _moved(samples: _Samples, tolerance: float) -> Moved:
    """What a slider moves, at as many nodes as numbers of the scene need; LiveError where they have no end.

    Fewer nodes are checked at those that come next, and at the value of the scene. Numbers of the static equilibrium
    come from an iteration, whose rounding no polynomial follows.
    """
    slider, form = samples.slider, samples.form
    coarse, last = None, inf
    for count in _NODES:
        at = nodes(slider, count).tolist()
        fine = Moved(np.arange(form.numbers.size), np.array([samples.at(value) for value in at]))
        if coarse is not None:
            off = max(_off(coarse, slider, value, samples.at(value), form) for value in (*at, slider.start))
            if off <= tolerance:
                break
            if off > _FALLS * last or count == _NODES[-1]:
                raise LiveError(
                    f"{slider.label}: the model jumps or bends between {slider.low:g} and "
                    f"{slider.text(slider.high)}, so that it cannot slide; choose a smaller range, or use "
                    "`fanfold study`"
                )
            last = off if len(coarse.values) > _NODES[0] else inf
        coarse = fine
    assert coarse is not None
    places = np.flatnonzero(np.ptp(coarse.values, axis=0))
    if not places.size:
        raise LiveError(f"{slider.label} changes nothing in this scene; name another key")
    if places.size > _LARGEST:
        raise LiveError(
            f"{slider.label} changes {places.size} numbers of the model, which are too many for a page"
        )
    return Moved(places, coarse.values[:, places])


def _off(moved: Moved, slider: Slider, value: float, numbers: Vector, form: _Form) -> float:
    """Largest error of interpolation at a value, relative to the size of each number."""
    off = np.abs(weights(slider, moved, value) @ moved.values - numbers)
    size = np.abs(moved.values).max(axis=0)
    return float(np.max(off / np.where(size > 0.0, size, 1.0), where=~form.is_iterated, initial=0.0))


def _numbers(maker: Maker, slider: Slider, form: _Form, value: float) -> Vector:
    """All numbers of the data at a value of a slider; those that are not finite are as at the start."""
    try:
        made = maker.data(slider.settings(maker.tree, value))
    except FanfoldError as error:
        raise LiveError(f"{slider.label}: the scene refuses {slider.text(value)}: {error}") from None
    if not form.fits(made):
        raise FormError(
            f"{slider.label} changes the form of the model and not its numbers alone; use `fanfold study` for it"
        )
    found = numbers_at(made, form.offsets)
    return np.where(np.isfinite(found) & np.isfinite(form.numbers), found, 0.0)


def _verified(model: LiveModel, maker: Maker, headline: Headline) -> LiveModel:
    """The model, with how changes of several sliders combine; LiveError where its runs are not those of the scene.

    All sliders are moved at once, to two values of each; the scene and the model run at the first.
    """
    steps = np.arange(1, len(model.sliders) + 1)
    shares = [(steps * _GOLDEN) % 1.0, 1.0 - (steps * _GOLDEN) % 1.0]
    values = [
        [s.low + (s.high - s.low) * x for s, x in zip(model.sliders, share.tolist(), strict=True)]
        for share in shares
    ]
    true = []
    for some in values:
        settings: Settings = {}
        for one, value in zip(model.sliders, some, strict=True):
            settings |= one.settings(maker.tree, value)
        true.append(maker.data(settings))
    model = replace(model, products=_products(model, values, true))
    exact, found = model.outputs(true[0]), model.outputs(model.data_at(values[0]))
    if name := next(_unlike(exact, found, maker.tolerance, headline), ""):
        keys = ", ".join(one.label for one in model.sliders)
        raise LiveError(
            f"{maker.name}: {keys} do not slide together: {name} is {found[name]:.6g} in place of "
            f"{exact[name]:.6g}; name fewer keys by --slider, or smaller ranges"
        )
    return model


def _unlike(
    exact: Mapping[str, float], found: Mapping[str, float], tolerance: float, headline: Headline
) -> Iterator[str]:
    """Outputs of lines that differ by more than the tolerance and the estimated error of the result."""
    errors = {number.key: number.error or 0.0 for number in headline.numbers()}
    for line in headline.latch_times:
        for quantity in ("time", "rate", "torque peak"):
            name = f"{line}.latch_{quantity.replace(' ', '_')}"
            allowed = max(tolerance * abs(exact[name]), errors.get((f"latch {quantity}", line), 0.0))
            if abs(found[name] - exact[name]) > allowed:
                yield name


def _products(model: LiveModel, values: Sequence[Sequence[float]], true: Sequence[bytes]) -> frozenset[int]:
    """Numbers that several sliders move, and that come nearer to the true ones as products of their changes."""
    places, count = np.unique(np.concatenate([one.places for one in model.moved]), return_counts=True)
    shared = places[count > 1]
    shared = shared[model.numbers[shared] != 0.0]
    every = replace(model, products=frozenset(shared.tolist()))
    off = [np.zeros(shared.size), np.zeros(shared.size)]
    for some, data in zip(values, true, strict=True):
        exact = numbers_at(data, model.offsets)[shared]
        for k, one in enumerate((model, every)):
            off[k] += np.abs(numbers_at(one.data_at(some), model.offsets)[shared] - exact)
    return frozenset(shared[off[1] < off[0]].tolist())
