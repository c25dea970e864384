"""Checks the generator itself: the engine against independent integrations, and clean cases against the noise.

Run it by `run.sh --check`. It exits 1 where a difference is above its limit.
"""

import copy
import math
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from baseline import Baseline
from case import Case
from effects.laws import EvenSpring, LocalDamper, PeriodicForce, PowerFriction, SofteningSpring
from effects.link import GravityTilt, QuadraticDrag, ViscousDrag
from effects.shaped import FifthOrderStiffness, TransmissionHarmonics
from effects.transmission import CoulombFriction, CubicStiffness, QuadraticDamping, TendonBacklash, TransmissionError
from simulate import simulate

# Torque across the joint and on the link, written down anew from the truth's parameters p and the arm a.
LAWS = {
    CubicStiffness: lambda p, a, e, u, du, dy: (-p["k3_nm_per_rad3"] * e ** 3, 0.0),
    TransmissionError: lambda p, a, e, u, du, dy: (
        p["amp_rad"] * (a.stiffness * math.sin(p["cycles_per_rad"] * u + p["phase_rad"])
                        + a.damping * p["cycles_per_rad"] * du * math.cos(p["cycles_per_rad"] * u + p["phase_rad"])), 0.0),
    TendonBacklash: lambda p, a, e, u, du, dy: (a.stiffness * max(-0.5 * p["gap_rad"], min(0.5 * p["gap_rad"], e)), 0.0),
    LocalDamper: lambda p, a, e, u, du, dy: (-p["c"] * (dy - du) * math.exp(-((u - p["at_rad"]) / p["width_rad"]) ** 2 / 2), 0.0),
    EvenSpring: lambda p, a, e, u, du, dy: (-p["c"] * abs(e) ** p["power"], 0.0),
    SofteningSpring: lambda p, a, e, u, du, dy: (a.stiffness * (e - p["bend_rad"] * math.atan2(e, p["bend_rad"])), 0.0),
    PeriodicForce: lambda p, a, e, u, du, dy: (0.0, p["torque_nm"] * sum(
        h * math.sin((k + 1) * p["cycles_per_rad"] * (u + e) + q) for k, (h, q) in enumerate(zip(p["heights"], p["phases_rad"])))),
    TransmissionHarmonics: lambda p, a, e, u, du, dy: (p["amp_rad"] * sum(
        h * (a.stiffness * math.sin((k + 1) * p["cycles_per_rad"] * u + q)
             + a.damping * (k + 1) * p["cycles_per_rad"] * du * math.cos((k + 1) * p["cycles_per_rad"] * u + q))
        for k, (h, q) in enumerate(zip(p["heights"], p["phases_rad"]))), 0.0),
    FifthOrderStiffness: lambda p, a, e, u, du, dy: (-p["third_order"] * e ** 3 - p["fifth_order"] * e ** 5, 0.0),
    PowerFriction: lambda p, a, e, u, du, dy: (
        -p["c"] * (dy - du) * math.hypot(dy - du, p["linear_below_rad_s"]) ** (p["power"] - 1), 0.0),
    QuadraticDamping: lambda p, a, e, u, du, dy: (-p["c2"] * (dy - du) * abs(dy - du), 0.0),
    ViscousDrag: lambda p, a, e, u, du, dy: (0.0, -p["c"] * dy),
    QuadraticDrag: lambda p, a, e, u, du, dy: (0.0, -p["c2"] * dy * abs(dy)),
    GravityTilt: lambda p, a, e, u, du, dy: (
        0.0, a.mass * 0.4 * a.lever * 9.81 * math.sin(p["tilt_rad"]) * math.sin(p["direction_rad"] - u - e)),
}
SMOOTH_LIMIT = 0.3e-6      # rad; a tenth of the smallest noise of a tracker at the longest lever
DRY_LIMIT = 6e-6           # rad, at the worst sample: the engine regularises its friction


def run_of(effect_class, seed):
    """A case with one effect at its first size, run through the first three seconds of its programme."""
    case = Case(np.random.default_rng([3, seed]), "single", [effect_class])
    arm, effect = copy.deepcopy(case.arm), case.effects[0]
    effect.change_arm(effect.start, arm)
    hook = effect.hook(effect.start, arm, "train")
    programme = case.programmes["train"] | {"duration_s": 3.0}
    return arm, effect.parameters(effect.start), simulate(arm, programme, [hook] if hook else [])


def smooth_difference(effect_class, law):
    """Largest difference of the link's position between the engine and an adaptive integration of its equation of motion."""
    arm, parameters, run = run_of(effect_class, 5)
    motor = CubicSpline(run.time, run.motor)
    speed = motor.derivative()

    def slope(t, x):
        u, du = float(motor(t)), float(speed(t))
        e, de = x[0] - u, x[1] - du
        across, on_link = law(parameters, arm, e, u, du, x[1])
        return [x[1], (-arm.stiffness * e - arm.damping * de + across + on_link) / arm.inertia]
    start = [run.motor[0] + run.deformation[0], 0.0]
    link = solve_ivp(slope, (0, 2.99), start, rtol=1e-8, atol=1e-11, max_step=1e-3, dense_output=True).sol
    times = run.time[run.time < 2.98][::10]
    engine = (run.motor + run.deformation)[:len(run.time[run.time < 2.98])][::10]
    return np.abs(link(times)[0] - engine).max()


def dry_difference(seed, h=1e-5):
    """The same for dry friction, against a stick-slip machine stepped at 10 us."""
    arm, parameters, run = run_of(CoulombFriction, seed)
    count = int(2.98 / h)
    push = -arm.inertia * CubicSpline(run.time, run.motor).derivative(2)(np.arange(count) * h + h / 2)
    most, e, v, path = parameters["friction_nm"] * h / arm.inertia, 0.0, 0.0, np.empty(count)
    for i in range(count):
        path[i] = e
        free = v + h / arm.inertia * (push[i] - arm.stiffness * (e + v * h / 2) - arm.damping * v)
        after = free - math.copysign(min(most, abs(free)), free)
        e, v = e + h * (v + after) / 2, after
    stride = int(round((run.time[1] - run.time[0]) / h))
    kept = path[::stride]
    return np.abs(kept - run.deformation[:kept.size]).max()


def clean_ratio(seed):
    """Residual over noise of a clean case."""
    case = Case(np.random.default_rng([11, seed]), "none", [])
    recording = case.recording("train", [])
    return Baseline(recording, case.nominal).fit()[0] / case.chain.noise_std


def main():
    """Prints every difference; 1 where one is too large."""
    failed = False
    for effect_class, law in LAWS.items():
        difference = smooth_difference(effect_class, law)
        failed |= difference > SMOOTH_LIMIT
        print(f"{effect_class.__name__:22s} engine against integration: {1e6 * difference:6.3f} urad")
    for seed in (5, 6, 7):
        difference = dry_difference(seed)
        failed |= difference > DRY_LIMIT
        print(f"{'CoulombFriction':22s} engine against stick and slip: {1e6 * difference:6.3f} urad")
    ratios = np.array([clean_ratio(seed) for seed in range(24)])
    failed |= not 0.98 < np.median(ratios) < 1.03
    print(f"24 clean cases, residual over noise: median {np.median(ratios):.3f}, {ratios.min():.3f} to {ratios.max():.3f}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
