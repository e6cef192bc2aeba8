r"""Rigid and modal bodies: one component, because a rigid body is a modal body without modes.

$$ \ddot{\eta}{}_j + 2 \zeta_j \omega_j \dot{\eta}{}_j + \omega_j^2 \eta_j = Q_j(t),\qquad \mathbf r =
\mathbf r_c + \mathbf R\,(\mathbf X + \boldsymbol\Phi\, \boldsymbol\eta) $$

$$ \dot{\mathbf p} = \sum_k \mathbf F_k + m \mathbf g,\qquad \dot{\mathbf L} = \sum_k (\mathbf r_k \times
\mathbf F_k + \mathbf T_k) + \mathbf r_c \times m \mathbf g $$

with modal coordinates $\eta_j$, their forces $Q_j$ from loads and from rates of the frame, momenta $\mathbf p$ and
$\mathbf L$ (about the world origin), wrenches $\mathbf F_k, \mathbf T_k$ at the ports, and the centre of mass at
$\mathbf r_c$.

A floating frame in the centre of mass plus orthonormalised Craig-Bampton modes with the rigid modes
removed, so that linear momentum decouples and the frame is the mean-axis frame (Bagnoli 2007, section 1.3,
Table 1-1, with I3 = I4 = 0). The states are momenta: world linear and angular momentum are conserved to
round-off. Wrenches linear in time act on the ports; the modes are propagated exactly, the rotation by the mean of
the angular velocities at both ends, each in the body's axes of its instant, iterated to convergence, so a step is
time-symmetric, of fourth order in the vibration and of second in large rotations.

That mean keeps the energy of a rigid body (Simo and Wong 1991), w . (l1 - l0) being its change and w . (w x l) nothing.
Slopes lower the mean by g = h/6 J^-1 S, and g . (l1 - l0) is their work on the moment h/6 (w1 - w0). With modes the
quadratic forces take w0 w1 for w w, and the inertia at the mean coordinates, so that they do the work that inertia that
changes takes. All other maps from slopes to motion and from motion to moments are transposes of one another: means
times travel and slopes times moments are the energy a body takes up, but for (turn of a step)^2 / 12 of the work of
forces, 1/6 (turn of a port by its modes)^3 of that of torques, and 1/4 dw B dB dw.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .body_parts.carried import Carried
from .body_parts.example_modes import example_modal_data
from .body_parts.inertia_coupling import CouplingLevel as CouplingLevel
from .body_parts.inertia_coupling import InertiaCoupling, full_matrix, symmetric_product
from .body_parts.interface import Interface, interface_data
from .body_parts.load import Load
from .body_parts.mass import check_mass
from .body_parts.ports import BodyPorts
from .body_parts.second_order import ModalPath, correct_step
from .body_parts.tension import TensionForms, own_tension
from .body_parts.turn import (
    MAX_ITERATIONS,
    Ending,
    Turned,
    change_of,
    is_found,
    is_slender,
    newton_turn,
    refuse_unsettled,
    settled,
)
from .body_parts.variables import observations, parameters, states
from .contract.component import Component, ComponentError, ContinuousStates, Layout, Port, Vector
from .contract.frames import (
    Quaternion,
    exponential,
    left_product,
    multiply,
    normalized,
    rotation_matrix,
    skew,
    sum_of_moments,
)
from .contract.mass import RigidMass
from .flexible.modal import ModalData
from .numerics.oscillators import Propagator, propagator

_AT = Layout(states(np.zeros(0), 0))
_R, _Q, _P, _L, _W, _D = (
    _AT[name] for name in ("position", "orientation", "momentum", "spin", "angular_velocity", "heat")
)
_ETA = _AT.size
_CACHED_STEP_SIZES = 64


@dataclass(slots=True)
class _Constants:
    """What a step needs, derived from structure and parameters."""

    gravity: Vector
    frequency: Vector
    damping_ratio: Vector
    start: tuple[Vector, Vector, Vector, Vector, Vector]
    propagators: dict[float, Propagator] = field(default_factory=dict)

    def propagator(self, h: float) -> Propagator:
        """The modal propagator of step size h, remembered because a run reuses few step sizes."""
        found = self.propagators.get(h)
        if found is None:
            if len(self.propagators) >= _CACHED_STEP_SIZES:
                self.propagators.clear()
            found = self.propagators[h] = propagator(self.frequency, self.damping_ratio, h)
        return found


class Body(Component):
    """Rigid or flexible body with ports at attachment points, nodes, or offsets from either.

    modal: fields of `ModalData`. ports: one mapping per port with `name`, `point` (a point of the modal
    data), optional `offset` (3, m, body axes, a rigid arm) and `orientation` (quaternion of the port in the
    body's construction axes). inertia_coupling: which invariants vary with deformation; "rigid" and
    "constant" keep the undeformed inertia (they coincide for mean axes), "partial" drops I5 and I9. is_base: a rigid
    body that is the spacecraft; it records its attitude and the loads at its ports, see `Interface`. carried: fields
    of `Carried`, of that part of its mass that its loads include, as it is none of it.
    """

    kind = "body"
    ports_vary = True
    starts_from_inputs = False

    def __init__(
        self,
        modal: Mapping[str, Any],
        ports: Sequence[Mapping[str, Any]],
        inertia_coupling: CouplingLevel = "full",
        is_base: bool = False,
        carried: Mapping[str, Any] | None = None,
    ) -> None:
        data = ModalData.from_arrays(modal)
        self.data = data
        self.modes = data.frequency.size
        check_mass(data)
        self.inertia = InertiaCoupling(data, inertia_coupling)
        self._placed = BodyPorts(data, ports)
        self.tension = TensionForms(data.tension_forms) if len(data.tension_forms) else None
        self.arms = self._placed.arms
        self._interface: Interface | None = None
        self.carried: Carried | None = None
        structure: dict[str, Any] = {
            "modal": dict(modal),
            "ports": [dict(p) for p in ports],
            "inertia_coupling": inertia_coupling,
        }
        if data.second_order_modes and inertia_coupling != "full":
            raise ComponentError(
                f"inertia_coupling is {inertia_coupling!r}; a body with second-order modes needs 'full', as its spin"
                " stiffens it by the inertia that they change"
            )
        if is_base:
            if self.modes:
                raise ComponentError("is_base is for rigid bodies; this one has modes")
            structure["is_base"] = True
            if carried is not None:
                structure["carried"] = dict(carried)
                self.carried = Carried.of(carried)
            self._interface = Interface(ports, self.arms + data.center_of_mass, self.carried, data)
            self.noun = Interface.noun
        own = self._interface
        self._declare(
            structure,
            ports=[Port(p["name"], "body", 4) for p in ports],
            parameters=parameters(self.modes),
            inputs=own.inputs if own else (),
            observations=[*observations(self.modes), *(own.observations if own else ())],
            states=[*states(data.frequency, len(ports)), *(own.states if own else ())],
        )
        self.continuous = ContinuousStates.of(self.state_layout)
        # deformation moves the arms of forces and the inertia: a slender body that bends by a tenth of its length
        # turns about its axis a thousand times harder than straight
        self.constant_mobility = self.modes == 0 and not is_slender(data.inertia)
        self.translation, self.rotation = self._placed.translation, self._placed.rotation
        self.second_order = self._placed.second_order
        self._moments = self.state_layout["moments"]

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        at = self.parameter_layout
        orientation = p[at["initial_orientation"]]
        if abs(np.linalg.norm(orientation) - 1.0) > 1e-6:
            raise ComponentError(
                f"initial_orientation has length {np.linalg.norm(orientation):g}; a quaternion must have length 1"
            )
        return _Constants(
            gravity=p[at["gravity"]].copy(),
            frequency=self.data.frequency,
            damping_ratio=self.data.damping_ratio * float(p[at["damping_scale"]][0]),
            start=(
                p[at["initial_position"]].copy(),
                orientation.copy(),
                p[at["initial_velocity"]].copy(),
                p[at["initial_angular_velocity"]].copy(),
                p[at["initial_modal_coordinate"]].copy() if self.modes else np.zeros(0),
            ),
        )

    def _modal(self, x: Vector) -> tuple[Vector, Vector]:
        """Modal coordinates and momenta (M,) of a state."""
        m = self.modes
        return x[_ETA : _ETA + m], x[_ETA + m : _ETA + 2 * m]

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """Placed, bent and moving as the initial parameters say, with no momentum of the modes."""
        position, orientation, velocity, angular_velocity, eta = c.start
        q = normalized(tuple(orientation.tolist()))
        a = rotation_matrix(q)
        x = np.zeros(self.state_layout.size)
        x[_R] = position + a @ self.data.center_of_mass
        x[_Q] = q
        x[_P] = self.data.mass * velocity
        x[_W] = a.T @ angular_velocity
        x[_L] = a @ symmetric_product(self.inertia.at(eta).inertia, x[_W])
        x[_ETA : _ETA + self.modes] = eta
        return x

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step under wrenches in world axes, linear in time."""
        load = u if self._interface is None else self._interface.without_own(u)
        # the absurd wrenches an iteration may try end as values that are not finite, without a warning
        with np.errstate(over="ignore", invalid="ignore"):
            result = self._dynamic_step(c, x, load, h)
        if self._interface is not None:
            behind = self._moments.stop
            result[behind:] = self._interface.after(x[_Q], x[_W], x[behind:], u, h)
        return result

    def _dynamic_step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        mass, load = self.data.mass, Load.of(u)
        turned = self._turned_flexible(c, x, load, h) if self.modes else self._turned_rigid(x, load, h)
        result = np.empty_like(x)
        result[_P] = x[_P] + h * (load.force.sum(0) + mass * c.gravity)
        result[_R] = x[_R] + (0.5 * h / mass) * (x[_P] + result[_P])
        result[_R] -= (h * h / (6.0 * mass)) * load.force_slope.sum(0)
        q0 = tuple(x[_Q].tolist())
        half_turn = exponential(tuple((0.5 * h * turned.omega).tolist()))
        result[_Q] = q1 = normalized(multiply(q0, multiply(half_turn, half_turn)))
        a1 = rotation_matrix(q1)
        moment, _ = load.moments(turned.world_arms, turned.arms @ a1.T)
        result[_L] = x[_L] + h * moment
        result[_ETA : self._moments.start] = np.concatenate((turned.eta, turned.pi))
        result[_D] = x[_D] + turned.heat
        result[_W] = turned.end
        center = (h / (6.0 * mass)) * (result[_P] - x[_P])
        result[self._moments] = self._port_moments(x, turned, center, half_turn, a1, h).ravel()
        return result

    def _port_moments(
        self, x: Vector, turned: Turned, center: Vector, half_turn: Quaternion, a1: Vector, h: float
    ) -> Vector:
        """First moments of velocity and angular velocity of every port over a step, world axes, (ports, 6).

        center: that of the velocity of the centre of mass. The transpose of what slopes do in a step.
        """
        q0 = tuple(x[_Q].tolist())
        a0, a_mid = rotation_matrix(q0), rotation_matrix(multiply(q0, half_turn))
        start, end = turned.world_arms, turned.arms @ a1.T
        rate_moment, turn = a_mid @ turned.rate_moment, (h / 6.0) * (a_mid @ turned.omega)
        y = np.empty((len(self.arms), 6))
        y[:, :3] = center + 0.5 * (start + end) @ skew(rate_moment).T + (end - start) @ skew(turn).T
        y[:, 3:] = rate_moment
        if self.modes:
            change, placed = (turned.eta - self._modal(x)[0]) / 6.0, self._placed
            moved, changed = (placed.velocities(turned.eta_mean, e) for e in (turned.modal_moment, change))
            y[:, :3] += 0.5 * moved @ (a0 + a1).T + changed @ (a1 - a0).T
            twist, twisted = (placed.twists(turned.eta_mean, e) for e in (turned.modal_moment, change))
            y[:, 3:] += twist @ a_mid.T + twisted @ (a1 - a0).T
        return y

    def _turned_rigid(self, x: Vector, load: Load, h: float) -> Turned:
        """Mean angular velocity, iterated on the moments of the forces at both ends."""
        a0 = rotation_matrix(tuple(x[_Q].tolist()))
        world_arms = self.arms @ a0.T
        momentum, start, omega, inverse = x[_L], x[_W], x[_W], self.inertia.inverse
        for _ in range(MAX_ITERATIONS):
            half = rotation_matrix(exponential(tuple((0.5 * h * omega).tolist())))
            a_mid = a0 @ half
            a1 = a_mid @ half
            moment, slope = load.moments(world_arms, self.arms @ a1.T)
            spin, slope = (momentum + h * moment) @ a1, slope @ a_mid
            end = inverse @ spin
            missing = 0.5 * (start + end) - (h / 6.0) * (inverse @ slope) - omega
            change = newton_turn(
                Ending(self.data.inertia, spin, self.arms, slope, a1), load, omega, missing, h
            )
            omega = omega + change
            if is_found(change, h):
                break
        else:
            refuse_unsettled(change, h)
        none = x[_ETA:_ETA]
        return Turned(
            omega, end, world_arms, self.arms, none, none, 0.0, (h / 6.0) * (end - start), none, none
        )

    def _turned_flexible(self, c: _Constants, x: Vector, load: Load, h: float) -> Turned:
        """The same with modes: their exact propagation under the forces of mid-step is part of the iteration."""
        prop, inertia = c.propagator(h), self.inertia
        a0 = rotation_matrix(tuple(x[_Q].tolist()))
        (eta0, pi0), momentum, start = self._modal(x), x[_L], x[_W]
        world_arms = (self.arms + self._placed.displacements(eta0)) @ a0.T
        before = after = inertia.at(eta0)
        omega, end, eta1, rate_mean = start, start, eta0, pi0 - start @ before.b
        own, modal_moment = own_tension(self.tension, eta0), np.zeros(self.modes)
        _, moment_slope = load.moments(world_arms, world_arms)
        deflection = 0.0
        for _ in range(MAX_ITERATIONS):
            half = rotation_matrix(exponential(tuple((0.5 * h * omega).tolist())))
            a_mid = a0 @ half
            a1 = a_mid @ half
            eta_mean = 0.5 * (eta0 + eta1)
            mid, trapezoid = inertia.mean(before, after, eta_mean), 0.5 * (start + end)
            drag = trapezoid @ mid.b
            wrenches = self._placed.wrenches(a0, a_mid, a1, eta_mean, load)
            force, slope = (self._placed.modal_force(wrench, eta_mean) for wrench in wrenches)
            turning = inertia.solve(mid, moment_slope @ a_mid - mid.b @ slope)
            force = force + inertia.forces(mid, start, end, (h / 6.0) * turning, rate_mean)
            slope = slope - turning @ mid.b
            rate0, last = pi0 - drag, eta1
            if self.data.second_order_modes:
                path = ModalPath(eta0, rate0, eta1, modal_moment)
                modal_moment = correct_step(self._placed, prop, wrenches, own, path, force, slope)
            eta1, rate1 = prop.end(eta0, rate0, force, slope)
            rate_mean = 0.5 * (rate0 + rate1) - (h / 6.0) * slope
            after, arms = inertia.at(eta1), self.arms + self._placed.displacements(eta1)
            moment, moment_slope = load.moments(world_arms, arms @ a1.T)
            spin = (momentum + h * moment) @ a1
            end = inertia.solve(after, spin - after.b @ (rate1 + drag))
            missing = 0.5 * (start + end) - (h / 6.0) * turning - omega
            ending = Ending(full_matrix(after.inertia), spin, arms, moment_slope @ a_mid, a1)
            change = newton_turn(ending, load, omega, missing, h)
            omega = omega + change
            earlier, deflection = deflection, change_of(self.data.inertia, last, eta1)
            deflected = not self.data.second_order_modes or settled(deflection, earlier)
            if deflected and is_found(change, h):
                break
        else:
            refuse_unsettled(change, h, deflected=deflected)
        modal_moment = prop.moment(eta0, rate0, force, slope)
        growth = after.b - before.b
        torque = spin - momentum @ a0 - symmetric_product(after.inertia - before.inertia, trapezoid)
        torque -= growth @ (rate_mean + drag)
        rate_moment = inertia.solve(mid, (h / 6.0) * torque - mid.b @ modal_moment)
        return Turned(
            omega,
            end,
            world_arms,
            arms,
            eta1,
            rate1 + drag,
            prop.dissipated(eta0, rate0, force, slope),
            rate_moment,
            modal_moment - rate_moment @ mid.b - (h / 6.0) * (trapezoid @ growth),
            eta_mean,
        )

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Pose and velocity of every port and its first moments over the last step, world axes.

        Moments are zero where no step in time was made: at the start and in model exchange.
        """
        q = tuple(x[_Q].tolist())
        a = rotation_matrix(q)
        omega = x[_W]
        y = np.empty((len(self.arms), 13))
        arms, spin = self.arms, skew(omega)
        velocity = arms @ spin.T
        turns = np.zeros_like(arms)
        rate_of_turn = np.broadcast_to(omega, arms.shape)
        if self.modes:
            eta, pi = self._modal(x)
            rate = self.inertia.modal_rate(omega, eta, pi)
            deflection = self._placed.displacements(eta)
            arms = arms + deflection
            velocity = arms @ spin.T + self._placed.velocities(eta, rate)
            turns = self._placed.turns(eta)
            rate_of_turn = omega + self._placed.twists(eta, rate)
        y[:, 0:3] = x[_R] + arms @ a.T
        y[:, 3:7] = self._placed.quaternions(q, turns)
        y[:, 7:10] = x[_P] / self.data.mass + velocity @ a.T
        y[:, 10:13] = rate_of_turn @ a.T
        return np.concatenate((y.ravel(), x[self._moments]))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Pose of the construction frame, momenta, energies and modal coordinates."""
        a = rotation_matrix(tuple(x[_Q].tolist()))
        eta, pi = self._modal(x)
        rate = self.inertia.modal_rate(x[_W], eta, pi)
        kinetic = 0.5 * (x[_P] @ x[_P] / self.data.mass + x[_W] @ (x[_L] @ a) + rate @ pi)
        strain = 0.5 * float((self.data.frequency * eta) @ (self.data.frequency * eta))
        if self.tension is not None:
            strain += self.tension.energy(eta)
        energies = np.array((kinetic, strain - self.data.mass * float(c.gravity @ x[_R])))
        position, spin = x[_R] - a @ self.data.center_of_mass, x[_L] + np.cross(x[_R], x[_P])
        found = np.concatenate((position, x[_Q], x[_P], spin, energies, x[_D], eta))
        if self._interface is None:
            return found
        return np.concatenate((found, self._interface.observe(x[_Q], x[_W], x[self._moments.stop :], u)))

    def masses(self) -> list[RigidMass]:
        """The undeformed body at its floating frame."""
        position, orientation = (
            self.observation_layout[f"frame_{name}"].start for name in ("position", "orientation")
        )
        data = self.data
        return [RigidMass(data.mass, data.center_of_mass, data.inertia, (position, position), orientation)]

    def complete(self, c: _Constants, x: Vector) -> Vector:
        """The state with a quaternion of unit length and the angular velocity that belongs to its momenta."""
        result = x.copy()
        result[_Q] = q = normalized(tuple(x[_Q].tolist()))
        momentum = x[_L] @ rotation_matrix(q)
        result[_W] = self.inertia.angular_velocity(momentum, *self._modal(x))
        return result

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Equations of motion under the wrenches of the instant, without their slopes.

        A quaternion that a solver made longer or shorter returns to unit length.
        """
        complete = self.complete(c, x)
        a = rotation_matrix(tuple(complete[_Q].tolist()))
        omega, (eta, pi) = complete[_W], self._modal(x)
        wrench = u[: 6 * len(self.arms)].reshape(-1, 6)
        force, torque = wrench[:, :3], wrench[:, 3:]
        arms = (self.arms + self._placed.displacements(eta)) @ a.T
        rate = self.inertia.modal_rate(omega, eta, pi)
        friction = 2.0 * c.damping_ratio * c.frequency * rate
        load = self._placed.modal_force(self._placed.conjugate(a, a, eta, force, torque), eta)
        load = load + self.inertia.forces(self.inertia.at(eta), omega, omega, np.zeros(3), rate)
        if self.tension is not None:
            load[: self.tension.count] -= self.tension.at(eta).gradient
        turning = left_product(tuple(x[_Q].tolist()))[:, 1:] @ omega
        return np.concatenate(
            (
                x[_P] / self.data.mass,
                0.5 * turning + (0.5 - 0.5 * (x[_Q] @ x[_Q])) * x[_Q],
                force.sum(0) + self.data.mass * c.gravity,
                sum_of_moments(arms, force) + torque.sum(0),
                (friction @ rate,),
                rate,
                load - friction - c.frequency**2 * eta,
            )
        )

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Arrays that `fmus/native/kernels/body.c` reads."""
        return {
            "mass": self.data.mass,
            "center_of_mass": self.data.center_of_mass,
            "frequency": self.data.frequency,
            "damping_ratio": self.data.damping_ratio,
            "arms": self.arms,
            "translation": self.translation,
            "rotation": self.rotation,
            "port_orientation": self._placed.orientation,
            "second_order_modes": self.data.second_order_modes,
            "second_order": self._placed.second_order,
            "tension_forms": self.data.tension_forms,
            **interface_data(self._interface, len(self.arms)),
            **self.inertia.native_data(),
        }

    @classmethod
    def example(cls) -> Body:
        """A flexible body with four modes of a made-up grid, three of second order, and one port with an offset."""
        data = example_modal_data()
        return cls(
            modal=data.to_arrays(),
            ports=[
                {"name": "inboard", "point": "left"},
                {"name": "outboard", "point": "right", "offset": (0.1, 0.0, 0.02)},
            ],
        )

    @classmethod
    def other_examples(cls) -> dict[str, Body]:
        """The free spacecraft."""
        points = {"hinge": (0.0,) * 3, "jet": (0.2, -0.3, 0.1)}
        rigid = ModalData.rigid(1.0, (0.0,) * 3, tuple(np.eye(3).tolist()), points)
        ports = [{"name": name, "point": name, "outside": name == "jet"} for name in points]
        base: dict[str, Any] = {"modal": rigid.to_arrays(), "ports": ports, "is_base": True}
        yoke = {"mass": 0.2, "center_of_mass": (0.5, 0.1, 0.0), "inertia": np.diag((0.01, 0.03, 0.02))}
        return {"a free spacecraft": cls(**base), "one that carries a yoke": cls(**base, carried=yoke)}
