"""How much later does every line latch with more friction in the hinges? A sweep of 20 values and its picture."""

import matplotlib.pyplot as plt

import orchestrator as fanfold

frictions, wing = [0.01 * k for k in range(20)], fanfold.load("amos3", settings={"scene.tolerance": 1e-2})
wings = [wing.with_settings({"friction.coefficient": friction}) for friction in frictions]
runs = [fanfold.simulate(one, rigid="all", estimate=False) for one in wings]
axes = plt.figure().add_subplot(xlabel="friction coefficient", ylabel="latch-up, s")
axes.plot(frictions, [list(run.latch_times.values()) for run in runs], "o-", label=wing.hinge_lines)
axes.legend().figure.savefig("latch_times.png")
