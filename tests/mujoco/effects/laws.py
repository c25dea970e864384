"""Laws that no catalogue has and that have one coordinate, as torques on the joint: a curve over it could be learned."""

import math

from effects.effect import Effect, log_uniform
from effects.slider import Slider


class LocalDamper(Effect):
    """A damper across the joint that acts near one position of the motor: c exp(-((u - p) / w)^2 / 2) e'."""

    place, name, high = "transmission", "local_damper", 6.0
    start = 0.5

    def draw(self, rng, setting):
        self.at = setting.arm.home + rng.uniform(0.1, 0.9) * setting.reach
        self.width = setting.reach * rng.uniform(0.03, 0.15)

    def parameters(self, size):
        return {"c": size * self.setting.torque / self.setting.rate, "at_rad": self.at, "width_rad": self.width}

    def hook(self, size, arm, which):
        c, dof = size * self.setting.torque / self.setting.rate, []

        def damp(t, dt, e, de, u, du, model):
            if not dof:
                dof.append(model.joint("flex").dofadr[0])
            # By the engine's own damping; not while the arm settles, when the clock stands.
            if t > dt:
                model.dof_damping[dof[0]] = arm.damping + c * math.exp(-0.5 * ((u - self.at) / self.width) ** 2)
            return 0.0, 0.0
        return damp


class EvenSpring(Effect):
    """A torque -c |e|^n that has the same sign on both sides; with n = 1 it would be the catalogue's one-sided spring."""

    place, name, high = "transmission", "even_spring", 0.4

    def draw(self, rng, setting):
        self.power, self.sign = float(rng.choice([2.0, 2.0, 3.0])), float(rng.choice([-1.0, 1.0]))

    def parameters(self, size):
        return {"c": self.sign * size * self.setting.torque / self.setting.peak ** self.power, "power": self.power}

    def hook(self, size, arm, which):
        c, power = self.parameters(size)["c"], self.power
        return lambda t, dt, e, de, u, du, model: (-c * abs(e) ** power, 0.0)


class SofteningSpring(Effect):
    """The joint's spring bends like an arc tangent: k d atan(e / d) in place of k e."""

    place, name, start, low, high = "transmission", "softening_spring", 0.5, 0.05, 0.9

    def parameters(self, size):
        return {"bend_rad": self.setting.peak / size}

    def hook(self, size, arm, which):
        k, d = arm.stiffness, self.setting.peak / size
        return lambda t, dt, e, de, u, du, model: (k * (e - d * math.atan(e / d)), 0.0)


class PowerFriction(Effect):
    """-c sign(e') |e'|^n, linear below a hundredth of the typical rate."""

    place, name, high = "transmission", "power_friction", 1.0

    def draw(self, rng, setting):
        self.power = float(rng.choice([rng.uniform(0.4, 0.75), rng.uniform(1.3, 1.6)]))

    def parameters(self, size):
        return {"c": size * self.setting.torque / self.setting.rate ** self.power, "power": self.power,
                "linear_below_rad_s": 0.01 * self.setting.rate}

    def hook(self, size, arm, which):
        c, n, small = self.parameters(size).values()
        return lambda t, dt, e, de, u, du, model: (-c * de * math.hypot(de, small) ** (n - 1), 0.0)


class MaxwellSlip(Effect):
    """Three to five springs side by side that each slide at a torque of their own."""

    place, name = "transmission", "maxwell_slip_friction"

    def draw(self, rng, setting):
        self.shares = rng.dirichlet([2.0] * int(rng.integers(3, 6)))
        self.lengths = sorted(setting.peak * log_uniform(rng, 0.03, 1.0) for _ in self.shares)

    def parameters(self, size):
        return {"levels_nm": (size * self.setting.torque * self.shares).tolist(), "lengths_rad": self.lengths}

    def hook(self, size, arm, which):
        levels = (size * self.setting.torque * self.shares).tolist()
        sliders = [Slider(level, length, 5e-4) for level, length in zip(levels, self.lengths)]
        return lambda t, dt, e, de, u, du, model: (-sum(slider.torque(de, dt) for slider in sliders), 0.0)


class PeriodicForce(Effect):
    """A torque on the link that repeats with its position, with four harmonics of about the same size."""

    place, name = "link", "periodic_force"

    def draw(self, rng, setting):
        self.order = log_uniform(rng, 4.0, 20.0)
        self.heights, self.phases = rng.uniform(0.6, 1.0, 4).tolist(), rng.uniform(0, 2 * math.pi, 4).tolist()

    def parameters(self, size):
        return {"torque_nm": size * self.setting.torque, "cycles_per_rad": self.order, "heights": self.heights,
                "phases_rad": self.phases}

    def hook(self, size, arm, which):
        waves = [(size * self.setting.torque * h, (k + 1) * self.order, p)
                 for k, (h, p) in enumerate(zip(self.heights, self.phases))]
        return lambda t, dt, e, de, u, du, model: (0.0, sum(h * math.sin(n * (u + e) + p) for h, n, p in waves))


EFFECTS = [LocalDamper, EvenSpring, SofteningSpring, PowerFriction, MaxwellSlip, PeriodicForce]
