"""The controller of examples/own-controller for PythonFMU: the same equations in the same order."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

PARAMETERS = {"kp": 0.5, "ki": 0.0, "kd": 0.0, "derivative_lag": 0.0, "limit": 100.0}


class Pid(Fmi2Slave):
    """PID controller of the contact force."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name, value in PARAMETERS.items():
            setattr(self, name, value)
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed, start=value)
            )
        self.F, self.F_desired, self.u = 0.0, 0.0, 0.0
        self.integral, self.derivative, self.error = 0.0, 0.0, None
        for name in ("F", "F_desired"):
            self.register_variable(Real(name, causality=Fmi2Causality.input, start=0.0))
        self.register_variable(Real("u", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        ki, kd = self.ki * step_size, self.kd / step_size
        kept = math.exp(-step_size / self.derivative_lag) if self.derivative_lag > 0.0 else 0.0
        error = self.F_desired - self.F
        change = kd * (error - (error if self.error is None else self.error))
        self.derivative = kept * self.derivative + (1.0 - kept) * change
        self.error = error
        rest = self.kp * error + self.derivative
        integral = self.integral + ki * error
        if not (abs(rest + integral) > self.limit and (rest + integral) * error > 0.0):
            self.integral = integral
        self.u = max(-self.limit, min(self.limit, rest + self.integral))
        return True
