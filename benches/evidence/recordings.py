"""The tables of recordings.md: what `quell identify` says of two public recordings."""

from .table import Table, as_text

PAGE = "recordings.md"


def identify(manifest):
    return (f"quell identify {{work}}/manifests/{manifest}.toml --force --out {{work}}/out",)


def table(outputs):
    """Without the recording's name, and without the files that were written."""
    text = outputs[0][outputs[0].index("on-line") :]
    return as_text([text.split("\nReport:", 1)[0]])


MANIFESTS = (("tests/manifests", "."),)
TABLES = [
    Table("quanser", PAGE, identify("quanser_lqg_step_20deg"), table, copies=MANIFESTS),
    Table("flexarm", PAGE, identify("flexarm_square"), table, copies=MANIFESTS),
]
