#!/usr/bin/env python3
"""Commands `mujoco_arm.py` through `quell serve`: what two modes, and a mode that follows the pose, leave from move to move.

    tests/robots/modes.py target/release/quell

Each arm makes the same moves twice, from 0 degrees: unshaped, and as the service does them. It prints what each move leaves of
the unshaped vibration, as the engine has it, and ends with 1 where more is left than is aimed at: two modes from the third move on 1 % in
the median and 2 % at most, the pose 1 % and 3 % from the fifth. By chance some moves leave little unshaped, so that the worst is a
share of what the moves leave in the mean square. It needs the Python package `mujoco`. The arm's time is that of the setpoints, so that
a machine that is busy makes it late and not wrong. A move in which the service skipped ticks is marked.
"""

import argparse
import pathlib
import statistics
import sys
import tempfile
import time

import campaign

ARM = pathlib.Path(__file__).with_name("mujoco_arm.py")
TARGETS = [60, 0, 30, 55, 10, 45, 5, 60, 20, 40, 0, 35, 60, 15, 50, 0]
# A ramp of 5 ms makes 19 Hz ring.
JOINT = """
[service]
robot = "udp"

[watchdog]
timeout_s = 1.0

[[joint]]
name = "joint_1"
velocity_deg_s = 150.0
acceleration_deg_s2 = 570.0
jerk_deg_s3 = {jerk}
range_deg = [-10.0, 70.0]
frequency_hz = {belief}
damping_ratio = 0.05
sensor_rate_hz = 1000.0
encoder_resolution_deg = 0.0006
"""
# Arm, belief (Hz), moves before it is judged, most in the median and at worst (%).
ARMS = [("two", 10.0, 2, 1.0, 2.0), ("pose", 10.0, 4, 1.0, 3.0), ("pose", 8.0, 4, 1.0, 3.0)]


class Service(campaign.Service):
    """`quell serve` of one joint whose modes ring."""

    def __init__(self, quell, folder, belief, options):
        (folder / "quell.toml").write_text(JOINT.format(belief=belief, jerk=options.jerk))
        self.folder, self.quell, self.rate = folder, quell, options.rate
        self.start("127.0.0.1:0")


def run(options, arm, belief, shaper):
    """What each move leaves, rad, whether ticks were skipped, and what the service said."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        service = Service(options.quell, folder, belief, options)
        arguments = ["--arm", arm, "--seed", options.seed, "--loss", options.loss]
        arguments += ["--sensor", "deformation", "--lockstep"]
        robot = campaign.Robot(service, folder, arguments, ARM)
        try:
            left, skipped = [], 0
            for degrees in TARGETS[: options.moves]:
                target = degrees * 0.017453292519943295
                service.move(target, shaper)
                peak = robot.moved(target)["residual"]
                state = service.state()
                before, skipped = skipped, state["tick"]["skipped"]
                left.append((peak, skipped > before, state["joints"][0]["learning"]))
                # Five time constants of 8 Hz at 3 %.
                time.sleep(3.5 if shaper else 1.0)
            return left
        finally:
            service.process.terminate()
            service.process.wait()
            robot.end()


def judge(verdict, options, arm, belief, from_, median, most):
    plain = run(options, arm, belief, "none")
    shaped = run(options, arm, belief, None)
    shares = [100.0 * now[0] / all_[0] for now, all_ in zip(shaped, plain)]
    calm = [not (now[1] or all_[1]) for now, all_ in zip(shaped, plain)]
    text = " ".join(f"{share:.2f}{'' if good else '*'}" for share, good in zip(shares, calm))
    print(f"{arm}, belief {belief} Hz, % of {[f'{one[0]:.2e}' for one in plain]} rad: {text}")
    if options.verbose:
        for one in shaped:
            print("   ", one[2])
    judged = shares[from_:]
    middle = statistics.median(judged)
    usual = statistics.fmean(one[0] ** 2 for one in plain) ** 0.5
    worst = max(100.0 * now[0] / usual for now in shaped[from_:])
    text = f"{arm}, belief {belief} Hz: {middle:.2f} % in the median of {len(judged)} moves, {worst:.2f} % at most of what"
    text += f" the moves leave unshaped in the mean square ({max(judged):.2f} % of the same move)"
    verdict.says(middle <= median and worst <= most, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("quell")
    parser.add_argument("--moves", type=int, default=len(TARGETS))
    parser.add_argument("--rate", type=float, default=1000.0, help="ticks a second")
    parser.add_argument("--jerk", type=float, default=340000.0, help="deg/s^3")
    parser.add_argument("--loss", type=float, default=0.0, help="share of datagrams, each way")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="one of the arms")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    verdict = campaign.Verdict()
    for arm in ARMS:
        if not options.only or options.only == arm[0]:
            judge(verdict, options, *arm)
    sys.exit(1 if verdict.fails else 0)


if __name__ == "__main__":
    main()
