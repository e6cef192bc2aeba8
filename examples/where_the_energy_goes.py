"""Where does the energy of the motors go? Every cause on its own account, and the balance that checks them."""

import numpy as np

import orchestrator as fanfold

result = fanfold.simulate("amos3", rigid="all", tolerance=1e-3, estimate=False)
latch_up = max(result.latch_times.values())

released = sum(result[hinge, "motor_energy"].at(latch_up) for hinge in result.recording("motor_energy"))
heat = {}
for component in result.recording("dissipated_energy"):
    if component != "scene":
        energy = result[component, "dissipated_energy"]
        heat[component] = float(energy.at(latch_up) - energy[0])
for component, joules in sorted(heat.items(), key=lambda item: -item[1])[:5]:
    print(f"{component:>12}: {joules:7.3f} J, {joules / released:.1%} of what the motors released")

residual = float(np.max(np.abs(result["scene", "energy_residual"])))
print(f"the balance is off by {residual:.2g} J of {released:.3f} J")
figure = result.plot("energy_balance")
figure.savefig("energy.png")
