"""Named effects whose law has not the textbook's shape."""

import math

from effects.effect import Effect, log_uniform
from effects.slider import Slider


class CompliantFriction(Effect):
    """Dry friction whose contact is a spring and a damper (Kelvin and Voigt) that bends before it slides."""

    place, name, catalogue = "transmission", "compliant_friction", ("coulomb_friction",)
    shape = "over a contact with compliance"

    def draw(self, rng, setting):
        self.length, self.tau = setting.peak * log_uniform(rng, 0.01, 0.1), log_uniform(rng, 5e-4, 4e-3)

    def parameters(self, size):
        return {"friction_nm": size * self.setting.torque, "contact_deflection_rad": self.length, "contact_time_s": self.tau}

    def hook(self, size, arm, which):
        slider = Slider(size * self.setting.torque, self.length, self.tau)
        return lambda t, dt, e, de, u, du, model: (-slider.torque(de, dt), 0.0)


class RoundBacklash(Effect):
    """A gap whose flanks set in gradually: each pushes k r ln(1 + exp((|e| - gap) / r))."""

    place, name, catalogue, timestep, high = "transmission", "round_backlash", ("backlash",), 1e-4, 0.5
    shape = "with round edges"

    def draw(self, rng, setting):
        self.round = rng.uniform(0.15, 0.5)

    def parameters(self, size):
        gap = size * self.setting.peak
        return {"round_gap_rad": 2.0 * gap, "edge_rad": self.round * gap}

    def hook(self, size, arm, which):
        gap, k, d = size * self.setting.peak, arm.stiffness, arm.damping
        r = self.round * gap

        def flank(depth):
            """Compression of one flank, and its slope."""
            x = depth / r
            if abs(x) > 30:
                return (depth, 1.0) if x > 0 else (0.0, 0.0)
            return r * math.log1p(math.exp(x)), 1.0 / (1.0 + math.exp(-x))

        def force(t, dt, e, de, u, du, model):
            (up, up_slope), (down, down_slope) = flank(e - gap), flank(-e - gap)
            return k * (e - up + down) + d * de * (1.0 - up_slope - down_slope), 0.0
        return force


class TransmissionHarmonics(Effect):
    """A transmission error with its second and third harmonic."""

    place, name, catalogue, high = "transmission", "transmission_harmonics", ("transmission_ripple",), 0.5
    shape = "with harmonics"

    def draw(self, rng, setting):
        first = log_uniform(rng, 12, 30)
        heights = [1.0, rng.uniform(0.25, 0.6), rng.uniform(0.1, 0.35)]
        self.waves = [(h, (k + 1) * first, rng.uniform(0, 2 * math.pi)) for k, h in enumerate(heights)]

    def parameters(self, size):
        return {"amp_rad": size * self.setting.peak, "cycles_per_rad": self.waves[0][1],
                "heights": [h for h, _, _ in self.waves], "phases_rad": [p for _, _, p in self.waves]}

    def hook(self, size, arm, which):
        a, k, d, waves = size * self.setting.peak, arm.stiffness, arm.damping, self.waves
        return lambda t, dt, e, de, u, du, model: (
            a * sum(h * (k * math.sin(n * u + p) + d * n * du * math.cos(n * u + p)) for h, n, p in waves), 0.0)


class FifthOrderStiffness(Effect):
    """A spring with a cubic and a fifth-order term, of one sign or of two."""

    place, name, catalogue, high = "transmission", "fifth_order_stiffness", ("cubic_stiffness",), 0.8
    shape = "with a term of fifth order"

    def draw(self, rng, setting):
        self.third = float(rng.choice([1.0, -0.3]))
        self.fifth = rng.uniform(0.5, 1.5)

    def parameters(self, size):
        torque, peak = size * self.setting.torque, self.setting.peak
        return {"third_order": self.third * torque / peak ** 3, "fifth_order": self.fifth * torque / peak ** 5}

    def hook(self, size, arm, which):
        k3, k5 = self.parameters(size).values()
        return lambda t, dt, e, de, u, du, model: (-(k3 + k5 * e * e) * e ** 3, 0.0)


EFFECTS = [CompliantFriction, RoundBacklash, TransmissionHarmonics, FifthOrderStiffness]
