"""The recordings, as every peer gets them: evenly sampled, with what drives them and what they are judged by.

What an engineer knows beforehand is given to all: which channel drives, the order of the equation of motion, the
controller of a loop, a list of terms that holds every law hidden here that a list of terms can hold.
"""

import gzip
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar
from scipy.signal import savgol_filter

CLOCK = 0.01                # how far a sensor's clock may be off, s
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def least(function, reach):
    """Where a function is least between minus and plus its reach: the best of a scan, refined."""
    scan = np.linspace(-reach, reach, 41)
    best = scan[np.argmin([function(value) for value in scan])]
    around = best - scan[1] + scan[0], best + scan[1] - scan[0]
    return minimize_scalar(function, bounds=around, method="bounded").x


@dataclass
class Stretch:
    """A part of a recording on an even grid."""

    step: float
    position: np.ndarray          # what is to be predicted, as measured
    drives: dict                  # what is known beforehand, by name
    columns: np.ndarray           # nuisances that are fitted to the error of any model, as Quell fits them
    clock: float = 0.0            # how far the clock of the sensor may be off, s

    def part(self, rows):
        """Some of its rows."""
        drives = {name: values[rows] for name, values in self.drives.items()}
        return Stretch(self.step, self.position[rows], drives, self.columns[rows], self.clock)

    def error(self, prediction):
        """Root mean square of what is left of the recording; none where the prediction ran away."""
        reach = 10.0 * np.ptp(self.position) + np.abs(self.position).max()
        if not np.all(np.isfinite(prediction)) or np.abs(prediction).max() > reach:
            return None
        if self.clock == 0.0:
            return self._left(prediction)
        time = self.step * np.arange(len(prediction))
        spline = CubicSpline(time, prediction)
        shifted = lambda shift: self._left(spline(np.clip(time - shift, 0.0, time[-1])))
        return shifted(least(shifted, self.clock))

    def _left(self, prediction):
        left = self.position - prediction
        if self.columns.shape[1]:
            left = left - self.columns @ np.linalg.lstsq(self.columns, left, rcond=None)[0]
        return float(np.sqrt(np.mean(left**2)))


@dataclass
class Case:
    """One row of the table."""

    name: str
    model: Path
    train: Path
    held_out: Path
    unit: str
    scale: float                  # of errors to SI, in which Quell tells them: an angle's are told at the lever arm
    judged_by_held_out: bool      # else Quell keeps the last third of the moves apart
    fitted: Stretch = None
    judged: Stretch = None
    acceleration: list = field(default_factory=list)   # terms of x'' = sum of coefficient times term
    loop: object = None           # force from reference, position and the two positions before
    output: tuple = ("x",)        # what a difference equation predicts: x, or x less a drive
    inputs: list = field(default_factory=list)         # choices of what drives it


def table(path):
    """Columns of a CSV file by name."""
    with gzip.open(path, "rt") as lines:
        names = lines.readline().strip().split(",")
        return dict(zip(names, np.loadtxt(lines, delimiter=",").T))


def rows_of(manifest):
    """The rows that a manifest takes."""
    return slice(*tomllib.loads(manifest.read_text())["rows"])


def example(folder, shared, work):
    """Manifests and model of an example beside its data."""
    data = shared / "recordings" / folder
    if not data.is_dir():
        return None
    work = work / folder
    work.mkdir(parents=True)
    for path in [*(EXAMPLES / folder).iterdir(), *data.iterdir()]:
        (work / path.name).symlink_to(path.resolve())
    return work


def silverbox(shared, work):
    """Volts to volts; two realisations of the multisine are fitted, the arrow is held out."""
    work = example("silverbox", shared, work)
    if work is None:
        return None
    data = table(work / "SNLS80mV.csv.gz")
    case = Case("silverbox", work / "model.toml", work / "train.toml", work / "held_out.toml", "mV", 1.0, True)

    def stretch(manifest):
        rows = rows_of(manifest)
        position, force = data["output_V"][rows], data["input_V"][rows]
        return Stretch(1.0 / 610.3516, position, {"f": force}, np.ones((len(position), 1)))

    case.fitted, case.judged = stretch(case.train), stretch(case.held_out)
    case.acceleration = ["1", "x", "v", "f", "x**2", "x**3", "x*v", "v**2", "x**2*v", "v*abs(v)", "sign(v)"]
    case.inputs = [("f",)]
    return case


def emps(shared, work):
    """Reference to position; the loop between them is known."""
    work = example("emps", shared, work)
    if work is None:
        return None
    data = table(work / "DATA_EMPS.csv.gz")
    case = Case("emps", work / "model.toml", work / "train.toml", work / "held_out.toml", "um", 1.0, True)
    keys = tomllib.loads(case.model.read_text())
    position_gain, velocity_gain = keys["position_gain"]["value"], keys["velocity_gain"]["value"]
    limit, span = keys["output_limit"]["value"], keys["loop_velocity_span_s"]["value"]

    def loop(reference, now, before):
        force = velocity_gain * (position_gain * (reference - now) - (now - before) / span)
        return min(max(force, -limit), limit)

    def stretch(manifest):
        rows, step = rows_of(manifest), 1e-3
        position, reference = data["q_meas_m"][rows], data["q_ref_m"][rows]
        velocity = np.gradient(reference, step)
        before = np.concatenate([position[:1].repeat(2), position[:-2]])
        force = [loop(*each) for each in zip(reference, position, before)]
        drives = {"r": reference, "w": velocity, "a": np.gradient(velocity, step),
                  "s": np.where(np.abs(velocity) > 1e-4, np.sign(velocity), 0.0), "f": np.array(force)}
        return Stretch(step, position, drives, np.empty((len(position), 0)))

    case.loop = loop
    case.fitted, case.judged = stretch(case.train), stretch(case.held_out)
    case.acceleration = ["1", "v", "f", "sign(v)", "abs(v)", "v**2", "v*abs(v)", "v**3", "x", "x**2", "x*f"]
    case.output, case.inputs = ("x", "r"), [("w",), ("w", "s"), ("w", "a", "s")]
    return case


def linear_misfit(stretch):
    """What a spring and a damper leave of the acceleration; smoothed over a tenth of a period or so."""
    position, velocity, rate = (savgol_filter(stretch.position, 15, 5, deriv=d, delta=stretch.step) for d in (0, 1, 2))
    terms = np.column_stack([position - stretch.drives["u"], velocity - stretch.drives["w"]])
    return np.sum((rate - terms @ np.linalg.lstsq(terms, rate, rcond=None)[0]) ** 2)


def joint(folder, quell):
    """A flexible joint: motor side to tip, both on the tracker's grid."""
    case = Case(folder.name, folder / "model.toml", folder / "train", folder / "test", "um", 0.0, False)
    case.scale = arm = tomllib.loads(case.model.read_text())["lever_arm_m"]

    def load(recording):
        return table(recording / "encoder.csv.gz"), *quell.recorded(case.model, recording)

    def stretch(motor, stamps, arc, clock):
        step = float(np.median(np.diff(stamps)))
        spline = CubicSpline(motor["time_s"], motor["joint_1_rad"])
        count = int((min(stamps[-1], motor["time_s"][-1]) - stamps[0]) / step + 1e-6) + 1
        grid = stamps[0] + step * np.arange(count)
        seen = np.clip(grid - clock, 0.0, motor["time_s"][-1])
        drives = {"u": spline(seen), "w": spline(seen, 1), "a": spline(seen, 2)}
        frame = np.column_stack([np.ones(count), np.sin(drives["u"]), np.cos(drives["u"])])
        angle = CubicSpline(stamps, arc / arm)(grid) if np.ptp(np.diff(stamps)) > 0.1 * step else arc[:count] / arm
        # The sensor's frame from where the joint rests, so that the models need not learn it.
        rest = np.abs(drives["w"]) < 1e-3
        lying = np.linalg.lstsq(frame[rest], (angle - drives["u"])[rest], rcond=None)[0]
        return Stretch(step, angle - frame @ lying, drives, frame, CLOCK)

    train, test = load(case.train), load(case.held_out)
    # A clock that is off by a millisecond looks like a deformation as large as the true one.
    offset = least(lambda clock: linear_misfit(stretch(*train, clock)), CLOCK)
    case.fitted, case.judged = stretch(*train, offset), stretch(*test, offset)
    bent, rate = "(x-u)", "(v-w)"
    case.acceleration = ["1", bent, rate, "w", "a", f"{bent}**2", f"{bent}**3", f"{bent}*abs({bent})", f"{rate}*abs({rate})",
                         f"sign({rate})", "v", "v*abs(v)", "sign(v)", f"{bent}*{rate}", f"{bent}**2*{rate}", "sin(x)", "cos(x)"]
    case.output, case.inputs = ("x", "u"), [("a",), ("w", "a")]
    return case
