"""How surely does the wing latch in time? Motor torques and friction are drawn at random."""

import orchestrator as fanfold

found = fanfold.study(
    "amos3",
    {
        "friction.coefficient": "uniform(0.05, 0.15)",
        "hinge_line.HL1.motor.stowed,hinge_line.HL1.motor.deployed*": "normal(1, 0.03)",
    },
    runs=8,
    until="13 s",
    tolerance=1e-2,
    rigid="all",
)
low, median, high = found.quantiles("latch_time.HL1")
print(f"HL1 latches at {median:.2f} s, between {low:.2f} and {high:.2f} s in 90 % of all cases")
print(found.wing_not_opening())
