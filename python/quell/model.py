"""Models of an axis: what an engineer believes, or what a diagnosis has found."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _quell
from ._result import bold, table
from ._written import written

__all__ = ["Effect", "Model"]


@dataclass(frozen=True)
class Effect:
    """
    Physics besides the linear chain.

    Parameters
    ----------
    name : str
        Its name in the catalogue, such as `backlash`.
    place : str
        Where it sits, such as `transmission`.
    parameters : dict of str to float
        Its parameters; the book's reference of effects has their units.
    """

    name: str
    place: str
    parameters: dict[str, float]


class Model:
    """
    A model of an axis.

    Parameters
    ----------
    kind : str
        The kind, such as `flexible_joint` or `rigid_axis`.
    **values : float
        The keys of that kind; the book's reference of `model.toml` has them with their units.

    Raises
    ------
    ModelError
        Where a key is missing, unknown or out of its range.

    Examples
    --------
    >>> import quell
    >>> model = quell.Model("flexible_joint", natural_frequency_hz=8.0, damping_ratio=0.06)
    >>> model["natural_frequency_hz"]
    8.0
    """

    def __init__(self, kind: str, **values: float) -> None:
        lines = [f'kind = "{kind}"', *(f"{key} = {float(value)!r}" for key, value in values.items())]
        self._inner = _quell.Model("\n".join(lines) + "\n", "model")

    @classmethod
    def _of(cls, inner: _quell.Model) -> Model:
        model = cls.__new__(cls)
        model._inner = inner
        return model

    @classmethod
    def from_toml(cls, text: str, file: str | Path = "model.toml") -> Model:
        """
        Read a model from the text of a `model.toml`.

        Parameters
        ----------
        text : str
            The text.
        file : str or Path, default "model.toml"
            What errors and reports call it.

        Returns
        -------
        Model
            The model.

        Raises
        ------
        ModelError
            With line and key.
        """
        return cls._of(_quell.Model(text, file))

    @classmethod
    def load(cls, file: str | Path) -> Model:
        """
        Read a `model.toml`.

        Parameters
        ----------
        file : str or Path
            The file.

        Returns
        -------
        Model
            The model.

        Raises
        ------
        ModelError
            With file, line and key.
        """
        return cls._of(_quell.Model.load(file))

    def to_toml(self) -> str:
        """
        Give the text of its `model.toml`.

        Returns
        -------
        str
            The text, which `from_toml` and the command line read.
        """
        return self._inner.toml()

    def save(self, file: str | Path) -> Path:
        """
        Write its `model.toml`.

        Parameters
        ----------
        file : str or Path
            The file; it is written over.

        Returns
        -------
        Path
            The file.
        """
        return written(file, self.to_toml())

    @property
    def kind(self) -> str:
        """The kind, such as `flexible_joint`."""
        return self._inner.kind

    @property
    def values(self) -> dict[str, float]:
        """Its keys, in the units of the book's reference of `model.toml`."""
        return dict(self._inner.values())

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The physics besides the linear chain."""
        return tuple(Effect(name, place, dict(values)) for name, place, values in self._inner.effects())

    def __getitem__(self, key: str) -> float:
        return self.values[key]

    def to_dict(self) -> dict[str, Any]:
        """
        Give kind, values and effects as a dictionary.

        Returns
        -------
        dict
            Keys `kind`, `values` and `effects`.
        """
        effects = [{"name": e.name, "place": e.place, **e.parameters} for e in self.effects]
        return {"kind": self.kind, "values": self.values, "effects": effects}

    def __repr__(self) -> str:
        values = "".join(f", {key}={value:.6g}" for key, value in self.values.items())
        effects = "".join(f" + {effect.name}" for effect in self.effects)
        return f"Model({self.kind}{values}{effects})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        return Model.from_toml, (self.to_toml(), str(self._inner.file))

    def _repr_html_(self) -> str:
        rows: list[tuple[str, str, float]] = [("", key, value) for key, value in self.values.items()]
        for effect in self.effects:
            rows += [(effect.name, key, value) for key, value in effect.parameters.items()]
        return bold(self.kind) + table(["effect", "parameter", "value"], rows)
