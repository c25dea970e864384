"""Effects in the measuring chain of the output sensor."""

import numpy as np

from effects.effect import POSITION_ROLES, Effect, log_uniform


class ClockSkew(Effect):
    """The sensor's clock runs fast or slow."""

    name, catalogue, timed = "clock_skew", ("clock_skew",), True

    def draw(self, rng, setting):
        self.sign = float(rng.choice([-1.0, 1.0]))

    def parameters(self, size):
        return {"skew": self.sign * size * 1e-3}

    def change_chain(self, size, chain):
        skew = self.sign * size * 1e-3
        chain.clock.append(lambda t: t + skew * (t - chain.clock_offset))


class SensorDelay(Effect):
    """The sensor reports late: nothing but a large clock offset to whoever has no other sensor."""

    name, catalogue, equivalents, sized = "sensor_delay", ("sensor_delay",), ("clock_offset", "none"), False

    def draw(self, rng, setting):
        self.start = rng.uniform(0.004, 0.02)

    def parameters(self, size):
        return {"delay_s": size}

    def change_chain(self, size, chain):
        chain.clock.append(lambda t: t - size)


class SensorLag(Effect):
    """A low-pass of first or second order in the sensor."""

    name, catalogue, high = "sensor_lag", ("sensor_lag",), 0.3

    def draw(self, rng, setting):
        self.order, self.zeta = int(rng.choice([1, 1, 2])), rng.uniform(0.5, 0.9)
        if self.order == 2:
            self.equivalents = ("sensor_lag_second_order",)

    def parameters(self, size):
        return {"tau_s": 0.2 * size, "order": self.order} | ({"zeta": self.zeta} if self.order == 2 else {})

    def change_chain(self, size, chain):
        tau = 0.2 * size
        if self.order == 1:
            chain.lags.append(([1.0], [tau, 1.0]))
        else:      # the same delay at low frequency: 2 zeta / w0 = tau
            w0 = 2 * self.zeta / tau
            chain.lags.append(([w0 * w0], [1.0, 2 * self.zeta * w0, w0 * w0]))


class SensorGain(Effect):
    """The sensor's scale is wrong."""

    name, catalogue, equivalents = "sensor_gain", ("sensor_gain",), ("misalignment", "gravity_load")

    def draw(self, rng, setting):
        self.sign = float(rng.choice([-1.0, 1.0]))
        self.unit = {"tip_position": 0.01, "deformation": 1.0, "tip_acceleration": 1.0}[setting.role]
        if setting.role != "tip_position":
            self.equivalents = ("deformation_gain",)

    def parameters(self, size):
        return {"gain": 1 + self.sign * size * self.unit}

    def change_chain(self, size, chain):
        gain = 1 + self.sign * size * self.unit
        chain.static.append(lambda values, run: gain * values)


class Misalignment(Effect):
    """Skewed axes of a tracker; for a direct channel, a share of the motor's circle that leaks into the deformation."""

    name, catalogue, equivalents = "misalignment", ("misalignment",), ("sensor_gain", "gravity_load")

    def draw(self, rng, setting):
        self.axes = rng.standard_normal((3, 3))
        self.axes -= self.axes.T * 0.5
        self.axes /= np.linalg.norm(self.axes)
        self.phase = rng.uniform(0, 2 * np.pi)

    def parameters(self, size):
        if self.setting.role == "tip_position":
            return {"skew_matrix": (0.02 * size * self.axes).round(9).tolist()}
        if self.setting.role == "deformation":
            return {"leak_rad": 2 * size * self.setting.peak, "phase_rad": self.phase}
        return {"angle_rad": size}

    def change_chain(self, size, chain):
        peak = self.setting.peak

        def skew(values, run):
            if chain.role == "tip_position":
                return values + values @ (0.02 * size * self.axes).T
            if chain.role == "deformation":
                return values + 2 * size * peak * np.sin(run.motor + self.phase)[:, None]
            # An accelerometer that is turned about the vertical also feels the pull towards the axis.
            rate = np.gradient(run.angle, run.time)
            pull = self.setting.arm.lever * rate ** 2
            return np.cos(size) * values + np.sin(size) * pull[:, None]
        chain.static.append(skew)


class SensorDrift(Effect):
    """The sensor's zero wanders: linearly, towards a limit, or slowly to and fro."""

    name, catalogue, timed, roles = "sensor_drift", ("sensor_drift",), True, POSITION_ROLES

    def draw(self, rng, setting):
        self.kind = str(rng.choice(["linear", "warming", "slow_wave"]))
        self.period = {"linear": setting.durations["train"], "warming": rng.uniform(1.0, 4.0),
                       "slow_wave": rng.uniform(4.0, 12.0)}[self.kind]
        self.phase = rng.uniform(0, 2 * np.pi)
        self.direction = rng.standard_normal(3) * [1, 1, 0.3]
        self.direction /= np.linalg.norm(self.direction)
        if setting.role == "deformation":
            self.direction = np.ones(1)

    def amplitude(self, size):
        """How far the zero goes, in the unit of the sensor."""
        return size * (1e-3 if self.setting.role == "tip_position" else self.setting.peak)

    def parameters(self, size):
        return {"kind": self.kind, "amplitude": self.amplitude(size), "time_s": self.period,
                "direction": self.direction.round(6).tolist()}

    def change_chain(self, size, chain):
        shape = {"linear": lambda t: t / self.period, "warming": lambda t: -np.expm1(-np.maximum(t, 0) / self.period),
                 "slow_wave": lambda t: np.sin(2 * np.pi * t / self.period + self.phase)}[self.kind]
        chain.drift.append(lambda t: self.amplitude(size) * np.outer(shape(t), self.direction))


class MissingSamples(Effect):
    """Samples are lost in bursts; the stamps of the others are right, so nothing is wrong with the model."""

    name, catalogue, equivalents, sized = "missing_samples", ("missing_samples",), ("none",), False

    def draw(self, rng, setting):
        self.start = log_uniform(rng, 0.03, 0.25)
        self.burst = int(rng.integers(1, 30))

    def parameters(self, size):
        return {"share": size, "burst": self.burst}

    def change_chain(self, size, chain):
        def keep(rng, count):
            mask = np.ones(count, bool)
            for start in rng.integers(0, count, max(1, int(size * count / self.burst))):
                mask[start:start + self.burst] = False
            return mask
        chain.drop.append(keep)


EFFECTS = [ClockSkew, SensorDelay, SensorLag, SensorGain, Misalignment, SensorDrift, MissingSamples]
