"""PySINDy: sparse regression of the equation of motion, and a free run of what it found.

The state is position and velocity; `x' = v` is given, `v'` is regressed on the case's terms. Settings are chosen on the
fitted part alone: the first 70 % are regressed, the free run over the rest is compared. Then all of it is regressed.

- derivatives: finite differences of twelfth order, of the recording as it is or smoothed (Savitzky-Golay; the drives are
  smoothed alike, so that a linear equation stays what it is); or the weak form, by test functions of several lengths
- thresholds: eight, as shares of the acceleration, for terms of unit root mean square

Source: de Silva et al., PySINDy, JOSS 5 (2020) 2104; Kaptanoglu et al., JOSS 7 (2022) 3994; for the weak form Reinbold,
Gurevich, Grigoriev, Phys. Rev. E 101 (2020) 010203.
"""

import math

import numpy as np
import pysindy
from scipy.interpolate import CubicSpline
from scipy.signal import savgol_filter

REGRESSED = 0.7
THRESHOLDS = (0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1)
WINDOWS = (0, 7, 11, 15, 21, 31, 45, 61)      # samples
WEAK = (4, 5, 6, 8, 10, 14, 20, 40, 80)                  # half lengths of the test functions, samples
DOMAINS = 600
STEPS = 4                                     # in a sample: the fastest mode here turns by 0.18 rad in one
ARRAYS = {"sign": np.sign, "abs": np.abs, "sin": np.sin, "cos": np.cos}
NUMBERS = {"sign": lambda v: float((v > 0.0) - (v < 0.0)), "abs": abs, "sin": math.sin, "cos": math.cos}


def differentiate(values, time, order):
    """Finite differences of twelfth order: a period may have no more than nine samples."""
    return pysindy.FiniteDifference(order=12, d=order, is_uniform=True)._differentiate(values[:, None], time)[:, 0]


class Regression:
    """What is regressed on what, by one way to differentiate."""

    def __init__(self, case, stretch, window=0, weak=0):
        smooth = (lambda values: savgol_filter(values, window, 5)) if window else np.asarray
        self.time, self.weak = stretch.step * np.arange(len(stretch.position)), weak
        position = smooth(stretch.position)
        velocity, self.rate = (differentiate(position, self.time, order) for order in (1, 2))
        self.state = np.column_stack([position, velocity])
        self.control = np.column_stack([smooth(values) for values in stretch.drives.values()])
        names, columns = ",".join(["x", "v", *stretch.drives]), [*self.state.T, *self.control.T]
        self.terms, functions = [], []
        for term in case.acceleration:
            size = float(np.sqrt(np.mean(eval(f"lambda {names}: ({term}) + 0.0 * x", ARRAYS)(*columns) ** 2))) or 1.0
            functions.append(eval(f"lambda {names}: (({term}) + 0.0 * x) / {size!r}", ARRAYS))
            self.terms.append((term, size))
        self.library = pysindy.CustomLibrary(functions)
        if weak:
            np.random.seed(1)     # the test functions lie at random
            half = weak * stretch.step
            self.library = pysindy.WeakPDELibrary(self.library, spatiotemporal_grid=self.time, K=DOMAINS, H_xt=half)

    def equation(self, threshold):
        """Terms of x'' that are left, with their coefficients."""
        optimizer = pysindy.STLSQ(threshold=threshold * self.rate.std(), alpha=1e-12)
        model = pysindy.SINDy(feature_library=self.library, optimizer=optimizer)
        rates = None if self.weak else np.column_stack([self.state[:, 1], self.rate])
        model.fit(self.state, t=self.time, x_dot=rates, u=self.control)
        coefficients = model.coefficients()[1]
        return [(term, float(c) / size) for c, (term, size) in zip(coefficients, self.terms) if c != 0.0]


def free_run(case, stretch, equation, start):
    """Positions that the equation makes of the drives, from a start; NaN where it runs away."""
    terms = " + ".join(f"{c!r} * ({term})" for term, c in equation) or "0.0"
    acceleration = eval(f"lambda {','.join(['x', 'v', *stretch.drives])}: {terms}", NUMBERS)
    count, step, start = len(stretch.position), stretch.step / STEPS, [float(value) for value in start]
    time = np.arange(count)
    halves = np.arange(2 * STEPS * (count - 1) + 1) / (2 * STEPS)
    driven = {name: CubicSpline(time, values)(halves) for name, values in stretch.drives.items()}
    try:
        if case.loop:
            return looped(case.loop, acceleration, stretch, start, step)
        rows = list(zip(*(values.tolist() for values in driven.values())))
        return driven_run(acceleration, rows, count, start, step)
    except (OverflowError, ValueError):
        return np.full(count, np.nan)


def runge_kutta(acceleration, x, v, step, first, middle, last):
    """One step of the classical method; the drives at its start, middle and end."""
    half = 0.5 * step
    a1 = acceleration(x, v, *first)
    v2 = v + half * a1
    a2 = acceleration(x + half * v, v2, *middle)
    v3 = v + half * a2
    a3 = acceleration(x + half * v2, v3, *middle)
    v4 = v + step * a3
    a4 = acceleration(x + step * v3, v4, *last)
    return x + step / 6.0 * (v + 2.0 * (v2 + v3) + v4), v + step / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)


def driven_run(acceleration, rows, count, start, step):
    """By drives that are known beforehand."""
    (x, v), positions = start, np.full(count, np.nan)
    positions[0] = x
    for k in range(1, count):
        for n in range(2 * STEPS * (k - 1), 2 * STEPS * k, 2):
            x, v = runge_kutta(acceleration, x, v, step, rows[n], rows[n + 1], rows[n + 2])
        if not abs(x) < 1e6:
            break
        positions[k] = x
    return positions


def looped(loop, acceleration, stretch, start, step):
    """By a controller that holds its force over a sample."""
    others = [values.tolist() for values in stretch.drives.values()]
    force = list(stretch.drives).index("f")
    (x, v), positions = start, [start[0] - 2.0 * stretch.step * start[1], start[0] - stretch.step * start[1], start[0]]
    reference = others[list(stretch.drives).index("r")]
    for k in range(len(stretch.position) - 1):
        drives = [values[k] for values in others]
        drives[force] = loop(reference[k], x, positions[-3])
        for _ in range(STEPS):
            x, v = runge_kutta(acceleration, x, v, step, drives, drives, drives)
        positions.append(x)
    return np.array(positions[2:])


def search(case):
    """The settings whose free run is best; none where all diverged."""
    split = int(REGRESSED * len(case.fitted.position))
    regressed, compared = case.fitted.part(slice(0, split)), case.fitted.part(slice(split, None))
    best = None, None
    for way in [{"window": window} for window in WINDOWS] + [{"weak": weak} for weak in WEAK]:
        regression, tried = Regression(case, regressed, **way), []
        start = Regression(case, case.fitted, window=way.get("window", 0)).state[split]
        for threshold in THRESHOLDS:
            equation = regression.equation(threshold)
            if equation in tried:
                continue
            tried.append(equation)
            error = compared.error(free_run(case, compared, equation, start))
            if error is not None and (best[0] is None or error < best[0]):
                best = error, {**way, "threshold": threshold}
    return best[1]


def fit(case, settings):
    """The equation, from all that is fitted."""
    way = {name: value for name, value in settings.items() if name != "threshold"}
    return Regression(case, case.fitted, **way).equation(settings["threshold"])


def predict(case, equation):
    """A free run over what was held out, from its first sample; at rest where the drive is a motion."""
    position = case.judged.position
    speed = 0.0 if "u" in case.judged.drives else np.gradient(position[:3], case.judged.step, edge_order=2)[0]
    return free_run(case, case.judged, equation, (position[0], speed))
