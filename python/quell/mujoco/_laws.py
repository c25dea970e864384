"""Laws for which a format has no element, as tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["Friction", "Law", "about_zero", "friction_of", "resistance_of", "spline"]

Array = NDArray[np.float64]
Coordinate = Literal["position", "velocity"]
# Points of a curve, and of a period.
POINTS, A_PERIOD = 401, 64
# Turns (m over 2 pi) in each direction that a table over the position has.
TURNS = 1.0
# A speed, rad/s or m/s, and a position beyond which no table is asked.
FAR = 100.0
# Widths about 0 within which a law over the velocity has changed all it does: exp(-16) = 1e-7.
DENSE = 4.0


@dataclass(frozen=True, eq=False)
class Law:
    """
    A generalised force as a table over a coordinate.

    Parameters
    ----------
    joints : tuple of str
        The joints whose positions (velocities) add up to the coordinate; the force acts on each.
    coordinate : {"position", "velocity"}
        What the force depends on.
    points : ndarray
        Points of the coordinate in rising order, rad or rad/s (m, m/s), shape (n,). Beyond the ends the end values hold.
    values : ndarray
        The force in the joints' positive direction at the points, N.m (N), shape (n,).
    effect : str
        What it is, such as `stribeck_friction`.
    """

    joints: tuple[str, ...]
    coordinate: Coordinate
    points: Array
    values: Array
    effect: str

    def __call__(self, coordinate: float) -> float:
        return float(np.interp(coordinate, self.points, self.values))

    def to_dict(self) -> dict[str, Any]:
        """
        Give the law as plain lists.

        Returns
        -------
        dict
            Keys `joints`, `coordinate`, `points`, `values` and `effect`.
        """
        points, values = self.points.tolist(), self.values.tolist()
        given = {"joints": list(self.joints), "coordinate": self.coordinate, "effect": self.effect}
        return {**given, "points": points, "values": values}


@dataclass(frozen=True)
class Friction:
    """
    Dry friction as `frictionloss`, which sticks, and what is to be added to it while the joint slides.

    `added(v)` is the force in positive direction: continuous, and so small at rest that sticking is the constraint's.
    """

    loss: float
    added: Callable[[Array], Array] | None
    width: float


def friction_of(effect: str, p: Mapping[str, float], scale: float) -> Friction | None:
    """Dry friction of a named or learned law, forces multiplied by `scale`; none of another effect."""
    if effect == "coulomb_friction":
        return Friction(scale * p["friction"], None, 0.0)
    if effect == "asymmetric_friction":
        # [-F (1 - a), F (1 + a)] is [-F, F], moved.
        size, offset = scale * p["friction"], -scale * p["friction"] * p["asymmetry"]
        return Friction(size, lambda v: np.full_like(v, offset), 1.0)
    if effect == "stribeck_friction":
        size, width = scale * p["friction"], p["stribeck_velocity"]
        return _falling(size * (1.0 + p["excess"]), size * p["excess"], width)
    if effect == "stiction":
        size = scale * p["breakaway"]
        # It falls at a speed too small to be seen.
        return _falling(size, size * (1.0 - p["kinetic_ratio"]), 1e-4)
    if effect == "learned_friction":
        return _learned_friction(p, scale)
    return None


def _falling(breakaway: float, fall: float, width: float) -> Friction:
    """`F(v) = breakaway - fall (1 - exp(-(v / width)^2))`."""
    return Friction(breakaway, lambda v: np.sign(v) * fall * (1.0 - np.exp(-np.square(v / width))), width)


def _learned_friction(p: Mapping[str, float], scale: float) -> Friction:
    values = scale * _ordinates(p)
    half = len(values) // 2
    forward, backward = spline(0.0, p["to"], values[half:]), spline(0.0, -p["from"], values[:half][::-1])
    # MuJoCo sticks alike in both directions: the mean holds, the difference pushes.
    rest = np.zeros(1)
    up, down = float(forward(rest)[0]), float(backward(rest)[0])
    loss = 0.5 * (up + down)

    def added(v: Array) -> Array:
        level = np.where(v >= 0.0, forward(np.abs(v)), -backward(np.abs(v)))
        return loss * np.sign(v) - np.where(v == 0.0, 0.5 * (up - down), np.maximum(np.abs(level), 0.0) * np.sign(v))

    return Friction(loss, added, max(p["to"], -p["from"]))


@dataclass(frozen=True)
class Resistance:
    """A force against positive motion over a coordinate, and points between which it is as good as straight."""

    coordinate: Coordinate
    law: Callable[[Array], Array]
    points: Array


def resistance_of(effect: str, p: Mapping[str, float], scale: float, stiffness: float) -> Resistance | None:
    """
    The static law of an effect over position or velocity; none of another effect.

    `scale` multiplies forces; `stiffness` is that of the transmission, N.m/rad (N/m).
    """
    if effect == "force_offset":
        return Resistance("position", lambda x: np.full_like(x, scale * p["force"]), np.array([-1.0, 1.0]))
    if effect == "cogging":
        count = math.ceil(2.0 * TURNS * max(p["order"], 1.0) * A_PERIOD)
        points = np.linspace(-TURNS, TURNS, count) * 2.0 * np.pi
        return Resistance("position", lambda x: scale * p["amplitude"] * np.sin(p["order"] * x + p["phase"]), points)
    if effect == "gravity_load":
        points = np.linspace(-TURNS, TURNS, POINTS) * 2.0 * np.pi
        return Resistance("position", lambda x: scale * p["amplitude"] * np.cos(x + p["phase"]), points)
    if effect in ("learned_position_force", "learned_spring"):
        own = stiffness / scale if effect == "learned_spring" else 0.0
        curve = _stable(spline(p["from"], p["to"], _ordinates(p)), p["from"], p["to"], own)
        # Straight beyond its ends.
        points = np.concatenate([[p["from"] - FAR], np.linspace(p["from"], p["to"], POINTS), [p["to"] + FAR]])
        return Resistance("position", lambda x: scale * curve(x), points)
    if effect == "bilinear_stiffness":
        knees = np.array([-FAR, -p["knee"], p["knee"], FAR])
        return Resistance("position", lambda x: stiffness * _bilinear(p, x), knees)
    if effect == "smooth_coulomb_friction":
        width = p["transition_velocity"]
        return Resistance("velocity", lambda v: scale * p["friction"] * np.tanh(v / width), about_zero(width))
    if effect == "viscous_drag":
        return Resistance("velocity", lambda v: scale * p["viscous"] * v, np.array([-FAR, FAR]))
    if effect == "quadratic_drag":
        return Resistance("velocity", lambda v: scale * p["coefficient"] * v * np.abs(v), about_zero(0.1))
    return None


def about_zero(width: float) -> Array:
    """Points that are dense within some widths about 0 and thin out to `FAR`."""
    near = np.linspace(0.0, DENSE * width, POINTS)
    far = np.geomspace(DENSE * width, max(FAR, 2.0 * DENSE * width), POINTS)
    half = np.concatenate([near, far[1:]])
    return np.concatenate([-half[:0:-1], half])


def _bilinear(p: Mapping[str, float], x: Array) -> Array:
    above, below = (p["change"] * (1.0 + side * p.get("asymmetry", 0.0)) for side in (1.0, -1.0))
    return above * np.maximum(x - p["knee"], 0.0) + below * np.minimum(x + p["knee"], 0.0)


def _ordinates(p: Mapping[str, float]) -> Array:
    return np.array([p[name] for name in p if name[0] == "y" and name[1:].isdigit()])


def _stable(curve: Callable[[Array], Array], start: float, end: float, own: float) -> Callable[[Array], Array]:
    """A curve that keeps its last value beyond an end where its slope and `own` beside it are not above 0 together."""
    edges = curve(np.array([2.0 * start - end, start, end, 2.0 * end - start]))
    falls = (np.diff(edges)[[0, 2]] / (end - start) + own) <= 0.0
    low, high = start if falls[0] else -np.inf, end if falls[1] else np.inf
    return lambda x: curve(np.clip(x, low, high))


def spline(start: float, end: float, ordinates: Array) -> Callable[[Array], Array]:
    """
    The not-a-knot cubic through ordinates at equally spaced knots, of constant slope beyond its ends.

    Source: de Boor, A Practical Guide to Splines (1978), chapter IV.
    """
    count = len(ordinates)
    if count < 4 or not end > start:
        return lambda x: np.full_like(x, ordinates[0])
    # Second derivatives m in units of the spacing.
    matrix, right = np.zeros((count, count)), np.zeros(count)
    matrix[0, :3] = matrix[-1, -3:] = (1.0, -2.0, 1.0)
    for k in range(1, count - 1):
        matrix[k, k - 1 : k + 2] = (1.0, 4.0, 1.0)
        right[k] = 6.0 * (ordinates[k - 1] - 2.0 * ordinates[k] + ordinates[k + 1])
    bends = np.linalg.solve(matrix, right)

    def value(x: Array) -> Array:
        place = (np.asarray(x) - start) / (end - start) * (count - 1)
        inside = np.clip(place, 0.0, count - 1.0)
        k = np.minimum(inside.astype(int), count - 2)
        s = inside - k
        y, z, m, n = ordinates[k], ordinates[k + 1], bends[k], bends[k + 1]
        slope = z - y - (2.0 * m + n) / 6.0
        cubic = y + s * (slope + s * (0.5 * m + s * (n - m) / 6.0))
        return cubic + (place - inside) * (slope + s * (m + 0.5 * s * (n - m)))

    return value
