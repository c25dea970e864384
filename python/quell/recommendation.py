"""Which shaper to take."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import _quell
from ._result import Result, bold, build, frame, table
from .modes import ModesLike, given

if TYPE_CHECKING:
    import pandas

__all__ = ["Recommendation", "ShaperFigures", "recommend"]


@dataclass(frozen=True)
class ShaperFigures:
    """
    A shaper's figures for modes that are known only so well.

    Parameters
    ----------
    shaper : str
        Its name.
    delay_s : float
        Delay that it adds, s.
    residual : float
        Vibration left at the estimate, as a share of the unshaped.
    residual_mean : float
        The mean over the uncertainty.
    residual_95 : float
        What 95 % of the uncertainty stays below.
    eligible : bool
        Whether it may be taken.
    """

    shaper: str
    delay_s: float
    residual: float
    residual_mean: float
    residual_95: float
    eligible: bool


@dataclass(frozen=True, eq=False)
class Recommendation(Result):
    """
    Which shaper to take.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    best : ShaperFigures
        The one to take.
    candidates : tuple of ShaperFigures
        All of them.
    """

    best: ShaperFigures
    candidates: tuple[ShaperFigures, ...]

    def __repr__(self) -> str:
        best = self.best
        left = f"leaves at most {100.0 * best.residual_95:.2g} % for 95 % of the uncertainty"
        return f"Recommendation({best.shaper}: adds {best.delay_s:.4g} s, {left}; {len(self.candidates)} candidates)"

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give all shapers as a data frame.

        Returns
        -------
        pandas.DataFrame
            A row for each.
        """
        return frame(self.document["candidates"], list(self.document["best"]))

    def _repr_html_(self) -> str:
        rows = [list(one.values()) for one in self.document["candidates"]]
        return bold(self.best.shaper) + table(list(self.document["best"]), rows)


def recommend(
    modes: ModesLike,
    *,
    acceptable: float = 0.05,
    longest_delay: float = math.inf,
    allow_negative: bool = False,
) -> Recommendation:
    """
    Recommend a shaper for modes that are known only so well.

    It is the shortest that leaves no more than is acceptable for 95 % of the uncertainty; where none does, the
    one that leaves least.

    Parameters
    ----------
    modes : Mode, (float, float), sequence of these, or Identification
        The modes with their standard deviations.
    acceptable : float, default 0.05
        Residual vibration that is small enough, as a share of the unshaped.
    longest_delay : float, default inf
        The longest delay, s.
    allow_negative : bool, default False
        Whether negative impulses are allowed, which can exceed the limits of a move.

    Returns
    -------
    Recommendation
        The shaper, and the figures of all.

    Raises
    ------
    ShaperError
        Where none is short enough.
    """
    told = _quell.recommend(given(modes), longest_delay, acceptable, allow_negative)
    document = json.loads(told)
    for one in [document["best"], *document["candidates"]]:
        one.update({key: math.nan for key, value in one.items() if value is None})
    return build(Recommendation, document, document=document)
