"""Runs what measures a table, and says when, where and on which code."""

import datetime
import os
import platform
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PAGES = ROOT / "docs/src/evidence"
QUELL = ["cargo", "run", "--release", "--features", "full", "--quiet", "--"]


def output(*command):
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def machine():
    """Cores and model of the processor, as Linux tells them."""
    lines = open("/proc/cpuinfo") if os.path.exists("/proc/cpuinfo") else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{os.cpu_count()} cores ({names[0] if names else platform.machine()})"


def commit():
    """The commit, and whether the code differs from it. The pages that are written do not count."""
    changed = output("git", "status", "--porcelain", "--", ".", f":!{PAGES.relative_to(ROOT)}")
    return output("git", "rev-parse", "--short", "HEAD") + (" and changes" if changed else "")


def words_of(command):
    """The environment and the words of a command line, in which `quell` stands for the program of this repository."""
    words = command.split()
    environment = {}
    while "=" in words[0]:
        key, value = words.pop(0).split("=", 1)
        environment[key] = value
    return environment, [*QUELL, *words[1:]] if words[0] == "quell" else words


def build(words):
    """Builds what a command of cargo runs, so that its time is not counted."""
    if words[0] == "cargo":
        before = [word for word in (words[: words.index("--")] if "--" in words else words) if word != "--quiet"]
        before = [before[0], "build", *before[2:]] if before[1] == "run" else [*before, "--no-run"]
        subprocess.run(before, cwd=ROOT, check=True)


def copied(copies, work, recordings):
    """Copies folders of the repository, with manifests that find their files in the folder of the recordings."""
    for folder, below in copies:
        copy = shutil.copytree(ROOT / folder, Path(work) / Path(folder).name)
        for manifest in copy.glob("*.toml"):
            manifest.write_text(manifest.read_text().replace('file = "', f'file = "{recordings / below}/'))


def measured(table, recordings):
    """What the commands of a table print, and a sentence with date, machine, load, commit and time."""
    # Programs that are not made by cargo look for this one.
    build(QUELL)
    outputs, ends, load, took = [], [], os.getloadavg()[0], 0.0
    with tempfile.TemporaryDirectory() as work:
        copied(table.copies, work, recordings)
        for command in table.commands:
            environment, words = words_of(command.format(work=work, recordings=recordings))
            build(words)
            begin = time.monotonic()
            done = subprocess.run(words, cwd=ROOT, env={**os.environ, **environment}, capture_output=True, text=True)
            took += time.monotonic() - begin
            outputs.append(done.stdout)
            if done.returncode:
                # One that misses an aim has measured all the same: whether there is a table decides.
                ends.append(f" `{command}` ended with {done.returncode}.")
                print(done.stderr[-2000:])
    today = datetime.date.today().isoformat()
    where = f"Measured {today} on {machine()}, load {load:.1f}, commit {commit()}, in {took:.0f} s"
    return outputs, f"{where}.{''.join(ends)}"
