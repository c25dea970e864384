"""Quell beside PySINDy and SysIdentPy on the same recordings: seconds, and error on what was held out.

    diagnosis.py --quell target/release/quell --shared ../shared [--markdown | --json] [CASE ...]

CASE is a folder with model.toml, train/ and test/; by default the first three of SHARED/concealed. What is said of them
elsewhere is not read. All run on one thread, and seconds are the processor's: on a quiet machine those on the wall, which
--json has, too. Quell's run from the start of its process to the last figure of its report; a peer's hold its search for
settings and, in brackets, the one fit by these. The environment with the peers is made on the first run.
"""

import environment

environment.enter()

import argparse
import json
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import narmax
import recordings
import sindy
from judge import Quell

PEERS = {"pysindy": sindy, "sysidentpy": narmax}
UNITS = {"um": 1e6, "mV": 1e3}


def measured(peer, case):
    """Seconds of a peer, on the wall and of the processor, and its error on what was held out."""
    begun, used = time.perf_counter(), time.process_time()
    settings = peer.search(case)
    chosen = time.process_time()
    found = None if settings is None else peer.fit(case, settings)
    now = time.process_time()
    result = {"seconds": time.perf_counter() - begun, "cpu_seconds": now - used, "fit_cpu_seconds": now - chosen}
    error = None if found is None else case.judged.error(peer.predict(case, found))
    if peer is sindy and found:
        result["equation"] = dict(found)
    return {**result, "settings": settings, "error": None if error is None else error * case.scale}


def row(quell, case):
    """One row of the table."""
    result = {"recording": case.name, "unit": case.unit, "quell": quell.measured(case)}
    for name, peer in PEERS.items():
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            result[name] = measured(peer, case)
    return result


def cases(arguments, quell, work):
    """The recordings that are there."""
    for make in (recordings.emps, recordings.silverbox):
        case = make(arguments.shared, work)
        if case is None:
            print(f"skipped: {make.__name__}, which is not in {arguments.shared / 'recordings'}", file=sys.stderr)
        elif not arguments.only or case.name in arguments.only:
            yield case
    folders = arguments.case or sorted((arguments.shared / "concealed").glob("case-*"))[:3]
    if not folders:
        print(f"skipped: concealed cases, which are not in {arguments.shared}", file=sys.stderr)
    for folder in folders:
        if not arguments.only or folder.name in arguments.only:
            yield recordings.joint(folder, quell)


def error(result, unit):
    """An error in the unit of its row."""
    if result["error"] is None:
        return "diverged"
    return f"{result['error'] * UNITS[unit]:.3g}"


def ratio(result, quell, key):
    """In times that of Quell."""
    return "-" if result[key] is None else f"{result[key] / quell[key]:.2f}"


def cells(result):
    """A row as text: errors, ratios of errors, seconds, ratios of seconds."""
    own, unit = result["quell"], result["unit"]
    noise = own["noise"] * UNITS[unit]
    line = [result["recording"], unit, f"{noise:.3g}", error(own, unit), f"{own['cpu_seconds']:.1f}"]
    for name in PEERS:
        peer = result[name]
        seconds = f"{peer['cpu_seconds']:.1f} ({peer['fit_cpu_seconds']:.2f})"
        line += [error(peer, unit), ratio(peer, own, "error"), seconds, ratio(peer, own, "cpu_seconds")]
    return line


def show(rows, markdown):
    """The table."""
    head = ["recording", "unit", "noise", "quell", "s"]
    for name in PEERS:
        head += [name, "ratio", "s", "ratio"]
    lines = [head, *map(cells, rows)]
    if markdown:
        lines.insert(1, ["---"] * len(head))
        print("\n".join("| " + " | ".join(line) + " |" for line in lines))
        return
    widths = [max(map(len, column)) for column in zip(*lines)]
    print("\n".join("  ".join(cell.rjust(width) for cell, width in zip(line, widths)) for line in lines))


def cores(quell, found):
    """Seconds of Quell by one thread and by two."""
    for case in found:
        with tempfile.TemporaryDirectory() as out:
            one, two = (quell.diagnose(case, out, jobs) for jobs in (1, 2))
        faster = one["seconds"] / two["seconds"]
        print(f"{case.name}: {one['seconds']:.2f} s on one core, {two['seconds']:.2f} s on two, {faster:.2f} times as fast; "
              f"of the processors {one['cpu_seconds']:.2f} and {two['cpu_seconds']:.2f} s")


def main():
    """Command line."""
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=Path, nargs="*", help="folders of concealed cases")
    parser.add_argument("--quell", type=Path, default=root / "target" / "release" / "quell")
    parser.add_argument("--shared", type=Path, default=Path("../shared"))
    parser.add_argument("--only", type=lambda names: names.split(","), help="rows to run, by name: emps,case-01")
    parser.add_argument("--markdown", action="store_true")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--cores", action="store_true", help="Quell alone, on one core and on two")
    arguments = parser.parse_args()
    if not arguments.quell.exists():
        environment.skip(f"no program at {arguments.quell}; build it with cargo build --release")
    quell = Quell(arguments.quell.resolve())
    with tempfile.TemporaryDirectory() as work:
        found = cases(arguments, quell, Path(work))
        if arguments.cores:
            return cores(quell, found)
        rows = [row(quell, case) for case in found]
    if not rows:
        environment.skip("no recordings to run")
    if arguments.json:
        print(json.dumps(rows, indent=2))
    else:
        show(rows, arguments.markdown)


if __name__ == "__main__":
    main()
