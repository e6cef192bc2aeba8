"""Torque margin by GEVS from measured friction and motor torques, over the temperature of the wing."""

import orchestrator as fanfold


def measured(*values):
    """Columns of a test at three temperatures."""
    return {"temperature": ["-80 C", "-20 C", "40 C"], "value": list(values)}


wing = fanfold.load("bepicolombo").with_settings(
    {
        "hinge_line.HL2.friction_preload": measured("0.20 N.m", "0.12 N.m", "0.10 N.m"),
        "hinge_line.HL2.motor.stowed": measured("2.25 N.m", "2.29 N.m", "2.304 N.m"),
    }
)
margins = {}
for temperature in ("-80 C", "-50 C", "20 C"):
    scene = wing.with_settings({"scene.temperature": temperature})
    found = fanfold.torque_margin(scene, cases=["base"], gevs="critical", friction="constant", positions=2)
    rule = next(one for one in found.lines[0].margins if one.rule == "GEVS")
    margins[temperature] = float(rule.margin[rule.worst])
    print(f"{temperature:>6}: margin {margins[temperature]:.3f}, {'passes' if rule.passes else 'fails'}")
