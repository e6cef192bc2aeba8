"""Messages of scenes and runs, each with a code that stays: tests, scripts and documents name codes, not wording.

A warning (`W-...`) is something a careful engineer acts on. A note (`N-...`) is a fact of the run that the result keeps
and the report shows; it is not printed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

CODES = {
    "W-attitude": "the spacecraft turns by more than a full turn, which its rotation vector cannot show",
    "W-backend": "an FMU cannot do what was asked for, and something slower replaces it",
    "W-base-turned": "the base is turned at the start, while places and axes are those of the world",
    "W-beam-data": "a beam's section or mass is no beam's, probably a unit",
    "W-bent": "hinges bent across their line further than any hinge does",
    "W-body-data": "a body's mass or inertia is impossible, probably a unit",
    "W-cache": "the cache folder cannot be written to",
    "W-compression": "a body carries more axial load than its model accounts for",
    "W-creep": "a line creeps through smooth friction",
    "W-different-scenes": "two results that are compared are of different scenes",
    "W-disk": "the disk will be full before the run ends, or the result is very large",
    "W-drive-start": "a drive starts away from its command, wound up",
    "W-end-data": "a latch, an end stop or a friction stiffness is no hardware's, probably a unit",
    "W-energy-balance": "the energy balance is further off than the tolerance explains",
    "W-error": "the estimated error of a number exceeds one per cent and ten tolerances",
    "W-error-unknown": "no error could be estimated",
    "W-event": "an event does not happen, or has no effect",
    "W-export": "exported FMUs lack something that the scene has",
    "W-export-step": "tools that do not iterate have no stable communication step for these FMUs",
    "W-figure": "a figure of a plugin failed and is left out",
    "W-fmu": "an FMU of another tool warned during the run",
    "W-fmu-delay": "FMUs read each other in a loop, one of them a step late",
    "W-fmu-events": "an event and an FMU set the same input",
    "W-fmu-hinges": "an FMU reads or sets one hinge of a line that has several",
    "W-fmu-loop": "an FMU and the scene form a loop that is unstable at the FMU's step",
    "W-fmu-step": "the step of an FMU is longer than the run, or very many steps are needed",
    "W-fmu-unit": "variables of an FMU have no unit",
    "W-fmu-wing": "a wing that is an FMU is driven at its base",
    "W-folded-back": "a line moved behind its stowed angle",
    "W-free-slide": "all hinges of a line are cylindrical, so its body slides",
    "W-friction-data": "a friction coefficient or presliding table cannot be meant",
    "W-held-body": "a body that should be flexible is part of a rigid group",
    "W-hold-down-start": "a hold-down grips a line that starts away from its stowed angle",
    "W-idle-load": "a load or a spring without a force, or a hold-down released after the end",
    "W-incomplete": "the result is of an interrupted run",
    "W-joint-opened": "a joint opened by more than joints do",
    "W-joint-stiffness": "a mode depends on default joint stiffness",
    "W-large-rotation": "deformation or rotation is beyond a linear model",
    "W-latch-curve": "a latch's torque curve is contradicted or cannot be followed",
    "W-latch-inertia": "latch damping counts less inertia than moves with the line",
    "W-linear-plate": "a linear plate bent by more than its thickness",
    "W-loop-data": "a cable loop or a gear does not fit its lines, or several leave them no motion",
    "W-membrane-mesh": "a membrane's mesh is coarse for its rims",
    "W-modes-omitted": "an analysis of small motion leaves something out",
    "W-motion-reach": "a joint stays open where motions lead farthest",
    "W-motor-short": "a motor is weaker than friction and harness somewhere on the way",
    "W-no-end": "nothing ends a line's motion",
    "W-not-opened": "a line has not reached its latch, stop or deployed angle",
    "W-open-loop": "start angles leave a loop open",
    "W-overlap": "panels pass through each other as a line opens",
    "W-panel-data": "a panel's section or mass is no panel's, probably a unit",
    "W-peak-at-end": "a peak lies at the end of the run",
    "W-preload": "the static equilibrium of the start changes a preload or a pose",
    "W-rail-start": "a rail starts off its plane, or has no stiffness",
    "W-redundant": "joints constrain the same motion more than once",
    "W-rigid-twin": "a flexible body and its rigid model have different masses",
    "W-signals": "a pattern matches no signal",
    "W-singular-start": "the scene starts in a singular position",
    "W-spin": "a spinning body does not stiffen with its spin",
    "W-start-blow": "loads act suddenly at the start",
    "W-start-rate": "motion starts at a rate from a static equilibrium",
    "W-step-divided": "a fixed step was divided",
    "W-steps": "the run takes very many steps",
    "W-stop-before-latch": "an end stop lies before the latch",
    "W-stop-pressed": "an end stop gave way",
    "W-stress": "stresses lack something or lie outside the model's range",
    "W-table-range": "a line moves beyond its table",
    "W-turned-start": "joints turn a placed body at the start",
    "N-fmu-order": "in which order FMUs that read each other step",
    "N-linear-plate": "a plate that the scene states to be linear bent by more than its thickness",
    "N-repeated": "the run was repeated with a smaller tolerance",
    "N-repetition-failed": "a repetition with a smaller tolerance failed or took too many steps",
    "N-tolerance": "an estimated error exceeds ten tolerances",
}
"""Meaning of every code, in one clause."""
_CODE = re.compile(r"\[([WN]-[a-z-]+)\]$")


def message(code: str, sentence: str) -> str:
    """A sentence with its code, which `CODES` lists."""
    if code not in CODES:
        raise ValueError(f"there is no message code {code!r}")
    return f"{sentence} [{code}]"


def coded(code: str, sentences: Iterable[str]) -> Iterator[str]:
    """Sentences of one kind with their code."""
    return (message(code, sentence) for sentence in sentences)


def code_of(sentence: str) -> str:
    """Code of a message; empty where it has none."""
    match = _CODE.search(sentence)
    return match[1] if match else ""


def is_note(sentence: str) -> bool:
    """Whether a message is a note, which results keep and nothing prints."""
    return code_of(sentence).startswith("N-")
