"""What every result can do: a dictionary, a table, a page."""

from __future__ import annotations

import copy
import dataclasses
import html
import math
import textwrap
import types
import typing
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, Union, cast

from typing import TYPE_CHECKING

from ._written import written

if TYPE_CHECKING:
    import pandas

T = TypeVar("T")


def build(kind: type[T], source: Mapping[str, Any], /, **more: Any) -> T:
    """A dataclass from a document with its fields; keys that it does not know are left."""
    hints = typing.get_type_hints(kind)
    values: dict[str, Any] = dict(more)
    for field in dataclasses.fields(cast(Any, kind)):
        if field.name in source and field.name not in values:
            values[field.name] = _value(hints[field.name], source[field.name])
    return kind(**values)


def _value(hint: Any, value: Any) -> Any:
    """A value as its type says."""
    if value is None:
        return None
    if dataclasses.is_dataclass(hint):
        return build(cast(Any, hint), value)
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (Union, types.UnionType):
        given = [one for one in arguments if one is not type(None)]
        return _value(given[0], value)
    if origin is tuple:
        return tuple(_value(arguments[0], one) for one in value)
    return value


def frame(rows: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> pandas.DataFrame:
    """A data frame of rows."""
    import pandas

    table: Any = pandas.DataFrame(list(rows), columns=list(columns))
    return table


def table(heads: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """A table for a notebook."""

    def cell(value: Any) -> str:
        text = f"{value:.4g}" if isinstance(value, float) else str(value)
        return html.escape(text)

    head = "".join(f"<th>{html.escape(head)}</th>" for head in heads)
    body = "".join(
        "<tr>" + "".join(f"<td>{cell(value)}</td>" for value in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def bold(text: str) -> str:
    """A heading for a notebook."""
    return f"<b>{html.escape(text)}</b>"


def paragraph(text: str) -> str:
    """A paragraph for a notebook."""
    return f"<p>{html.escape(text)}</p>"


def figure(value: float, deviation: float) -> str:
    """A number with its standard deviation, which may not be known."""
    return f"{value:.6g}" if not math.isfinite(deviation) or deviation == 0.0 else f"{value:.6g} +- {deviation:.2g}"


# What a result with a text has, beside what a terminal shows.
MORE = "text, plot(), to_pandas() and save_report(file) have more"


def in_lines(head: str, lines: Sequence[str], more: str) -> str:
    """A result in a terminal: one thing a line, and what has more."""
    folded = [textwrap.fill(line, 100, initial_indent="  ", subsequent_indent="    ") for line in (*lines, more)]
    return "\n".join([head, *folded])


@dataclasses.dataclass(frozen=True, eq=False)
class Result:
    """What every result has."""

    document: dict[str, Any] = dataclasses.field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """
        Give all as plain numbers, strings, lists and dictionaries, as the JSON of the command line has them.

        Returns
        -------
        dict
            A copy.
        """
        return copy.deepcopy(self.document)


@dataclasses.dataclass(frozen=True, eq=False)
class Reported(Result):
    """A result that has a text and a page."""

    text: str = dataclasses.field(repr=False)
    html: str = dataclasses.field(repr=False)

    def __str__(self) -> str:
        return self.text

    def save_report(self, file: str | Path) -> Path:
        """
        Write the report: one page of HTML that needs no other file.

        Parameters
        ----------
        file : str or Path
            The file; it is written over.

        Returns
        -------
        Path
            The file.
        """
        return written(file, self.html)
