"""Time and memory of `quell` against the length of a recording and the number of recordings.

    python3 benches/growth.py                      # 1e3 to 1e6 samples
    python3 benches/growth.py --longest 1e7        # and 1e7

Makes its own recordings: a joint of 8 Hz and 5 % that goes there and back, its motor side and its
deformation at 250 Hz, with white noise of 10 urad. An exponent is the
slope of log time, or of log memory, over log length from one line to the next: 1 is linear.
Seconds are those of the processor, memory is the most that the process held.
"""

import argparse
import math
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

RATE = 250.0
FREQUENCY, DAMPING = 8.0, 0.05
NOISE = 1e-5
# A move of 0.5 rad in 0.6 s, every 2.4 s; there and back.
MOVE, DISTANCE, EVERY = 0.6, 0.5, 2.4

MODEL = """kind = "flexible_joint"
natural_frequency_hz = 8.3
damping_ratio = 0.06
lever_arm_m = 1.8
tip_height_m = 0.9
"""
MANIFEST = """name = "growth"
[[channel]]
role = "motor_position"
file = "run.csv"
time = "time_s"
column = "motor_rad"
unit = "rad"
[[channel]]
role = "deformation"
file = "run.csv"
time = "time_s"
column = "deformation_rad"
unit = "rad"
"""


def motion(samples):
    """Position and acceleration of the motor side: steps of the fifth order."""
    for k in range(samples):
        number, time = divmod(k / RATE, EVERY)
        x = min(time / MOVE, 1.0)
        step = x**3 * (10.0 + x * (6.0 * x - 15.0))
        bend = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / MOVE**2
        sign = 1.0 if number % 2 == 0 else -1.0
        start = 0.0 if sign > 0 else DISTANCE
        yield start + sign * DISTANCE * step, sign * DISTANCE * bend


def transition(period, parts=200):
    """The response of deformation and rate over a sample: to themselves, and to the acceleration at its
    ends, linear in between; by steps that are too small to matter."""
    omega = 2.0 * math.pi * FREQUENCY

    def run(state, force):
        step = period / parts
        for k in range(parts):
            def rate(at, s):
                share = (k + at) / parts
                f = force[0] + share * (force[1] - force[0])
                return s[1], -2.0 * DAMPING * omega * s[1] - omega**2 * s[0] - f
            a = rate(0.0, state)
            b = rate(0.5, [s + 0.5 * step * d for s, d in zip(state, a)])
            c = rate(0.5, [s + 0.5 * step * d for s, d in zip(state, b)])
            d = rate(1.0, [s + step * e for s, e in zip(state, c)])
            state = [s + step / 6.0 * (p + 2 * q + 2 * r + t) for s, p, q, r, t in zip(state, a, b, c, d)]
        return state

    basis = [([1, 0], [0, 0]), ([0, 1], [0, 0]), ([0, 0], [1, 0]), ([0, 0], [0, 1])]
    return [run(list(map(float, state)), force) for state, force in basis]


def record(folder, samples, seed=1):
    """Writes a recording of so many samples."""
    folder.mkdir(parents=True)
    (folder / "recording.toml").write_text(MANIFEST)
    (x, y, begin, end) = transition(1.0 / RATE)
    noise = random.Random(seed)
    delta, rate, before = 0.0, 0.0, 0.0
    with open(folder / "run.csv", "w", buffering=1 << 20) as file:
        file.write("time_s,motor_rad,deformation_rad\n")
        for k, (position, acceleration) in enumerate(motion(samples)):
            if k:
                delta, rate = (
                    x[0] * delta + y[0] * rate + begin[0] * before + end[0] * acceleration,
                    x[1] * delta + y[1] * rate + begin[1] * before + end[1] * acceleration,
                )
            before = acceleration
            file.write("%.3f,%.9f,%.8f\n" % (k / RATE, position, delta + noise.gauss(0.0, NOISE)))


def measure(command, limit):
    """Processor seconds and the most memory (MB) of a command; None where it fails or takes too long."""
    child = subprocess.Popen(["timeout", str(limit), *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    error = child.stderr.read().decode(errors="replace")
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        last = (error.strip().splitlines() or ["no word"])[-1]
        return None, f"ended with {child.returncode}: {last[:60]}"
    return (usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024.0), None


def exponent(before, now):
    """The slope in log-log from one (size, value) to the next."""
    if before is None or min(before[1], now[1]) <= 0.0:
        return ""
    return "%.2f" % (math.log(now[1] / before[1]) / math.log(now[0] / before[0]))


def table(title, unit, sizes, run):
    print(f"\n{title}\n| {unit} | seconds | exponent | MB | exponent |\n|---|---|---|---|---|")
    seconds, memory = None, None
    for size in sizes:
        figures, why = run(size)
        if figures is None:
            print(f"| {size:.0e} | {why} | | | |", flush=True)
            break
        now = (size, figures[0]), (size, figures[1])
        print(f"| {size:.0e} | {figures[0]:.2f} | {exponent(seconds, now[0])} "
              f"| {figures[1]:.0f} | {exponent(memory, now[1])} |", flush=True)
        seconds, memory = now


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--quell", default="target/release/quell")
    parser.add_argument("--longest", type=float, default=1e6)
    parser.add_argument("--diagnosed", type=float, help="the longest that is diagnosed [default: as --longest]")
    parser.add_argument("--recordings", type=int, default=64)
    parser.add_argument("--limit", type=float, default=1800.0, help="seconds that one command may take")
    parser.add_argument("--verbs", nargs="+", default=["inspect", "identify", "simulate", "score", "diagnose", "batch"])
    options = parser.parse_args()
    program = str(Path(options.quell).resolve())
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        model = work / "model.toml"
        model.write_text(MODEL)
        sizes = [10**k for k in range(3, 8) if 10**k <= options.longest]
        for size in sizes:
            record(work / str(size), size)
        out = ["--out", str(work / "out")]
        verbs = {
            "inspect": lambda path: ["inspect", path],
            "identify": lambda path: ["identify", path, *out],
            "simulate": lambda path: ["simulate", str(model), path, "--out", str(work / "prediction.csv")],
            "score": lambda path: ["score", str(model), path],
            "diagnose": lambda path: ["diagnose", "--model", str(model), path, *out],
        }
        for verb in options.verbs:
            if verb in verbs:
                longest = options.diagnosed if verb == "diagnose" and options.diagnosed else options.longest
                run = lambda size: measure([program, *verbs[verb](str(work / str(size)))], options.limit)
                table(f"quell {verb}, one recording", "samples", [s for s in sizes if s <= longest], run)
        if "batch" in options.verbs:
            table("quell diagnose --batch, recordings of 1000 samples", "recordings",
                  [n for n in (4, 16, 64, 256) if n <= options.recordings],
                  lambda count: batch(program, model, work / f"fleet{count}", count, options.limit))


def batch(program, model, fleet, count, limit):
    for number in range(count):
        record(fleet / str(number), 1000, seed=number)
    command = [program, "diagnose", "--batch", "--model", str(model), str(fleet), "--out", str(fleet / "out")]
    return measure(command, limit)


if __name__ == "__main__":
    sys.exit(main())
