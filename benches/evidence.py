"""Runs what the figures of the book are made from, and writes docs/src/evidence/measured.md.

    python3 benches/evidence.py                    # all that takes a minute or less
    python3 benches/evidence.py tick planning      # these alone
    python3 benches/evidence.py --list             # names, commands, what takes long

What a command prints is written as it is, with date, machine, load and commit, in the place of what it printed before. The other
sections stay. Long campaigns are run by their names only.
"""

import argparse
import datetime
import os
import platform
import re
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/src/evidence/measured.md"
HEAD = """# Measured last

What the commands printed when they were run last. `python3 benches/evidence.py` runs those that take a minute or less and writes this page;
`python3 benches/evidence.py tick` runs one; `--list` shows all. The other pages of this part say what the figures mean, and hold older and
longer campaigns with their dates.

"""
# Name, heading, command, whether it takes long.
RUNS = [
    ("compare", "Shapers", "quell compare", False),
    ("closed_loop", "What is left of the vibration", "cargo test --release --features full --test closed_loop -- --nocapture", False),
    ("step", "A step of the filter", "cargo bench -p quell-shapers --bench step", False),
    ("tick", "A tick of the controller", "cargo bench --features full --bench tick", False),
    ("planning", "Planning", "cargo bench -p quell-trajectories --bench planning", False),
    ("lateness", "Lateness", "cargo bench --features full --bench lateness", False),
    ("optimum", "Beside the best that is possible", "cargo bench -p quell-shapers --bench optimum", True),
    ("tolerance", "Within a tolerance", "cargo bench --features full --bench tolerance", True),
    ("estimation", "Periods until the estimate is right", "cargo bench --features full --bench estimation", True),
    ("printers", "Printers", "cargo bench --features full --bench printers", True),
    ("diagnosis", "Seconds of a diagnosis", "cargo bench --features full --bench diagnosis", True),
    ("axes", "The number of joints", "cargo bench --features full --bench axes", True),
    ("cramer_rao", "Against the Cramér-Rao bound", "cargo bench --features full --bench cramer_rao", True),
    ("faults", "When a sensor fails", "cargo bench --features full --bench faults", True),
    ("growth", "The length of a recording", "python3 benches/growth.py", True),
    ("prove", "Concealed cases", "quell prove --cases 500 --seed 1", True),
]
SECTION = r"<!-- measured: {} -->\n(.*?)<!-- end -->"
# What cargo says of itself.
NOISE = re.compile(r"^(running \d+ test|test .* \.\.\. |test result: |successes:|failures:)")


def output(*command):
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def machine():
    names = [line.split(":", 1)[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
    name = names[0] if names else platform.machine()
    return f"{os.cpu_count()} cores ({name})"


def commit():
    # The page itself does not count.
    changed = output("git", "status", "--porcelain", "--", ".", f":!{PAGE.relative_to(ROOT)}")
    return output("git", "rev-parse", "--short", "HEAD") + (" and changes" if changed else "")


def measured(heading, command):
    words = command.split()
    if words[0] == "quell":
        words = "cargo run --release --features full --quiet --".split() + words[1:]
    build = [word for word in words[: words.index("--")] if word != "--quiet"] if "--" in words else list(words)
    if words[0] == "cargo":
        build[1] = "build" if build[1] == "run" else build[1]
        subprocess.run(build + ([] if build[1] == "build" else ["--no-run"]), cwd=ROOT, check=True)
    load = os.getloadavg()[0]
    begin = time.monotonic()
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    seconds = time.monotonic() - begin
    if done.returncode != 0:
        raise SystemExit(f"{command}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    lines = [line.rstrip() for line in done.stdout.splitlines() if not NOISE.match(line)]
    text = re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip("\n")
    today = datetime.date.today().isoformat()
    return (
        f"## {heading}\n\n`{command}`\n\n{today}, {machine()}, load {load:.1f}, commit {commit()}, {seconds:.0f} s.\n\n"
        f"```text\n{text}\n```\n"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", choices=[[], *(run[0] for run in RUNS)])
    parser.add_argument("--list", action="store_true", help="names and commands, no run")
    arguments = parser.parse_args()
    if arguments.list:
        for name, _, command, long in RUNS:
            print(f"{name:12} {'long ' if long else '     '} {command}")
        return
    text = PAGE.read_text() if PAGE.exists() else ""
    for name, heading, command, long in RUNS:
        if name not in arguments.names and (long or arguments.names):
            continue
        print(name, flush=True)
        section = measured(heading, command)
        kept = {run[0]: re.search(SECTION.format(run[0]), text, re.S) for run in RUNS}
        parts = {own: found.group(1) for own, found in kept.items() if found} | {name: section}
        text = HEAD + "\n".join(f"<!-- measured: {run[0]} -->\n{parts[run[0]]}<!-- end -->\n" for run in RUNS if run[0] in parts)
        # After each, so that what was measured is not lost with the next.
        PAGE.write_text(text)


main()
