"""Effects on the link and under the base."""

import math

import numpy as np

from effects.effect import Effect, log_uniform


class ViscousDrag(Effect):
    """A damper from the link to the ground, by the engine's damping of a tendon over both joints."""

    name, catalogue, high = "viscous_drag", ("viscous_drag",), 4.0
    equivalents = ("clock_offset",)      # c / w^2 of clock offset and a shift of xi stand in for most of it

    def parameters(self, size):
        return {"c": size * self.setting.torque}

    def change_arm(self, size, arm):
        arm.tendons.append(f'<fixed name="drag" damping="{size * self.setting.torque}"><joint joint="motor" coef="1"/>'
                           '<joint joint="flex" coef="1"/></fixed>')


class FluidDrag(Effect):
    """The engine's own inertia-based fluid forces: quadratic in speed."""

    name, catalogue, high = "fluid_drag", ("quadratic_drag",), 20.0

    def parameters(self, size):
        return {"air_density": 1000 * size}

    def change_arm(self, size, arm):
        arm.density = 1000 * size


class QuadraticDrag(Effect):
    """-c y' |y'| on the link."""

    name, catalogue = "quadratic_drag", ("quadratic_drag",)

    def parameters(self, size):
        return {"c2": size * self.setting.torque}

    def hook(self, size, arm, which):
        c = size * self.setting.torque
        return lambda t, dt, e, de, u, du, model: (0.0, -c * (du + de) * abs(du + de))


class GravityTilt(Effect):
    """The base is tilted, so the link's weight pulls with the position."""

    name, catalogue = "gravity_tilt", ("gravity_load",)
    equivalents = ("sensor_gain", "misalignment")
    roles = ("tip_position", "deformation")
    high, pairable = 0.12, False

    def draw(self, rng, setting):
        self.direction = rng.uniform(0, 2 * math.pi)
        self.start = rng.uniform(0.01, 0.05)
        # A tracker's free frame swallows nearly all of a tilt; only a direct deformation channel can size it.
        self.sized = setting.role == "deformation"

    def parameters(self, size):
        return {"tilt_rad": size, "direction_rad": self.direction}

    def change_arm(self, size, arm):
        g, s = 9.81, math.sin(size)
        arm.gravity = (g * s * math.cos(self.direction), g * s * math.sin(self.direction), -g * math.cos(size))


class Resonator(Effect):
    """Something on the link that swings by itself: an extra hinge with spring and damper."""

    name, catalogue, equivalents, high = "second_mode", ("second_mode",), ("base_mode",), 0.5

    def draw(self, rng, setting):
        f = setting.arm.frequency / (2 * math.pi)
        self.f2, self.xi2 = min(f * rng.uniform(1.7, 3.5), 45.0), rng.uniform(0.01, 0.05)
        self.at = rng.uniform(0.3, 0.9)

    def parameters(self, size):
        return {"f2": self.f2, "xi2": self.xi2, "j2": size * self.setting.arm.inertia}

    def change_arm(self, size, arm):
        j2, w2 = size * arm.inertia, 2 * math.pi * self.f2
        arm.link_inertia_taken += j2
        arm.on_link.append(
            f'<body name="second" pos="{self.at * arm.lever} 0 0"><joint name="second" axis="0 0 1" '
            f'stiffness="{j2 * w2 ** 2}" damping="{2 * self.xi2 * j2 * w2}"/>'
            f'<inertial pos="0 0 0" mass="1e-3" diaginertia="{j2} {j2} {j2}"/></body>')


class BendingLink(Effect):
    """The outer part of the link, which carries the tip, bends against the inner part."""

    name, catalogue, equivalents, high = "second_mode", ("second_mode",), ("base_mode",), 0.6
    roles = ("tip_position", "tip_acceleration")

    def draw(self, rng, setting):
        f = setting.arm.frequency / (2 * math.pi)
        self.f2, self.xi2 = min(f * rng.uniform(2.2, 4.5), 55.0), rng.uniform(0.01, 0.05)

    def parameters(self, size):
        return {"f2": self.f2, "xi2": self.xi2, "outer_inertia": size * self.setting.arm.inertia, "at": 0.6}

    def change_arm(self, size, arm):
        at, out = 0.6 * arm.lever, 0.2 * arm.lever
        total = size * arm.inertia                      # about joint 1
        mass = 0.9 * total / (at + out) ** 2
        spin = 0.1 * total
        own, w2 = spin + mass * out ** 2, 2 * math.pi * self.f2
        arm.link_inertia_taken += total
        arm.tip_on_link = False
        arm.on_link.append(
            f'<body name="second" pos="{at} 0 0"><joint name="second" axis="0 0 1" stiffness="{own * w2 ** 2}" '
            f'damping="{2 * self.xi2 * own * w2}"/><inertial pos="{out} 0 0" mass="{mass}" '
            f'diaginertia="{spin} {spin} {spin}"/><site name="tip" pos="{arm.lever - at} 0 {arm.height}"/></body>')


class HangingLoad(Effect):
    """A load that hangs from the arm and swings along the path of the tip, a pendulum near 1 Hz."""

    name, catalogue = "hanging_load", ("second_mode",)

    def draw(self, rng, setting):
        self.length = rng.uniform(0.2, 0.6)
        self.at = rng.uniform(0.6, 1.0)
        self.xi2 = rng.uniform(0.005, 0.05)

    def parameters(self, size):
        return {"mass": self.mass(size), "length_m": self.length, "f2": math.sqrt(9.81 / self.length) / (2 * math.pi),
                "xi2": self.xi2}

    def mass(self, size):
        """Mass of the load, for a share `size` of the link's inertia."""
        return size * self.setting.arm.inertia / (self.at * self.setting.arm.lever) ** 2

    def change_arm(self, size, arm):
        m, w2 = self.mass(size), math.sqrt(9.81 / self.length)
        arm.on_link.append(
            f'<body name="load" pos="{self.at * arm.lever} 0 0"><joint name="load" axis="1 0 0" '
            f'damping="{2 * self.xi2 * w2 * m * self.length ** 2}"/><inertial pos="0 0 {-self.length}" mass="{m}" '
            f'diaginertia="{1e-3 * m} {1e-3 * m} {1e-3 * m}"/></body>')


class PoseDependentInertia(Effect):
    """A mass runs outwards along the link as joint 1 turns, with all that this couples (inertia, Coriolis force)."""

    name, catalogue = "pose_dependent_inertia", ("pose_dependent_frequency",)

    def draw(self, rng, setting):
        self.near, self.far = (0.3, 0.8) if rng.random() < 0.5 else (0.8, 0.3)

    def parameters(self, size):
        near, far = self.near * self.setting.arm.lever, self.far * self.setting.arm.lever
        return {"mass": self.mass(size), "radius_at_home_m": near, "radius_at_reach_m": far, "reach_rad": self.setting.reach}

    def mass(self, size):
        """Mass that changes the inertia by the share `size` over the reach."""
        return min(size, 0.8) * self.setting.arm.inertia / abs(self.far ** 2 - self.near ** 2) / self.setting.arm.lever ** 2

    def change_arm(self, size, arm):
        m, near, far = self.mass(size), self.near * arm.lever, self.far * arm.lever
        w, spin = 2 * math.pi * 60, 1e-3 * arm.inertia
        arm.link_inertia_taken += min(m * near ** 2 + spin, 0.8 * arm.inertia)
        arm.on_link.append(
            f'<body name="slide"><joint name="slide" type="slide" axis="1 0 0" damping="{1.4 * m * w}"/>'
            f'<inertial pos="0 0 0" mass="{m}" diaginertia="{spin} {spin} {spin}"/></body>')
        arm.actuators.append(f'<position name="slide" joint="slide" kp="{m * w * w}"/>')
        arm.laws["slide"] = lambda travel: near + (far - near) * np.asarray(travel) / self.setting.reach


class PoseDependentStiffness(Effect):
    """The joint's stiffness changes with the position of joint 1."""

    name, catalogue = "pose_dependent_stiffness", ("pose_dependent_frequency",)

    def draw(self, rng, setting):
        self.sign = float(rng.choice([-1.0, 1.0]))

    def parameters(self, size):
        return {"relative_change_at_reach": self.sign * min(size, 0.6), "reach_rad": self.setting.reach}

    def hook(self, size, arm, which):
        change, reach, joint = self.sign * min(size, 0.6), self.setting.reach, []

        def stiffen(t, dt, e, de, u, du, model):
            if not joint:
                joint.append(model.joint("flex").id)
            model.jnt_stiffness[joint[0]] = arm.stiffness * (1 + change * (u - arm.home) / reach)
            return 0.0, 0.0
        return stiffen


class PayloadChange(Effect):
    """A mass at the tip is taken up or put down at one time."""

    name, catalogue, timed = "payload_change", ("payload_change",), True

    def draw(self, rng, setting):
        self.attach = rng.random() < 0.5
        shared = min(setting.durations.values())
        inner = [t for t in setting.dwells if 0.2 * shared < t < 0.85 * shared]
        self.at = float(rng.choice(inner)) if inner and rng.random() < 0.7 else rng.uniform(0.3, 0.75) * shared

    def parameters(self, size):
        mass = size * self.setting.arm.inertia / self.setting.arm.lever ** 2
        return {"m": mass, "at_s": self.at, "attached_after": float(self.attach)}

    def change_arm(self, size, arm):
        arm.on_link.append(f'<body name="payload" pos="{arm.lever} 0 0"><inertial pos="0 0 0" mass="1e-6" '
                           'diaginertia="1e-9 1e-9 1e-9"/></body>')

    def hook(self, size, arm, which):
        mass, body = self.parameters(size)["m"], []

        def payload(t, dt, e, de, u, du, model):
            if not body:
                body.append(model.body("payload").id)
            model.body_mass[body[0]] = mass if (t >= self.at) == self.attach else 1e-6
            return 0.0, 0.0
        return payload


class EndStop(Effect):
    """A compliant stop in the link's way, near the end of its travel, by the engine's limit constraint."""

    name, catalogue, timestep = "end_stop", ("end_stop",), 1e-4
    start, high = 0.2, 2.5

    def draw(self, rng, setting):
        self.f, self.zeta = rng.uniform(25, 70), rng.uniform(0.2, 0.8)

    def angle(self, size):
        """Where the stop is: the larger the size, the further inside the overshoot."""
        return self.setting.arm.home + self.setting.reach + self.setting.peak * (0.6 - size)

    def parameters(self, size):
        return {"stop_rad": self.angle(size), "stop_hz": self.f, "stop_zeta": self.zeta}

    def change_arm(self, size, arm):
        w = 2 * math.pi * self.f
        arm.tendons.append(
            f'<fixed name="stop" limited="true" range="-10 {self.angle(size)}" solreflimit="{-w * w} {-2 * self.zeta * w}" '
            'solimplimit="0.95 0.95 0.001"><joint joint="motor" coef="1"/><joint joint="flex" coef="1"/></fixed>')


class BaseCompliance(Effect):
    """The base turns on its foundation, a spring and a damper."""

    name, catalogue, equivalents, high = "base_compliance", ("base_mode",), ("second_mode",), 0.5
    roles, place = ("tip_position", "tip_acceleration"), "base"

    def draw(self, rng, setting):
        f = setting.arm.frequency / (2 * math.pi)
        self.f, self.xi = min(f * rng.uniform(1.8, 4.0), 50.0), rng.uniform(0.01, 0.06)

    def parameters(self, size):
        k = self.setting.arm.stiffness / size
        w = 2 * math.pi * self.f
        return {"k": k, "j": k / w ** 2, "d": 2 * self.xi * k / w}

    def change_arm(self, size, arm):
        p = self.parameters(size)
        arm.base_inertia = p["j"]
        arm.base = f'<joint name="base" axis="0 0 1" stiffness="{p["k"]}" damping="{p["d"]}"/>'


EFFECTS = [ViscousDrag, FluidDrag, QuadraticDrag, GravityTilt, Resonator, BendingLink, HangingLoad, PoseDependentInertia,
           PoseDependentStiffness, PayloadChange, EndStop, BaseCompliance]
