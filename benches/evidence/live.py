"""The tables of live.md, faults.md and hardness.md."""

from pathlib import Path

from .table import SHORT, Table, as_printed, between, found, markdown

PAGE = "live.md"
SOAK = "python3 tests/robots/soak.py target/release/quell"
SOAKS = {
    "10 min at 1 kHz": f"{SOAK} --minutes 10",
    "1 min at 250 Hz": f"{SOAK} --minutes 1 --rate 250",
    "1 min at 4 kHz": f"{SOAK} --minutes 1 --rate 4000",
    "1 min at 1 kHz, 3 joints": f"{SOAK} --minutes 1 --joints 3",
}
CAMPAIGNS = ("95000", "83000", "71000", "131000")
FUZZ = Path(__file__).resolve().parent.parent.parent / "fuzz"


def soak(outputs):
    """Ticks, lateness and memory of the service under load."""
    rows = []
    for name, text in zip(SOAKS, outputs):
        (ticks, skipped), = found(r"(\d+) ticks at \d+ Hz, (\d+) skipped", text)
        (late, latest), = found(r"lateness p50 \d+, p99 (\d+), max (\d+) us", text)
        memory, = found(r"memory (\d+) kB at the start, \d+ warm, (\d+) at most, (\d+) at the end", text)
        megabytes = ", ".join(f"{float(kb) / 1024:.1f}" for kb in memory)
        rows.append([name, f"{skipped} of {int(ticks) + int(skipped)}", f"{late} us, {float(latest) / 1e3:.1f} ms", f"{megabytes} MB"])
    return markdown(["run", "ticks skipped", "lateness p99, max", "memory at the start, most, at the end"], rows)


def lateness(outputs):
    """Lateness of the service's tick beside a bare loop that sleeps."""
    lines = found(r"^(bare loop|tick of quell serve) +([\d.]+) +([\d.]+) +([\d.]+)", outputs[0])
    rows = []
    for name in dict.fromkeys(line[0] for line in lines):
        columns = [[float(line[k]) for line in lines if line[0] == name] for k in (1, 2, 3)]
        rows.append([name, *(between(values, 0) for values in columns)])
    ratios = dict(found(r"^ratio of (\w+): ([\d.]+)", outputs[0]))
    rows.append(["ratio of the middle turns", ratios["median"], ratios["p99"], "-"])
    return markdown(["us", "median", "99 %", "most"], rows)


def modes(outputs):
    """Residual vibration of arms with several modes, pose and payload."""
    rows, name = [], ""
    of = {}
    for line in outputs[0].splitlines()[1:]:
        if not line.startswith(" "):
            name = line
            continue
        policy, figures = line.strip().split(":", 1)
        _, late, _, each = figures.split("|")
        of[name, policy] = (", ".join(late.split()), each.split()[0])
    for name in dict.fromkeys(key[0] for key in of):
        rows.append([name, of[name, "Fixed"][0], of[name, "Learned"][0], of[name, "Learned"][1]])
    return markdown(["arm", "without adaptation", "learned", "learned, first move"], rows)


def campaign(outputs):
    """Random arms: what all moves leave, over what they leave without adaptation."""
    rows = []
    for start, text in zip(CAMPAIGNS, outputs):
        pattern = r"^(learned.*?): median ([\d.]+), 90 % [\d.]+, 99 % ([\d.]+), worst ([\d.]+); (\d+) of (\d+) above"
        for name, median, most, worst, above, count in found(pattern, text):
            part = "from the third move on" if "third" in name else "all moves"
            rows.append([f"{start}: {part}", median, most, worst, f"{above} of {count}"])
    return markdown(["programmes", "median", "99 %", "worst", "above 1.05"], rows)


def another_simulator(outputs):
    """Arms of MuJoCo over UDP."""
    pattern = r"^(?:ok|note|FAIL) +(\S.*?, belief [\d.]+ Hz): ([\d.]+) % in the median of \d+ moves, ([\d.]+) % at most .*\(([\d.]+) % of the same move\)"
    rows = found(pattern, outputs[0])
    return markdown(["arm", "median", "worst, of the mean square of the unshaped", "worst, of the same move"], rows)


def fuzz(outputs):
    """Executions of each target, and what failed. What it reads is the first line of its file."""
    rows = []
    for part in outputs[0].split("\n== ")[1:]:
        target = part.split("\n", 1)[0].strip()
        reads = (FUZZ / "targets" / f"{target}.rs").read_text().splitlines()[0].removeprefix("//! ").rstrip(".")
        (count,) = found(r"number_of_executed_units: +(\d+)", part)
        edges = found(r"DONE +cov: (\d+)", part)[-1]
        rows.append([f"`{target}`", reads, count, edges, sum("SUMMARY" in line for line in part.splitlines())])
    return markdown(["target", "what it reads", "executions", "edges", "failures"], rows)


TABLES = [
    Table("soak", PAGE, tuple(SOAKS.values()), soak),
    Table("lateness", PAGE, ("cargo bench --features full --bench lateness",), lateness, SHORT),
    Table("modes", PAGE, ("cargo bench --features full --bench modes",), modes),
    Table(
        "campaign", PAGE, tuple(f"cargo bench --features full --bench modes -- --campaign 60 --from {n}" for n in CAMPAIGNS), campaign
    ),
    Table("another_simulator", PAGE, ("python3 tests/robots/modes.py target/release/quell",), another_simulator),
    Table("faults", "faults.md", ("QUELL_FAULTS=60 cargo bench --features full --bench faults",), as_printed),
    Table("fuzz", "hardness.md", ("fuzz/run 300",), fuzz),
]
