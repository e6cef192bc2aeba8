"""An attitude controller as a PythonFMU, which knows nothing of the wing: a proportional and derivative law."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class AttitudeController(Fmi2Slave):
    """torque = -(stiffness angle + damping rate), within what reaction wheels can give."""

    def __init__(self, **keys):
        super().__init__(**keys)
        self.angle = self.rate = self.torque = 0.0
        self.stiffness, self.damping, self.largest = 200.0, 560.0, 2.0
        for name in ("angle", "rate"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("stiffness", "damping", "largest"):
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
            )
        self.register_variable(Real("torque", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        """Sample the law."""
        wanted = -(self.stiffness * self.angle + self.damping * self.rate)
        self.torque = max(-self.largest, min(self.largest, wanted))
        return True
