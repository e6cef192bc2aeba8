"""An FMI 2.0 co-simulation FMU, a file, as a participant."""

from __future__ import annotations

import shutil
from collections.abc import Collection, Mapping, Sequence
from ctypes import c_void_p
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, ClassVar
from xml.etree import ElementTree

from fmpy.fmi2 import FMU2Slave, calloc, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, free
from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as Allocate
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as Free

from components.cache.temporary import process_folder
from fmus.archive import content_digest
from fmus.binary import cut_short
from fmus.host.process import LONGEST_CALL, HostError

from .fmi_participant import FmiParticipant
from .fmu_variables import described_in, said_of, says
from .isolated import IsolatedFmu
from .participant import OK, WARNING, ParticipantError
from .shared_library import library_of, unpack
from .typed_functions import Groups, References, as_numbers, references_of

_PYTHON = "PythonFMU"
"""Its FMUs create a new state with every save, and log texts with percent signs unchanged."""


class FMU2Declared(FMU2Slave):  # type: ignore[misc] # FMPy looks at the beginning of the name
    """FMPy's slave, with the types of all functions determined once, not for every instance."""

    _declared: ClassVar[dict[str, tuple[Any, Any, Any]]] = {}

    def _loadFunctions(self) -> None:
        if not self._declared:
            super()._loadFunctions()
            for name, function in self._functions.items():
                self._declared[name] = function.argnames, function.argtypes, function.restype
            return
        for name, types in self._declared.items():
            function = getattr(self.dll, name)
            function.argnames, function.argtypes, function.restype = types
            self._functions[name] = function


class FmuParticipant(FmiParticipant):
    """One instance of an FMU file.

    isolate: whether it runs in a process of its own, by default where its binary is not the one that was compiled here;
    longest_call: time (s) after which a call to this process counts as hanging.
    """

    def __init__(
        self,
        name: str,
        path: Path,
        start: Mapping[str, float | Sequence[float]] | None = None,
        *,
        isolate: bool | None = None,
        longest_call: float = LONGEST_CALL,
    ) -> None:
        super().__init__(name, start or {})
        self.path = path
        self._isolate = isolate
        self._longest_call = longest_call
        self._last_words = ""
        self._fmu: FMU2Slave | IsolatedFmu | None = None
        self._folder = Path(mkdtemp(dir=process_folder()))
        try:
            self._load(unpack(path, self._folder))
        except ParticipantError:
            self.close()
            raise
        except Exception as error:
            self.close()
            reason = ": ".join([str(error), *self._messages])
            raise ParticipantError(f"{name}: {path.name} cannot be loaded: {reason}") from None

    def _load(self, own: Collection[Path]) -> None:
        """own: binaries that were compiled here."""
        described = described_in(self._folder)
        description, annotation = described.description, described.annotation
        if description.fmiVersion != "2.0" or description.coSimulation is None:
            raise ParticipantError(f"{self.name}: {self.path.name} is not an FMI 2.0 co-simulation FMU")
        self.can_restore = bool(description.coSimulation.canGetAndSetFMUstate)
        self._serializes = bool(description.coSimulation.canSerializeFMUstate)
        self.directional_derivatives = bool(description.coSimulation.providesDirectionalDerivative) and says(
            annotation, "DirectionalDerivative", "afterStep"
        )
        self.constant_mobility = says(annotation, "Mobility", "constant")
        self.prescribed_motion = says(annotation, "Mobility", "zero")
        self.noun = "" if (said := said_of(annotation, "Component")) is None else said.get("noun", "")
        self._keeps_states_apart = _PYTHON in (description.generationTool or "")
        variables = described.parameters, described.inputs, described.outputs, described.observations
        self.parameter_layout, self.input_layout, self.output_layout, self.observation_layout = (
            layout for layout, _ in variables
        )
        binary = library_of(self._folder, description.coSimulation.modelIdentifier)
        if binary.is_file() and (problem := cut_short(binary)):
            raise ParticipantError(f"{self.name}: {self.path.name} cannot be loaded: {problem}")
        apart = binary not in own if self._isolate is None else self._isolate
        self._fmu = (
            IsolatedFmu(self._folder, self.name, self._longest_call)
            if apart
            else self._instance_here(description)
        )
        functions, references = self._number_functions(variables, said_of(annotation, "Numbers"))
        self._bind(functions, self._fmu.component, references)
        self._set_up()

    def _number_functions(
        self, variables: Groups, said: ElementTree.Element | None
    ) -> tuple[Any, References]:
        """Functions of which those for real variables take numbers of all types, and references for them.

        said: of the annotation, that the FMU does so itself, and after which call.
        """
        assert self._fmu is not None
        functions = self._fmu.dll
        if said is None:
            return as_numbers(functions, variables)
        if name := said.get("after"):
            self.check(getattr(functions, name)(c_void_p(self._fmu.component)), "accept numbers")
        return functions, references_of(variables)

    def _instance_here(self, description: Any) -> FMU2Slave:  # noqa: ANN401
        fmu = FMU2Declared(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=str(self._folder),
            instanceName=self.name,
        )
        self._callbacks = fmi2CallbackFunctions(
            fmi2CallbackLoggerTYPE(self._log), Allocate(calloc), Free(free)
        )
        fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        return fmu

    def _log(self, environment: Any, instance: Any, status: int, category: Any, message: bytes) -> None:  # noqa: ANN401
        if category is not None:
            self._hear(message.decode("utf-8", "replace"))

    @property
    def digest(self) -> str:
        """SHA-256 of the files in it."""
        return content_digest(self.path)

    def check(self, status: int, action: str) -> None:
        """ParticipantError with the FMU's own words, or those of its process."""
        if status in (OK, WARNING) or not isinstance(self._fmu, IsolatedFmu):
            return super().check(status, action)
        failure = self._fmu.failure
        if failure is not None and not isinstance(failure, HostError):
            raise failure
        self._messages.append(self._fmu.reason)
        try:
            if self._last_words:
                raise ParticipantError(self._last_words)
            return super().check(status, action)
        except ParticipantError as error:
            if not self._fmu.is_sound:
                self._last_words = str(error)  # shorter steps are tried in vain
            raise

    @property
    def is_isolated(self) -> bool:
        """Whether it has a process of its own."""
        return isinstance(self._fmu, IsolatedFmu)

    def close(self) -> None:
        """Free state and instance, end its process, remove the unpacked files."""
        if self._fmu is not None:
            self._free_saved()
            if isinstance(self._fmu, IsolatedFmu):
                self._fmu.close()
            else:
                self._fmu.dll.fmi2FreeInstance(self._fmu.component)
            self._fmu = None
        shutil.rmtree(self._folder, ignore_errors=True)
