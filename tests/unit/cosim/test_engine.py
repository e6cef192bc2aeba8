"""The coupled step in C: the same numbers as in Python, the same sentences, work that grows with the chain."""

from __future__ import annotations

import ctypes
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from components import Layout
from fmus import build_fmu, native_library
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.implicit import engine
from orchestrator.cosim.implicit.coupling import Coupling, Tolerance
from orchestrator.cosim.implicit.elimination import eliminate
from orchestrator.cosim.implicit.engine import Calls, Engine, Limits, Matrices, Shared
from orchestrator.cosim.implicit.interface_jacobian import (
    Probe,
    mobility_of,
    probe_mobility,
    probe_stiffness,
    stiffness_of,
)
from orchestrator.cosim.implicit.sparse_system import SparseSystem
from orchestrator.cosim.master import Settings
from orchestrator.cosim.network import WIDTHS, Meeting, Network, PortPlaces
from orchestrator.cosim.participant import ParticipantError
from orchestrator.results.result import Result
from orchestrator.run.run import as_fmus, run
from orchestrator.scene import find_scene, load_scene
from tests.unit.cosim.faulty import FaultyDamper

pytestmark = pytest.mark.skipif(engine.library() is None, reason="no C compiler built the engine")
needs_native = pytest.mark.skipif(native_library() is None, reason="no C compiler built the native FMUs")

TWO_PANELS = (Path(__file__).parents[2] / "scenes" / "two_panels.toml").read_text(encoding="utf-8")
DAMPER = '[[damper]]\nname = "brake"\nhinge = "root"\ndamping_coefficient = 2.0\n'


def in_python(monkeypatch):
    """Let couplings do without the engine, but FMUs keep their derivatives."""
    monkeypatch.setattr(Engine, "serves", staticmethod(lambda network: False))


def scale(coupling):
    """What a correction of 1 means for every wrench, as the engine has it."""
    place = ctypes.cast(coupling._engine._data.scale, ctypes.POINTER(ctypes.c_double))
    return np.ctypeslib.as_array(place, (coupling.network.size,))


class Wired:
    """Participants without equations, joined as said: connections are tuples of the bodies at their ports."""

    def __init__(self, bodies, connections, order=2):
        self.order, self.width = order, WIDTHS[order]
        wrench = self.width.wrench
        self.rng = np.random.default_rng(3)
        ends = [(body, c, side) for c, found in enumerate(connections) for side, body in enumerate(found)]
        ends.sort(key=lambda end: end[0])
        counts = [sum(body == end[0] for end in ends) for body in range(bodies)]
        starts = np.cumsum([0, *counts]).tolist()
        self.meetings = [
            Meeting(body, link - starts[body], c, side) for link, (body, c, side) in enumerate(ends)
        ]
        self.size = wrench * len(ends)
        self.body_ports = [[str(k) for k in range(count)] for count in counts]
        self.connection_ports = [[str(k) for k in range(len(found))] for found in connections]
        self.rows = [slice(wrench * a, wrench * b) for a, b in pairwise(starts)]
        self.connection_rows = [
            np.concatenate(
                [
                    wrench * link + np.arange(wrench)
                    for side in range(len(found))
                    for link, m in enumerate(self.meetings)
                    if (m.connection, m.connection_port) == (c, side)
                ]
            )
            for c, found in enumerate(connections)
        ]
        self.body_places, self.connection_places = (
            [PortPlaces(len(ports), None, None) for ports in found]
            for found in (self.body_ports, self.connection_ports)
        )
        self.bodies = [self.still(len(ports), "outputs") for ports in self.body_ports]
        self.connections = [self.still(len(ports), "inputs") for ports in self.connection_ports]

    def still(self, ports, motion):
        """A participant that never steps, with ports at rest in random poses."""
        made = FmuParticipant.__new__(FmuParticipant)
        made.inputs, made.outputs = np.zeros(13 * ports), np.zeros(13 * ports)
        made.input_layout = made.output_layout = Layout(())
        made.calls = Calls(input=made.inputs.ctypes.data, output=made.outputs.ctypes.data)
        table = getattr(made, motion).reshape(-1, 13)
        table[:, :7] = self.rng.standard_normal((ports, 7))
        table[:, 3:7] /= np.linalg.norm(table[:, 3:7], axis=1)[:, None]
        return made

    def probes(self):
        """Random matrices of all participants, with the axes of random poses."""
        wrench, coordinates = self.width
        shapes = [(coordinates * len(p), wrench * len(p)) for p in self.body_ports]
        shapes += [(wrench * len(p), coordinates * len(p)) for p in self.connection_ports]
        axes = [np.linalg.qr(self.rng.standard_normal((3, 3)))[0] for _ in shapes]
        return [Probe(self.rng.standard_normal(s), a) for s, a in zip(shapes, axes, strict=True)]

    def turned(self, probes):
        motions = [b.outputs for b in self.bodies] + [c.inputs for c in self.connections]
        found = []
        for probe, motion in zip(probes, motions, strict=True):
            w, x, y, z = motion[3:7]
            axes = np.eye(3) + 2.0 * (
                w * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                + np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            )
            rows, columns = (n // 3 for n in probe.matrix.shape)
            turn = axes @ probe.axes.T
            found.append(np.kron(np.eye(rows), turn) @ probe.matrix @ np.kron(np.eye(columns), turn.T))
        return found

    def dense(self, turned):
        """I - stiffness x mobility, entry by entry from where the ports meet."""
        matrix = np.eye(self.size)
        first, n = len(self.bodies), self.width.coordinates
        for c, rows in enumerate(self.connection_rows):
            for m in self.meetings:
                if m.connection == c:
                    stiffness = turned[first + c][:, n * m.connection_port : n * (m.connection_port + 1)]
                    mobility = turned[m.body][n * m.body_port : n * (m.body_port + 1)]
                    matrix[rows, self.rows[m.body]] -= stiffness @ mobility
        return matrix

    def engine(self):
        limits = Limits(0.1, 10.0, 0.9, 1e-15, 1e-2, 1e12, 100.0, 0, 5, (2, 3, 4))
        rows = np.zeros((4, len(self.bodies) + len(self.connections)), dtype=np.uintp)
        return Engine(self, limits, Shared(*(np.zeros(self.size) for _ in range(4)), np.zeros(1), rows))

    def matrices(self, probes):
        """Those of bodies and those of connections."""
        return Matrices(probes[: len(self.bodies)]), Matrices(probes[len(self.bodies) :])


def chain(length):
    return Wired(length, [(k, k + 1) for k in range(length - 1)])


def links(bodies, connections):
    """A network of so many bodies, given its order."""
    return partial(Wired, bodies, connections)


NETWORKS = {
    "chain": links(6, [(k, k + 1) for k in range(5)]),
    "parallel hinges": links(3, [(0, 1), (1, 0), (1, 2), (1, 2), (0, 1)]),
    "star": links(7, [(0, 1), (0, 2), (3, 0), (1, 4), (2, 5), (3, 6)]),
    "ring": links(5, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)]),
    "mesh": links(5, [(0, 1), (1, 2), (2, 0), (2, 3), (3, 4), (4, 1), (0, 3)]),
    "three ports, one of them twice on a body": links(4, [(0, 1, 2), (2, 3), (3, 3, 1)]),
    "one port": links(2, [(0,), (0, 1)]),
}


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("still", [(), (0,), (0, 1)])
@pytest.mark.parametrize("name", NETWORKS)
def test_linear_system_of_any_network(name, still, order):
    """Independent path: corrections of the engine and of the sparse solver equal those of a dense matrix.

    Bodies that never move leave the elimination, not the solution.
    """
    network = NETWORKS[name](order)
    probes = network.probes()
    for body in still:
        probes[body].matrix[:] = 0.0
    turned = network.turned(probes)
    residual = network.rng.standard_normal(network.size)
    expected = np.linalg.solve(network.dense(turned), residual)
    made = network.engine()
    made.use(*network.matrices(probes))
    made.assemble()
    np.testing.assert_allclose(made.direction(residual), expected, rtol=1e-7, atol=1e-9)
    system = SparseSystem(network)
    system.factorize(turned[: len(network.bodies)], turned[len(network.bodies) :])
    np.testing.assert_allclose(system.solve(residual), expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("order", [2, 4])
def test_matrices_of_poses_alone(order):
    """Independent path: where no connection depends on rates, the engine leaves rates out of it, and is exact."""
    network = NETWORKS["parallel hinges"](order)
    probes = network.probes()
    for probe in probes[len(network.bodies) :]:
        probe.matrix.reshape(len(probe.matrix), -1, network.width.coordinates)[:, :, -6:] = 0.0
    residual = network.rng.standard_normal(network.size)
    made = network.engine()
    made.use(*network.matrices(probes))
    made.assemble()
    expected = np.linalg.solve(network.dense(network.turned(probes)), residual)
    np.testing.assert_allclose(made.direction(residual), expected, rtol=1e-7, atol=1e-9)


def test_singular_matrix_gives_the_residual():
    """Bad input: with a matrix that has no pivot the correction is the residual itself, and finite."""
    network = Wired(2, [(0,), (0, 1)])
    zeros = [Probe(np.zeros_like(p.matrix), np.eye(3)) for p in network.probes()]
    made = network.engine()
    made.use(*network.matrices([Probe(np.full_like(p.matrix, np.nan), p.axes) for p in zeros]))
    made.assemble()
    np.testing.assert_array_equal(made.direction(np.ones(network.size)), np.ones(network.size))
    made.use(*network.matrices(zeros))
    made.assemble()
    np.testing.assert_array_equal(made.direction(np.full(network.size, 2.0)), np.full(network.size, 2.0))


def test_chain_stays_sparse():
    """Cost: entries of the factors and products of the elimination grow with the length of a chain, not faster."""
    short, long = (eliminate(chain(length).meetings, 6) for length in (50, 500))
    assert long.length < 10.5 * short.length
    assert long.targets.size <= 10.5 * short.targets.size
    assert long.parts.size < 10.5 * short.parts.size


def test_tree_of_chains_has_no_fill():
    """Cost: wings on a hub are eliminated from their tips, so that no block appears that was not there."""
    wings = [(5 * wing + k if k else 0, 5 * wing + k + 1) for wing in range(4) for k in range(5)]
    found = eliminate(Wired(21, wings).meetings, 6)
    pairs = sum(len(set(a) & set(b)) > 0 for a in wings for b in wings)
    assert len(found.blocks) == pairs


def wing():
    return assemble(load_scene(find_scene("amos3")), rigid={"all"})


@needs_native
def test_derivatives_equal_differences_of_steps():
    """Independent path: mobility and stiffness that native FMUs return are those of probing the same step."""
    assembly = wing()
    with as_fmus(assembly, "native") as participants:
        network = Network(participants, assembly.links)
        coupling = Coupling(network, Tolerance(1e-6))
        for body in network.bodies:
            body.write()
            body.read()
        network.carry_motion()
        for participant in participants:
            participant.initialize(0.0)
            participant.read()
        coupling.save(0.0)
        coupling.wrenches[:] = np.random.default_rng(1).standard_normal(network.size)
        coupling.sweep(0.0, 0.01)
        for given, probe, side, ports_of in (
            (mobility_of, probe_mobility, network.bodies, network.body_places),
            (stiffness_of, probe_stiffness, network.connections, network.connection_places),
        ):
            for participant, places in zip(side, ports_of, strict=True):
                assert participant.directional_derivatives
                exact = given(participant, places, network.width, 0.0, 0.01).matrix
                probed = probe(participant, places, network.width, 0.0, 0.01).matrix
                scale = np.abs(probed).max() + 1e-9
                np.testing.assert_allclose(exact / scale, probed / scale, atol=1e-4, err_msg=participant.name)


@pytest.mark.parametrize("backend", [pytest.param("native", marks=needs_native), "python"])
def test_engine_equals_python(tmp_path, monkeypatch, backend):
    """Independent path: AMOS-3 by the engine and in Python takes the same steps and sweeps to the same motion."""
    assembly = wing()
    load = partial(as_fmus, backend=backend)
    # later an error estimate comes closer to where steps grow than its noise, from rounding times stiffness
    one = run(assembly, tmp_path / "engine.h5", Settings(), 0.1, load=load)
    in_python(monkeypatch)
    other = run(assembly, tmp_path / "python.h5", Settings(), 0.1, load=load)
    counts = [(o.costs.steps, o.costs.iterations, o.costs.rejected) for o in (one, other)]
    assert counts[0] == counts[1]
    for mine, theirs in zip(one.segments, other.segments, strict=True):
        assert mine == pytest.approx(theirs, rel=1e-12)
    results = [Result.open(path) for path in (one.path, other.path)]
    # both solve a wrench to 1e-6 of the largest and 1 N, and the base adds up those of its four ports
    solved = 2.0 * 4.0 * 1e-6 * (1.0 + largest(results[0], "N"))
    for component in results[0].components:
        for variable in results[0].variables(component):
            mine, theirs = (result.signal(component, variable) for result in results)
            # momenta add up that error over the run
            known = {"N": solved, "N.m": solved, "N.s": 0.1 * solved, "N.m.s": 0.1 * solved}
            atol = known.get(results[0].unit(component, variable), 1e-7)
            np.testing.assert_allclose(mine, theirs, rtol=1e-6, atol=atol, err_msg=f"{component}.{variable}")


def largest(result, unit):
    """Largest magnitude of all signals in a unit."""
    return max(
        np.abs(result.signal(component, variable)).max()
        for component in result.components
        for variable in result.variables(component)
        if result.unit(component, variable) == unit
    )


@needs_native
def test_prediction_and_energies_equal_python(monkeypatch):
    """Independent path: guesses, error work and energies of a step are those of Python for the same wrenches."""
    assembly = wing()
    size = 2e-3
    with as_fmus(assembly, "native") as participants:
        network = Network(participants, assembly.links)
        mine = Coupling(network, Tolerance(1e-6))
        in_python(monkeypatch)
        theirs = Coupling(network, Tolerance(1e-6))
        for body in network.bodies:
            body.write()
            body.read()
        network.carry_motion()
        for participant in network.by_name.values():
            participant.initialize(0.0)
            participant.read()
        mine.save(0.0)
        time, whole = 0.0, []
        for h in (size, size, 0.5 * size, size, size):
            guess = mine.predicted(time, h).copy()
            np.testing.assert_allclose(guess, theirs.predicted(time, h), rtol=1e-11, atol=1e-12)
            assert mine.solve(time, h, guess).converged
            # Python takes the engine's solution and its matrices for its own
            theirs.wrenches[:] = mine.wrenches
            theirs._mobilities, theirs._stiffnesses = mine._mobilities, mine._stiffnesses
            theirs._tolerated = scale(mine) * min(mine._engine.correction, 1.0)
            squares = []
            for coupling in (mine, theirs):
                coupling._refresh(time, h, probe=False)
                squares.append(coupling.error_square(time, h, 2.0))
            assert (squares[0] is None) == (squares[1] is None) == (time < 1.5 * size)
            if squares[0] is not None:
                assert squares[0] == pytest.approx(squares[1], rel=1e-9)
                whole.append(squares[0])
            mine.accept(time, h)
            theirs.accept(time, h)
            time += h
            np.testing.assert_array_equal(mine.accepted, theirs.accepted)
            energies = [coupling.observe(time) for coupling in (mine, theirs)]
            np.testing.assert_array_equal(mine.observations, theirs.observations)
            assert energies[0] == pytest.approx(energies[1], rel=1e-14)
            assert energies[0].kinetic > 0.0
            assert energies[0].dissipated > 0.0
        assert whole[1] > 0.0
        for coupling in (mine, theirs):
            coupling.restart()
            np.testing.assert_array_equal(coupling.predicted(time, size), coupling.accepted)
            assert coupling.error_square(time, size, 2.0) is None


def test_bodies_that_never_move_join_nothing():
    """Count: legs of two bodies on one base are eliminated as if each stood alone, but for what the base takes."""
    legs = [pair for k in range(8) for pair in ((0, 1 + 2 * k), (1 + 2 * k, 2 + 2 * k))]
    one, eight = (
        eliminate(Wired(bodies, legs[:count]).meetings, 6, {0}) for bodies, count in ((3, 2), (17, 16))
    )
    assert eight.length == 8 * one.length
    assert eight.targets.size == 8 * one.targets.size


def test_without_a_library_python_does_it(tmp_path, monkeypatch):
    """Fallback: no engine, no native derivatives, and the run still reaches its end."""
    monkeypatch.setattr(engine, "library", lambda: None)
    outcome = run(wing(), tmp_path / "run.h5", Settings(), 0.02)
    assert outcome.headline.complete


def follow(coupling):
    """Free motion: sweep after sweep without wrenches, each a step."""
    for step in range(20):
        coupling.sweep(0.01 * step, 0.01)
        coupling.save(0.01 * (step + 1))


def failing(folder, fault, monkeypatch, *, native):
    """The sentence of two panels whose brake, an FMU like everything else, fails at 0.1 s."""
    path = folder / "scene.toml"
    path.write_text(TWO_PANELS + DAMPER, encoding="utf-8")
    assembly = assemble(load_scene(path))
    monkeypatch.setenv("FANFOLD_CACHE", str(folder / "cache"))
    part = next(p for p in assembly.parts if p.name == "brake")
    brake = FmuParticipant(
        "brake", build_fmu(FaultyDamper(fault, **part.structure), "brake", folder, part.start, "python")
    )
    with as_fmus(assembly) as participants:
        network = Network([brake if p.name == "brake" else p for p in participants], assembly.links)
        assert Engine.serves(network)
        if not native:
            in_python(monkeypatch)
        coupling = Coupling(network, Tolerance(1e-6))
        for participant in network.by_name.values():
            participant.initialize(0.0)
            participant.read()
        coupling.save(0.0)
        with pytest.raises(ParticipantError) as caught:
            follow(coupling)
        brake.close()
    return str(caught.value)


@pytest.mark.parametrize("fault", ["error", "nan"])
def test_failure_is_told_as_in_python(tmp_path, monkeypatch, fault):
    """Bad input: the engine's sentence is Python's, with the FMU's name, its own words or output, and the time."""
    with monkeypatch.context() as patch:
        sentence = failing(tmp_path, fault, patch, native=True)
    assert sentence.startswith("brake: ")
    assert {"error": "the magnet has come off", "nan": "inboard.torque[2] is nan"}[fault] in sentence
    assert sentence == failing(tmp_path, fault, monkeypatch, native=False)


def test_library_of_another_version_is_refused(monkeypatch):
    """Bad input: structures of another size mean another source; Python then does it."""
    monkeypatch.setattr(engine, "sizeof", lambda structure: 8)
    engine.library.cache_clear()
    try:
        assert engine.library() is None
    finally:
        monkeypatch.undo()
        engine.library.cache_clear()
    assert engine.library() is not None
