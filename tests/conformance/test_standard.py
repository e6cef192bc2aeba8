"""What the FMI standards ask of native FMUs beyond a plain run: derivatives of all unknowns, times, prefixed names."""

from __future__ import annotations

import subprocess
from ctypes import CDLL, c_char_p, c_double, c_size_t, c_uint, c_void_p
from pathlib import Path

import numpy as np
import pytest

from fmus import native_library
from fmus.native import compiler
from fmus.native.compile import FLAGS, HERE, compile_files, sources
from tests.conformance.programs.driver import ERROR, KINDS, OK, Fmu, Reference
from tests.conformance.test_fmus import BACKENDS, path_of

pytestmark = pytest.mark.skipif(native_library() is None, reason="no native library was built")
H = 1e-3
LAST_SUCCESSFUL_TIME = 2


def opened(kind):
    """An FMU in initialization mode under ordinary inputs, and its component's numbers."""
    fmu, reference = Fmu(path_of(kind, "native")), Reference(KINDS[kind].example())
    reference.u = reference.random_inputs(np.random.default_rng(5))
    assert fmu.set(reference.firsts[1], reference.u) == OK
    return fmu, reference


def continuous_inputs(reference):
    """Columns of the inputs that have derivatives, one of every quantity."""
    layout = reference.component.input_layout
    return [layout[q.name].start for q in layout.quantities if q.variability != "discrete"]


def unknowns_of(reference):
    return list(range(reference.firsts[2], reference.firsts[3] + reference.sizes[3]))


def assert_close(found, ahead, behind, amount):
    """Against a central difference.

    It errs by its rounding, 1e-14 of the values over the amount, and by the third derivative: 1e-10 of the values for
    amounts of 1e-5, and 1e-4 where coordinates move by 1e-5 in a step of 1e-3.
    """
    expected = (ahead - behind) / (2.0 * amount)
    size = max(np.abs(expected).max(), 1e-9)
    rounding = 1e-14 * (np.abs(ahead) + 1.0) / amount
    assert np.all(np.abs(found - expected) <= 1e-4 * size + rounding)


@pytest.mark.parametrize("kind", BACKENDS["native"])
def test_all_outputs_have_derivatives_over_a_step(kind):
    """Independent: whole steps from a saved state; port outputs and observations alike."""
    fmu, reference = opened(kind)
    assert fmu.start() == OK
    first, unknowns = reference.firsts[1], unknowns_of(reference)
    assert fmu.step(0.0, H) == OK
    # other inputs: drag is not smooth where nothing moves
    state, u = fmu.slave.getFMUstate(), reference.random_inputs(np.random.default_rng(6))
    for column in continuous_inputs(reference):
        amount, after = 1e-5 * max(1.0, abs(u[column])), []
        for side in (1.0, -1.0, 0.0):
            fmu.slave.setFMUstate(state)
            shifted = u.copy()
            shifted[column] += side * amount
            assert fmu.set(first, shifted) == OK
            assert fmu.step(H, H) == OK
            after.append(np.array(fmu.slave.getReal(unknowns)))
        found = np.array(fmu.slave.getDirectionalDerivative(unknowns, [first + column], [1.0]))
        assert_close(found, after[0], after[1], amount)
        assert np.array_equal(fmu.slave.getReal(unknowns), after[2]), "asking for derivatives changed values"


@pytest.mark.parametrize("kind", BACKENDS["native"])
def test_initial_unknowns_have_derivatives(kind):
    """Independent: initial values under shifted inputs and parameters."""
    fmu, reference = opened(kind)
    unknowns = unknowns_of(reference)
    knowns = [reference.firsts[1] + column for column in continuous_inputs(reference)]
    knowns += [i for i in range(reference.sizes[0]) if reference.p[i] != 0.0][:12]
    before = fmu.slave.getReal(unknowns)
    for known in knowns:
        (value,) = fmu.slave.getReal([known])
        amount = 1e-5 * (abs(value) if known < reference.sizes[0] else max(1.0, abs(value)))
        shifted = []
        for side in (1.0, -1.0, 0.0):
            assert fmu.set(known, [value + side * amount]) == OK
            values = (c_double * len(unknowns))()
            status = fmu.slave.dll.fmi2GetReal(
                c_void_p(fmu.slave.component),
                (c_uint * len(unknowns))(*unknowns),
                c_size_t(len(unknowns)),
                values,
            )
            shifted.append(np.array(values) if status == OK else None)
        if shifted[0] is None and shifted[1] is None:  # a component of a quaternion
            assert fmu.call("getDirectionalDerivative", unknowns, [known], [1.0]) == ERROR
            continue
        found = np.array(fmu.slave.getDirectionalDerivative(unknowns, [known], [1.0]))
        if shifted[0] is not None and shifted[1] is not None:
            assert_close(found, shifted[0], shifted[1], amount)
        assert fmu.slave.getReal(unknowns) == before
    assert fmu.start() == OK


@pytest.mark.parametrize("kind", BACKENDS["native"])
def test_initial_unknowns_follow_what_is_listed(kind):
    """FMI 2.0, 2.2.8: what is not listed does not act, and no list means all that is known. Other inputs act on none.

    Bodies and bases start from their parameters, so that a tool has no loop to solve through their ports.
    """
    fmu, reference = opened(kind)
    component = reference.component
    listed = {one.variable.valueReference: one.dependencies for one in fmu.description.initialUnknowns}
    unlisted = [place for place, known in listed.items() if known is not None]
    assert {one.causality for place in unlisted for one in listed[place]} <= {"parameter"}
    if any(port.side == "body" for port in component.ports):
        assert set(unlisted) >= set(range(reference.firsts[2], reference.firsts[3]))
    before = fmu.slave.getReal(unlisted)
    assert fmu.set(reference.firsts[1], reference.random_inputs(np.random.default_rng(7))) == OK
    assert fmu.slave.getReal(unlisted) == before


@pytest.mark.parametrize("kind", BACKENDS["native"])
def test_derivatives_are_never_nan(kind):
    """Rule: what is answered OK is a number. Regression: at extreme inputs, whose squares overflow, it was none."""
    fmu, reference = opened(kind)
    assert fmu.start() == OK
    assert fmu.step(0.0, H) == OK
    rng, unknowns, first = np.random.default_rng(1), unknowns_of(reference), reference.firsts[1]
    refused = 0
    for _ in range(40):
        u = reference.u.copy()
        u[rng.integers(u.size)] = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(100.0, 308.0)
        assert fmu.set(first, u) == OK
        known = [first + int(rng.integers(u.size))]
        status = fmu.call("getDirectionalDerivative", unknowns, known, [1.0])
        assert status in (OK, ERROR)
        refused += status == ERROR
        if status == OK:
            assert np.all(np.isfinite(fmu.slave.getDirectionalDerivative(unknowns, known, [1.0])))
    assert refused or kind not in ("hold_down", "point_motion", "suspension")  # where it was seen


def test_a_step_has_to_move_time():
    """In floats 1e30 s and a millisecond are 1e30 s."""
    fmu, _ = opened("hinge")
    assert fmu.start() == OK
    assert fmu.step(1e30, H) == ERROR
    assert "rounding" in fmu.log[-1]


def test_a_refused_step_leaves_the_time():
    fmu, _ = opened("hinge")
    assert fmu.start() == OK
    assert fmu.step(0.0, H) == OK
    for time, h in ((0.5, -H), (float("nan"), H), (0.5, float("inf"))):
        assert fmu.step(time, h) == ERROR
        last = c_double()
        status = fmu.slave.dll.fmi2GetRealStatus
        assert status(c_void_p(fmu.slave.component), LAST_SUCCESSFUL_TIME, last) == OK
        assert last.value == H


def test_loads_of_the_base_follow_its_inputs_before_the_first_step():
    """Statics: the sum of the forces at its ports, but for what acts there from outside."""
    fmu, reference = opened("fixed_base")
    outside = [port["name"] for port in reference.component.structure["ports"] if port.get("outside")]
    layout = reference.component.input_layout
    forces = [q.name for q in layout.quantities if q.name.endswith(".force")]
    forces = [name for name in forces if name.removesuffix(".force") not in outside]
    place = reference.firsts[3] + reference.component.observation_layout["interface_force"].start
    for _ in ("during initialization", "after it"):
        total = sum(reference.u[layout[name]] for name in forces)
        assert fmu.slave.getReal([place, place + 1, place + 2]) == pytest.approx(total, rel=1e-15)
        reference.u = 2.0 * reference.u
        if _ == "during initialization":
            assert fmu.start() == OK
        assert fmu.set(reference.firsts[1], reference.u) == OK


ONE_KERNEL = """#include "kernel.h"
extern const Kernel hinge_kernel;
const Kernel *const kernels[] = {&hinge_kernel};
const size_t kernel_count = 1;
"""


@pytest.mark.skipif(compiler() is None, reason="there is no C compiler")
def test_names_take_a_prefix(tmp_path: Path):
    """For static linking (FMI 2.0 section 2.1.1, FMI 3.0 section 2.2.2); internal names stay inside.

    Names are those of the core, which is all of the library but its kernels: one of these does.
    """
    prefixes = [f"-DFMI{version}_FUNCTION_PREFIX=wing_" for version in (2, 3)]
    for name, text in {**sources(), "kernels.c": ONE_KERNEL}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    names = {
        "kernels.c",
        "hinge.c",
        "hinge_derivative.c",
        *(path.name for path in (HERE / "core").glob("*.c")),
    }
    target = tmp_path / "prefixed.so"
    flags = [flag for flag in FLAGS if flag not in ("-O3", "-fvisibility=hidden")] + prefixes
    compile_files([tmp_path / name for name in sorted(names)], target, flags)
    listed = subprocess.run(
        ["nm", "-D", "--defined-only", target], capture_output=True, text=True, check=True
    )
    names = [line.split()[-1] for line in listed.stdout.splitlines()]
    fmi = [name for name in names if "fmi" in name]
    assert len(fmi) > 100
    assert all(name.startswith("wing_fmi") for name in fmi)
    assert not {"allocate", "kernels", "instance_create", "data_read"} & set(names)
    library = CDLL(str(target))
    for version in (2, 3):
        answer = library[f"wing_fmi{version}GetVersion"]
        answer.restype = c_char_p
        assert answer() == f"{version}.0".encode()
