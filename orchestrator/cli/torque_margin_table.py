"""Tables and sentences of torque margins and restarts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from rich.table import Table

from ..analysis.torque_margin.margins import TorqueMargin
from ..analysis.torque_margin.restart import CaseRestart, Restart
from ..analysis.torque_margin.rules import LIMITS, RULE_TEXTS, Found, Margins
from ..results.round_off import noise_floor
from ..scene.units import degrees_text
from .tables import table_of


def margin_table(found: TorqueMargin) -> Table:
    """Every line, case and rule at its worst angle, in the order of the scene's lines."""
    rules = list(dict.fromkeys(rule.rule for one in found.lines for rule in one.margins))
    phase = f", GEVS factors of phase {found.gevs}" if found.gevs else ""
    title = f"torque margin at the worst angle\n{found.factors} factors, {found.friction} friction{phase}"
    left = ("line", "case", "rule", "verdict")
    headings = (*left[:3], "margin", "at,\ndeg", "driving,\nN.m", "resisting,\nN.m", "verdict")
    lines = list(dict.fromkeys(one.line for one in found.lines))
    rows = (
        (one.line, one.case, rule.rule, *_margin_cells(one, rule))
        for one in sorted(found.lines, key=lambda one: lines.index(one.line))
        for rule in one.margins
    )
    table = table_of(title, headings, rows, left)
    table.caption = "\n".join(f"{rule} rule, {_limit(LIMITS[rule])}: {RULE_TEXTS[rule]}" for rule in rules)
    table.caption_justify = "left"
    return table


def _limit(limit: float) -> str:
    return f"limit {limit:g}" if limit else "above 0"


def _margin_cells(found: Found, rule: Margins) -> tuple[str, ...]:
    """Margin, angle, driving and resisting torque, and the verdict; no margin and no angle where nothing resists."""
    k = rule.worst
    is_finite = bool(np.isfinite(rule.margin[k]))
    numbers = (f"{rule.margin[k]:.3f}", degrees_text(found.torques.angle[k], 1)) if is_finite else ("-", "-")
    return (
        *numbers,
        f"{rule.available[k]:.4f}",
        f"{rule.resisting[k]:.4f}",
        _margin_verdict(found, rule, is_finite),
    )


def _margin_verdict(found: Found, rule: Margins, is_finite: bool) -> str:
    if not found.counts:
        return "in the group"
    if is_finite:
        return "passes" if rule.passes else "FAILS"
    return "no resisting torque" if rule.passes else "FAILS by TD and TL"


def margin_sentences(found: TorqueMargin) -> list[str]:
    """Sentences on coupled lines, lines without a margin, and parts that no margin includes."""
    groups = {one.line: one.torques.rates for one in found.lines if len(one.torques.rates) > 1}
    coupled = [
        f"{line}: cable loops or gears couple these lines at rates {' : '.join(f'{r:.4g}' for r in rates.values())}; "
        f"their common verdict has torques at the rate of {next(iter(rates))}"
        for line, rates in groups.items()
    ]
    left_out = [f"not included: {name}; {why}" for name, why in found.uncounted.items()]
    return [*coupled, *_held_at(found), *sentences_without_margin(found.without), *left_out]


def _held_at(found: TorqueMargin) -> Iterator[str]:
    """Where lines, coupled lines together, do not start from rest with nominal torques."""
    for one in found.lines:
        net = one.torques.net
        short = np.flatnonzero(net < -noise_floor(one.torques.driving.tolist()))
        if one.counts and short.size:
            k = int(short[0])
            yield (
                f"{one.line} ({one.case}): at {degrees_text(one.torques.angle[k], 1)} deg friction and harness "
                f"exceed the driving torque by {-net[k]:.4g} N.m even without factors, so the line does not start "
                "there from rest"
            )


def sentences_without_margin(cases: Mapping[str, Mapping[str, str]]) -> list[str]:
    """A sentence for each reason, from reasons by case and line; cases are named where they differ."""
    found: dict[str, dict[str, list[str]]] = {}
    for case, reasons in cases.items():
        for line, reason in reasons.items():
            found.setdefault(reason, {}).setdefault(line, []).append(case)
    sentences = []
    for reason, lines in found.items():
        names = [
            line if len(among) == len(cases) else f"{line} ({', '.join(among)})"
            for line, among in lines.items()
        ]
        verb = "has" if len(names) == 1 else "have"
        sentences.append(f"{', '.join(names)} {verb} no margin: {reason}")
    return sentences


def restart_table(runs: Sequence[CaseRestart]) -> Table:
    """Every line of every restart."""
    left = ("case", "stopped\nat", "line", "verdict")
    headings = (*left[:3], "start,\ndeg", "end,\ndeg", "fastest,\ndeg/s", "opened\nafter, s", "verdict")
    rows = []
    for run in runs:
        for line in run.lines:
            after = "-" if line.opened_at is None else f"{line.opened_at:.4f}"
            start, end = degrees_text(line.start, 2), degrees_text(line.end, 2)
            fastest = f"{np.rad2deg(line.fastest):.3g}"
            rows.append((run.case, run.position, line.line, start, end, fastest, after, _verdict(line)))
    return table_of("restarts from rest", headings, rows, left)


def _verdict(line: Restart) -> str:
    if line.opens:
        return "opens" if line.net >= 0.0 else "opens, HELD AT REST"
    if line.still_opening:
        return "NOT OPEN YET"
    return "stops, DOES NOT OPEN" if line.moves else "DOES NOT MOVE"


def restart_sentences(runs: Sequence[CaseRestart]) -> list[str]:
    """Difference between restarts and margins, and why lines do not start, or started although they should not."""
    if not runs:
        return []
    sentences = [
        "restarts use nominal torques, margins use uncertainty factors and a limit; so a line that fails its margin "
        "may open"
    ]
    for run in runs:
        for net in dict.fromkeys(line.net for line in run.lines if line.net < 0.0):
            lines = [line for line in run.lines if line.net == net]
            sentences.append(
                f"{', '.join(line.line for line in lines)} ({run.case}) {_held(run.position, lines)}"
            )
    return sentences


def _held(position: str, lines: Sequence[Restart]) -> str:
    """Why coupled lines cannot start from a position, and why they moved nevertheless."""
    it, alone = ("they", "by themselves") if len(lines) > 1 else ("it", "by itself")
    turned = ""
    if any(line.opens or line.still_opening for line in lines):
        turned = "creep of smooth friction, or gravity and loads, which no margin includes"
    elif any(line.moves for line in lines):
        turned = "the sudden start of the motor torque"
    return (
        f"from {position}: static friction and harness exceed the driving torque by {-lines[0].net:.4g} N.m, so "
        f"{it} cannot start {alone}{f'; {it} moved by {turned}' if turned else ''}"
    )
