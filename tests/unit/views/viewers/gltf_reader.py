"""A binary glTF file read and played by the letter of its standard (Khronos, glTF 2.0, sections 3.7, 3.11 and 4)."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

Vector = NDArray[np.float64]
_KINDS = {5126: "<f4", 5125: "<u4"}
_SIZES = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


@dataclass(frozen=True)
class Glb:
    """The document of a file and its binary chunk."""

    document: dict[str, Any]
    binary: bytes

    @classmethod
    def open(cls, path: Path) -> Glb:
        """Read a file; AssertionError where its container is not as the standard says."""
        data = path.read_bytes()
        magic, version, length = struct.unpack("<4sII", data[:12])
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, kind = struct.unpack("<I4s", data[12:20])
        assert kind == b"JSON"
        assert size % 4 == 0
        rest = data[20 + size :]
        size_of_binary, kind = struct.unpack("<I4s", rest[:8])
        assert kind == b"BIN\0"
        assert len(rest) == 8 + size_of_binary
        document = json.loads(data[20 : 20 + size])
        assert document["buffers"][0]["byteLength"] <= size_of_binary
        return cls(document, rest[8:])

    def accessor(self, number: int) -> Vector:
        """Values (n,) or (n, size) of an accessor, whose bounds, where it tells them, are those of its values."""
        one = self.document["accessors"][number]
        view = self.document["bufferViews"][one["bufferView"]]
        start = view.get("byteOffset", 0) + one.get("byteOffset", 0)
        assert start % 4 == 0
        size = _SIZES[one["type"]]
        values = np.frombuffer(self.binary, _KINDS[one["componentType"]], one["count"] * size, start)
        assert values.nbytes <= view["byteLength"]
        values = values.reshape(-1, size)
        if "min" in one:
            np.testing.assert_array_equal(np.float32(one["min"]), values.min(axis=0))
            np.testing.assert_array_equal(np.float32(one["max"]), values.max(axis=0))
        return (values[:, 0] if size == 1 else values).astype(np.float64)

    def node(self, name: str) -> int:
        """Number of the node of a name."""
        (found,) = [k for k, node in enumerate(self.document["nodes"]) if node.get("name") == name]
        return found

    def played(self, name: str, time: float) -> Vector:
        """Vertices (D, 3) of a node's mesh at a time (s), in the axes of the file (y up), through all nodes above."""
        number = self.node(name)
        node = self.document["nodes"][number]
        mesh = self.document["meshes"][node["mesh"]]
        (primitive, *_) = mesh["primitives"]
        points = self.accessor(primitive["attributes"]["POSITION"])
        weights = self._property(number, "weights", time, mesh.get("weights", []))
        for weight, target in zip(weights, primitive.get("targets", []), strict=True):
            points = points + weight * self.accessor(target["POSITION"])
        while True:
            turn = Rotation.from_quat(self._property(number, "rotation", time, [0.0, 0.0, 0.0, 1.0]))
            points = turn.apply(points) + self._property(number, "translation", time, [0.0, 0.0, 0.0])
            above = [k for k, one in enumerate(self.document["nodes"]) if number in one.get("children", [])]
            if not above:
                return points
            (number,) = above

    def _property(self, number: int, path: str, time: float, default: list[float]) -> Vector:
        found = np.array(self.document["nodes"][number].get(path, default))
        for animation in self.document.get("animations", []):
            for channel in animation["channels"]:
                if channel["target"] == {"node": number, "path": path}:
                    found = self._sampled(animation["samplers"][channel["sampler"]], path, time)
        return found

    def _sampled(self, sampler: dict[str, Any], path: str, time: float) -> Vector:
        assert sampler["interpolation"] == "LINEAR"
        clock = self.accessor(sampler["input"])
        assert np.all(np.diff(clock) > 0.0)
        values = self.accessor(sampler["output"]).reshape(clock.size, -1)
        inside = float(np.clip(time, clock[0], clock[-1]))
        if path == "rotation":
            np.testing.assert_allclose(np.linalg.norm(values, axis=1), 1.0, atol=1e-6)
            return np.asarray(Slerp(clock, Rotation.from_quat(values))(inside).as_quat())
        return np.array([np.interp(inside, clock, column) for column in values.T])
