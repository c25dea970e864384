"""What a patched MuJoCo model predicts, against a fit of the four usual parameters.

Physics is hidden in a joint of a six-axis arm. `quell.mujoco` diagnoses and patches the description; a fit of friction,
damping, armature and stiffness by rollouts has the same recording. Both predict another recording from its commands:
motor and link, root mean square over the noise of each encoder.

    mujoco_patch.py [SEED ...] [--cases NAME,NAME] [--sysid]
    mujoco_patch.py [SEED ...] --whole

With `--sysid` mujoco.sysid fits the same four beside. With `--whole` two joints have something hidden, and all six are
diagnosed and patched.
"""

import argparse
import math
import sys
import time
from pathlib import Path

import mujoco
import numpy as np
import quell.mujoco

sys.path.insert(0, str(Path(__file__).parents[1] / "python" / "tests"))
import four_parameters  # noqa: E402
import six_axes  # noqa: E402
from six_axes import Hidden  # noqa: E402

STRIBECK = {"friction": 25.0, "excess": 0.6, "stribeck": 0.1}
SPRING = {"stiffness": 15000.0, "spring_damping": 30.0}
PLAY = {"stiffness": 60000.0, "spring_damping": 120.0, "gap": 1e-3}
CASES = {
    "nothing": ("forearm", Hidden()),
    "coulomb": ("elbow", Hidden(friction=10.0)),
    "stribeck": ("shoulder", Hidden(**STRIBECK)),
    "delay": ("elbow", Hidden(delay=0.012)),
    "elastic": ("elbow", Hidden(**SPRING)),
    "backlash": ("base", Hidden(**PLAY)),
    "stribeck + delay": ("shoulder", Hidden(**STRIBECK, delay=0.008)),
    "elastic + stribeck": ("elbow", Hidden(**SPRING, friction=10.0, excess=0.6, stribeck=0.1)),
}
NOISE = {"motor_position": six_axes.MOTOR, "link_position": six_axes.LINK}


def errors(model, log, joint):
    """Root mean square over the noise, by role."""
    return {role: one.rms / NOISE[role] for role, one in quell.mujoco.simulate(model, log, joint).items()}


def whole(by_role):
    """Over all that was measured."""
    return math.sqrt(np.mean(np.square(list(by_role.values()))))


def run(name, seed, peers):
    joint, hidden = CASES[name]
    hidden = {joint: hidden} if hidden != Hidden() else {}
    train, test = six_axes.record(hidden, seed=seed), six_axes.record(hidden, seed=seed + 100)
    began = time.perf_counter()
    found = quell.mujoco.diagnose(six_axes.mjcf(), train, joints=[joint])
    patched = quell.mujoco.patch(six_axes.mjcf(), found)
    took = time.perf_counter() - began
    lines = [("patched, another recording", errors(patched, test, joint), took)]
    for label, fit in peers.items():
        began = time.perf_counter()
        usual = fit(six_axes.mjcf(), train, joint)
        lines.append((f"{label}, the same", errors(usual, test, joint), time.perf_counter() - began))
    # What Quell itself leaves where it was fitted, and what the patched model leaves there.
    sides = {"drive": found[joint].drive, "transmission": found[joint].transmission}
    told = [one.effect for one in found[joint].findings]
    quells = {side: one.fit.after.held_out_over_noise for side, one in sides.items() if one}
    print(f"{name:18} seed {seed}  told {' + '.join(told) or '-'}")
    print("    Quell, held-out stretches   ", "  ".join(f"{side} {value:.2f}" for side, value in quells.items()))
    for label, by_role, seconds in lines:
        print(f"    {label:28}", "  ".join(f"{role} {value:.2f}" for role, value in by_role.items()), f" ({seconds:.0f} s)")
    ours, theirs = whole(lines[0][1]), min(whole(by_role) for _, by_role, _ in lines[1:])
    print(f"    ratio {theirs / ours:.2f}", flush=True)
    return name, ours, theirs


def whole_arm(seed):
    """All joints of one arm: what was told, and what the patched model predicts of another recording."""
    hidden = {"shoulder": Hidden(**STRIBECK), "elbow": Hidden(**SPRING)}
    train, test = six_axes.record(hidden, seed=seed), six_axes.record(hidden, seed=seed + 100)
    found = quell.mujoco.diagnose(six_axes.mjcf(), train)
    patched = quell.mujoco.patch(six_axes.mjcf(), found)
    for joint, own in found.joints.items():
        told = [one.effect for one in own.findings] + (["elasticity"] if own.stiffness else [])
        left = "  ".join(f"{role} {value:.2f}" for role, value in errors(patched, test, joint).items())
        print(f"{joint:10} seed {seed}  {' + '.join(told) or '-':32} {left}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seeds", nargs="*", type=int, default=[1])
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--sysid", action="store_true")
    parser.add_argument("--whole", action="store_true")
    given = parser.parse_args()
    if given.whole:
        for seed in given.seeds:
            whole_arm(seed)
        return
    peers = {"four parameters": four_parameters.fit}
    if given.sysid:
        sys.path.insert(0, str(Path(__file__).parent / "peers"))
        import mujoco_sysid

        peers["mujoco.sysid"] = mujoco_sysid.fit
    print(f"quell {quell.__version__}, mujoco {mujoco.__version__}; rms over the noise of the encoder")
    rows = [run(name, seed, peers) for name in given.cases.split(",") for seed in given.seeds]
    print("\nmedian over seeds: patched, best fit of four parameters, ratio")
    for name in dict.fromkeys(row[0] for row in rows):
        ours, theirs = (np.median([row[k] for row in rows if row[0] == name]) for k in (1, 2))
        print(f"{name:18} {ours:8.2f} {theirs:8.2f} {theirs / ours:8.2f}")


if __name__ == "__main__":
    main()
