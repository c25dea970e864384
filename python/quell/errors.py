"""What can go wrong, with its place."""

from __future__ import annotations

__all__ = [
    "DiagnosisError",
    "Error",
    "IdentificationError",
    "ModelError",
    "PlanError",
    "RecordingError",
    "ShaperError",
    "SimulationError",
]


class Error(ValueError):
    """Bad input; every error of Quell is one.

    The message is the one that the command line prints.
    """


class RecordingError(Error):
    """A recording that is refused.

    Parameters
    ----------
    message : str
        What is wrong, and what would help.
    file : str, optional
        The file.
    line : int, optional
        The line, counted from 1.
    column : str, optional
        The column, or the variable of a file that has variables.
    byte : int, optional
        The byte of an MCAP file, counted from 0.
    topic : str, optional
        The topic of an MCAP file.
    field : str, optional
        The field of the topic's messages.
    """

    def __init__(
        self,
        message: str,
        file: str | None = None,
        line: int | None = None,
        column: str | None = None,
        byte: int | None = None,
        topic: str | None = None,
        field: str | None = None,
    ) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.column = column
        self.byte = byte
        self.topic = topic
        self.field = field


class ModelError(Error):
    """A model that is refused.

    Parameters
    ----------
    message : str
        What is wrong.
    file : str, optional
        The file.
    line : int, optional
        The line, counted from 1.
    key : str, optional
        The key.
    """

    def __init__(
        self,
        message: str,
        file: str | None = None,
        line: int | None = None,
        key: str | None = None,
    ) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.key = key


class IdentificationError(Error):
    """No mode can be identified in a recording."""


class DiagnosisError(Error):
    """A diagnosis or a prediction that cannot be made."""


class ShaperError(Error):
    """A shaper that cannot be designed or run."""


class PlanError(Error):
    """A move that cannot be planned."""


class SimulationError(Error):
    """A robot or a command that cannot be simulated."""
