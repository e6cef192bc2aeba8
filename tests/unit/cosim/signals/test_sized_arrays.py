"""Arrays of FMI 3.0 whose size is a structural parameter, in an FMU that is compiled here."""

import zipfile

import pytest

import orchestrator as fanfold
from fmus.description.binaries import binary_member
from fmus.native.compile import compile_files, compiler

SOURCE = r"""
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
/* y[i] = the sum over k of A[i,k] u[k]; n is the size. */
static uint64_t n = 3;
static double a[16], u[4], y[4];
static double *of(uint32_t r, size_t *size) {
    *size = r == 2 ? n * n : n;
    return r == 2 ? a : r == 3 ? u : y;
}
const char *fmi3GetVersion(void) { return "3.0"; }
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *path, bool visible, bool logging,
                                  bool events, bool early, const uint32_t *r, size_t count, void *environment,
                                  void *log, void *update) { return &n; }
void fmi3FreeInstance(void *i) {}
int fmi3EnterConfigurationMode(void *i) { return 0; }
int fmi3ExitConfigurationMode(void *i) { return 0; }
int fmi3SetUInt64(void *i, const uint32_t *r, size_t count, const uint64_t *v, size_t size) { n = *v; return 0; }
int fmi3EnterInitializationMode(void *i, bool td, double t, double s, bool sd, double e) { return 0; }
int fmi3ExitInitializationMode(void *i) { return 0; }
int fmi3Terminate(void *i) { return 0; }
int fmi3GetFloat64(void *i, const uint32_t *r, size_t count, double *v, size_t size) {
    size_t needed;
    const double *from = of(*r, &needed);
    if (size != needed) return 3;
    for (size_t k = 0; k < size; k++) v[k] = from[k];
    return 0;
}
int fmi3SetFloat64(void *i, const uint32_t *r, size_t count, const double *v, size_t size) {
    size_t needed;
    double *to = of(*r, &needed);
    if (size != needed) return 3;
    for (size_t k = 0; k < size; k++) to[k] = v[k];
    return 0;
}
int fmi3DoStep(void *i, double t, double h, bool no, bool *event, bool *ends, bool *early, double *last) {
    *event = *ends = *early = false;
    *last = t + h;
    for (size_t k = 0; k < n; k++) {
        y[k] = 0.0;
        for (size_t l = 0; l < n; l++) y[k] += a[k * n + l] * u[l];
    }
    return 0;
}
"""
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Matrix" instantiationToken="x">
<CoSimulation modelIdentifier="Matrix"/><ModelVariables>
<UInt64 name="n" valueReference="1" causality="structuralParameter" variability="fixed" start="3"/>
<Float64 name="A" valueReference="2" causality="parameter" variability="fixed" start="0 0 0 0 0 0 0 0 0">
<Dimension valueReference="1"/><Dimension valueReference="1"/></Float64>
<Float64 name="u" valueReference="3" causality="input" start="0 0 0"><Dimension valueReference="1"/></Float64>
<Float64 name="y" valueReference="4" causality="output"><Dimension valueReference="1"/></Float64>
</ModelVariables><ModelStructure><Output valueReference="4"/></ModelStructure></fmiModelDescription>"""

pytestmark = [
    pytest.mark.skipif(compiler() is None, reason="there is no C compiler"),
    pytest.mark.filterwarnings("ignore"),
]


@pytest.fixture(scope="module")
def matrix(tmp_path_factory):
    folder = tmp_path_factory.mktemp("matrix")
    (folder / "matrix.c").write_text(SOURCE, encoding="utf-8")
    compile_files([folder / "matrix.c"], folder / "library", ("-fPIC",))
    file = folder / "Matrix.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(folder / "library", binary_member("3.0", "Matrix"))
    return file


def scene(file, **keys):
    found = fanfold.load("workbench")
    given = {"inputs": {"u[2]": "HL.angle"}, "outputs": {"y[1]": [], "y[2]": []}, **keys}
    found.fmu("matrix", file, step=0.1, **given)
    return found


@pytest.mark.parametrize("size", [3, 2])
def test_elements_of_arrays_with_a_structural_size(matrix, size):
    """Definition: y[1] = A[1,2] u[2] with the other inputs zero, in row-major order at the default and another size."""
    structure = {} if size == 3 else {"n": size}
    run = fanfold.simulate(
        scene(matrix, parameters={**structure, "A[1,2]": 2.0}), rigid="all", until=0.3, estimate=False
    )
    angle = run["matrix", "u[2]"].at([0.1, 0.2, 0.3])
    assert angle[-1] > 0.0
    assert run["matrix", "y[1]"].at([0.1, 0.2, 0.3]) == pytest.approx(2.0 * angle, rel=1e-12)
    assert run["matrix", "y[2]"].at(0.3) == 0.0


@pytest.mark.parametrize(
    "keys", [{"outputs": {"y[3]": []}, "parameters": {"n": 2}}, {"parameters": {"A[1]": 1.0}}]
)
def test_elements_beyond_the_size_are_refused(matrix, keys):
    with pytest.raises(
        fanfold.FanfoldError, match=r"fmu.matrix.(outputs.y\[3\]: .*y has 2|parameters.A\[1\]: .*3 x 3)"
    ):
        fanfold.simulate(scene(matrix, **keys))
