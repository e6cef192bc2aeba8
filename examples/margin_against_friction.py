"""How much friction does the torque margin allow, and does the array open when it was stopped halfway? By bisection."""

import orchestrator as fanfold

array = fanfold.load("bepicolombo")


def passes(friction):
    """Whether HL2 keeps a margin of 2 with this friction torque (N.m)."""
    scene = array.with_settings({"hinge_line.HL2.friction_preload": friction})
    return fanfold.torque_margin(scene, cases=["base"], friction="constant", positions=5).passes


low, high = 0.0, 0.16
for _ in range(5):
    middle = 0.5 * (low + high)
    low, high = (middle, high) if passes(middle) else (low, middle)

margin = fanfold.torque_margin(array, positions=5)
pictures = fanfold.plot(margin, "margins")
for found in margin.lines:
    for rule in found.margins:
        print(f"{found.line}, {found.case}, {rule.rule}: {rule.margin[rule.worst]:.3f}")

(restart,) = fanfold.restart(array, ["50%"], cases=["cold"])
opens = {line.line: line.opens for line in restart.lines}
print(f"friction up to {low:.3f} N.m; opens from the middle: {opens}")
