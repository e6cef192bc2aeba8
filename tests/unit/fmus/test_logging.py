"""Log messages that a host does not want: warnings and discards are silent where it switched them off, errors never."""

import fmpy
import pytest
from fmpy import calloc, free
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Slave

from components.damper import EddyCurrentDamper
from fmus import native_library
from fmus.build import build_fmu

pytestmark = pytest.mark.skipif(native_library() is None, reason="the native library is not built")


ALL, ERRORS, DISCARDS = [], ["logStatusError"], ["logStatusDiscard"]


def messages(folder, version, asked):
    """What is said of a step that is discarded, after a host asked for some messages, or for none of them."""
    path = build_fmu(EddyCurrentDamper.example(), "damper", folder, fmi=version)
    description, place, said = fmpy.read_model_description(path), fmpy.extract(path, folder / "files"), []
    options = {"guid": description.guid, "unzipDirectory": place, "instanceName": "damper"}
    name = description.coSimulation.modelIdentifier
    reference = next(v for v in description.modelVariables if v.name == "damping_coefficient").valueReference
    if version == "2.0":
        fmu = FMU2Slave(modelIdentifier=name, **options)
        logger = fmi2CallbackLoggerTYPE(lambda _, __, ___, ____, message: said.append(message.decode()))
        memory = fmi2CallbackAllocateMemoryTYPE(calloc), fmi2CallbackFreeMemoryTYPE(free)
        fmu.instantiate(callbacks=fmi2CallbackFunctions(logger, *memory), loggingOn=True)
        fmu.setupExperiment()
        set_number = fmu.setReal
    else:
        fmu = FMU3Slave(modelIdentifier=name, **options)
        fmu.instantiate(logMessage=lambda _, __, ___, message: said.append(message.decode()))
        set_number = fmu.setFloat64
    if asked is not None:
        fmu.setDebugLogging(*asked)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    set_number([reference], [-1.0])
    with pytest.raises(fmpy.fmi1.FMICallException):
        fmu.doStep(0.0, 0.01)
    fmu.freeInstance()
    return said


@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (None, True),
        ((True, ALL), True),
        ((True, DISCARDS), True),
        ((True, ERRORS), False),
        ((False, ALL), False),
    ],
)
def test_a_discarded_step_is_told_of_where_it_is_wanted(version, asked, says, tmp_path):
    """FMI: categories that a host did not ask for stay silent; without any choice all that goes wrong is told."""
    assert (
        any("damping_coefficient = -1" in sentence for sentence in messages(tmp_path, version, asked)) is says
    )
