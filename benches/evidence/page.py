"""Puts a table into its page, between its markers."""

import re

from .run import PAGES

MARKED = r"(<!-- table: {} -->\n\n)(.*?)(\n\n<!-- end -->)"


def put(table, text):
    """Replaces what stands between the markers of a table."""
    page = PAGES / table.page
    old = page.read_text()
    new, count = re.subn(MARKED.format(re.escape(table.name)), lambda parts: parts[1] + text + parts[3], old, flags=re.S)
    if count != 1:
        raise SystemExit(f"{page}: {count} places between <!-- table: {table.name} --> and <!-- end -->, where one was expected")
    page.write_text(new)
