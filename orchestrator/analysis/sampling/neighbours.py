"""Runs of a scene and of its neighbours, whose parameters differ a little, side by side in one pass."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import Literal, NamedTuple

from components import FanfoldError

from ...assembly import Assembly
from ...assembly.statics.start import static_start
from ...cosim.fmu import FmuParticipant
from ...cosim.native.library import library
from ...cosim.network import Network
from ...cosim.participant import Participant, ParticipantError
from ...cosim.sensitivity.nominal_run import NominalRun
from ...cosim.sensitivity.perturbed_run import PerturbedRun
from ...cosim.settings import Settings
from ...cosim.stepping import StepError
from ...results.recorder import MemoryRecorder
from ...results.result import Result
from ...run.run import alike, as_fmus, signal_groups

_ORDER: Literal[4] = 4
_CHOOSES_NOTHING = ((1.0,),)
"""A step plan, as a neighbour makes the steps of its leader."""


class Followed(NamedTuple):
    """Results of a run and of its neighbours, and the steps (s) of the run, a list for every segment between events."""

    result: Result
    neighbours: list[Result]
    segments: list[list[float]]


def run_beside(
    assembly: Assembly,
    others: Mapping[str, Assembly],
    settings: Settings,
    until: float,
    watch: Callable[[float, float], None] = lambda time, h: None,
) -> Followed:
    """Run an assembly, and others whose parameters differ a little, by what differs, along its steps.

    FanfoldError where one of them does not reach the end (s), or does not meet the events that the assembly meets.
    """
    _refuse_signals(assembly)
    assembly = static_start(assembly).assembly
    others = {name: static_start(other).assembly for name, other in others.items()}
    settings = replace(settings, progress=watch, driving=assembly.driving)
    beside = replace(settings, step_plan=_CHOOSES_NOTHING, progress=lambda time, h: None)
    with ExitStack() as stack:
        try:
            own = stack.enter_context(as_fmus(assembly))
            _refuse_slow(assembly, own)
            neighbours: list[PerturbedRun] = []
            recorders: list[MemoryRecorder] = []
            for name, other in others.items():
                participants = stack.enter_context(_instances(own, assembly, other))
                network, recorder = _with_recorder(other, participants)
                neighbours.append(
                    PerturbedRun(name, network, other.hinge_lines, recorder, beside, other.events)
                )
                recorders.append(recorder)
            network, recorder = _with_recorder(assembly, own)
            leader = NominalRun(
                neighbours, network, assembly.hinge_lines, recorder, settings, assembly.events
            )
            leader.initialize(preload=assembly.preload)
            leader.run(until)
        except (ParticipantError, StepError) as error:
            raise FanfoldError(f"{assembly.name}: {error}") from None
        return Followed(recorder.result(), [one.result() for one in recorders], leader.segments)


def _refuse_signals(assembly: Assembly) -> None:
    if assembly.signal_fmus:
        names = ", ".join(one.name for one in assembly.signal_fmus)
        raise FanfoldError(
            f"{assembly.name}: what FMUs with signals do ({names}) has no derivatives, as they cannot make a step "
            "twice; leave them out, or compare runs"
        )


def _refuse_slow(assembly: Assembly, participants: Sequence[FmuParticipant]) -> None:
    if library() is None:
        raise FanfoldError(
            f"{assembly.name}: derivatives need the native library; install Fanfold again where there is a C compiler"
        )
    if slow := [one.name for one in participants if one.native is None]:
        raise FanfoldError(
            f"{assembly.name}: derivatives need native FMUs, and {', '.join(slow)} can only be had in Python; compare "
            "runs instead"
        )


@contextmanager
def _instances(
    own: Sequence[FmuParticipant], assembly: Assembly, other: Assembly
) -> Iterator[Sequence[Participant]]:
    """Participants of another assembly: of the same files, where they differ by start values alone."""
    if not alike(assembly.parts, other.parts):
        with as_fmus(other) as participants:
            yield participants
        return
    with ExitStack() as stack:
        found = []
        for participant, part in zip(own, other.parts, strict=True):
            found.append(participant.another(part.start))
            stack.callback(found[-1].close)
        yield found


def _with_recorder(assembly: Assembly, participants: Sequence[Participant]) -> tuple[Network, MemoryRecorder]:
    network = Network(participants, assembly.links, _ORDER)
    return network, MemoryRecorder(signal_groups(network), {}, assembly.geometry, assembly.hinge_lines)
