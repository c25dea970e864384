"""Measures the tables of docs/src/evidence again, and writes them into their pages.

    python3 benches/evidence.py                                  # all that take a few minutes
    python3 benches/evidence.py tick planning                    # these alone
    python3 benches/evidence.py real --recordings ../recordings  # one of public recordings, which are not in the repository
    python3 benches/evidence.py --list                           # name, page, what it takes, commands

Each table gets a line with date, cores, model of the processor, load, commit and time. Tables that are not measured stay as they are.
"""

import argparse
from pathlib import Path

from evidence import TABLES
from evidence.page import put
from evidence.run import measured
from evidence.table import SHORT


def listed():
    for table in TABLES:
        needs = "recordings" if table.needs_recordings else table.takes
        print(f"{table.name:18} {table.page:14} {needs}")
        for command in table.commands:
            print(f"    {command}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", choices=[[], *(table.name for table in TABLES)])
    parser.add_argument("--list", action="store_true", help="names, pages and commands, no run")
    parser.add_argument("--recordings", type=Path, help="folder of the public recordings")
    arguments = parser.parse_args()
    if arguments.list:
        return listed()
    outputs = {}
    for table in TABLES:
        if table.name not in arguments.names and (arguments.names or table.takes != SHORT):
            continue
        if table.needs_recordings and not arguments.recordings:
            print(f"{table.name}: skipped, needs --recordings DIR", flush=True)
            continue
        print(table.name, flush=True)
        # Tables of the same commands share a run.
        if table.commands not in outputs:
            outputs[table.commands] = measured(table, arguments.recordings and arguments.recordings.resolve())
        texts, sentence = outputs[table.commands]
        # After each, so that what was measured is not lost with the next.
        put(table, f"{sentence}\n\n{table.made(texts)}")


main()
