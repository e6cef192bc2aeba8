"""What does a flexible panel change? The same latch-up with both models, side by side."""

import orchestrator as fanfold

panel = fanfold.load("workbench", settings={"hinge_line.HL.start_angle": "150 deg", "scene.until": "3 s"})
rigid = fanfold.simulate(panel, rigid="all", save="rigid.h5")
flexible = fanfold.simulate(panel, tolerance=1e-3, save="flexible.h5")

comparison = fanfold.compare(rigid, flexible)
for row in comparison.rows:
    if row.ratio is not None:
        print(f"{row.quantity} of {row.of}: {row.a:.4g} and {row.b:.4g} {row.unit}")

peaks = {
    name: one.headline.latch_torque_peaks["HL"] for name, one in (("rigid", rigid), ("flexible", flexible))
}
figure = flexible.plot("latch_torques")
figure.savefig("latch_torques.png")
page = fanfold.report(flexible, other=rigid, frames=6)
