"""FMUs for model exchange only in a scene: integrated by CVODE, with state, time and step events; FMI 2.0 and 3.0."""

import re
import zipfile
from math import exp, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import orchestrator as fanfold
from components.drive import MotionLaw
from fmus import check_fmu
from fmus.description.binaries import binary_member
from fmus.native.compile import compile_files, compiler
from tests.unit.cosim.signals.signal_cases import INERTIA, STEP, spacecraft

SOURCE = r"""
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
/* A bouncing ball (h, v), an oscillator of van der Pol (p, q), a controller (w' = 10 (-40 u - w)) and a counter of
   tenths of a second. It refuses calls in a wrong mode, and times beyond its next event. */
enum { H, V, P, Q, W, STATES };
static struct { double t, x[STATES], u, next, fails, ends; int count, events; bool event_mode; } m
    = {0.0, {1.0, 0.0, 2.0, 0.0, 0.0}, 0.0, 0.1, 1e9, 1e9, 0, 0, true};
#if VERSION == 2
#define F(name) fmi2##name
typedef int truth;
#define SIZE
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *path, const void *callbacks,
                      int visible, int logging) { return type == 0 ? &m : NULL; }
int fmi2SetupExperiment(void *i, int td, double t, double s, int sd, double e) { return 0; }
int fmi2EnterInitializationMode(void *i) { return 0; }
#else
#define F(name) fmi3##name
typedef bool truth;
#define SIZE , size_t size
void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *path, bool visible, bool logging,
                                   void *environment, void *log) { return &m; }
int fmi3EnterInitializationMode(void *i, bool td, double t, double s, bool sd, double e) { return 0; }
int fmi3GetNumberOfContinuousStates(void *i, size_t *n) { *n = STATES; return 0; }
int fmi3GetNumberOfEventIndicators(void *i, size_t *n) { *n = 1; return 0; }
#define fmi3GetDerivatives fmi3GetContinuousStateDerivatives
#define fmi3SetReal fmi3SetFloat64
#define fmi3GetReal fmi3GetFloat64
#define fmi3GetInteger fmi3GetInt32
#endif
void F(FreeInstance)(void *i) {}
int F(ExitInitializationMode)(void *i) { return 0; }
int F(Terminate)(void *i) { return 0; }
int F(EnterEventMode)(void *i) { if (m.event_mode) return 3; m.event_mode = true; return 0; }
int F(EnterContinuousTimeMode)(void *i) { if (!m.event_mode) return 3; m.event_mode = false; return 0; }
int F(SetTime)(void *i, double t) { if (m.event_mode || t > m.next) return 3; m.t = t; return 0; }
static void discrete(truth *again, truth *ends, truth *nominals, truth *values, truth *has_next, double *next) {
    *again = *ends = *nominals = *values = false;
    if (m.x[H] <= 0.0 && m.x[V] < 0.0) { m.x[H] = 0.0; m.x[V] *= -0.7; *again = *values = true; }
    if (m.t >= m.next) { m.count++; m.next = 0.1 * (m.count + 1); *again = true; }
    *has_next = true;
    *next = m.next;
}
#if VERSION == 2
struct events { int again, ends, nominals, values, has_next; double next; };
int fmi2NewDiscreteStates(void *i, struct events *e) {
    if (!m.event_mode) return 3;
    discrete(&e->again, &e->ends, &e->nominals, &e->values, &e->has_next, &e->next);
    return 0;
}
#else
int fmi3UpdateDiscreteStates(void *i, bool *again, bool *ends, bool *nominals, bool *values, bool *has, double *next) {
    if (!m.event_mode) return 3;
    discrete(again, ends, nominals, values, has, next);
    return 0;
}
#endif
int F(CompletedIntegratorStep)(void *i, truth no, truth *event, truth *ends) {
    *event = m.events == 0;  /* one step event, after the first step */
    m.events++;
    *ends = m.t >= m.ends;
    return 0;
}
int F(SetReal)(void *i, const uint32_t *r, size_t n, const double *v SIZE) {
    if (!m.event_mode) return 3;
    for (size_t k = 0; k < n; k++) *(r[k] == 5 ? &m.u : r[k] == 6 ? &m.fails : &m.ends) = v[k];
    return 0;
}
int F(GetReal)(void *i, const uint32_t *r, size_t n, double *v SIZE) {
    for (size_t k = 0; k < n; k++) v[k] = m.x[r[k]];
    return 0;
}
int F(GetInteger)(void *i, const uint32_t *r, size_t n, int *v SIZE) { *v = m.count; return 0; }
int F(GetContinuousStates)(void *i, double *x, size_t n) { for (size_t k = 0; k < n; k++) x[k] = m.x[k]; return 0; }
int F(SetContinuousStates)(void *i, const double *x, size_t n) {
    if (m.event_mode) return 3;
    for (size_t k = 0; k < n; k++) m.x[k] = x[k];
    return 0;
}
int F(GetNominalsOfContinuousStates)(void *i, double *x, size_t n) {
    for (size_t k = 0; k < n; k++) x[k] = 1.0;
    return 0;
}
int F(GetEventIndicators)(void *i, double *z, size_t n) { z[0] = m.x[H]; return 0; }
#ifndef WITHOUT_RATES
int F(GetDerivatives)(void *i, double *d, size_t n) {
    const double *x = m.x;
    if (m.t > m.fails) return 3;
    d[H] = x[V]; d[V] = -9.81;
    d[P] = x[Q]; d[Q] = (1.0 - x[P] * x[P]) * x[Q] - x[P];
    d[W] = 10.0 * (-40.0 * m.u - x[W]);
    return 0;
}
#endif
"""
NAMES = ("h", "v", "p", "q", "w")
SETTABLE = (("u", "input"), ("fails", "parameter"), ("ends", "parameter"))


def real(version, name, reference, causality, **more):
    """Of a variable its element of the model description."""
    variability = "fixed" if causality == "parameter" else "continuous"
    about = f'name="{name}" valueReference="{reference}" causality="{causality}" variability="{variability}"'
    keys = " ".join(f'{key}="{value}"' for key, value in more.items())
    if version == "3.0":
        return f"<Float64 {about} {keys}/>"
    return f"<ScalarVariable {about}><Real {keys}/></ScalarVariable>"


def description(version):
    variables = [real(version, name, k, "output") for k, name in enumerate(NAMES)]
    variables += [
        real(version, name, 5 + k, kind, start=1e9 * (k > 0)) for k, (name, kind) in enumerate(SETTABLE)
    ]
    rates, structure = [8 + k for k in range(5)], ""
    if version == "3.0":
        variables += [real(version, f"der({n})", 8 + k, "local", derivative=k) for k, n in enumerate(NAMES)]
        variables.append(
            '<Int32 name="count" valueReference="13" causality="output" variability="discrete"/>'
        )
        variables.append(real(version, "z", 14, "local"))
        variables.append(real(version, "time", 15, "independent"))
        structure += "".join(f'<Output valueReference="{k}"/>' for k in (*range(5), 13))
        structure += "".join(f'<ContinuousStateDerivative valueReference="{k}"/>' for k in rates)
        structure += "".join(f'<InitialUnknown valueReference="{k}"/>' for k in (*range(5), *rates, 13))
        structure += '<EventIndicator valueReference="14"/>'
        root, interface = (
            'instantiationToken="x"',
            '<ModelExchange modelIdentifier="M" needsCompletedIntegratorStep="true"/>',
        )
    else:
        variables += [
            real(version, f"der({n})", 8 + k, "local", derivative=k + 1) for k, n in enumerate(NAMES)
        ]
        variables.append(
            '<ScalarVariable name="count" valueReference="13" causality="output" variability="discrete">'
            "<Integer/></ScalarVariable>"
        )
        groups = {
            "Outputs": (*range(5), 13),
            "Derivatives": rates,
            "InitialUnknowns": (*range(5), *rates, 13),
        }
        for name, group in groups.items():
            unknowns = "".join(f'<Unknown index="{k + 1}"/>' for k in group)
            structure += f"<{name}>{unknowns}</{name}>"
        root, interface = 'guid="x" numberOfEventIndicators="1"', '<ModelExchange modelIdentifier="M"/>'
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="{version}" modelName="M" {root} '
        f'variableNamingConvention="structured">{interface}<ModelVariables>{"".join(variables)}</ModelVariables>'
        f"<ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )


pytestmark = [
    pytest.mark.skipif(compiler() is None, reason="there is no C compiler"),
    pytest.mark.filterwarnings("ignore:fmu.guest.*W-fmu-unit"),
]


def built(folder, version, *flags):
    (folder / "m.c").write_text(SOURCE, encoding="utf-8")
    compile_files([folder / "m.c"], folder / "library", ("-fPIC", f"-DVERSION={version[0]}", *flags))
    file = folder / "M.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", description(version))
        archive.write(folder / "library", binary_member(version, "M"))
    return file


@pytest.fixture(scope="module")
def guests(tmp_path_factory):
    """By version of FMI."""
    return {version: built(tmp_path_factory.mktemp("guest"), version) for version in ("2.0", "3.0")}


def scene(file, until=1.15, **keys):
    """The controller brakes the spacecraft by the torque of its wheel."""
    found = spacecraft(until)
    outputs = {"w": "wheel.added_torque", "h": [], "p": [], "count": []}
    found.fmu("guest", file, step=STEP, inputs={"u": "craft.attitude_rate[2]"}, outputs=outputs, **keys)
    return found


def sampled(steps):
    """Rate and torque at the end of each step: one axis, the exact filter under a constant input, by SciPy."""
    push = MotionLaw(True, 0.0, 1.0, 0.0, 0.5)
    rate, torque, found = 0.0, 0.0, [(0.0, 0.0)]
    for k in range(steps):
        rate = solve_ivp(
            lambda t, y, held=torque: [(held + push.angle(t)) / INERTIA],
            (k * STEP, (k + 1) * STEP), [rate], rtol=1e-12, atol=1e-15,
        ).y[0, -1]  # fmt: skip
        torque = -40.0 * rate + (torque + 40.0 * rate) * exp(-10.0 * STEP)
        found.append((rate, torque))
    return np.array(found).T


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_states_and_events_are_integrated(guests, version):
    """Closed forms of a ball (two bounces), a counter and a filter; van der Pol's oscillator by SciPy.

    CVODE bounds the error of a step; those of a run are up to a hundred of these.
    """
    tolerance = 1e-8
    run = fanfold.simulate(scene(guests[version]), tolerance=tolerance, estimate=False)
    times = np.arange(1, 23) * STEP
    found = {name: run["guest", name].at(times + 1e-7) for name in ("h", "p", "count", "w")}
    first = sqrt(2.0 / 9.81)
    second = first * (1.0 + 2.0 * 0.7)
    up = (0.7 * 9.81 * first, 0.49 * 9.81 * first)
    heights = np.select(
        [times < first, times < second],
        [1.0 - 4.905 * times**2, up[0] * (times - first) - 4.905 * (times - first) ** 2],
        up[1] * (times - second) - 4.905 * (times - second) ** 2,
    )
    assert found["h"] == pytest.approx(heights, abs=100.0 * tolerance)
    exact = solve_ivp(
        lambda t, y: [y[1], (1.0 - y[0] ** 2) * y[1] - y[0]], (0.0, 1.15), [2.0, 0.0], t_eval=times,
        method="DOP853", rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    assert found["p"] == pytest.approx(exact.y[0], abs=100.0 * tolerance)
    assert found["count"].tolist() == [k // 2 for k in range(1, 23)]
    rates, torques = sampled(22)
    assert found["w"] == pytest.approx(torques[1:], abs=100.0 * tolerance)
    assert run["craft", "attitude_rate"].at(times)[:, 1] == pytest.approx(rates[1:], abs=tolerance)


@pytest.mark.parametrize(
    ("version", "parameter", "words"),
    [
        ("2.0", "ends", "asks for the end"),
        ("3.0", "ends", "asks for the end"),
        ("3.0", "fails", "fmi3GetContinuousStateDerivatives .*error"),
    ],
)
def test_the_end_and_failures_are_named_and_rows_are_kept(guests, tmp_path, version, parameter, words):
    """FMI, terminateSimulation, and a derivative that cannot be computed: which FMU, when, what."""
    path, asked = tmp_path / "run.h5", {parameter: 0.32}
    with pytest.raises(
        fanfold.FanfoldError, match=rf"guest: cannot do a step of 0.05 s at t = 0.3 s: .*{words}"
    ):
        fanfold.simulate(scene(guests[version], parameters=asked), save=path, estimate=False)
    assert fanfold.Result.open(path).time[-1] == pytest.approx(0.35)


def test_the_check_integrates_it(guests, tmp_path):
    """It can be a guest, but no component; a binary without derivatives is named by check and run."""
    absent = "its binary has no function "  # that of the test has only those that it needs
    problems = [one for one in check_fmu(guests["3.0"]) if one.kind != "advice" and absent not in one]
    assert [problem.kind for problem in problems] == ["Fanfold needs"]
    assert "model exchange" in problems[0]
    lame = built(tmp_path, "2.0", "-DWITHOUT_RATES")
    lacks = f"{absent}fmi2GetDerivatives"
    assert re.match(f"it cannot be stepped .*{lacks}", check_fmu(lame)[-1])
    with pytest.raises(fanfold.FanfoldError, match=f"guest: .*{lacks}"):
        fanfold.simulate(scene(lame, until=0.1), estimate=False)
