"""How much later does every line latch with more friction in the hinges? A sweep of 20 values and its picture."""

import matplotlib.pyplot as plt

import orchestrator as fanfold

vary = {"friction.coefficient": "uniform(0, 0.19)"}
sweep = fanfold.study("amos3", vary, method="grid", levels=20, rigid="all", until="12 s", tolerance=1e-2)
axes = plt.figure().add_subplot(xlabel="friction coefficient", ylabel="latch-up, s")
for line in ("HL1", "HL2", "HL3"):
    axes.plot(sweep.parameters["friction.coefficient"], sweep.numbers[f"latch_time.{line}"], "o-", label=line)
axes.legend().figure.savefig("latch_times.png")
