"""Is every scene that cannot be meant refused with a sentence? Scenes are mutated by seed, checked, and some are run.

    python -m tests.benchmark.faults.scenes [COUNT] [FIRST_SEED]

The built-in scenes and those of the tests are mutated in their tables (values of another kind, size or unit, keys and
entries that are lost, doubled or mistyped; events, friction that sticks, stops, tables of motors and a free base that
they did not have, of any size and at odd times) or in their text. What is accepted is looked at, and one in ten
is run for some steps into a file: no exception but a FanfoldError, no warning of a library, no time beyond all bounds,
no file that cannot be read, and no run that ends complete with values that are no numbers or energy that nobody
accounts for.
"""

from __future__ import annotations

import random
import signal
import tomllib
import traceback
import warnings
from collections.abc import Callable, Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

import orchestrator as fanfold
from orchestrator.scene import find_scene, list_scenes
from tests.benchmark.faults.listing import Fault, main

SLOWEST = 120
"""s; what takes longer hangs."""
_STEPS = 40
"""of a run, about"""
_UNREMARKED = 10.0
"""tolerances that the balance of energy may leave open without a word"""
_SCENES = [find_scene(name) for name in list_scenes()]
_SCENES += sorted(Path(__file__).parents[2].joinpath("scenes").glob("[!l]*.toml"))
Dice = random.Random
_VALUES: tuple[Any, ...] = (
    0, -1, 1e-300, 1e300, float("nan"), float("inf"), "", "nan", "90", "90 deg", "-400 deg", "1e-308 deg", "3 m",
    "1e9 N.m", "5 kg", "1e-12 ms", True, [], {}, [[]], "[/bold]", "\x1b[31m", "é", "a.b", "base", [0, 0, 0],
    ["1 m"] * 3, 10**30, {"name": "x"}, [{"name": "x"}],
)  # fmt: skip


def faults(count: int, first: int, folder: Path, run_every: int = 10) -> Iterator[Fault]:
    """Faults of so many mutated scenes."""
    for seed in range(first, first + count):
        dice = Dice(seed)
        path = folder / "mutated.toml"
        path.write_bytes(mutated(dice))
        variants = dice.choice([(), (), _variants(path)])
        with _bounded():
            what = answer(path, variants, runs=seed % run_every == 0)
        if what:
            yield Fault(seed, what)


def answer(path: Path, variants: tuple[str, ...], runs: bool) -> str:
    """What went wrong with a scene; empty where it was refused with a sentence, or is sound."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            scene = fanfold.load(path, variants)
            found = [fanfold.check_scene(one) for one in scene.runs.values()]
            if runs and not any(one.problems for one in found):
                return _after_a_run(next(iter(scene.runs.values())), path.with_suffix(".h5"))
    except fanfold.FanfoldError as error:
        return "" if str(error).strip() else "an error without a word"
    except TimeoutError:
        return f"took more than {SLOWEST} s"
    except Exception as error:
        return "".join(traceback.format_exception(error)[-3:])
    return ""


def _after_a_run(scene: fanfold.Scene, path: Path) -> str:
    """What went wrong with some steps of a sound scene."""
    checked = scene.check()
    until = _STEPS * min(2e-4, float(checked.header.largest_step))
    path.unlink(missing_ok=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fanfold.FanfoldWarning)
        fanfold.simulate(scene, rigid="all", until=until, estimate=False, save=path)
    result = fanfold.Result.open(path)
    for component in result.components:
        for variable in result.variables(component):
            if not np.all(np.isfinite(result[component, variable][:])):
                return f"complete, and {component}.{variable} has values that are no numbers"
    left = result.headline.energy_residual or 0.0
    told = any("energy" in sentence for sentence in result.warnings)
    if left > _UNREMARKED * checked.header.tolerance and not told:
        return f"complete, with {left:.2g} of the energy unaccounted for, and nothing said"
    return ""


class _bounded:
    """Raise TimeoutError in what takes too long."""

    def __enter__(self) -> None:
        def stop(*_: object) -> None:
            raise TimeoutError

        signal.signal(signal.SIGALRM, stop)
        signal.alarm(SLOWEST)

    def __exit__(self, *_: object) -> None:
        signal.alarm(0)


def _variants(path: Path) -> tuple[str, ...]:
    """A variant of the file, if it can be read and has any."""
    try:
        return tuple(tomllib.loads(path.read_text(encoding="utf-8")).get("variant", {}))[:1]
    except (ValueError, AttributeError, TypeError, RecursionError):
        return ()


def mutated(dice: Dice) -> bytes:
    """The text of a scene with one to three mutations."""
    text = dice.choice(_SCENES).read_text(encoding="utf-8")
    if dice.random() < 0.2:
        return _of_text(dice, text)
    tree = tomllib.loads(text)
    for _ in range(dice.choice((1, 1, 2, 3))):
        _mutate(dice, tree)
    return tomli_w.dumps(tree).encode()


def _of_text(dice: Dice, text: str) -> bytes:
    """Mutations that no tree has: cut, nested, doubled, foreign bytes."""
    at = dice.randrange(len(text))
    return dice.choice(
        (
            text[:at].encode(),
            text.encode()[:at] + bytes([dice.randrange(256)]) + text.encode()[at:],
            f"{text}\nx = {'[' * 3000}{']' * 3000}\n".encode(),
            (text + text[text.rindex("[[") :] if "[[" in text else text).encode(),
            text.replace(dice.choice(text.split()), "", 1).encode(),
        )
    )


def _mutate(dice: Dice, tree: dict[str, Any]) -> None:
    """One change somewhere in the tree: most often another size, which leaves a scene that can be run."""
    places = list(_places(tree))
    sizes = [(holder, key) for holder, key in places if _is_size(holder[key])]
    if sizes and dice.random() < 0.7:
        holder, key = dice.choice(sizes)
        holder[key] = _resized(dice, holder[key])
        return
    if dice.random() < 0.5:
        dice.choice(_ADDITIONS)(dice, tree)
        return
    holder, key = dice.choice(places)
    kind, value = dice.randrange(4), holder[key]
    if kind == 0:
        del holder[key]
    elif kind == 1 and isinstance(holder, list):
        holder.append(deepcopy(value))
    elif kind == 2 and isinstance(holder, dict):
        holder[f"{key}{dice.choice('xyz')}"] = holder.pop(key)
    else:
        holder[key] = dice.choice(_VALUES)


def _add_event(dice: Dice, tree: dict[str, Any]) -> None:
    """An event at an odd time or of an odd value, on whatever has a name."""
    named = [
        entry["name"]
        for key in ("hinge_line", "connection", "ccl", "damper", "body")
        for entry in _entries(tree, key)
        if isinstance(entry.get("name"), str)
    ]
    events = tree.setdefault("event", [])
    if not isinstance(events, list) or not named:
        return
    event: dict[str, Any] = {"name": f"added_{len(events)}"}
    if dice.random() < 0.6:
        event["time"] = dice.choice(_TIMES)
    else:
        side, value = dice.choice(("above", "below")), dice.choice((0, 1e-9, "1e-6 deg", -1, 1e300, "3 N"))
        event["when"] = {
            "component": dice.choice(named),
            "variable": dice.choice(_OBSERVED),
            side: value,
        }
    if dice.random() < 0.4:
        event["release"] = [dice.choice(named)]
    if dice.random() < 0.7:
        value = dice.choice((0, 0, 1, 1, -1, 1e-6, 1e9, 1e300, "2 N.m", [0, 0, 1]))
        event["set"] = {dice.choice(named): {dice.choice(_SET): value}}
    events.append(event)


def _add_to_line(dice: Dice, tree: dict[str, Any]) -> None:
    """What a hinge line may have and this one does not."""
    if lines := _entries(tree, "hinge_line"):
        key, make = dice.choice(_OF_LINES)
        dice.choice(lines)[key] = make(dice)


def _add_free_base(dice: Dice, tree: dict[str, Any]) -> None:
    """A free spacecraft, of a sound mass or not."""
    if isinstance(tree.get("base"), dict):
        tree["base"]["free"] = {
            "mass": 1200 * _factor(dice),
            "center_of_mass": [-1.0 * _factor(dice), 0.0, 0.0],
            "inertia": [800 * _factor(dice), 900, 700],
        }


def _entries(tree: dict[str, Any], key: str) -> list[dict[str, Any]]:
    found = tree.get(key)
    return [entry for entry in found if isinstance(entry, dict)] if isinstance(found, list) else []


def _factor(dice: Dice) -> float:
    return dice.choice((1.0, 1.0, 1.0, 0.1, 10.0, 0.0, -1.0, 1e-6, 1e6, 1e200))


_TIMES = (0, "0 s", 1e-12, 1e-9, 1e-5, "1 ms", "1 ms", "4 ms", "4.0000000001 ms", 0.02, 5.0, 1e9, 1e300, -1)
_OBSERVED = ("angle", "angular_rate", "latch_torque", "motor_torque", "tension_a", "contact_force",
             "interface_force[1]", "force[3]", "frame_position[2]", "stored_energy")  # fmt: skip
_SET = ("motor_stiffness", "motor_constant_torque", "latch_command", "failure_command", "latch_stiffness", "gravity",
        "friction_coefficient", "friction_preload", "presliding_stiffness", "preload", "strand_stiffness", "damping",
        "reference_force", "translational_stiffness", "latch_damping", "stiction_velocity")  # fmt: skip
_OF_LINES: tuple[tuple[str, Callable[[Dice], Any]], ...] = (
    ("presliding", lambda dice: {"stiffness": 10.0 ** dice.randrange(-2, 13)}),
    ("presliding", lambda dice: {"stiffness": 2e4, "damping": _factor(dice)}),
    ("friction_preload", lambda dice: 0.1 * _factor(dice)),
    ("end_stop", lambda dice: {"stiffness": 2e4 * _factor(dice), "damping": 50 * _factor(dice)}),
    ("end_stop", lambda dice: {"stiffness": 2e4, "angle": f"{100 * _factor(dice)} deg"}),
    ("latch", lambda dice: {"stiffness": 2000 * _factor(dice)}),
    (
        "motor",
        lambda dice: {
            "angle": ["0 deg", f"{90 * _factor(dice)} deg"],
            "torque": [1.5 * _factor(dice), 1.0],
            "closing_torque": [1.6, 1.1 * _factor(dice)],
        },
    ),
    (
        "harness",
        lambda dice: {"angle": ["0 deg", "90 deg"], "resisting_torque": [0.1 * _factor(dice), -0.1]},
    ),
    ("start_angle", lambda dice: f"{30 * _factor(dice)} deg"),
    ("held", lambda dice: True),
)
_ADDITIONS = (_add_event, _add_event, _add_to_line, _add_to_line, _add_free_base)


def _is_size(value: object) -> bool:
    """Whether a value is a number, or one with a unit."""
    if isinstance(value, str):
        return value.partition(" ")[0].replace(".", "").lstrip("-").isdigit()
    return isinstance(value, int | float) and not isinstance(value, bool)


def _resized(dice: Dice, value: Any) -> Any:
    """A size of another order or sign, or without its unit."""
    factor = dice.choice((0.5, 0.8, 0.95, 1.05, 1.2, 2.0, 0.1, 10.0, 0, -1, 1e-6, 1e3, 1e9, 1e200))
    if not isinstance(value, str):
        return value * factor
    number, _, unit = value.partition(" ")
    return dice.choice((*[f"{float(number) * factor!r} {unit}"] * 8, number, f"{number} {unit}x"))


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every table or list with every key or position of it."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in list(items):
        yield value, key
        yield from _places(inner)


if __name__ == "__main__":
    main(faults, "mutated scenes", 3000)
