"""Both solvers of a coupled step: the same numbers, the same sentences, work that grows with the chain."""

from __future__ import annotations

import ctypes
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from orchestrator.cosim.implicit import native_solver, solvers
from orchestrator.cosim.implicit.differences import jacobian_by_differences
from orchestrator.cosim.implicit.elimination import eliminate
from orchestrator.cosim.implicit.interface_jacobian import JacobianBlock, Matrices
from orchestrator.cosim.implicit.native_solver import NativeSolver
from orchestrator.cosim.implicit.solvers import solver_for
from orchestrator.cosim.implicit.sparse_system import SparseSystem
from orchestrator.cosim.native import library as coupling_library
from orchestrator.cosim.native.library import Calls, library

from components import Layout
from fmus import build_fmu, native_library
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim import fmu
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.network import Network, PortConnection
from orchestrator.cosim.participant import ParticipantError
from orchestrator.cosim.ports import WIDTHS, PortPlaces
from orchestrator.cosim.settings import Settings
from orchestrator.results.result import Result
from orchestrator.run.run import as_fmus, run
from orchestrator.scene import find_scene, load_scene
from orchestrator.scene.builder import Scene
from tests.references.coupled import Tolerance
from tests.unit.cosim.faulty import FaultyDamper
from tests.unit.cosim.networks import start

pytestmark = pytest.mark.skipif(library() is None, reason="no C compiler built the native solver")
needs_native = pytest.mark.skipif(native_library() is None, reason="no C compiler built the native FMUs")

PANELS = Path(__file__).parents[2] / "scenes" / "two_panels.toml"
TWO_PANELS = PANELS.read_text(encoding="utf-8")
DAMPER = '[[damper]]\nname = "brake"\nhinge = "root"\ndamping_coefficient = 2.0\n'


def in_python(monkeypatch):
    """Solve steps in Python, but let FMUs keep their derivatives."""
    monkeypatch.setattr(solvers, "library", lambda: None)


def scale(solver):
    """What a correction of 1 means for every wrench, as the native solver has it."""
    place = ctypes.cast(solver._data.scale, ctypes.POINTER(ctypes.c_double))
    return np.ctypeslib.as_array(place, (solver.network.size,))


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
            PortConnection(body, link - starts[body], c, side) for link, (body, c, side) in enumerate(ends)
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
            [PortPlaces(side, len(ports)) for ports in found]
            for side, found in (("body", self.body_ports), ("connection", self.connection_ports))
        )
        self.bodies = [self.still(len(ports), "outputs") for ports in self.body_ports]
        self.connections = [self.still(len(ports), "inputs") for ports in self.connection_ports]
        self.participants = [*self.bodies, *self.connections]

    def still(self, ports, motion):
        """A participant that never steps, with ports at rest in random poses."""
        made = FmuParticipant.__new__(FmuParticipant)
        made.inputs, made.outputs = np.zeros(13 * ports), np.zeros(13 * ports)
        made.input_layout = made.output_layout = made.observation_layout = Layout(())
        made.calls = Calls(input=made.inputs.ctypes.data, output=made.outputs.ctypes.data)
        table = getattr(made, motion).reshape(-1, 13)
        table[:, :7] = self.rng.standard_normal((ports, 7))
        table[:, 3:7] /= np.linalg.norm(table[:, 3:7], axis=1)[:, None]
        return made

    def blocks(self):
        """Random matrices of all participants, with the axes of random poses."""
        wrench, coordinates = self.width
        shapes = [(coordinates * len(p), wrench * len(p)) for p in self.body_ports]
        shapes += [(wrench * len(p), coordinates * len(p)) for p in self.connection_ports]
        axes = [np.linalg.qr(self.rng.standard_normal((3, 3)))[0] for _ in shapes]
        motions = [b.outputs for b in self.bodies] + [c.inputs for c in self.connections]
        return [
            JacobianBlock(self.rng.standard_normal(s), a, m)
            for s, a, m in zip(shapes, axes, motions, strict=True)
        ]

    def turned(self, blocks):
        found = []
        for block in blocks:
            w, x, y, z = block.motion[3:7]
            axes = np.eye(3) + 2.0 * (
                w * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                + np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            )
            rows, columns = (n // 3 for n in block.matrix.shape)
            turn = axes @ block.axes.T
            found.append(np.kron(np.eye(rows), turn) @ block.matrix @ np.kron(np.eye(columns), turn.T))
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

    def natively(self, blocks):
        """A native solver with these matrices factorised."""
        made = NativeSolver(self, Tolerance(1e-6), self.participants, library())
        self.factorize(made, blocks)
        return made

    def factorize(self, solver, blocks):
        """Have a solver take them, those of bodies and those of connections."""
        bodies = len(self.bodies)
        solver._factorize(Matrices(blocks[:bodies]), Matrices(blocks[bodies:]), 1.0)


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
    """Independent path: corrections of both solvers equal those of a dense matrix.

    Bodies that never move leave the elimination, not the solution.
    """
    network = NETWORKS[name](order)
    blocks = network.blocks()
    for body in still:
        blocks[body].matrix[:] = 0.0
    turned = network.turned(blocks)
    residual = network.rng.standard_normal(network.size)
    expected = np.linalg.solve(network.dense(turned), residual)
    made = network.natively(blocks)
    np.testing.assert_allclose(made._direction(residual), expected, rtol=1e-7, atol=1e-9)
    system = SparseSystem(network)
    of_blocks = [block.turned() for block in blocks]
    system.factorize(of_blocks[: len(network.bodies)], of_blocks[len(network.bodies) :])
    np.testing.assert_allclose(system.solve(residual), expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("order", [2, 4])
def test_matrices_of_poses_alone(order):
    """Independent path: where no connection depends on rates, the native solver leaves rates out, and is exact."""
    network = NETWORKS["parallel hinges"](order)
    blocks = network.blocks()
    for block in blocks[len(network.bodies) :]:
        block.matrix.reshape(len(block.matrix), -1, network.width.coordinates)[:, :, -6:] = 0.0
    residual = network.rng.standard_normal(network.size)
    expected = np.linalg.solve(network.dense(network.turned(blocks)), residual)
    np.testing.assert_allclose(network.natively(blocks)._direction(residual), expected, rtol=1e-7, atol=1e-9)


def test_singular_matrix_gives_the_residual():
    """Bad input: with a matrix that has no pivot the correction is the residual itself, and finite."""
    network = Wired(2, [(0,), (0, 1)])
    blocks = network.blocks()
    for block in blocks:
        block.matrix[:] = np.nan
    made = network.natively(blocks)
    np.testing.assert_array_equal(made._direction(np.ones(network.size)), np.ones(network.size))
    for block in blocks:
        block.matrix[:] = 0.0
    network.factorize(made, blocks)
    np.testing.assert_array_equal(made._direction(np.full(network.size, 2.0)), np.full(network.size, 2.0))


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
def test_bodies_are_differentiated_seldom_and_laws_when_they_may_have_changed():
    """By count: after an event those of connections alone, after a failed step those of bodies that vary too.

    Steps that differ little, by which an event is searched for, share those of bodies.
    """
    assembly = assemble(load_scene(find_scene("amos3")), rigid={"yoke", "panel1"})
    with as_fmus(assembly, "native") as participants:
        network = Network(participants, assembly.links)
        solver = solver_for(network, Tolerance(1e-6))
        start(network)
        solver.save(0.0)
        solver.sweep(0.0, 1e-3)
        key = 1e-3

        def evaluated(before):
            now = [block for kind in solver.jacobian.matrices(key, 0.0) for block in kind.blocks]
            names = [participant.name for participant in network.participants]
            return now, {name for name, a, b in zip(names, before or now, now, strict=True) if a is not b}

        connections = {connection.name for connection in network.connections}
        blocks, _ = evaluated(None)
        solver.forget()
        blocks, anew = evaluated(blocks)
        assert anew == connections
        solver.jacobian.outdate(key, bodies=True)
        blocks, anew = evaluated(blocks)
        assert anew == connections | {"panel2"}
        blocks, anew = evaluated(blocks)
        assert not anew
        for size, shared in ((1.005e-3, True), (1.02e-3, False)):
            alike, _ = solver.jacobian.matrices(size, 0.0)
            assert all((a is b) == shared for a, b in zip(alike.blocks, blocks, strict=False))
        solver.forget_all()
        assert evaluated(blocks)[1] == connections | {body.name for body in network.bodies}


@needs_native
def test_derivatives_equal_differences_of_steps():
    """Independent path: the interface Jacobians that native FMUs return are those of differences of the same step."""
    assembly = wing()
    with as_fmus(assembly, "native") as participants:
        network = Network(participants, assembly.links)
        solver = solver_for(network, Tolerance(1e-6))
        start(network)
        solver.save(0.0)
        solver.wrenches[:] = np.random.default_rng(1).standard_normal(network.size)
        solver.sweep(0.0, 0.01)
        places = [*network.body_places, *network.connection_places]
        for participant, place in zip(network.participants, places, strict=True):
            exact = participant.interface_jacobian(place, network.width)
            expected = jacobian_by_differences(participant, place, network.width, 0.0, 0.01)
            size = np.abs(expected).max() + 1e-9
            np.testing.assert_allclose(exact / size, expected / size, atol=1e-4, err_msg=participant.name)


@pytest.mark.parametrize(
    ("backend", "end"), [pytest.param("native", 0.1, marks=needs_native), ("python", 0.01)]
)
def test_native_solver_equals_python(tmp_path, monkeypatch, backend, end):
    """Independent path: solved in C and in Python, wings take the same steps, and sweeps, to the same motion.

    Where friction breaks away within an iteration depends on the last bit: sweeps agree within one per cent.

    AMOS-3, and for PythonFMUs, whose derivatives are differences of many steps, the two panels.
    """
    assembly = wing() if backend == "native" else assemble(load_scene(PANELS))
    load = partial(as_fmus, backend=backend)
    # later an error estimate comes closer to where steps grow than its noise, from rounding times stiffness
    one = run(assembly, tmp_path / "native.h5", Settings(), end, load=load)
    in_python(monkeypatch)
    other = run(assembly, tmp_path / "python.h5", Settings(), end, load=load)
    counts = [(o.costs.steps, o.costs.rejected) for o in (one, other)]
    assert counts[0] == counts[1]
    assert one.costs.iterations == pytest.approx(other.costs.iterations, rel=0.01)
    for mine, theirs in zip(one.segments, other.segments, strict=True):
        assert mine == pytest.approx(theirs, rel=1e-12)
    results = [Result.open(path) for path in (one.path, other.path)]
    # both solve a wrench to 1e-6 of the largest and 1 N, and the base adds up those of its four ports
    solved = 2.0 * 4.0 * 1e-6 * (1.0 + largest(results[0], "N"))
    for component in results[0].components:
        for variable in results[0].variables(component):
            if variable == "iterations":
                continue
            mine, theirs = (result.signal(component, variable) for result in results)
            # momenta add up that error over the run
            known = {"N": solved, "N.m": solved, "N.s": end * solved, "N.m.s": end * solved}
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
        mine = solver_for(network, Tolerance(1e-6))
        in_python(monkeypatch)
        theirs = solver_for(network, Tolerance(1e-6))
        assert type(mine) is not type(theirs)
        start(network)
        mine.save(0.0)
        time, whole = 0.0, []
        for h in (size, size, 0.5 * size, size, size):
            guess = mine.predicted(time, h).copy()
            np.testing.assert_allclose(guess, theirs.predicted(time, h), rtol=1e-11, atol=1e-12)
            assert mine.solve(time, h, guess).converged
            # Python takes the native solution and its matrices for its own
            theirs.wrenches[:] = mine.wrenches
            theirs.jacobian = mine.jacobian
            theirs._tolerated = scale(mine) * min(mine._data.correction, 1.0)
            squares = []
            for solver in (mine, theirs):
                solver._refresh(time, h, evaluate=False)
                squares.append(solver.error_square(time, h, 2.0))
            assert (squares[0] is None) == (squares[1] is None) == (time < 1.5 * size)
            if squares[0] is not None:
                assert squares[0] == pytest.approx(squares[1], rel=1e-9)
                whole.append(squares[0])
            mine.accept(time, h)
            theirs.accept(time, h)
            time += h
            np.testing.assert_array_equal(mine.accepted, theirs.accepted)
            energies = [solver.observe(time) for solver in (mine, theirs)]
            np.testing.assert_array_equal(mine.observations, theirs.observations)
            assert energies[0] == pytest.approx(energies[1], rel=1e-14)
            assert energies[0].kinetic > 0.0
            assert energies[0].dissipated > 0.0
        assert whole[1] > 0.0
        for solver in (mine, theirs):
            solver.restart()
            np.testing.assert_array_equal(solver.predicted(time, size), solver.accepted)
            assert solver.error_square(time, size, 2.0) is None


def test_bodies_that_never_move_join_nothing():
    """Count: legs of two bodies on one base are eliminated as if each stood alone, but for what the base takes."""
    legs = [pair for k in range(8) for pair in ((0, 1 + 2 * k), (1 + 2 * k, 2 + 2 * k))]
    one, eight = (
        eliminate(Wired(bodies, legs[:count]).meetings, 6, {0}) for bodies, count in ((3, 2), (17, 16))
    )
    assert eight.length == 8 * one.length
    assert eight.targets.size == 8 * one.targets.size


def test_without_a_library_python_does_it(tmp_path, monkeypatch):
    """Fallback: no native solver, no native derivatives, and the run still reaches its end."""
    in_python(monkeypatch)
    monkeypatch.setattr(fmu, "library", lambda: None)
    outcome = run(wing(), tmp_path / "run.h5", Settings(), 0.02)
    assert outcome.headline.complete


def follow(solver):
    """Free motion: sweep after sweep without wrenches, each a step."""
    for step in range(20):
        solver.sweep(0.01 * step, 0.01)
        solver.save(0.01 * (step + 1))


def failing(folder, fault, monkeypatch, *, native):
    """The sentence of two panels whose brake, an FMU like everything else, fails."""
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
        if not native:
            in_python(monkeypatch)
        solver = solver_for(network, Tolerance(1e-6))
        assert isinstance(solver, NativeSolver) == native
        for participant in network.by_name.values():
            participant.initialize(0.0)
            participant.read()
        solver.save(0.0)
        with pytest.raises(ParticipantError) as caught:
            follow(solver)
        brake.close()
    return str(caught.value)


@pytest.mark.parametrize("fault", ["error", "nan"])
def test_failure_is_told_as_in_python(tmp_path, monkeypatch, fault):
    """Bad input: the native solver's sentence is Python's, with the FMU's name, its words or output, and the time."""
    with monkeypatch.context() as patch:
        sentence = failing(tmp_path, fault, patch, native=True)
    assert sentence.startswith("brake: ")
    assert {"error": "magnet", "nan": "inboard.torque[2] is nan"}[fault] in sentence
    assert sentence == failing(tmp_path, fault, monkeypatch, native=False)


def test_library_of_another_version_is_refused(monkeypatch):
    """Bad input: structures of another size mean another source; Python then does it."""
    monkeypatch.setattr(coupling_library, "sizeof", lambda structure: 8)
    library.cache_clear()
    try:
        assert library() is None
    finally:
        monkeypatch.undo()
        library.cache_clear()
    assert library() is not None


END = 0.0044
"""s, in which ARABSAT is let go and the first of its hinges break away."""


def sticking():
    """ARABSAT on its rig, with friction that sticks by an elastic deflection."""
    found = Scene.load("arabsat", "phase2")
    stiffness = {f"hinge_line.{name}.presliding.stiffness": "4e4 N.m/rad" for name in found.hinge_lines}
    return assemble(found.with_settings(stiffness).check_one_run())


@needs_native
@pytest.mark.thorough
def test_corrections_that_take_each_other_back_are_halved(monkeypatch):
    """Newton's method goes to and fro between friction that sticks and that slides, and steps are given up for it.

    With halving the solver in Python, which defines it, takes the same steps, and gives up as few: 113 and 1, against
    150 and 11 without. Where friction lets go within an iteration depends on the last bit, so iterations are not
    compared.
    """
    scene = sticking()
    halved = run(scene, None, Settings(), END).costs
    with monkeypatch.context() as patch:
        patch.setattr(native_solver._LIMITS, "halvings", 0)
        whole = run(scene, None, Settings(), END).costs
    assert halved.rejected < 0.5 * whole.rejected
    in_python(monkeypatch)
    python = run(scene, None, Settings(), END).costs
    assert python.steps == pytest.approx(halved.steps, rel=0.05)
    assert 0 < python.rejected < 0.5 * whole.rejected
