"""Effects from outside the machine."""

import math

from effects.effect import Effect


class Knocks(Effect):
    """Short pushes on the link at a few times of the training recording; the other recording has none."""

    name, catalogue, timed = "external_disturbance", ("external_disturbance",), True

    def draw(self, rng, setting):
        count = int(rng.integers(1, 4))
        self.times = sorted(rng.uniform(0.15, 0.9, count) * setting.durations["train"])
        self.widths = rng.uniform(0.008, 0.03, count)
        self.heights = rng.uniform(0.5, 1.0, count) * rng.choice([-1.0, 1.0], count)

    def parameters(self, size):
        return {"at_s": [float(t) for t in self.times], "width_s": self.widths.tolist(),
                "peak_nm": (10 * size * self.setting.torque * self.heights).tolist()}

    def hook(self, size, arm, which):
        if which != "train":
            return None
        pushes = [(t, w, 10 * size * self.setting.torque * h) for t, w, h in zip(self.times, self.widths, self.heights)]

        def push(t, dt, e, de, u, du, model):
            return 0.0, sum(h * math.sin(math.pi * (t - at) / w) for at, w, h in pushes if at < t < at + w)
        return push


class Shaker(Effect):
    """A machine next door shakes the link with a steady tone in the training recording; it is off in the other one."""

    name, catalogue, timed = "harmonic_disturbance", ("harmonic_disturbance",), True

    def draw(self, rng, setting):
        self.f, self.phase = rng.uniform(2.0, 25.0), rng.uniform(0, 2 * math.pi)

    def parameters(self, size):
        return {"torque_nm": 0.5 * size * self.setting.torque, "frequency_hz": self.f, "phase_rad": self.phase}

    def hook(self, size, arm, which):
        if which != "train":
            return None
        level, w = 0.5 * size * self.setting.torque, 2 * math.pi * self.f
        return lambda t, dt, e, de, u, du, model: (0.0, level * math.sin(w * t + self.phase))


EFFECTS = [Knocks, Shaker]
