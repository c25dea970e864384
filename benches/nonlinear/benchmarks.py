"""The published protocols of the nonlinear system identification benchmarks, and Quell's figure beside the published ones.

    python3 benches/nonlinear/benchmarks.py --recordings DIR [--only emps,silverbox] [--markdown]

Needs nothing but the program and Python. A model is diagnosed on the estimation part alone. On a test part offsets and
start are fitted to the first samples that the protocol grants (`quell score --first`), and the error is that of the free
run over all that follows. Splits and first samples are those of the benchmarks' own loader (nonlinear_benchmarks 1.0 of
PyPI, https://www.nonlinearbenchmark.org). Files that are absent are told in a word. README.md has what the files are called.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from published import PUBLISHED, SOURCE

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


@dataclass
class Part:
    """Rows of a file; all of them where none are named."""

    file: str
    rows: tuple = ()


@dataclass
class Benchmark:
    """One benchmark: what is fitted, what is judged."""

    name: str
    folder: str
    model: str
    channels: list                # role, column, unit
    train: Part
    tests: dict                   # name in PUBLISHED or of Quell's own: part
    first: int                    # samples that the start may be fitted to
    unit: str
    scale: float                  # from the recording's unit to this one
    remark: str = ""


def silverbox():
    """Volts to volts. Two of the realisations that may be fitted tell as much as all, and take a sixth of the time."""
    file = "SNLS80mV.csv.gz"
    return Benchmark(
        "silverbox", "silverbox", (EXAMPLES / "silverbox" / "model.toml").read_text(),
        [("force", "input_V", "V"), ("link_position", "output_V", "V")],
        Part(file, (40650, 50650)),
        {"silverbox multisine": Part(file, (105712, 127400)), "silverbox arrow": Part(file, (100, 40575)),
         "silverbox arrow, no extrapolation": Part(file, (100, 32100))},
        50, "mV", 1e3)


RIGID = """kind = "rigid_axis"
mass = { value = 100.0, std = 20.0, bounds = [20.0, 500.0] }        # kg
viscous = { value = 300.0, std = 200.0, bounds = [1.0, 3000.0] }    # N s/m
"""
CARRIAGE = [("force", "motor_force_N", "N"), ("motor_position", "q_meas_m", "m")]


def emps():
    """Force to position in open loop; the reference of the loop is not used."""
    return Benchmark("emps", "emps", RIGID, CARRIAGE, Part("DATA_EMPS.csv.gz"),
                     {"emps pulses": Part("DATA_EMPS_PULSES.csv.gz")}, 20, "mm", 1e3)


def emps_moves():
    """For who has only the estimation file."""
    file = "DATA_EMPS.csv.gz"
    return Benchmark("emps moves", "emps", RIGID, CARRIAGE, Part(file, (0, 18703)),
                     {"emps moves 7 and 8": Part(file, (18703, 24841))}, 20, "mm", 1e3,
                     "not the published test: the last two of eight moves of the estimation file")


def bouc_wen():
    """A mass on a hysteretic spring; what is fitted is the user's choice, the tests are published."""
    model = """kind = "oscillator"
natural_frequency_hz = { value = 35.0, std = 3.0, bounds = [20.0, 60.0] }
damping_ratio = { value = 0.02, std = 0.01, bounds = [0.001, 0.5] }
gain = { value = 2e-5, std = 5e-6, bounds = [1e-6, 1e-3] }
input_hold = "spline"
"""
    return Benchmark("bouc-wen", "bouc_wen", model, [("force", "u_N", "N"), ("link_position", "y_m", "m")],
                     Part("estimation.csv.gz"),
                     {"bouc-wen multisine": Part("multisine.csv.gz"), "bouc-wen sinesweep": Part("sinesweep.csv.gz")},
                     50, "um", 1e6)


# What has no kind of model here: a level with an outflow, and a speed without its sign.
OTHERS = {"tanks": "no kind of model here has a level and its outflow",
          "drives, low amplitude": "the sensor shows a speed without its sign, which no output here does",
          "drives, high amplitude": "the same"}


def manifest(benchmark, part, folder):
    """A manifest of a part; its file lies in the folder."""
    lines = [f'name = "{benchmark.name}"'] + ([f"rows = [{part.rows[0]}, {part.rows[1]}]"] if part.rows else [])
    for role, column, unit in benchmark.channels:
        file = json.dumps(str((folder / part.file).resolve()))
        lines += ["[[channel]]", f'role = "{role}"', f"file = {file}", 'time = "t_s"', f'column = "{column}"',
                  f'unit = "{unit}"']
    return "\n".join(lines) + "\n"


def run(*command):
    """What a command says, its processor seconds and the most memory that it held, MB."""
    begun = time.perf_counter()
    child = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    said = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))} ended with {child.returncode}")
    return said, {"wall_s": time.perf_counter() - begun, "cpu_s": usage.ru_utime + usage.ru_stime,
                  "mb": usage.ru_maxrss / 1024.0}


def measured(quell, benchmark, folder, jobs):
    """The figures of a benchmark: a row each test whose file is there."""
    there = {name: part for name, part in benchmark.tests.items() if (folder / part.file).exists()}
    for name in benchmark.tests.keys() - there.keys():
        print(f"{name}: {folder / benchmark.tests[name].file} is absent", file=sys.stderr)
    if not there or not (folder / benchmark.train.file).exists():
        return []
    with tempfile.TemporaryDirectory() as work:
        work = Path(work)
        (work / "model.toml").write_text(benchmark.model)
        (work / "train.toml").write_text(manifest(benchmark, benchmark.train, folder))
        _, cost = run(quell, "diagnose", "--jobs", jobs, "--model", work / "model.toml", work / "train.toml",
                      "--out", work / "out")
        said = json.loads((work / "out" / "diagnosis.json").read_text())
        named = " + ".join(finding["effect"].replace("_", " ") for finding in said["findings"])
        rows = []
        for name, part in there.items():
            (work / "test.toml").write_text(manifest(benchmark, part, folder))
            command = ["score", "--first", benchmark.first, "--json"]
            score = json.loads(run(quell, *command, work / "out" / "model.toml", work / "test.toml")[0])
            given = json.loads(run(quell, *command, work / "model.toml", work / "test.toml")[0])
            rows.append({"test": name, "unit": benchmark.unit, "quell": score["rms"] * benchmark.scale,
                         "given_model": given["rms"] * benchmark.scale, "named": f"{said['verdict']}: {named}",
                         "published": PUBLISHED.get(name, []), "remark": benchmark.remark, **cost})
        return rows


def line(row):
    """A row as cells."""
    published = "; ".join(f"{method} {value:g} ({by})" for method, value, by in row["published"]) or row["remark"] or "-"
    return [row["test"], row["unit"], f"{row['given_model']:.3g}", f"{row['quell']:.3g}", published,
            f"{row['cpu_s']:.0f}", f"{row['mb']:.0f}", row["named"]]


def show(rows, markdown):
    """The table, and where the figures of others are from."""
    lines = [["test", "unit", "given model", "quell", "published", "cpu s", "MB", "diagnosis"], *map(line, rows)]
    if markdown:
        lines.insert(1, ["---"] * len(lines[0]))
        print("\n".join("| " + " | ".join(cells) + " |" for cells in lines))
    else:
        widths = [max(map(len, column)) for column in zip(*lines)]
        print("\n".join("  ".join(cell.ljust(width) for cell, width in zip(cells, widths)).rstrip() for cells in lines))
    print(f"\nPublished: {SOURCE}.")


def main():
    """Command line."""
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quell", type=Path, default=root / "target" / "release" / "quell")
    parser.add_argument("--recordings", type=Path, default=Path("../shared/recordings"))
    parser.add_argument("--only", type=lambda names: names.split(","), help="benchmarks to run, by name: emps,silverbox")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--markdown", action="store_true")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    if not arguments.quell.exists():
        sys.exit(f"no program at {arguments.quell}; build it with cargo build --release")
    rows = []
    for make in (silverbox, emps, emps_moves, bouc_wen):
        benchmark = make()
        if arguments.only and benchmark.name not in arguments.only:
            continue
        rows += measured(arguments.quell.resolve(), benchmark, arguments.recordings / benchmark.folder, arguments.jobs)
    for name, why in {} if arguments.only else OTHERS.items():
        best = "; ".join(f"{method} {value:g} ({by})" for method, value, by in PUBLISHED[name])
        print(f"{name}: not run, {why}; published: {best}", file=sys.stderr)
    if arguments.json:
        print(json.dumps(rows, indent=2))
    elif rows:
        show(rows, arguments.markdown)


if __name__ == "__main__":
    main()
