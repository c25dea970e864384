"""The tables of growth.md."""

from .table import SHORT, Table, as_printed, below, markdown

VERBS = ("inspect", "diagnose", "score", "identify", "simulate")


def cells(line):
    return [cell.strip() for cell in line.strip("| \n").split("|")]


def length(outputs):
    """Seconds and memory of each verb over the length of a recording."""
    of = {}
    for verb in VERBS:
        for line in below(outputs[0], f"quell {verb}, one recording")[2:]:
            size, seconds, exponent, memory = [*cells(line), "", "", ""][:4]
            of[size, verb] = [f"{seconds}, {exponent}" if exponent else seconds, memory or "-"]
    sizes = list(dict.fromkeys(size for size, _ in of))
    head = [text for verb in VERBS for text in (f"`{verb}` s, exponent", "MB")]
    rows = [[size, *(cell for verb in VERBS for cell in of.get((size, verb), ["-", "-"]))] for size in sizes]
    return markdown(["samples", *head], rows)


def number(outputs):
    """The same over the number of recordings."""
    rows = [cells(line) for line in below(outputs[0], "quell diagnose --batch")[2:]]
    return markdown(["recordings of 1000 samples", "seconds", "exponent", "MB", "exponent"], rows)


LENGTH = "python3 benches/growth.py --longest 1e7"
TABLES = [
    Table("length", "growth.md", (LENGTH,), length),
    Table("number", "growth.md", (LENGTH,), number),
    Table("joints", "growth.md", ("cargo bench --features full --bench axes",), as_printed, SHORT),
]
