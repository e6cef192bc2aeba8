"""How much later does every line latch with more friction in the hinges? A sweep of 20 values and its picture."""

import matplotlib.pyplot as plt
import numpy as np

import orchestrator as fanfold

frictions, wing = np.linspace(0.0, 0.2, 20), fanfold.load("amos3", settings={"scene.tolerance": 1e-3})
runs = [fanfold.simulate(wing.with_settings({"friction.coefficient": f}), rigid="all") for f in frictions]
axes = plt.figure().add_subplot(xlabel="friction coefficient", ylabel="latch-up, s")
axes.plot(frictions, [list(run.latch_times.values()) for run in runs], "o-", label=wing.hinge_lines)
axes.legend().figure.savefig("latch_times.png")
