"""What a model predicts of a recording, and how well."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _quell
from ._result import Result, build, paragraph
from .model import Model
from .recording import Recording

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

__all__ = ["Output", "PayloadScore", "Prediction", "Score", "score", "simulate"]


@dataclass(frozen=True, eq=False)
class Score(Result):
    """
    The error of a prediction.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    rms : float
        Root mean square error of the first output, in `unit`.
    unit : str
        Its unit, SI.
    noise_std : float
        Standard deviation of the noise, in `unit`.
    rms_over_noise : float
        The former over the latter; 1 of a model that lacks nothing.
    fit_percent : float
        `100 (1 - |error| / |recorded - mean|)`, percent.
    samples : int
        Samples that the error is of.
    windows : int
        Windows in which the motion was replayed, each with a start of its own.
    first : int, optional
        Samples at the start to which alone offsets, clocks and start were fitted.
    with_payload : PayloadScore, optional
        The score with the link's inertia fitted, which `quell.score` gives where the recording names a payload.
    text : str
        The same in a line, and in one more with the payload.
    """

    rms: float
    unit: str
    noise_std: float
    rms_over_noise: float
    fit_percent: float
    samples: int
    windows: int
    first: int | None = None
    with_payload: PayloadScore | None = None
    text: str = field(default="", repr=False)

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return paragraph(self.text)


@dataclass(frozen=True, eq=False)
class PayloadScore:
    """
    What a recording with a payload says of the link's inertia, beside a model that says nothing of its payload.

    Parameters
    ----------
    payload : str
        The payload, as the recording names it.
    relative_inertia : float
        Inertia of the link over the model's, by least squares.
    score : Score
        The score with that inertia.
    """

    payload: str
    relative_inertia: float
    score: Score


@dataclass(frozen=True, eq=False)
class Output:
    """
    One output of a prediction, at its own stamps.

    Parameters
    ----------
    role : str
        What it measures.
    unit : str
        Unit of its values, SI.
    time : ndarray
        Stamps, s, shape (n,).
    recorded : ndarray
        What was recorded.
    predicted : ndarray
        What the model says.
    """

    role: str
    unit: str
    time: NDArray[np.float64]
    recorded: NDArray[np.float64]
    predicted: NDArray[np.float64]

    def __repr__(self) -> str:
        return f"Output({self.role}, {self.unit}: {len(self.time)} samples)"

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give the output as a data frame.

        Returns
        -------
        pandas.DataFrame
            Index `time_s`; columns `recorded` and `predicted`.
        """
        import pandas

        index: Any = pandas.Index(self.time, name="time_s")
        return pandas.DataFrame({"recorded": self.recorded, "predicted": self.predicted}, index=index)


@dataclass(frozen=True, eq=False)
class Prediction:
    """
    What a model predicts of a recording.

    Parameters
    ----------
    outputs : tuple of Output
        Every output that the recording has.
    score : Score
        The error of the first.
    """

    outputs: tuple[Output, ...]
    score: Score

    def __repr__(self) -> str:
        return f"Prediction({', '.join(one.role for one in self.outputs)}: {self.score.text})"

    def __getitem__(self, role: str) -> Output:
        for output in self.outputs:
            if output.role == role:
                return output
        raise KeyError(role)

    def to_dict(self) -> dict[str, Any]:
        """
        Give outputs and score as plain numbers and lists.

        Returns
        -------
        dict
            Keys `outputs` and `score`.
        """
        outputs = [
            {
                "role": one.role,
                "unit": one.unit,
                "time_s": one.time.tolist(),
                "recorded": one.recorded.tolist(),
                "predicted": one.predicted.tolist(),
            }
            for one in self.outputs
        ]
        return {"outputs": outputs, "score": self.score.to_dict()}

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give the first output as a data frame.

        Returns
        -------
        pandas.DataFrame
            Index `time_s`; columns `recorded` and `predicted`.
        """
        return self.outputs[0].to_pandas()

    def _repr_html_(self) -> str:
        return paragraph(self.score.text)

    def plot(self) -> Figure:
        """
        Draw each output, recorded and predicted, over time.

        Returns
        -------
        matplotlib.figure.Figure
            One axis for each output.
        """
        import matplotlib.pyplot as plt

        count = len(self.outputs)
        figure, axes = plt.subplots(count, 1, sharex=True, squeeze=False, figsize=(8, 3 * count), layout="constrained")
        for output, axis in zip(self.outputs, axes[:, 0]):
            axis.plot(output.time, output.recorded, linewidth=0.8, label="recorded")
            axis.plot(output.time, output.predicted, linewidth=0.8, label="predicted")
            axis.set_ylabel(f"{output.role} / {output.unit}")
            axis.legend()
        axes[-1, 0].set_xlabel("time / s")
        return figure


def simulate(model: Model, recording: Recording, *, first: int | None = None) -> Prediction:
    """
    Simulate a model with the input that was recorded.

    Only the clock offset, the output's offset, the sensor's frame and a start that no sensor says are fitted; the
    model's parameters and effects are taken as they stand.

    Parameters
    ----------
    model : Model
        The model.
    recording : Recording
        A recording with an input of the model and an output that it predicts.
    first : int, optional
        Fit offsets, clocks and start to the first samples alone, and judge by those that follow.

    Returns
    -------
    Prediction
        Every output, and the score.

    Raises
    ------
    DiagnosisError
        Where the recording does not suit the model.
    """
    inner = model._inner, recording._inner
    outputs, document, line = _quell.predict(*inner, first)
    told = json.loads(document)
    held = tuple(Output(role, unit, *arrays) for role, unit, arrays in outputs)
    return Prediction(held, build(Score, told, document=told, text=line))


def score(model: Model, recording: Recording, *, first: int | None = None) -> Score:
    """
    Score how well a model predicts a recording that it has never seen.

    A model does not say with which payload it holds. Where the recording names one, `with_payload` has the score
    with the link's inertia fitted.

    Parameters
    ----------
    model : Model
        The model.
    recording : Recording
        The recording.
    first : int, optional
        Fit offsets, clocks and start to the first samples alone, and judge by those that follow.

    Returns
    -------
    Score
        The error over the noise.

    Raises
    ------
    DiagnosisError
        Where the recording does not suit the model.
    """
    document, lines, own_line = _quell.score(model._inner, recording._inner, first)
    told = json.loads(document)
    carried = told.get("with_payload")
    own = carried and build(Score, carried["score"], document=carried["score"], text=own_line)
    with_payload = carried and PayloadScore(carried["payload"], carried["relative_inertia"], own)
    return build(Score, told, document=told, with_payload=with_payload, text=lines)
