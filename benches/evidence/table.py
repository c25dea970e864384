"""What a table of the book is, and forms of tables."""

import re
from dataclasses import dataclass
from typing import Callable

SHORT, LONG = "short", "long"


@dataclass(frozen=True)
class Table:
    """A table of a page.

    `commands` are run in the root of the repository, one after the other, and `made` gets what each printed on its standard output.
    In a command `{recordings}` stands for the folder of the recordings, and `{work}` for a folder that is new. `copies` are folders of
    the repository that are copied into `{work}` first, each with the folder of the recordings in which its manifests find their files.
    """

    name: str
    page: str
    commands: tuple[str, ...]
    made: Callable[[list[str]], str]
    takes: str = LONG
    copies: tuple[tuple[str, str], ...] = ()

    @property
    def needs_recordings(self):
        return bool(self.copies) or any("{recordings}" in command for command in self.commands)


def markdown(head, rows):
    """A table in Markdown. No rows are an error: the command printed something else than was expected."""
    rows = [[str(cell) for cell in row] for row in rows]
    if not rows or any(len(row) != len(head) for row in rows):
        raise ValueError(f"rows that do not fit to the head {head}: {rows}")
    lines = ["| " + " | ".join(line) + " |" for line in [head, *rows]]
    return "\n".join([lines[0], "|---" * len(head) + "|", *lines[1:]])


def split(line):
    """The cells of a line whose columns stand at least two spaces apart."""
    return re.split(r" {2,}", line.strip())


def below(text, begin, end=None):
    """The lines below the first that contains `begin`, up to one that contains `end`, else to an empty one."""
    lines = text.splitlines()
    first = next((k for k, line in enumerate(lines) if begin in line), None)
    if first is None:
        raise ValueError(f"no line with {begin!r} in:\n{text}")
    rest = lines[first + 1 :]
    last = (k for k, line in enumerate(rest) if (end in line if end else not line.strip()))
    return rest[: next(last, len(rest))]


def found(pattern, text):
    """The groups of each match, of which there must be one."""
    groups = re.findall(pattern, text, re.M)
    if not groups:
        raise ValueError(f"nothing like {pattern!r} in:\n{text}")
    return groups


def as_printed(outputs):
    """The lines of a table that the command prints as Markdown."""
    lines = [line for line in outputs[0].splitlines() if line.startswith("|")]
    if len(lines) < 3:
        raise ValueError(f"no table in:\n{outputs[0]}")
    return "\n".join(lines)


def as_text(outputs):
    """What the command prints, as it is."""
    return "```text\n" + "\n".join(line.rstrip() for line in outputs[0].strip("\n").splitlines()) + "\n```"


def between(values, digits):
    """Least and most of some values: `1.06 to 1.63`, or one where both are told by the same digits."""
    least, most = (f"{value:.{digits}f}" for value in (min(values), max(values)))
    return least if least == most else f"{least} to {most}"
