"""A result as a binary glTF 2.0 file: bodies that move and bend, for viewers of three-dimensional pictures.

    fanfold (turns z up into glTF's y up)
        a node a body: mesh, forms as morph targets; translation, rotation and weights over time

Nodes of bodies are in the axes of the result, in m. Lengths of time are in s, as the result has them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from components.contract.component import Vector

from ...assembly import Geometry
from ...results.result import Result, ResultError
from ..placement import placed
from .motion import Motion, Rows, from_least, keys, motion
from .output import library, whole
from .surface import shown_bodies, surface

SHARE_OF_SIZE = 1e-4
"""Tolerance that nobody asked for another than, of the largest distance that any node lies from any other."""
_Z_UP: Final = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
_VERTICES, _INDICES = 34962, 34963
_FLOAT, _WHOLE = 5126, 5125
_KINDS: Final = {0: "SCALAR", 3: "VEC3", 4: "VEC4"}
_LINES, _TRIANGLES = 1, 4


def write_glb(path: Path, result: Result, tolerance: float | None = None) -> None:
    """Write the animated bodies; between its keys no node is off by more than a tolerance (m) at any row."""
    gltf = library("pygltflib", "a glb file")
    bodies = shown_bodies(result)
    if result.time[0] < 0.0:
        raise ResultError(
            f"{result.name}: the run begins before t = 0, where animations of glTF cannot begin"
        )
    rows = _distinct(result.time)
    allowed = _default(result, bodies, rows) if tolerance is None else tolerance
    if not 0.0 < allowed < np.inf:
        raise ResultError(f"the tolerance is {allowed} m; it must be a length above 0")
    scene = _Scene(gltf, result, allowed)
    for name, body in bodies.items():
        found = motion(result, name, body, rows, allowed)
        scene.add(name, body, from_least(found.part(keys(found, allowed))))
    try:
        content = b"".join(scene.finished().save_to_bytes())
    except ValueError:  # of JSON, which has no number that is not finite
        raise ResultError(f"{result.name}: its motion has numbers that are not finite") from None
    with whole(path) as part:
        part.write_bytes(content)


def _distinct(time: Vector) -> Rows:
    """Rows whose times differ in single precision, which glTF has; of those that do not the last."""
    return np.flatnonzero(np.diff(time.astype(np.float32), append=np.inf) > 0.0)


def _default(result: Result, bodies: dict[str, Geometry], rows: Rows) -> float:
    """Tolerance (m) from the size of all that is shown at some rows of the run."""
    some = rows[:: max(1, rows.size // 20)]
    every = np.concatenate([placed(result, name, body, some).reshape(-1, 3) for name, body in bodies.items()])
    return SHARE_OF_SIZE * float(np.linalg.norm(np.ptp(every, axis=0))) or SHARE_OF_SIZE


class _Scene:
    """A glTF scene to which bodies are added one by one, and the buffer with their numbers."""

    def __init__(self, gltf: Any, result: Result, tolerance: float) -> None:  # noqa: ANN401
        self._of, self._buffer = gltf, bytearray()
        self._gltf = gltf.GLTF2(
            asset=gltf.Asset(generator=f"Fanfold {result.provenance.get('fanfold', '')}".strip()),
            scene=0,
            scenes=[gltf.Scene(nodes=[0])],
            nodes=[gltf.Node(name=result.provenance.get("scene", "fanfold"), rotation=_Z_UP, children=[])],
            animations=[gltf.Animation(name="deployment")],
            buffers=[gltf.Buffer()],
        )
        events = [{"time": time, "component": name, "event": text} for time, name, text in result.events]
        self._gltf.scenes[0].extras = {"interpolation_tolerance_m": tolerance, "events": events}

    def add(self, name: str, body: Geometry, found: Motion) -> None:
        """A body with what moves of it."""
        of, number = self._of, len(self._gltf.nodes)
        node = of.Node(
            name=name,
            mesh=self._mesh(name, body, found),
            translation=found.position[0].tolist(),
            rotation=_scalar_last(found.orientation[0]).tolist(),
        )
        self._gltf.nodes.append(node)
        self._gltf.nodes[0].children.append(number)
        clock: int | None = None
        for path, values, still in (
            ("translation", found.position, np.ptp(found.position, axis=0)),
            ("rotation", _scalar_last(found.orientation), np.ptp(found.orientation, axis=0)),
            ("weights", found.amplitudes.reshape(-1), found.amplitudes),
        ):
            if np.any(still):
                clock = self._numbers(found.time, bounds=True) if clock is None else clock
                self._channel(number, path, clock, self._numbers(values))

    def finished(self) -> Any:  # noqa: ANN401
        """The whole of it."""
        if not self._gltf.animations[0].channels:
            self._gltf.animations = []
        self._gltf.buffers[0].byteLength = len(self._buffer)
        self._gltf.set_binary_blob(bytes(self._buffer))
        return self._gltf

    def _mesh(self, name: str, body: Geometry, found: Motion) -> int:
        of, shape = self._of, surface(np.asarray(body.faces))
        positions = self._numbers(found.nodes, bounds=True, target=_VERTICES)
        forms = np.moveaxis(found.forms, 2, 0)
        targets = [
            of.Attributes(POSITION=self._numbers(form, bounds=True, target=_VERTICES)) for form in forms
        ]
        primitives = [
            of.Primitive(
                attributes=of.Attributes(POSITION=positions),
                indices=self._indices(corners),
                mode=mode,
                material=self._material(name),
                targets=targets,
            )
            for mode, corners in ((_TRIANGLES, shape.triangles), (_LINES, shape.lines))
            if corners.size
        ]
        word = "mode" if found.missed is None else "form"
        names = [f"{word} {k + 1}" for k in range(len(targets))]
        weights = found.amplitudes[0].tolist()
        extras = {"targetNames": names} if names else {}
        self._gltf.meshes.append(of.Mesh(name=name, primitives=primitives, weights=weights, extras=extras))
        return len(self._gltf.meshes) - 1

    def _material(self, name: str) -> int:
        """A matt colour, that of the body in pictures of the report."""
        number = len(self._gltf.meshes)
        if number == len(self._gltf.materials):
            look = self._of.PbrMetallicRoughness(
                baseColorFactor=[*_colour(number), 1.0], metallicFactor=0.0, roughnessFactor=0.8
            )
            self._gltf.materials.append(
                self._of.Material(name=name, pbrMetallicRoughness=look, doubleSided=True)
            )
        return number

    def _channel(self, node: int, path: str, times: int, values: int) -> None:
        animation, of = self._gltf.animations[0], self._of
        target = of.AnimationChannelTarget(node=node, path=path)
        animation.channels.append(of.AnimationChannel(sampler=len(animation.samplers), target=target))
        animation.samplers.append(of.AnimationSampler(input=times, output=values, interpolation="LINEAR"))

    def _numbers(self, values: Vector, bounds: bool = False, target: int | None = None) -> int:
        """Accessor of values (n,), (n, 3) or (n, 4) in single precision."""
        single = np.ascontiguousarray(values, dtype="<f4")
        size = single.shape[1] if single.ndim == 2 else 0
        limits: dict[str, list[float]] = {}
        if bounds:
            flat = single.reshape(len(single), -1)
            limits = {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        return self._accessor(single, _FLOAT, _KINDS[size], target, limits)

    def _indices(self, corners: NDArray[np.int64]) -> int:
        return self._accessor(corners.astype("<u4").reshape(-1), _WHOLE, "SCALAR", _INDICES, {})

    def _accessor(
        self, values: NDArray[Any], kind: int, shape: str, target: int | None, limits: dict[str, list[float]]
    ) -> int:
        of, start = self._of, len(self._buffer)
        self._buffer += values.tobytes()
        view = of.BufferView(buffer=0, byteOffset=start, byteLength=values.nbytes, target=target)
        self._gltf.bufferViews.append(view)
        self._gltf.accessors.append(
            of.Accessor(
                bufferView=len(self._gltf.bufferViews) - 1, byteOffset=0, componentType=kind,
                count=len(values), type=shape, **limits,
            )
        )  # fmt: skip
        return len(self._gltf.accessors) - 1


def _scalar_last(orientation: Vector) -> Vector:
    return np.roll(orientation, -1, axis=-1)


def _colour(number: int) -> list[float]:
    """Linear red, green, blue of the body's colour in pictures, as glTF wants them (IEC 61966-2-1)."""
    from matplotlib.colors import to_rgb

    from ..style import COLOURS

    shown = np.array(to_rgb(COLOURS[number % len(COLOURS)]))
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    found: list[float] = linear.tolist()
    return found
