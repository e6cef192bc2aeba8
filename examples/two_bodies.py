"""Two masses and a spring, coupled as on the page "Theory": orders 2 and 4, and the energy that both keep."""

import numpy as np

MASS = 2.0, 3.0  # kg
STIFFNESS = 400.0  # N/m
START = 0.0, 0.0, 0.1, 0.0  # position and velocity of body 1, then of body 2


def body(position, velocity, mass, mean, slope, h):
    """Position and velocity of a mass after a step under mean + slope (2 t / h - 1), and the moment of its velocity."""
    end = position + h * velocity + h * h * (3.0 * mean - slope) / (6.0 * mass)
    return end, velocity + h * mean / mass, h * h * mean / (6.0 * mass)


def spring(start, end, moment, h, order):
    """Mean and slope of the spring's force over a step, from its lengths and the moment of its rate."""
    mean = 0.5 * STIFFNESS * (start + end)  # the discrete gradient of its energy
    if order == 2:
        return np.array([mean, 0.0])
    return np.array([mean - 0.5 * STIFFNESS * moment, 0.5 * STIFFNESS * (end - start)])


def step(state, h, order):
    """The state after a communication step: the master solves for the mean and the slope of the force."""
    x1, v1, x2, v2 = state

    def sweep(force):
        first = body(x1, v1, MASS[0], *force, h)
        second = body(x2, v2, MASS[1], *-force, h)
        returned = spring(x2 - x1, second[0] - first[0], second[2] - first[2], h, order)
        return returned - force, (*first[:2], *second[:2])

    residual = sweep(np.zeros(2))[0]
    jacobian = np.column_stack([sweep(unit)[0] - residual for unit in np.eye(2)])
    return sweep(np.linalg.solve(jacobian, -residual))[1]


def energy(state):
    """Kinetic energy and that of the spring, J."""
    x1, v1, x2, v2 = state
    return 0.5 * (MASS[0] * v1**2 + MASS[1] * v2**2 + STIFFNESS * (x2 - x1) ** 2)


def errors(h, order, duration=2.0):
    """Error of the spring's length at the end (m), and of the energy relative to that of the start."""
    state = START
    for _ in range(round(duration / h)):
        state = step(state, h, order)
    frequency = np.sqrt(STIFFNESS * (1.0 / MASS[0] + 1.0 / MASS[1]))
    exact = START[2] * np.cos(frequency * duration)
    return abs(state[2] - state[0] - exact), abs(energy(state) / energy(START) - 1.0)


if __name__ == "__main__":
    print("step, ms   error, order 2   error, order 4   energy, order 4")
    for h in (0.04, 0.02, 0.01, 0.005):
        second, fourth = errors(h, 2), errors(h, 4)
        print(f"{1e3 * h:8.3g}   {second[0]:14.1e}   {fourth[0]:14.1e}   {fourth[1]:15.0e}")
