"""How far long work is: a bar in a terminal or a notebook, or a function of the caller."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any, Union

from tqdm import tqdm

Progress = Union[bool, None, Callable[[float, str], None]]


def _is_watched() -> bool:
    """Whether there is a terminal, or a notebook."""
    return sys.stderr.isatty() or "ipykernel" in sys.modules


@contextmanager
def shown(progress: Progress) -> Generator[Callable[[float, str], None] | None, None, None]:
    """What the work calls with the share that is done and what is being done."""
    if callable(progress):
        yield progress
        return
    if progress is False or (progress is None and not _is_watched()):
        yield None
        return
    bar: Any = tqdm(total=100, bar_format="{bar:30} {percentage:3.0f} % {desc}", leave=False)

    def tell(share: float, what: str) -> None:
        bar.n = 100.0 * min(max(share, 0.0), 1.0)
        bar.set_description_str(what)

    try:
        yield tell
    finally:
        bar.close()
