"""What masters and views know components by, over the registry: a kind that plays a role wrongly fails here."""

import numpy as np
import pytest

from components import REGISTRY, Instance
from components.contract import roles
from components.contract.connection import Connection
from components.contract.quantity import Quantity
from tests.conformance.programs.driver import Reference
from tests.references.relative_motion import port_motion, works

EXAMPLES = {kind: component.example() for kind, component in REGISTRY.items()}
CONNECTIONS = [kind for kind, component in EXAMPLES.items() if isinstance(component, Connection)]
NAMED = {q.name: q for q in vars(roles).values() if isinstance(q, Quantity)}
ENERGIES = (
    roles.POTENTIAL_ENERGY, roles.DISSIPATED_ENERGY, roles.NUMERICAL_DISSIPATION, roles.SUPPLIED_ENERGY,
)  # fmt: skip
SMALL = 1e-3
"""m and rad: work of a torque by the rotation vector errs by a share of its square."""


def having(quantity):
    return [
        kind for kind in CONNECTIONS
        if any(quantity.name in layout for layout in EXAMPLES[kind].layouts)
    ]  # fmt: skip


def running(kind, seed):
    """An instance of a kind with random parameters, ports half a metre apart, and what draws the next motion."""
    rng = np.random.default_rng(seed)
    found = Instance(REGISTRY[kind].example())
    found.set_parameters(Reference(found.component).random_parameters(rng))
    home = [np.array((0.5 * k, 0.1, 0.0)) for k in range(len(found.component.ports))]

    def move():
        for k, place in enumerate(home):
            motion = port_motion(*(SMALL * rng.standard_normal(3) for _ in range(4)))
            motion[:3] += place
            found.inputs[13 * k : 13 * (k + 1)] = motion

    move()
    found.initialize()
    return found, move


def values(instance, quantities):
    layout, z = instance.component.observation_layout, instance.observe()
    return {q.name: z[layout[q.name]] for q in quantities if q.name in layout}


@pytest.mark.parametrize("kind", EXAMPLES)
def test_what_has_the_name_of_a_role_is_declared_as_it(kind):
    """Unit, size, range and variability; descriptions may say more."""
    for layout in EXAMPLES[kind].layouts:
        for quantity in layout.quantities:
            if quantity.name in NAMED:
                assert quantity.saying("") == NAMED[quantity.name].saying("")


@pytest.mark.parametrize("kind", EXAMPLES)
def test_roles_of_observations_have_their_units(kind):
    for quantity in EXAMPLES[kind].observation_layout.quantities:
        if quantity.role in (roles.LOAD, roles.INTERFACE_LOAD, roles.PORT_LOAD, roles.HINGE_LOAD):
            assert quantity.unit in ("N", "N.m")
            assert quantity.size in (1, 3)
        elif quantity.role == roles.ATTITUDE:
            assert (quantity.unit, quantity.size) in (("rad", 3), ("rad/s", 3))
        elif quantity.role == roles.PENETRATION:
            assert (quantity.unit, quantity.size) in (("rad", 1), ("m", 1))
        elif quantity.role:
            assert (quantity.role, quantity.unit) == (roles.DISSIPATION, "J")


@pytest.mark.parametrize("kind", CONNECTIONS)
@pytest.mark.parametrize("order", [2.0, 4.0])
def test_an_impulse_leaves_no_memory_of_motion(kind, order):
    """After an impulse loads follow from the present alone, whether the step before took 1 or 50 ms.

    What has no such input must not remember at all: a plain step is then no different. Clocks show the same time.
    """
    seen = []
    for h in (1e-3, 0.05):
        instance, move = running(kind, 3)
        if roles.ORDER.name in instance.component.parameter_layout:
            instance.set(roles.ORDER.name, order)
            instance.set_parameters(instance.parameters.copy())
            instance.initialize()
        instance.step(0.1 - h)
        move()
        instance.step(h)
        if roles.IMPULSE.name in instance.component.input_layout:
            instance.set(roles.IMPULSE.name, 1.0)
        instance.step(1e-7)
        layout = instance.component.observation_layout
        loads = [q for q in layout.quantities if q.unit in ("N", "N.m", "rad/s", "m/s")]
        seen.append(np.concatenate([*values(instance, loads).values(), np.zeros(0)]))
    assert seen[1] == pytest.approx(seen[0], rel=1e-9, abs=1e-9 * np.abs(seen[0]).max(initial=1.0))


@pytest.mark.parametrize("kind", having(roles.HOLD))
def test_what_is_held_stands_still(kind):
    """Nothing but the first step changes the wrenches of ports at rest: no clock goes on."""
    instance, _ = running(kind, 4)
    for port in instance.component.ports:
        instance.set(f"{port.name}.velocity", 0.0)
        instance.set(f"{port.name}.angular_velocity", 0.0)
    instance.initialize()
    instance.set(roles.HOLD.name, 1.0)
    found = []
    for _ in range(4):
        instance.step(0.25)
        found.append(instance.outputs())
    for later in found[2:]:
        assert later == pytest.approx(found[1], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("kind", CONNECTIONS)
def test_energies_account_for_the_work_on_the_ports(kind):
    """Conservation, step by step: work + potential + dissipated + numerical - supplied, each where it is declared."""
    instance, move = running(kind, 5)
    count = len(instance.component.ports)
    for _ in range(5):
        before, inputs = values(instance, ENERGIES), instance.inputs.copy()
        move()
        instance.step(2e-3)
        parts = works(instance.outputs(), inputs, instance.inputs, count)
        after = values(instance, ENERGIES)
        changes = {name: float((after[name] - before[name])[0]) for name in after}
        supplied = changes.pop(roles.SUPPLIED_ENERGY.name, 0.0)
        scale = np.abs(parts).sum() + abs(supplied) + sum(map(abs, changes.values()))
        assert abs(parts.sum() + sum(changes.values()) - supplied) < 1e-5 * scale + 1e-12
        assert changes.get(roles.DISSIPATED_ENERGY.name, 0.0) >= -1e-12 * scale


@pytest.mark.parametrize("kind", CONNECTIONS)
def test_causes_of_dissipation_are_parts_of_it(kind):
    instance, move = running(kind, 6)
    causes = [q for q in instance.component.observation_layout.quantities if q.role == roles.DISSIPATION]
    for _ in range(5):
        move()
        instance.step(2e-3)
    total = values(instance, [roles.DISSIPATED_ENERGY]).get(roles.DISSIPATED_ENERGY.name)
    if causes:
        assert sum(values(instance, causes).values()) <= total * (1.0 + 1e-12)


@pytest.mark.parametrize("kind", CONNECTIONS)
def test_event_indicators_are_as_many_as_declared(kind):
    structure = {**EXAMPLES[kind].structure, "wrench_mode": "endpoint"}
    component = REGISTRY[kind](**structure)
    instance = Instance(component)
    for k, port in enumerate(component.ports):
        instance.set(f"{port.name}.position", (0.5 * k, 0.0, 0.0))
    instance.initialize()
    found = component.indicators(instance.constants, instance.state, instance.inputs)
    assert found.shape == (component.continuous.indicators,) == (component.indicator_count,)
