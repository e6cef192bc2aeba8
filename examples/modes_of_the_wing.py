"""First frequencies of the AMOS-3 wing, stowed and deployed, and what the spacecraft feels when it vibrates."""

import numpy as np

import orchestrator as fanfold

wing = fanfold.load("amos3", "structural_damping")
deployed = fanfold.modes(wing, "deployed", count=6)
for mode in deployed.listed:
    print(f"{mode.frequency:8.3f} Hz, {100 * mode.damping_ratio:.2f} % of critical, most in {mode.body}")

rigid = fanfold.modes(wing, "deployed", rigid="all", count=1)
tuning = fanfold.latch_tuning(wing, "HL1", frequency=deployed.frequencies[0], stiffness_of="total")

response = fanfold.frequency_response(wing, "deployed", excite="z", low=0.2, high=20.0, steps=60)
load = np.abs(response.responses[0].values)
resonance = response.frequencies[np.argmax(load)]
pictures = [*fanfold.plot(response, "pictures"), *fanfold.plot(deployed, "pictures")]
