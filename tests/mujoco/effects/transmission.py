"""Effects across the flexible joint, between motor side and link. e is the deformation, u the motor position."""

import math

from effects.effect import Effect, log_uniform


def dry_solver(rng):
    """MuJoCo's regularisation of dry friction: how fast and how fully it sticks."""
    return f'solreffriction="{log_uniform(rng, 1e-4, 4e-4):.2e} 1" solimpfriction="0.999 0.999 0.001"'


class CoulombFriction(Effect):
    """Dry friction by the engine's own friction constraint."""

    name, catalogue, timestep = "coulomb_friction", ("coulomb_friction",), 5e-5
    integrator = "implicitfast"

    def draw(self, rng, setting):
        self.solver = dry_solver(rng)

    def parameters(self, size):
        return {"friction_nm": size * self.setting.torque}

    def change_arm(self, size, arm):
        arm.friction, arm.friction_solver = size * self.setting.torque, self.solver


class StribeckFriction(Effect):
    """Dry friction whose limit falls from breakaway to kinetic with speed: Fc + (Fs - Fc) exp(-(v / vs)^2)."""

    name, catalogue, timestep = "stribeck_friction", ("stribeck_friction",), 5e-5
    integrator = "implicitfast"

    def draw(self, rng, setting):
        self.solver = dry_solver(rng)
        self.ratio = rng.uniform(1.5, 2.5)
        self.speed = setting.rate * log_uniform(rng, 0.05, 0.4)

    def parameters(self, size):
        kinetic = size * self.setting.torque
        return {"kinetic_nm": kinetic, "breakaway_nm": self.ratio * kinetic, "stribeck_rad_s": self.speed}

    def change_arm(self, size, arm):
        arm.friction, arm.friction_solver = self.ratio * size * self.setting.torque, self.solver

    def hook(self, size, arm, which):
        kinetic, dof = size * self.setting.torque, []

        def limit(t, dt, e, de, u, du, model):
            if not dof:
                dof.append(model.joint("flex").dofadr[0])
            model.dof_frictionloss[dof[0]] = kinetic * (1 + (self.ratio - 1) * math.exp(-(de / self.speed) ** 2))
            return 0.0, 0.0
        return limit


class Dahl(Effect):
    """Presliding friction after Dahl: dF/dx = sigma (1 - F sign(v) / Fc), exact over a step."""

    name, catalogue = "dahl_friction", ("presliding_hysteresis",)

    def draw(self, rng, setting):
        self.length = setting.peak * log_uniform(rng, 0.03, 0.3)

    def parameters(self, size):
        return {"friction_nm": size * self.setting.torque, "presliding_rad": self.length}

    def hook(self, size, arm, which):
        level, z = size * self.setting.torque, 0.0

        def force(t, dt, e, de, u, du, model):
            nonlocal z
            dx = de * dt
            side = math.copysign(1.0, dx)
            z = side + (z - side) * math.exp(-abs(dx) / self.length)
            return -level * z, 0.0
        return force


class LuGre(Effect):
    """Presliding friction with Stribeck curve and bristle damping (LuGre)."""

    name, catalogue, timestep = "lugre_friction", ("presliding_hysteresis",), 1e-4

    def draw(self, rng, setting):
        self.length = setting.peak * log_uniform(rng, 0.02, 0.15)
        self.ratio, self.speed = rng.uniform(1.1, 1.6), setting.rate * rng.uniform(0.1, 0.4)
        self.bristle = rng.uniform(0.0, 0.1)

    def parameters(self, size):
        level = size * self.setting.torque
        return {"sigma0": level / self.length, "sigma1": self.bristle * level / self.setting.rate, "kinetic_nm": level,
                "breakaway_nm": self.ratio * level, "stribeck_rad_s": self.speed}

    def hook(self, size, arm, which):
        p, z = self.parameters(size), 0.0

        def force(t, dt, e, de, u, du, model):
            nonlocal z
            g = p["kinetic_nm"] + (p["breakaway_nm"] - p["kinetic_nm"]) * math.exp(-(de / self.speed) ** 2)
            decay = p["sigma0"] * abs(de) / g * dt
            old = z
            # dz/dt = v - sigma0 |v| z / g, linear in z over the step
            z = old * math.exp(-decay) + (de * dt if decay < 1e-9 else de * dt * -math.expm1(-decay) / decay)
            return -(p["sigma0"] * (z + old) / 2 + p["sigma1"] * (z - old) / dt), 0.0
        return force


class BoucWen(Effect):
    """A hysteretic spring in parallel: dz = (A - |z|^n (gamma + beta sign(v z))) dx."""

    name, catalogue = "bouc_wen", ("hysteretic_stiffness",)

    def draw(self, rng, setting):
        self.yield_at = setting.peak * log_uniform(rng, 0.2, 1.2)
        self.power, self.share = float(rng.choice([1.0, 1.0, 2.0])), rng.uniform(0.5, 0.8)

    def parameters(self, size):
        slope = size * self.setting.torque / self.yield_at
        total = slope / (slope * self.yield_at) ** self.power
        return {"A": slope, "beta": self.share * total, "gamma": (1 - self.share) * total, "n": self.power}

    def hook(self, size, arm, which):
        p, z = self.parameters(size), 0.0

        def slope(z, dx):
            return p["A"] - abs(z) ** p["n"] * (p["gamma"] + p["beta"] * math.copysign(1.0, dx * z))

        def force(t, dt, e, de, u, du, model):
            nonlocal z
            dx = de * dt
            old = z
            z += dx * slope(z + 0.5 * dx * slope(z, dx), dx)
            return -0.5 * (z + old), 0.0
        return force


class TendonBacklash(Effect):
    """A gap without torque by the engine's dead band of a spring; the damper acts in the gap too."""

    name, catalogue, timestep, high = "backlash", ("backlash",), 1e-4, 0.5

    def parameters(self, size):
        return {"gap_rad": 2.0 * size * self.setting.peak, "damper_in_gap": 1.0}

    def change_arm(self, size, arm):
        gap = size * self.setting.peak
        arm.tendons.append(f'<fixed name="gear" springlength="{-gap} {gap}" stiffness="{arm.stiffness}">'
                           '<joint joint="flex" coef="1"/></fixed>')
        arm.native_stiffness = 0.0


class ContactBacklash(Effect):
    """A gap between compliant, damped flanks that can only push."""

    name, catalogue, timestep, high = "backlash", ("backlash",), 1e-4, 0.5

    def parameters(self, size):
        return {"gap_rad": 2.0 * size * self.setting.peak, "damper_in_gap": 0.0}

    def hook(self, size, arm, which):
        gap, k, d = size * self.setting.peak, arm.stiffness, arm.damping

        def force(t, dt, e, de, u, du, model):
            flank = 0.0
            if abs(e) > gap:
                side = math.copysign(1.0, e)
                flank = side * max(0.0, k * (abs(e) - gap) + d * de * side)
            return k * e + d * de - flank, 0.0
        return force


class CubicStiffness(Effect):
    """Hardening or softening: -k3 e^3."""

    catalogue = ("cubic_stiffness",)

    def draw(self, rng, setting):
        self.sign = 1.0 if rng.random() < 0.7 else -1.0
        self.name = "hardening_stiffness" if self.sign > 0 else "softening_stiffness"
        self.high = 0.8 if self.sign > 0 else 0.25

    def parameters(self, size):
        return {"k3_nm_per_rad3": self.sign * size * self.setting.torque / self.setting.peak ** 3}

    def hook(self, size, arm, which):
        k3 = self.parameters(size)["k3_nm_per_rad3"]
        return lambda t, dt, e, de, u, du, model: (-k3 * e * e * e, 0.0)


class BilinearStiffness(Effect):
    """Another stiffness beyond a break point: on one side of a point near rest, or on both sides of a larger one."""

    name, catalogue = "bilinear_stiffness", ("bilinear_stiffness",)

    def draw(self, rng, setting):
        self.two_sided = rng.random() < 0.5
        self.point = setting.peak * (rng.uniform(0.15, 0.5) if self.two_sided else 0.0)
        self.sign = 1.0 if rng.random() < 0.6 else -1.0
        self.high = 1.0 if self.sign > 0 else 0.5

    def parameters(self, size):
        return {"extra_nm_rad": self.sign * size * self.setting.arm.stiffness, "beyond_rad": self.point,
                "both_sides": float(self.two_sided)}

    def hook(self, size, arm, which):
        extra, point = self.parameters(size)["extra_nm_rad"], self.point

        def force(t, dt, e, de, u, du, model):
            if e > point:
                return -extra * (e - point), 0.0
            if self.two_sided and e < -point:
                return -extra * (e + point), 0.0
            return 0.0, 0.0
        return force


class QuadraticDamping(Effect):
    """-c2 |e'| e'."""

    name, catalogue, high = "quadratic_damping", ("quadratic_damping",), 2.0

    def parameters(self, size):
        return {"c2": size * self.setting.torque / self.setting.rate ** 2}

    def hook(self, size, arm, which):
        c2 = self.parameters(size)["c2"]
        return lambda t, dt, e, de, u, du, model: (-c2 * abs(de) * de, 0.0)


class TransmissionError(Effect):
    """The spring's foot runs ahead and behind with the motor's angle: A sin(n u + phase)."""

    name, catalogue, high = "transmission_error", ("transmission_ripple",), 0.5

    def draw(self, rng, setting):
        self.cycles, self.phase = log_uniform(rng, 15, 80), rng.uniform(0, 2 * math.pi)

    def parameters(self, size):
        return {"amp_rad": size * self.setting.peak, "cycles_per_rad": self.cycles, "phase_rad": self.phase}

    def hook(self, size, arm, which):
        a, n, phase, k, d = size * self.setting.peak, self.cycles, self.phase, arm.stiffness, arm.damping
        return lambda t, dt, e, de, u, du, model: (
            k * a * math.sin(n * u + phase) + d * a * n * du * math.cos(n * u + phase), 0.0)


class StiffnessDrift(Effect):
    """The engine's joint stiffness changes while the recording runs: linearly, or towards a limit as it warms."""

    name, catalogue, timed = "stiffness_drift", ("stiffness_drift",), True

    def draw(self, rng, setting):
        self.sign = float(rng.choice([-1.0, 1.0]))
        self.constant = float(rng.choice([0.0, rng.uniform(1.0, 4.0)]))
        self.duration = setting.durations["train"]

    def parameters(self, size):
        return {"relative_change": self.sign * min(size, 0.6), "time_constant_s": self.constant,
                "duration_s": self.duration}

    def hook(self, size, arm, which):
        change, joint = self.sign * min(size, 0.6), []

        def drift(t, dt, e, de, u, du, model):
            if not joint:
                joint.append(model.joint("flex").id)
            done = t / self.duration if self.constant == 0 else -math.expm1(-t / self.constant)
            model.jnt_stiffness[joint[0]] = arm.stiffness * (1 + change * done)
            return 0.0, 0.0
        return drift


class MaxwellCreep(Effect):
    """A spring and a dashpot in series beside the joint: torque k1 (e - z), z' = (e - z) / tau."""

    name, catalogue = "viscoelastic_creep", ("viscoelastic_creep",)

    def draw(self, rng, setting):
        self.tau = log_uniform(rng, 0.05, 0.8)

    def parameters(self, size):
        return {"k1_nm_rad": size * self.setting.arm.stiffness, "tau_s": self.tau}

    def hook(self, size, arm, which):
        k1, tau, z = size * arm.stiffness, self.tau, 0.0

        def force(t, dt, e, de, u, du, model):
            nonlocal z
            old = z
            z = e + (z - e) * math.exp(-dt / tau)
            return -k1 * (e - 0.5 * (z + old)), 0.0
        return force


EFFECTS = [CoulombFriction, StribeckFriction, Dahl, LuGre, BoucWen, TendonBacklash, ContactBacklash, CubicStiffness,
           BilinearStiffness, QuadraticDamping, TransmissionError, StiffnessDrift, MaxwellCreep]

# What no reading of two at once could tell apart
HYSTERETIC = [CoulombFriction, StribeckFriction, Dahl, LuGre, BoucWen]
