"""A slider-crank with a controlled motor, for an FMU by pythonfmu: a massless rod, the mass at the slider, ideal joints. A controller
holds the speed of the crank."""

from math import asin, cos, pi, sin, sqrt

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

CRANK, ROD, MASS, INERTIA = 0.02, 0.08, 0.5, 1e-4
SPEED, GAIN = 20 * pi, 0.05


class SliderCrank(Fmi2Slave):
    author = "Hingewise"
    description = "slider-crank with a controlled motor"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.angle, self.speed, self.load = 0.0, SPEED, 5.0
        self.pin_fx = self.pin_fy = self.pin_turn = self.torque = 0.0
        self.register_variable(Real("load", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))
        for name in ("pin_fx", "pin_fy", "pin_turn", "torque", "speed"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def exit_initialization_mode(self):
        self.measure()

    def slope(self, angle):
        """Position of the slider by the angle of the crank: first and second derivative [m/rad, m/rad^2]."""
        s, c = sin(angle), cos(angle)
        root = sqrt(ROD**2 - (CRANK * s) ** 2)
        first = -CRANK * s - CRANK**2 * s * c / root
        second = -CRANK * c - CRANK**2 * (c * c - s * s) / root - CRANK**4 * (s * c) ** 2 / root**3
        return first, second

    def acceleration(self, angle, speed):
        """Angular acceleration of the crank, and force of the slider along its guide [N]."""
        first, second = self.slope(angle)
        self.torque = GAIN * (SPEED - speed)
        alpha = (self.torque - self.load * first - MASS * first * second * speed**2) / (INERTIA + MASS * first**2)
        return alpha, MASS * (first * alpha + second * speed**2) + self.load

    def measure(self):
        """Force of the crank on the rod in the rod's frame: along the rod, which has no mass."""
        _, along_guide = self.acceleration(self.angle, self.speed)
        rod = -asin(CRANK * sin(self.angle) / ROD)
        self.pin_fx, self.pin_fy = along_guide / cos(rod), 0.0
        self.pin_turn = self.angle - rod

    def do_step(self, current_time, step_size):
        for _ in range(4):
            h = step_size / 4
            middle = self.angle + 0.5 * h * self.speed
            alpha, _ = self.acceleration(middle, self.speed)
            alpha, _ = self.acceleration(middle, self.speed + 0.5 * h * alpha)
            self.angle += h * (self.speed + 0.5 * h * alpha)
            self.speed += h * alpha
        self.measure()
        return True
