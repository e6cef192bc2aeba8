"""The solver of a coupled step: its linear system on any network, its derivatives, its cost for long chains."""

from __future__ import annotations

from collections import Counter
from contextlib import nullcontext
from ctypes import CFUNCTYPE, c_int, c_size_t, c_void_p, cast
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from components import Component
from components.contract.component import Port
from orchestrator.assembly import Link
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.coupling import Coupling
from orchestrator.cosim.elimination import eliminate
from orchestrator.cosim.energy_balance import energy_rows
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import InProcess, ParticipantError, in_process
from orchestrator.cosim.settings import Settings
from orchestrator.cosim.tables import coupling_tables
from orchestrator.run.run import as_fmus, run
from orchestrator.scene import find_scene, load_scene
from orchestrator.scene.builder import Scene
from tests.references.coupled import mastered
from tests.references.coupled_step import CoupledStep, Step
from tests.references.coupling_parts import call, matrix_of
from tests.references.native_fmus import needs_native
from tests.references.record import Record

PANELS = Path(__file__).parents[2] / "scenes" / "two_panels.toml"


class Ported(Component, registered=False):
    """No equations, and ports on one side."""

    kind = "ported"

    def __init__(self, side, ports, *, still=False, rigid=False):
        self.prescribed_motion, self.constant_mobility = still, rigid
        self._declare({}, [Port(f"p{k}", side) for k in range(ports)])

    def prepare(self, p):
        return None

    def initial(self, c, u):
        return np.zeros(0)

    def step(self, c, x, u, h):
        return x

    def outputs(self, c, x, u):
        return np.zeros(self.output_layout.size)

    def observe(self, c, x, u):
        return np.zeros(0)

    @classmethod
    def example(cls):
        return cls("body", 1)


def wired(bodies, connections, order=2, still=(), rigid=()):
    """Participants without equations, joined as said: connections are tuples of the bodies at their ports."""
    counts: Counter[int] = Counter()
    links = []
    for number, ends in enumerate(connections):
        for side, body in enumerate(ends):
            links.append(Link((f"body{body}", f"p{counts[body]}"), (f"connection{number}", f"p{side}")))
            counts[body] += 1
    made = {f"body{b}": Ported("body", counts[b], still=b in still, rigid=b in rigid) for b in range(bodies)}
    made |= {f"connection{c}": Ported("connection", len(ends)) for c, ends in enumerate(connections)}
    return Network([InProcess(name, component) for name, component in made.items()], links, order)


def axes_of(motion):
    """Rotation matrix of a port's motion."""
    w, x, y, z = motion[3:7]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2.0 * (w * cross + cross @ cross)


class LinearSystem:
    """Random matrices of all participants of a network, each with axes of its own, and the correction by them."""

    def __init__(self, network):
        self.network = network
        self._coupling = Coupling(network, coupling_tables(network, [], [], Settings()), Record(network))
        self._rng = rng = np.random.default_rng(3)
        for body, places in zip(network.bodies, network.body_places, strict=True):
            table = body.outputs[: 13 * places.ports].reshape(-1, 13)
            table[:, :7] = rng.standard_normal((places.ports, 7))
            table[:, 3:7] /= np.linalg.norm(table[:, 3:7], axis=1)[:, None]
        network.carry_motion()
        wrench, coordinates = network.width
        shapes = [(coordinates * p.ports, wrench * p.ports) for p in network.body_places]
        shapes += [(wrench * p.ports, coordinates * p.ports) for p in network.connection_places]
        self.matrices = [rng.standard_normal(shape) for shape in shapes]
        for number, body in enumerate(network.bodies):
            rows, columns = shapes[number]
            if body.constant_mobility:  # its ports move as one
                self.matrices[number] = rng.standard_normal((rows, wrench)) @ rng.standard_normal(
                    (wrench, columns)
                )
        self._axes = [np.linalg.qr(rng.standard_normal((3, 3)))[0] for _ in shapes]

    def residual(self):
        return self._rng.standard_normal(self.network.size)

    def correction(self, residual):
        blocks = zip(self.matrices, self._axes, strict=True)
        numbers = np.concatenate([part.ravel() for block in blocks for part in block])
        result = np.zeros(self.network.size)
        call("correct", self._coupling, numbers, residual, result)
        return result

    def expected(self, residual):
        """By a dense matrix I - stiffness x mobility, entry by entry from where the ports meet."""
        network = self.network
        motions = [body.outputs for body in network.bodies] + [c.inputs for c in network.connections]
        turned = []
        for matrix, axes, motion in zip(self.matrices, self._axes, motions, strict=True):
            rows, columns = (n // 3 for n in matrix.shape)
            turn = axes_of(motion) @ axes.T
            turned.append(np.kron(np.eye(rows), turn) @ matrix @ np.kron(np.eye(columns), turn.T))
        dense, first, n = np.eye(network.size), len(network.bodies), network.width.coordinates
        for m in network.meetings:
            stiffness = turned[first + m.connection][:, n * m.connection_port : n * (m.connection_port + 1)]
            mobility = turned[m.body][n * m.body_port : n * (m.body_port + 1)]
            dense[network.connection_rows[m.connection], network.rows[m.body]] -= stiffness @ mobility
        return np.linalg.solve(dense, residual)


def assert_alike(system):
    """The correction of a residual is that of the dense matrix."""
    residual = system.residual()
    expected = system.expected(residual)
    np.testing.assert_allclose(
        system.correction(residual), expected, rtol=0.0, atol=1e-7 * np.abs(expected).max()
    )


def chain(length):
    return wired(length, [(k, k + 1) for k in range(length - 1)])


NETWORKS = {
    "chain": (6, [(k, k + 1) for k in range(5)]),
    "parallel hinges": (3, [(0, 1), (1, 0), (1, 2), (1, 2), (0, 1)]),
    "star": (7, [(0, 1), (0, 2), (3, 0), (1, 4), (2, 5), (3, 6)]),
    "ring": (5, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)]),
    "mesh": (5, [(0, 1), (1, 2), (2, 0), (2, 3), (3, 4), (4, 1), (0, 3)]),
    "three ports, one of them twice on a body": (4, [(0, 1, 2), (2, 3), (3, 3, 1)]),
    "one port": (2, [(0,), (0, 1)]),
}


@needs_native
@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize(
    ("still", "rigid"), [((), ()), ((0,), ()), ((0, 1), ()), ((), (0,)), ((0,), (1,)), ((), range(7))]
)
@pytest.mark.parametrize("name", NETWORKS)
def test_linear_system_of_any_network(name, still, rigid, order):
    """Independent path: the correction is that of a dense matrix.

    Bodies that never move leave the elimination, and rigid ones all but one wrench, not the solution.
    """
    system = LinearSystem(wired(*NETWORKS[name], order, still, rigid))
    for body in still:
        system.matrices[body][:] = 0.0
    assert_alike(system)


@needs_native
@pytest.mark.parametrize("order", [2, 4])
def test_matrices_of_poses_alone(order):
    """Independent path: where no connection depends on rates, the solver leaves rates out, and is exact."""
    system = LinearSystem(wired(*NETWORKS["parallel hinges"], order))
    for matrix in system.matrices[len(system.network.bodies) :]:
        matrix.reshape(len(matrix), -1, system.network.width.coordinates)[:, :, -6:] = 0.0
    assert_alike(system)


@needs_native
def test_singular_matrix_gives_the_residual():
    """Bad input: with a matrix that has no pivot the correction is the residual itself; others are solved then."""
    system = LinearSystem(wired(*NETWORKS["one port"]))
    for number, value in ((np.nan, 1.0), (0.0, 2.0)):
        for matrix in system.matrices:
            matrix[:] = number
        residual = np.full(system.network.size, value)
        np.testing.assert_array_equal(system.correction(residual), residual)


def test_chain_stays_sparse():
    """Cost: entries of the factors and products of the elimination grow with the length of a chain, not faster."""
    short, long = (eliminate(chain(length).meetings, 6) for length in (50, 500))
    assert long.length < 10.5 * short.length
    assert long.targets.size <= 10.5 * short.targets.size
    assert long.parts.size < 10.5 * short.parts.size


def test_tree_of_chains_has_no_fill():
    """Cost: wings on a hub are eliminated from their tips, so that no block appears that was not there."""
    wings = [(5 * wing + k if k else 0, 5 * wing + k + 1) for wing in range(4) for k in range(5)]
    found = eliminate(wired(21, wings).meetings, 6)
    pairs = sum(len(set(a) & set(b)) > 0 for a in wings for b in wings)
    assert len(found.blocks) == pairs


def test_bodies_that_never_move_join_nothing():
    """Count: legs of two bodies on one base are eliminated as if each stood alone, but for what the base takes."""
    legs = [pair for k in range(8) for pair in ((0, 1 + 2 * k), (1 + 2 * k, 2 + 2 * k))]
    one, eight = (
        eliminate(wired(bodies, legs[:count]).meetings, 6, {0}) for bodies, count in ((3, 2), (17, 16))
    )
    assert eight.length == 8 * one.length
    assert eight.targets.size == 8 * one.targets.size


def wing():
    return assemble(load_scene(find_scene("amos3")), rigid={"all"})


@needs_native
def test_damaged_tables_are_refused():
    """Bad input: FMUs of scenes carry them. A number that is none, negative or beyond all, or one that is missing."""
    assembly = wing()
    network = Network(in_process(assembly.parts), assembly.links, 4)
    tables = coupling_tables(network, assembly.hinge_lines, [], Settings())
    sound = {name: np.asarray(values, dtype=float).ravel() for name, values in tables.items()}
    numbers = {
        "scene",
        "by_tolerance",
        "constant_mobility",
        "matrix_length",
        "latch_distance",
        "latch_command",
        "unlatch_command",
    }
    for name, values in sound.items():
        if name in numbers or not values.size:
            continue
        for wrong in (np.nan, -1.0, 1e7):
            damaged = {**sound, name: np.append(wrong, values[1:])}
            with pytest.raises(ParticipantError):
                Coupling(network, damaged, Record(network))
        del damaged[name]
        with pytest.raises(ParticipantError):
            Coupling(network, damaged, Record(network))
    Coupling(network, sound, Record(network))


_DERIVATIVE = CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_void_p)


def watched(participant, called):
    """Have an FMU note its name where it is asked for derivatives; what must live as long."""
    given = _DERIVATIVE(participant.record.derivative)

    def noted(*arguments):
        called.add(participant.name)
        return given(*arguments)

    function = _DERIVATIVE(noted)
    participant.record.derivative = cast(function, c_void_p)
    return function


@needs_native
def test_bodies_are_differentiated_seldom_and_laws_when_they_may_have_changed():
    """By count: after an event those of connections alone, after a failed step those of bodies that vary too.

    Steps that differ little, by which an event is searched for, share those of bodies; all share those of rigid ones.
    """
    assembly = assemble(load_scene(find_scene("amos3")), rigid={"yoke", "panel1"})
    with as_fmus(assembly, "native") as participants:
        called: set[str] = set()
        functions = [watched(participant, called) for participant in participants]
        network = Network(participants, assembly.links)
        master = mastered(network, Settings()).master
        master.initialize(preload=False)
        coupling = master.coupling
        coupling.forget(bodies=True)

        def evaluated(h=1e-3, *, outdate=False):
            called.clear()
            assert call("use", coupling, h, outdate)
            return called.copy()

        bodies, connections = ({p.name for p in found} for found in (network.bodies, network.connections))
        assert evaluated() == bodies | connections
        coupling.forget()
        assert evaluated() == connections
        assert evaluated(outdate=True) == connections | {"panel2"}
        assert evaluated() == set()
        assert evaluated(1.005e-3) == connections
        assert evaluated(1.02e-3) == connections | {"panel2"}
        coupling.forget(bodies=True)
        assert evaluated() == bodies | connections
        assert len(functions) == len(participants)


@needs_native
@pytest.mark.parametrize("order", [2, 4])
def test_derivatives_equal_differences_of_steps(order):
    """Independent path: what native FMUs return against differences of the same step, of them and of the components."""
    assembly, h = wing(), 0.01
    found = []
    for load, kinds in ((partial(as_fmus, backend="native"), (False, True)), (components_of, (True,))):
        with load(assembly) as participants:
            network = Network(participants, assembly.links, order)
            master = mastered(network, Settings(order=order), assembly.hinge_lines).master
            master.initialize(preload=False)
            master.coupling.accepted[:] = np.random.default_rng(1).standard_normal(network.size)
            numbers = range(len(network.participants))
            found += [
                [matrix_of(master.coupling, number, h, differences=kind) for number in numbers]
                for kind in kinds
            ]
    names = [p.name for p in network.participants]
    for name, exact, of_fmu, of_component in zip(names, *found, strict=True):
        size = np.abs(exact).max() + 1e-9
        # rates of 1e-3 rad/s, by which differences are taken, turn with each other
        np.testing.assert_allclose(of_fmu, exact, rtol=0.0, atol=1e-4 * size, err_msg=name)
        np.testing.assert_allclose(of_component, of_fmu, rtol=0.0, atol=1e-6 * size, err_msg=name)


def components_of(assembly):
    """A loader of parts in process."""
    return nullcontext(in_process(assembly.parts))


@needs_native
def test_errors_and_energies_of_steps_equal_the_reference():
    """Independent path: error work and energies of steps of two sizes; the first two have no error."""
    assembly, size = wing(), 2e-3
    with as_fmus(assembly, "native") as participants:
        network = Network(participants, assembly.links)
        master = mastered(network, Settings(order=2), assembly.hinge_lines).master
        master.initialize(preload=False)
        coupling, reference = master.coupling, CoupledStep(network)
        rows = np.array(energy_rows(network.participants))
        for number, h in enumerate((size, size, 0.5 * size, size, size)):
            assert call("solve_one", coupling, h)
            square = call("square_of_error", coupling, h, 2.0)
            assert np.isnan(square) == (number < 2)
            reference.time, reference.wrenches = coupling.time, coupling.wrenches.copy()
            if number >= 2:
                assert square == pytest.approx(reference.error_square(h, 2.0), rel=1e-4)
            reference.made.append(Step(coupling.time + h, h, coupling.wrenches.copy(), {}, {}))
            assert call("accept_one", coupling, h)
            np.testing.assert_array_equal(coupling.accepted, coupling.wrenches)
            observed = np.append(np.concatenate([p.observe() for p in network.participants]), 0.0)
            np.testing.assert_array_equal(coupling.observations, observed[:-1])
            assert coupling.energies == pytest.approx(observed[rows].sum(1), rel=1e-14)
        assert min(coupling.energies.kinetic, coupling.energies.dissipated) > 0.0
        coupling.renew()
        np.testing.assert_array_equal(coupling.predicted(size), coupling.accepted)
        assert np.isnan(call("square_of_error", coupling, size, 2.0))


@needs_native
def test_fmus_in_python_make_the_same_steps_as_native_ones():
    """Independent path: derivatives by differences of many steps lead to the same motion of two panels."""
    assembly, end = assemble(load_scene(PANELS)), 0.01
    one, other = (
        run(assembly, None, Settings(), end, load=partial(as_fmus, backend=backend))
        for backend in ("native", "python")
    )
    counts = [(o.costs.steps, o.costs.rejected) for o in (one, other)]
    assert counts[0] == counts[1]
    assert one.costs.iterations == pytest.approx(other.costs.iterations, rel=0.01)
    # both solve a wrench to 1e-6 of the largest and 1 N, and the base adds up those of its four ports
    solved = 2.0 * 4.0 * 1e-6 * (1.0 + largest(one.result, "N"))
    for component in one.result.components:
        for variable in one.result.variables(component):
            if variable == "iterations":
                continue
            mine, theirs = (found.result.signal(component, variable) for found in (one, other))
            # momenta add up that error over the run
            known = {"N": solved, "N.m": solved, "N.s": end * solved, "N.m.s": end * solved}
            atol = known.get(one.result.unit(component, variable), 1e-7)
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
def test_corrections_that_take_each_other_back_are_halved():
    """Newton's method goes to and fro between friction that sticks and that slides, and steps are given up for it.

    ARABSAT on its rig is let go with friction that sticks by an elastic deflection, and the first of its hinges break
    away: 113 steps and 1 rejected, against 150 and 11 without halving.
    """
    found = Scene.load("arabsat", "phase2")
    stiffness = {f"hinge_line.{name}.presliding.stiffness": "4e4 N.m/rad" for name in found.hinge_lines}
    costs = run(assemble(found.with_settings(stiffness).check_one_run()), None, Settings(), 0.0044).costs
    assert costs.steps == pytest.approx(113, rel=0.05)
    assert costs.rejected < 5
