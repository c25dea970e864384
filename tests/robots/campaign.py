#!/usr/bin/env python3
"""Commands `udp_arm.py` through `quell serve` for many moves and judges what came of it.

    tests/robots/campaign.py target/release/quell --moves 200

Both are processes of their own; moves are commanded over HTTP. Every eighth move is unshaped, for
comparison. With --change the mode jumps up by 20 % half-way. It says what it measured, line by line, and
ends with 1 where something falls short. 200 moves take some six minutes. With --kill
the service is killed in mid-move instead, and started anew.

A machine that is busy elsewhere leaves the robot without setpoints, and the service without measurements: moves are
stopped then, and ring. With --stamps only what holds nevertheless is judged: limits by the stamps of the setpoints,
recordings, what is kept on disk. The rest is printed.
"""

import argparse
import csv
import json
import pathlib
import queue
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request

ARM = pathlib.Path(__file__).with_name("udp_arm.py")
# Steps of the arm a second.
ARM_RATE = 1000.0
# Limits hold for corrections and slow starts, too, but for rounding.
ROUNDING = 1 + 1e-9
# Buffers and threads of the service have come to their size after so many moves; what grows from then on is a leak.
MOVES_TO_SIZE = 20
# A longer silence has stopped the robot: after it the command starts slowly, from where it was.
BRIDGED = 0.02
TARGETS = (0.5, 0.0)

CONFIGURATION = """
[service]
robot = "udp"
{description}

[watchdog]
timeout_s = 1.0

[recording]
max_size_mb = 50.0

"""

JOINT = """
[[joint]]
name = "{name}"
velocity_deg_s = 100.0
acceleration_deg_s2 = 600.0
jerk_deg_s3 = 12000.0
frequency_hz = {belief}
damping_ratio = 0.05
sensor_rate_hz = {sensor_rate}
encoder_resolution_deg = 0.0006
"""

# One joint about z with the tip at 0.8 m, for a tracker that sees the tip.
DESCRIPTION = """
name = "One joint, tip at 0.8 m"
[move]
joint = 1
target_deg = 30.0
[controller]
rate_hz = 1000.0
[servo]
bandwidth_hz = 30.0
damping_ratio = 1.0
velocity_feed_forward = 1.0
[encoder]
rate_hz = 1000.0
resolution_rad = 1.0e-5
# Not where the tracker stands: the service does not know that.
[tracker]
rate_hz = 500.0
noise_um = 5.0
position_m = [0.0, 0.0, 0.0]
rpy_deg = [0.0, 0.0, 0.0]
clock_offset_s = 0.0
clock_skew_ppm = 0.0
[[joint]]
dh = {{ a_m = {radius}, alpha_deg = 0.0, d_m = 0.0, theta_deg = 0.0 }}
limits = {{ velocity_deg_s = 100.0, acceleration_deg_s2 = 600.0, jerk_deg_s3 = 12000.0 }}
mode = [{{ frequency_hz = {belief}, damping_ratio = 0.05, damping = "across_joint" }}]
link = {{ mass_kg = 9.0, centre_m = [-0.4, 0.0, 0.0], inertia_kg_m2 = [0.05, 0.2, 0.2] }}
"""


class Service:
    """`quell serve` as a process."""

    def __init__(self, quell, folder, options):
        self.folder, description = folder, ""
        sensor_rate = ARM_RATE / options.divider
        if options.sensor == "tip":
            text = DESCRIPTION.format(radius=0.8, belief=options.belief)
            (folder / "robot.toml").write_text(text)
            description = 'description = "robot.toml"'
        text = CONFIGURATION.format(description=description)
        for k in range(options.joints):
            name = f"joint_{k + 1}"
            text += JOINT.format(name=name, belief=options.belief, sensor_rate=sensor_rate)
        (folder / "quell.toml").write_text(text)
        self.quell, self.rate = quell, options.rate
        self.start("127.0.0.1:0")

    def start(self, udp):
        command = [self.quell, "serve", "--config", str(self.folder / "quell.toml")]
        command += ["--http", "127.0.0.1:0", "--udp", udp, "--rate", str(self.rate)]
        command += ["--data", str(self.folder / "data")]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        words = line.split()
        self.udp = words[words.index("UDP") + 2].rstrip(",")
        self.page = words[words.index("page") + 2]

    def ask(self, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"{self.page.rstrip('/')}{path}", data)
        request.add_header("Content-Type", "application/json")
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.load(answer)

    def state(self):
        return self.ask("/api/state")

    def wait(self, what, holds, patience=60.0):
        since = time.monotonic()
        while time.monotonic() - since < patience:
            state = self.state()
            found = holds(state)
            if found:
                return found
            time.sleep(0.02)
        sys.exit(f"waited {patience} s in vain: {what}: {json.dumps(state)}")

    def wait_for_rest(self):
        def rest(state):
            return state["joints"] and all(j["phase"] == "rest" for j in state["joints"])

        self.wait("the joints rest", rest)

    def enable(self):
        """Takes a fault back, if there is one, and lets moves begin, once every joint is ready."""
        while True:
            self.wait_for_rest()
            try:
                self.ask("/api/v1/reset", {})
                return self.ask("/api/v1/enable", {})
            except urllib.error.HTTPError as error:
                if error.code != 409:
                    sys.exit(f"/api/v1/enable: {error.read().decode()}")
                time.sleep(0.05)

    def order(self, target, shaper=None):
        """The number of a move; after the start and after a fault moves are enabled first."""
        body = {"joint": "joint_1", "target_rad": target}
        if shaper:
            body["shaper"] = shaper
        while True:
            self.wait_for_rest()
            try:
                return self.ask("/api/move", body)["id"]
            except urllib.error.HTTPError as error:
                text = error.read().decode()
                if error.code != 409:
                    sys.exit(f"/api/move: {text}")
                self.enable()

    def ended(self, number):
        """What a move came to, once it has ended."""
        found = lambda state: [m for m in state["moves"] if m["id"] == number]
        return self.wait("the move ends", found)[0]

    def move(self, target, shaper=None):
        """One that went to its end; one that a silence of the robot has stopped is asked for again."""
        while True:
            done = self.ended(self.order(target, shaper))
            if not done["interrupted"]:
                return done

    def remembered(self):
        """The mode that is on disk."""
        text = (self.folder / "data" / "state.json").read_text()
        return json.loads(text)["joints"]["joint_1"]["modes"][-1]["mode"]

    def memory(self):
        """Resident memory, kB."""
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0])


def arguments(options):
    """Those of `udp_arm.py`."""
    words = ["--sensor", options.sensor, "--divider", options.divider]
    words += ["--frequency", options.frequency, "--seed", options.seed]
    return [*words, "--joints", options.joints]


class Robot:
    """`udp_arm.py`, or another program that speaks as it does, as a process."""

    def __init__(self, service, folder, arguments, arm=ARM):
        self.log = folder / "setpoints.csv"
        command = [sys.executable, str(arm), "--service", service.udp, "--log", str(self.log)]
        command += [str(word) for word in arguments]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.moves, self.last = queue.Queue(), None
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        for line in self.process.stdout:
            self.moves.put(json.loads(line))

    def moved(self, target):
        """The last move that it made, which went to the target."""
        while True:
            try:
                self.last = self.moves.get(timeout=30)
            except queue.Empty:
                # From where a silence had stopped it, it was too short to count.
                return self.last
            if abs(self.last["to"] - target) < 1e-3:
                return self.last

    def order(self, **what):
        self.process.stdin.write(json.dumps(what) + "\n")
        self.process.stdin.flush()

    def end(self):
        self.process.stdin.close()
        self.process.wait(timeout=60)


def kill(verdict, service, options):
    """Kills the service in mid-move and starts it anew, where the robot still speaks to."""
    for target in (0.5, 0.0):
        service.move(target)
    # What is recorded goes on for a second.
    time.sleep(2.0)
    cut = service.order(0.5)
    moves = lambda state: state["joints"][0]["phase"] == "moving"
    service.wait("the move begins", moves)
    time.sleep(0.4)
    moving = moves(service.state())
    service.process.kill()
    service.process.wait()
    kept = service.remembered()
    service.start(service.udp)
    service.wait_for_rest()
    mode = service.state()["joints"][0]["mode"]
    text = f"{kept['frequency_hz']:.3f} Hz on disk, {mode['frequency_hz']:.3f} Hz in force"
    # What rings after the kill may teach it a little more at once.
    near = lambda one, other, within: abs(one / other - 1.0) < within
    # Two moves have taught it, of which it saw what the network let through.
    good = near(kept["frequency_hz"], options.frequency, 0.02)
    good &= near(mode["frequency_hz"], kept["frequency_hz"], 0.01)
    verdict.says(good, f"killed and started anew: {text}")
    verdict.says(moving, f"killed in mid-move: {moving}", timed=True)
    # A setpoint that ends in mid-move leaves a vibration that is nobody's.
    time.sleep(2.8)
    share, calm = first_moves(service)
    text = f"the first moves after the start leave {share:.2%}; {calm} of them are calm"
    verdict.says(share <= 0.03, text, timed=True)
    shelf = service.folder / "data" / "recordings"
    files = sorted(shelf.glob("[!.]*/*.mcap"))
    read = [subprocess.run([service.quell, "inspect", file], capture_output=True) for file in files]
    good = sum(run.returncode == 0 for run in read)
    text = f"{good} of {len(files)} recordings are read"
    verdict.says(len(files) >= 2 and good == len(files), text)
    # A second of rest before it, and what the move had come to but for the last quarter of a second.
    about = shelf / f"move-{cut:06}" / "about.json"
    length = json.loads(about.read_text())["duration_s"] if about.exists() else 0.0
    text = f"of the move that was killed {length:.2f} s are kept, 1 s of rest before it"
    verdict.says(length > 1.1, text, timed=True)


def first_moves(service):
    """What moves leave of their unshaped vibration in the median, and how many were judged.

    A time without ticks that is too long to be made up for stops the command, and that rings: such a move says
    nothing of what was learned. Three are judged in which no tick was skipped; where the machine has not left one
    in peace, the best."""
    calm, all_, skipped = [], [], service.state()["tick"]["skipped"]
    for number in range(9):
        done = service.move((0.0, 0.5)[number % 2])
        before, skipped = skipped, service.state()["tick"]["skipped"]
        all_.append(done["residual_rad"] / done["unshaped_rad"])
        if skipped == before:
            calm.append(all_[-1])
        if len(calm) == 3:
            break
    return statistics.median(calm) if calm else min(all_), len(calm)


class Verdict:
    def __init__(self, stamps=False):
        self.fails, self.stamps = 0, stamps

    def says(self, passes, text, timed=False):
        """Whether it passes; what is `timed` holds only where the machine has time for both sides."""
        noted = timed and self.stamps
        self.fails += not passes and not noted
        print(f"{'ok  ' if passes else 'note' if noted else 'FAIL'} {text}", flush=True)


def moves(service, robot, options):
    """The moves, as the arm saw them: shaped or not, residual, and when the mode jumped."""
    done, memory, skipped = [], [], 0
    jump = options.moves // 2 if options.change else None
    for number in range(options.moves):
        if number == jump:
            robot.order(frequency=1.2 * options.frequency)
        # The first two for the first comparison, then every eighth; not within a pair after a jump.
        plain = number < 2 or number % 8 == 7
        plain &= jump is None or not jump <= number < jump + 2
        told = service.move(TARGETS[number % 2], "none" if plain else None)
        true = robot.moved(TARGETS[number % 2])
        before, skipped = skipped, service.state()["tick"]["skipped"]
        disturbed = skipped > before
        done.append({**true, "shaped": not plain, "told": told, "disturbed": disturbed})
        # What rings is not to be met by the next move: seven time constants of 8 Hz at 5 %.
        time.sleep(2.8 if plain else 0.3)
        memory.append(service.memory())
        if options.verbose:
            mode = service.state()["joints"][0]["mode"]
            print(number, plain, true["residual"], told["residual_rad"], mode, flush=True)
    return done, memory, jump


def judge_residuals(verdict, done, jump):
    plain = statistics.median(m["residual"] for m in done if not m["shaped"])
    # Before the first comparison nothing is known: learning counts from the third move on.
    shaped = [m["residual"] for m in done if m["shaped"]]
    share = statistics.median(shaped) / plain
    worst = max(shaped) / plain
    text = f"adaptive residual {share:.2%} of unshaped {plain:.2e} rad in the median"
    calm = max((m["residual"] for m in done if m["shaped"] and not m["disturbed"]), default=0.0)
    text += f" of {len(shaped)} moves, at most {worst:.1%}, {calm / plain:.1%} where no tick was skipped"
    verdict.says(share <= 0.03, text, timed=True)
    if jump is not None:
        # A time without ticks that is too long to be made up for stops the command, and that rings: such
        # a move says nothing of what was learned. The second is judged, or else the next that is calm; where
        # none is, the best: what was not learned would show in all of them.
        after = [m for m in done[jump:] if m["shaped"]][:4]
        later = [m["residual"] for m in done[jump:] if not m["shaped"]]
        reference = statistics.median(later or [plain])
        calm = [m["residual"] for m in after[1:] if not m["disturbed"]]
        judged = calm[0] if calm else min(m["residual"] for m in after[1:])
        text = ", ".join(f"{m['residual'] / reference:.1%}" for m in after)
        text = f"after 20 % in frequency the moves leave {text}"
        verdict.says(judged <= 0.03 * reference, text, timed=True)


def judge_setpoints(verdict, log, limits, rate, joints=1):
    velocity, acceleration, jerk = (ROUNDING * limit for limit in limits)
    period, last, count, gaps, late = 1.0 / rate, {}, 0, 0, 0
    worst = dict.fromkeys(("velocity", "acceleration", "jerk", "position jump"), 0.0)
    with open(log) as file:
        for row in csv.DictReader(file):
            now = {key: float(value) for key, value in row.items()}
            count += 1
            before = last.get(now["joint"])
            if before and now["seq"] == before["seq"] + joints:
                # By the time that went by: ticks that were missed are made up for.
                gone = max(round((now["t"] - before["t"]) / period), 1) * period
                late += gone > 1.5 * period
                change = abs(now["acceleration"] - before["acceleration"]) / gone
                mean = 0.5 * (before["velocity"] + now["velocity"])
                jump = abs(now["position"] - before["position"] - gone * mean)
                if gone > BRIDGED + 1.5 * period:
                    # The robot has stopped, and is led on from where it was.
                    change, jump = 0.0, abs(now["position"] - before["position"])
                    gone = period
                for key, value in (
                    ("velocity", abs(now["velocity"]) / velocity),
                    ("acceleration", abs(now["acceleration"]) / acceleration),
                    ("jerk", (change - 1e-6) / jerk),
                    ("position jump", (jump - 1e-13) / (jerk * gone**3 * 5 / 24)),
                ):
                    worst[key] = max(worst[key], value)
            elif before:
                gaps += 1
            last[now["joint"]] = now
    text = ", ".join(f"{key} {value:.3f}" for key, value in worst.items())
    text = f"{count} setpoints, {gaps} gaps, {late} after missed ticks; worst shares of what is allowed: {text}"
    verdict.says(count > 0 and max(worst.values()) <= 1.0, text)


def judge_service(verdict, state, memory):
    tick = state["tick"]
    due = state["time_s"] * tick["rate_hz"]
    missing = due - tick["ticks"] - tick["skipped"]
    text = f"{tick['ticks']} ticks, {tick['skipped']} skipped, {tick['overruns']} overruns"
    text += f", lateness p50 {tick['lateness_p50_s'] * 1e6:.0f}, p99 {tick['lateness_p99_s'] * 1e6:.0f},"
    text += f" max {tick['lateness_max_s'] * 1e6:.0f} us, real time: {tick['real_time']}"
    # The clock starts some 100 ms before the first tick.
    verdict.says(0 <= missing < 0.5 * tick["rate_hz"], f"{text}; {missing:.0f} not accounted for")
    late = max(memory[-3:])
    early = memory[MOVES_TO_SIZE] if len(memory) > 2 * MOVES_TO_SIZE else late
    verdict.says(late - early < 4096, f"resident memory {early} kB, at the end {late} kB")
    link = state["link"]
    keys = ("received", "lost", "reordered", "doubled", "late", "malformed", "overflowed")
    counted = link["lost"] > 0 and link["reordered"] > 0 and link["doubled"] > 0
    verdict.says(counted, "link: " + ", ".join(f"{key} {link[key]}" for key in keys))
    print(f"     tick records lost: {tick['records_lost']}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("quell", help="the program")
    parser.add_argument("--moves", type=int, default=200)
    parser.add_argument("--sensor", default="link", choices=["link", "tip", "deformation"])
    parser.add_argument("--divider", type=int, default=1, help="steps a sample of the sensor")
    parser.add_argument("--frequency", type=float, default=8.0)
    parser.add_argument("--belief", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--change", action="store_true")
    parser.add_argument("--kill", action="store_true", help="in mid-move, and start anew")
    parser.add_argument("--stamps", action="store_true", help="judge only what a busy machine cannot change")
    parser.add_argument("--verbose", action="store_true")
    parser.set_defaults(joints=1, rate=1000)
    options = parser.parse_args()
    verdict = Verdict(options.stamps)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        service = Service(options.quell, folder, options)
        try:
            robot = Robot(service, folder, arguments(options))
            service.wait_for_rest()
            if options.kill:
                kill(verdict, service, options)
            else:
                done, memory, jump = moves(service, robot, options)
            state = service.state()
            robot.end()
        finally:
            service.process.terminate()
            service.process.wait(timeout=60)
        judge_setpoints(verdict, robot.log, state["joints"][0]["limits"], options.rate)
        if not options.kill:
            judge_residuals(verdict, done, jump)
            judge_service(verdict, state, memory)
    sys.exit(1 if verdict.fails else 0)


if __name__ == "__main__":
    main()
