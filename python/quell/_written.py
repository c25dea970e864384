"""Text in a file."""

from __future__ import annotations

from pathlib import Path


def written(file: str | Path, text: str) -> Path:
    """Write a text in UTF-8 over a file; the file as a path."""
    file = Path(file)
    file.write_text(text, encoding="utf-8")
    return file
