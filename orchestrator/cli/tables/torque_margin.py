"""What the torque margin and the restarts come to, as tables and sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from rich.table import Table

from ...analysis.torque_margin.margins import TorqueMargin
from ...analysis.torque_margin.restart import CaseRestart, Restart
from ...analysis.torque_margin.rules import LIMIT, RULE_TEXTS, LineTorques, Margins
from ...scene.units import degrees_text
from . import plain_table


def margin_table(found: TorqueMargin) -> Table:
    """Every line, case and rule at its worst angle, in the order of the scene's lines."""
    table = plain_table(
        f"torque margin at the worst angle, limit {LIMIT:g}\n{found.factors} factors, {found.friction} friction"
    )
    for name in ("line", "case", "rule"):
        table.add_column(name)
    for name in ("margin", "at,\ndeg", "driving,\nN.m", "resisting,\nN.m"):
        table.add_column(name, justify="right", min_width=5)
    table.add_column("verdict")
    table.caption = "\n".join(f"{rule} rule: {text}" for rule, text in RULE_TEXTS.items())
    table.caption_justify = "left"
    lines = list(dict.fromkeys(one.line for one in found.lines))
    for one in sorted(found.lines, key=lambda one: lines.index(one.line)):
        for rule in one.margins:
            table.add_row(one.line, one.case, rule.rule, *_margin_cells(one.torques, rule))
    return table


def _margin_cells(torques: LineTorques, rule: Margins) -> tuple[str, ...]:
    """Margin, angle, driving and resisting torque, and the verdict; no margin and no angle where nothing resists."""
    k = rule.worst
    balance = (f"{rule.available[k]:.4f}", f"{rule.resisting[k]:.4f}")
    if np.isfinite(rule.margin[k]):
        verdict = "passes" if rule.passes else "FAILS"
        return f"{rule.margin[k]:.3f}", degrees_text(torques.angle[k], 1), *balance, verdict
    verdict = "no resisting torque" if rule.passes else "FAILS by TD and TL"
    return "-", "-", *balance, verdict


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
        verb, whose = ("has", "its") if len(names) == 1 else ("have", "their")
        sentences.append(f"{', '.join(names)} {verb} no margin of {whose} own: {reason}")
    return sentences


def restart_table(runs: Sequence[CaseRestart]) -> Table:
    """Every line of every restart."""
    table = plain_table("restarts from rest")
    for name in ("case", "stopped\nat", "line"):
        table.add_column(name)
    for name in ("start,\ndeg", "end,\ndeg", "fastest,\ndeg/s", "opened\nafter, s"):
        table.add_column(name, justify="right", min_width=6)
    table.add_column("verdict")
    for run in runs:
        for line in run.lines:
            after = "-" if line.opened_at is None else f"{line.opened_at:.4f}"
            start, end = degrees_text(line.start, 2), degrees_text(line.end, 2)
            fastest = f"{np.rad2deg(line.fastest):.3g}"
            table.add_row(run.case, run.position, line.line, start, end, fastest, after, _verdict(line))
    return table


def _verdict(line: Restart) -> str:
    if line.opens:
        return "opens"
    if line.still_opening:
        return "NOT OPEN YET"
    return "stops, DOES NOT OPEN" if line.moves else "DOES NOT MOVE"
