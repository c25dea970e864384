"""What physics a model lacks."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Union

from . import _quell
from ._progress import Progress, shown
from ._result import MORE, Reported, bold, build, frame, in_lines, paragraph, table
from .findings import Candidate, Finding, Fit, Location, NextMove, Trace, Verdict
from .model import Model
from .recording import Recording

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

__all__ = ["Diagnosis", "diagnose"]


@dataclass(frozen=True, eq=False)
class Diagnosis(Reported):
    """
    What physics a model lacks.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    text : str
        The same as text, as the command line prints it.
    html : str
        The report: a page of HTML that needs no other file.
    verdict : str
        `no_mismatch`, `named`, `ambiguous`, `partly_explained`, `unexplained` or `not_excited`; the book's page on
        verdicts says what each means.
    summary : str
        One sentence.
    findings : tuple of Finding
        The best explanation, strongest effect first.
    location : Location
        Where the mismatch sits.
    fit : Fit
        The fit before and after.
    nuisances : dict of str to float
        What was fitted besides.
    nuisances_ci95 : dict of str to list of float
        95 % confidence intervals of those that are parameters of the model.
    next_move : NextMove or None
        What to do to be sure.
    candidates : tuple of Candidate
        The ranking, best first.
    ended_early : bool
        Whether the search was ended while there was more to try.
    remarks : tuple of str
        What the reader should know.
    model : Model
        The better model: with the findings in it.
    traces : tuple of Trace
        What the report draws.
    """

    verdict: Verdict
    summary: str
    findings: tuple[Finding, ...]
    location: Location
    fit: Fit
    nuisances: dict[str, float]
    nuisances_ci95: dict[str, list[float]]
    next_move: NextMove | None
    candidates: tuple[Candidate, ...]
    ended_early: bool
    remarks: tuple[str, ...]
    model: Model
    traces: tuple[Trace, ...] = field(repr=False)

    def __repr__(self) -> str:
        lines = [self.summary, *(str(finding) for finding in self.findings), str(self.fit)]
        if self.next_move:
            lines.append(f"next move: {self.next_move.why}")
        return in_lines(f"Diagnosis: {self.verdict}", lines, MORE)

    def __str__(self) -> str:
        return repr(self)

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give the parameters of all findings as a data frame.

        Returns
        -------
        pandas.DataFrame
            Columns `effect`, `place`, `parameter`, `value`, `ci95_low`, `ci95_high` and `unit`.
        """
        columns = ["effect", "place", "parameter", "value", "ci95_low", "ci95_high", "unit"]
        return frame([dict(zip(columns, row)) for row in self._rows()], columns)

    def _rows(self) -> list[tuple[str, str, str, float, float, float, str]]:
        return [
            (one.effect, one.place, p.name, p.value, p.ci95[0], p.ci95[1], p.unit)
            for one in self.findings
            for p in one.parameters
        ]

    def _repr_html_(self) -> str:
        heads = ["effect", "place", "parameter", "value", "from", "to", "unit"]
        rows = table(heads, self._rows()) if self.findings else ""
        remarks = "".join(paragraph(remark) for remark in self.remarks)
        return bold(self.verdict) + paragraph(self.summary) + rows + remarks

    def plot(self, trace: int = 0) -> Figure:
        """
        Draw an output and what both models leave of it.

        Parameters
        ----------
        trace : int, default 0
            Which of `traces`; the first is the most telling.

        Returns
        -------
        matplotlib.figure.Figure
            Two axes: the output, and the residuals.
        """
        import matplotlib.pyplot as plt

        one = self.traces[trace]
        figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(8, 5), layout="constrained")
        above.plot(one.time, one.recorded, linewidth=0.8)
        above.set_ylabel(f"{one.name} / {one.unit}")
        below.plot(one.time, one.recorded - one.before, linewidth=0.8, label="model as given")
        below.plot(one.time, one.recorded - one.after, linewidth=0.8, label="with findings")
        below.set_ylabel(f"residual / {one.unit}")
        below.set_xlabel("time / s")
        below.legend()
        return figure


def diagnose(
    model: Model,
    recordings: Union[Recording, Sequence[Recording]],
    *,
    held_out: Sequence[Recording] = (),
    seed: int = 1,
    time_limit: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Diagnosis:
    """
    Say what physics a model lacks, from recordings.

    Ctrl-C ends it. Other threads of Python go on meanwhile.

    Parameters
    ----------
    model : Model
        The model that is believed in.
    recordings : Recording or sequence of Recording
        Recordings of one machine.
    held_out : sequence of Recording, optional
        Recordings to judge by, which nothing is fitted to.
    seed : int, default 1
        Seed of the confidence intervals' bootstrap.
    time_limit : float, optional
        Ends the search for further effects after so many seconds, and tells the best explanation so far.
    threads : int, optional
        Threads to work with; one a core by default.
    progress : bool or callable, optional
        Whether a bar is shown; by default in a terminal and in a notebook. A function is called with the share that
        is done, 0 to 1, and what is being done.

    Returns
    -------
    Diagnosis
        Verdict, findings, the better model, and the report.

    Raises
    ------
    DiagnosisError
        Where a recording does not suit the model, or a sensor is dead.

    See Also
    --------
    score : How well a model predicts a recording.
    """
    train = [recordings] if isinstance(recordings, Recording) else list(recordings)
    inner = ([one._inner for one in train], [one._inner for one in held_out])
    limits = (time_limit, threads)
    with shown(progress) as tell:
        told = _quell.diagnose(model._inner, inner, seed, limits, tell)
    written, text, html, toml, outputs = told
    document = json.loads(written)
    return build(
        Diagnosis,
        document,
        document=document,
        text=text,
        html=html,
        model=Model.from_toml(toml, "better model"),
        traces=tuple(Trace(name, unit, *arrays, noise_std=noise) for name, unit, arrays, noise in outputs),
    )
