"""A deployment sequencer as a PythonFMU: it opens the inner bolt once the outer line stands at its end."""

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class DeploymentSequencer(Fmi2Slave):
    """Fires a bolt at the `start` time (s), and the next one when `angle` (rad) has passed `deployed`."""

    def __init__(self, **keys):
        super().__init__(**keys)
        self.angle, self.start, self.deployed = 0.0, 0.5, 3.1
        self.fire_outer = self.fire_inner = False
        self.register_variable(Real("angle", causality=Fmi2Causality.input))
        for name in ("start", "deployed"):
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)
            )
        for name in ("fire_outer", "fire_inner"):
            self.register_variable(Boolean(name, causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        """Commands stay once they are given."""
        self.fire_outer |= current_time + step_size >= self.start - 1e-9
        self.fire_inner |= self.angle > self.deployed
        return True
