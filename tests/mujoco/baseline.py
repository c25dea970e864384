"""The baseline fit: how well the nominal structure can explain a recording once it is refitted.

The model is the flexible joint without any effect, q'' = w^2 (u - q) + 2 xi w (u' - q'), driven by the
measured motor side u. Free: f, xi, the clock offset, the initial state of the link, and the output's offset (for the tip its
rigid frame, for an accelerometer its bias). The residual over the noise is 1 where nothing is hidden.
"""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares
from scipy.signal import cont2discrete, lfilter

GRID_S = 2.5e-4           # step of the linear filter: first-order hold on u errs by u'' h^2 / 12, some 0.05 urad
CLOCK_BOUND_S = 0.06      # wide, since the clock offset is a nuisance that may swallow most of a lag


def rigid_frame(points, model):
    """The rotation and translation that carry `model` onto `points` best (Kabsch), as the carried points."""
    centre, origin = points.mean(0), model.mean(0)
    left, _, right = np.linalg.svd((model - origin).T @ (points - centre))
    turn = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    return (model - origin) @ left @ turn @ right + centre


class Baseline:
    """Residuals of the nominal structure on one recording, as a function of (ln f, ln xi, clock offset, e0, e0')."""

    def __init__(self, recording, nominal):
        self.recording, self.nominal = recording, nominal
        time = recording["encoder_time"]
        self.grid = np.arange(time[0], time[-1] + GRID_S / 2, GRID_S)
        self.motor = CubicSpline(time, recording["encoder"])(self.grid)

    def link(self, w, xi, e0, v0):
        """Link position on the grid: the forced response of G(s) = (2 xi w s + w^2) / (s^2 + ...) and a free decay."""
        num, den, _ = cont2discrete(([2 * xi * w, w * w], [1, 2 * xi * w, w * w]), GRID_S, method="foh")
        start = self.motor[0]
        forced = lfilter(num.ravel(), den, self.motor - start) + start
        t, damped = self.grid - self.grid[0], w * np.sqrt(max(1 - xi * xi, 1e-6))
        decay = np.exp(-xi * w * t) * (e0 * np.cos(damped * t) + (v0 + xi * w * e0) / damped * np.sin(damped * t))
        return forced + decay

    def prediction(self, parameters):
        """The output at its stamps, with the linear nuisances (frame, offset) already at their best."""
        f, xi = np.exp(parameters[:2])
        measured, role = self.recording["values"], self.recording["role"]
        link = CubicSpline(self.grid, self.link(2 * np.pi * f, xi, parameters[3], parameters[4]))
        time = self.recording["time"] + parameters[2]
        if role == "tip_position":
            q, lever = link(time), self.nominal["lever_arm_m"]
            tip = np.column_stack([lever * np.cos(q), lever * np.sin(q), np.full_like(q, self.nominal["tip_height_m"])])
            return rigid_frame(measured, tip)
        if role == "deformation":
            value = link(time) - CubicSpline(self.grid, self.motor)(time)
        else:
            value = self.nominal["lever_arm_m"] * link(time, 2)
        return (value + np.mean(measured[:, 0] - value))[:, None]

    def residual(self, parameters):
        """Measured minus predicted, flat."""
        return (self.recording["values"] - self.prediction(parameters)).ravel()

    def rms_along_path(self, parameters):
        """Root mean square of the residual; of a tip's only the component along its path, where deformation shows."""
        predicted = self.prediction(parameters)
        residual = self.recording["values"] - predicted
        if predicted.shape[1] == 3:
            # The arc's plane from its two leading directions; the path is square to the radius in that plane.
            q = CubicSpline(self.grid, self.motor)(self.recording["time"] + parameters[2])
            basis = np.column_stack([np.cos(q), np.sin(q), np.ones_like(q)])
            ex, ey = np.linalg.lstsq(basis, predicted, rcond=None)[0][:2] / self.nominal["lever_arm_m"]
            along = np.outer(-np.sin(q), ex) + np.outer(np.cos(q), ey)
            return np.sqrt(np.mean(np.sum(residual * along, axis=1) ** 2))
        return np.sqrt(np.mean(residual ** 2))

    def fit(self):
        """Least squares from several starts of f; returns (rms of the residual along the path, parameters)."""
        scale = np.array([0.05, 0.3, 1e-3, 1e-4, 1e-3])
        best = None
        for factor in (1.0, 0.96, 1.04):
            start = np.array([np.log(self.nominal["natural_frequency_hz"] * factor),
                              np.log(self.nominal["damping_ratio"]), 0.0, 0.0, 0.0])
            low = np.array([start[0] - 0.5, np.log(1e-3), -CLOCK_BOUND_S, -0.02, -1.0])
            high = np.array([start[0] + 0.5, np.log(0.9), CLOCK_BOUND_S, 0.02, 1.0])
            found = least_squares(self.residual, start, bounds=(low, high), x_scale=scale, diff_step=1e-6, max_nfev=40)
            if best is None or found.cost < best.cost:
                best = found
        return self.rms_along_path(best.x), best.x
