"""What a diagnosis is made of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Candidate",
    "Finding",
    "Fit",
    "FittedParameter",
    "Location",
    "NextMove",
    "ProposedMove",
    "Quality",
    "Trace",
    "Verdict",
]

# Of those that a terminal shows: a learned law has an ordinate at each of its knots.
MOST_PARAMETERS = 4

Verdict = Literal["no_mismatch", "named", "ambiguous", "partly_explained", "unexplained", "not_excited"]


@dataclass(frozen=True)
class FittedParameter:
    """
    A fitted number.

    Parameters
    ----------
    name : str
        Its name.
    value : float
        Its value, in `unit`.
    unit : str
        Its unit.
    ci95 : tuple of float
        95 % confidence interval, in `unit`.
    """

    name: str
    value: float
    unit: str
    ci95: tuple[float, ...]

    def __str__(self) -> str:
        low, high = self.ci95
        return f"{self.name} {self.value:.4g} {self.unit} ({low:.4g} to {high:.4g})"


@dataclass(frozen=True)
class Finding:
    """
    One piece of physics that the model lacks.

    Parameters
    ----------
    effect : str
        Its name in the catalogue.
    place : str
        Its place in the chain.
    probability : float
        Probability that it is missing, of all explanations together that have it.
    parameters : tuple of FittedParameter
        Its parameters.
    evidence : str
        One sentence.
    alternatives : tuple of str
        Effects that the data cannot tell from it.
    happened_in : tuple of str
        The recordings in which it happened; empty where it is the machine's.
    """

    effect: str
    place: str
    probability: float
    parameters: tuple[FittedParameter, ...]
    evidence: str
    alternatives: tuple[str, ...]
    happened_in: tuple[str, ...] = ()

    def __str__(self) -> str:
        fitted = [str(parameter) for parameter in self.parameters[:MOST_PARAMETERS]]
        more = len(self.parameters) - len(fitted)
        fitted += [f"{more} more"] if more else []
        return f"{self.effect} at {self.place}: {', '.join(fitted)}; probability {self.probability:.3g}"

    def __repr__(self) -> str:
        return f"Finding({self})"

    def __getitem__(self, name: str) -> FittedParameter:
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)


@dataclass(frozen=True)
class Location:
    """
    Where the mismatch sits.

    Parameters
    ----------
    place : str or None
        Place in the chain.
    phases : tuple of str
        Phases of the motion in which it is strong.
    times_s : tuple of tuple of float
        Stretches of time in which it is strong, s.
    coordinate : str or None
        Coordinate that it follows best.
    frequency_hz : float or None
        Frequency that stands out of the residual, Hz.
    """

    place: str | None
    phases: tuple[str, ...]
    times_s: tuple[tuple[float, ...], ...]
    coordinate: str | None
    frequency_hz: float | None


@dataclass(frozen=True)
class Quality:
    """
    How well a model fits.

    Parameters
    ----------
    train_rms : float
        Root mean square residual where it was fitted, in the unit of the fit.
    held_out_rms : float
        Root mean square residual where it was not.
    held_out_over_noise : float
        The latter over the noise.
    """

    train_rms: float
    held_out_rms: float
    held_out_over_noise: float


@dataclass(frozen=True)
class Fit:
    """
    The fit before and after.

    Parameters
    ----------
    noise_std : float
        Standard deviation of the noise of the first output, in `unit`.
    unit : str
        Its unit, SI.
    before : Quality
        The given model, its parameters refitted.
    after : Quality
        The model with the findings.
    model_alone : Quality or None
        The better model, without what happened in one recording.
    """

    noise_std: float
    unit: str
    before: Quality
    after: Quality
    model_alone: Quality | None = None

    def __str__(self) -> str:
        before, after = (f"{one.held_out_over_noise:.3g}" for one in (self.before, self.after))
        return f"left on what was held out: {before} times the noise of {self.noise_std:.3g} {self.unit} before, {after} after"

    def __repr__(self) -> str:
        return f"Fit({self})"


@dataclass(frozen=True)
class ProposedMove:
    """
    One proposed move from rest to rest.

    Parameters
    ----------
    distance : float
        Target relative to where the move starts, in `unit`.
    speed : float
        Greatest speed, `unit`/s.
    acceleration : float
        Greatest acceleration, `unit`/s^2.
    jerk : float
        Greatest jerk, `unit`/s^3.
    pause_s : float
        Pause after it, s.
    unit : str
        `rad` or `m`.
    """

    distance: float
    speed: float
    acceleration: float
    jerk: float
    pause_s: float
    unit: str


@dataclass(frozen=True)
class NextMove:
    """
    The experiment that would tell two explanations apart.

    Parameters
    ----------
    why : str
        One sentence.
    separates : tuple of str
        The two explanations.
    expected_score : float
        Chi-squared by which the second would fail at least, were the first right.
    moves : tuple of ProposedMove
        What to do; empty where no motion separates them.
    """

    why: str
    separates: tuple[str, ...]
    expected_score: float
    moves: tuple[ProposedMove, ...]

    def __repr__(self) -> str:
        return f"NextMove({len(self.moves)} moves: {self.why})"


@dataclass(frozen=True)
class Candidate:
    """
    One line of the ranking.

    Parameters
    ----------
    effect : str
        Effect, or effects joined by ` + `.
    place : str
        Place of the last effect.
    log_evidence : float
        Log of its marginal likelihood over that of the refitted model.
    probability : float
        Its probability among the explanations that were looked at.
    held_out_ratio : float
        Held-out chi-squared over that of the refitted model.
    refused : str or None
        Why it is refused, whatever its evidence: its probability is then 0.
    """

    effect: str
    place: str
    log_evidence: float
    probability: float
    held_out_ratio: float
    refused: str | None


@dataclass(frozen=True, eq=False)
class Trace:
    """
    One output over one recording: what was recorded, and both models.

    Parameters
    ----------
    name : str
        Name of the recording and role of the output.
    unit : str
        Unit of its values, SI.
    time : ndarray
        Stamps, s, shape (n,).
    recorded : ndarray
        What was recorded.
    before : ndarray
        What the refitted model says.
    after : ndarray
        What the model with the findings says.
    noise_std : float
        Standard deviation of the noise.
    """

    name: str
    unit: str
    time: NDArray[np.float64]
    recorded: NDArray[np.float64]
    before: NDArray[np.float64]
    after: NDArray[np.float64]
    noise_std: float

    def __repr__(self) -> str:
        return f"Trace({self.name}, {self.unit}: {len(self.time)} samples)"
