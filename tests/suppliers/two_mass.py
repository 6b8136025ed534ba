"""The pantograph of pantograph.c for PythonFMU: the same equations, integrated in the same way with longer steps."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

# Longest internal step, s.
SUBSTEP = 5e-4

PARAMETERS = {
    "m1": 7.2,
    "m2": 15.0,
    "k1": 4200.0,
    "k2": 50.0,
    "c1": 10.0,
    "c2": 90.0,
    "static_force": 120.0,
    "reference_height": 5.3,
    "start_height": 5.3,
}


class TwoMass(Fmi2Slave):
    """A collector head on a frame on a base."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name, value in PARAMETERS.items():
            setattr(self, name, value)
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed, start=value)
            )
        self.F_c = 120.0
        self.state = [0.0, 0.0, 0.0, 0.0]
        self.register_variable(Real("F_c", causality=Fmi2Causality.input, start=self.F_c))
        self.register_variable(
            Real("z1", causality=Fmi2Causality.output, getter=lambda: self.reference_height + self.state[0])
        )
        self.register_variable(Real("v1", causality=Fmi2Causality.output, getter=lambda: self.state[2]))

    def exit_initialization_mode(self):
        rise = self.start_height - self.reference_height
        self.state = [rise, (self.static_force + self.k1 * rise) / (self.k1 + self.k2), 0.0, 0.0]

    def rates(self, u):
        spring = self.k1 * (u[0] - u[1]) + self.c1 * (u[2] - u[3])
        return [
            u[2],
            u[3],
            (-spring - self.F_c) / self.m1,
            (spring - self.k2 * u[1] - self.c2 * u[3] + self.static_force) / self.m2,
        ]

    def do_step(self, current_time, step_size):
        count = math.ceil(step_size / SUBSTEP * (1.0 - 1e-9))
        h = step_size / max(count, 1)
        for _ in range(count):
            u = self.state
            slope, total = [0.0] * 4, [0.0] * 4
            for at, weight in ((0.0, 1 / 6), (0.5, 1 / 3), (0.5, 1 / 3), (1.0, 1 / 6)):
                slope = self.rates([u[i] + h * at * slope[i] for i in range(4)])
                total = [total[i] + weight * slope[i] for i in range(4)]
            self.state = [u[i] + h * total[i] for i in range(4)]
        return True
