"""Effects that no catalogue has: a diagnosis should say that it does not know them, or name a near equivalent."""

import math

import numpy as np

from effects.effect import Effect, log_uniform


class RootSpeedFriction(Effect):
    """-c sign(e') sqrt(|e'|) across the joint."""

    place = "transmission"
    name = "root_speed_friction"

    def parameters(self, size):
        return {"c": size * self.setting.torque / math.sqrt(self.setting.rate)}

    def hook(self, size, arm, which):
        c, small = self.parameters(size)["c"], 1e-4 * self.setting.rate
        # sqrt is linear below `small`, so that the damping at rest stays finite
        return lambda t, dt, e, de, u, du, model: (-c * de / math.sqrt(max(abs(de), small)), 0.0)


class Detents(Effect):
    """Magnet-like places that pull the link towards them, unevenly spaced, of unequal strength and of a skewed shape."""

    place = "link"
    name = "position_detents"

    def draw(self, rng, setting):
        count = int(rng.integers(3, 8))
        self.places = setting.arm.home + np.sort(rng.uniform(-0.1, 1.1, count)) * setting.reach
        self.strengths, self.skew = rng.uniform(0.3, 1.0, count), rng.uniform(-0.8, 0.8)
        self.width = log_uniform(rng, 0.01, 0.04)

    def parameters(self, size):
        return {"places_rad": self.places.tolist(), "peak_nm": (3 * size * self.setting.torque * self.strengths).tolist(),
                "width_rad": self.width, "skew": self.skew}

    def hook(self, size, arm, which):
        wells = [(p, 3 * size * self.setting.torque * s) for p, s in zip(self.places.tolist(), self.strengths.tolist())]

        def pull(t, dt, e, de, u, du, model):
            total = 0.0
            for place, strength in wells:
                x = (u + e - place) / self.width
                if abs(x) < 5:
                    total -= strength * (x + self.skew * x * x) * math.exp(-0.5 * x * x)
            return 0.0, total
        return pull


class RateDependentStiffness(Effect):
    """The joint is stiffer while the motor turns fast."""

    place = "transmission"
    name = "rate_dependent_stiffness"

    def draw(self, rng, setting):
        self.speed = rng.uniform(0.1, 0.5)

    def parameters(self, size):
        return {"relative_change": size, "speed_rad_s": self.speed}

    def hook(self, size, arm, which):
        k = size * arm.stiffness
        return lambda t, dt, e, de, u, du, model: (-k * e * math.tanh((du / self.speed) ** 2), 0.0)


class FadingDamping(Effect):
    """The joint's damping changes by a factor while the recording runs (a lubricant that warms)."""

    place = "transmission"
    name, timed, start, high = "fading_damping", True, 1.0, 8.0

    def draw(self, rng, setting):
        self.constant = rng.uniform(1.0, 3.0)

    def parameters(self, size):
        return {"relative_change": size, "time_constant_s": self.constant}

    def hook(self, size, arm, which):
        return lambda t, dt, e, de, u, du, model: (
            -arm.damping * de * size * -math.expm1(-t / self.constant), 0.0)


class PatchFriction(Effect):
    """Dry friction only in a part of the travel (a scored bearing), by the engine's friction constraint."""

    place = "transmission"
    name, timestep, integrator = "patch_friction", 5e-5, "implicitfast"

    def draw(self, rng, setting):
        low = rng.uniform(0.1, 0.5)
        self.low, self.high_end = (setting.arm.home + setting.reach * x for x in (low, low + rng.uniform(0.2, 0.4)))

    def parameters(self, size):
        return {"friction_nm": size * self.setting.torque, "from_rad": self.low, "to_rad": self.high_end}

    def change_arm(self, size, arm):
        arm.friction = size * self.setting.torque
        arm.friction_solver = 'solreffriction="0.0002 1" solimpfriction="0.999 0.999 0.001"'

    def hook(self, size, arm, which):
        level, dof = size * self.setting.torque, []

        def patch(t, dt, e, de, u, du, model):
            if not dof:
                dof.append(model.joint("flex").dofadr[0])
            model.dof_frictionloss[dof[0]] = level if self.low < u < self.high_end else 0.0
            return 0.0, 0.0
        return patch


class WorkSoftening(Effect):
    """The joint softens with the distance that it has worked, as filled rubber does (Mullins)."""

    place = "transmission"
    name, timed, high = "work_softening", True, 1.0

    def parameters(self, size):
        return {"relative_change": min(0.6, size), "after_rad": 10 * self.setting.peak}

    def hook(self, size, arm, which):
        worked, k, scale = 0.0, min(0.6, size) * arm.stiffness, 10 * self.setting.peak

        def soften(t, dt, e, de, u, du, model):
            nonlocal worked
            worked += abs(de) * dt
            return k * e * -math.expm1(-worked / scale), 0.0
        return soften


class OneWayDamper(Effect):
    """A damper that works in one direction only."""

    place = "transmission"
    name = "one_way_damper"

    def parameters(self, size):
        return {"c": 2 * size * self.setting.torque / self.setting.rate}

    def hook(self, size, arm, which):
        c = self.parameters(size)["c"]
        return lambda t, dt, e, de, u, du, model: (-c * de if de > 0 else 0.0, 0.0)


class ClockJump(Effect):
    """The sensor's clock slips by some milliseconds at one or two times, and its stamps do not tell."""

    place = "sensor"
    name, timed = "clock_jump", True

    def draw(self, rng, setting):
        count = int(rng.integers(1, 3))
        self.times = np.sort(rng.uniform(0.2, 0.8, count)) * setting.durations["train"]
        self.signs = rng.choice([-1.0, 1.0], count)

    def parameters(self, size):
        return {"at_s": self.times.tolist(), "jump_s": (self.signs * size * 0.01).tolist()}

    def change_chain(self, size, chain):
        chain.clock.append(lambda t: t + sum(s * size * 0.01 * (t > at) for at, s in zip(self.times, self.signs)))


EFFECTS = [RootSpeedFriction, Detents, RateDependentStiffness, FadingDamping, PatchFriction, WorkSoftening,
           OneWayDamper, ClockJump]
