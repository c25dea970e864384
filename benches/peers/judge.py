"""Quell itself, run as anybody would run it: its model, its score, its seconds."""

import csv
import json
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np


class Quell:
    """The program at a path."""

    def __init__(self, program):
        self.program = str(program)

    def run(self, *arguments):
        """What it says on stdout."""
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(map(str, arguments))}: {done.stderr.strip()}")
        return done.stdout

    def diagnose(self, case, out, jobs=1):
        """Seconds on the wall and of the processor from the start of the process to its end."""
        held = ["--held-out", case.held_out] if case.judged_by_held_out else []
        used, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        self.run("diagnose", "--jobs", jobs, "--model", case.model, case.train, *held, "--out", out)
        wall, now = time.perf_counter() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
        return {"seconds": wall, "cpu_seconds": now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime}

    def measured(self, case):
        """Its seconds, and its error on what was held out."""
        with tempfile.TemporaryDirectory() as out:
            result = self.diagnose(case, out)
            said = json.loads((Path(out) / "diagnosis.json").read_text())
            score = json.loads(self.run("score", Path(out) / "model.toml", case.held_out, "--json"))
        named = " + ".join(finding["effect"].replace("_", " ") for finding in said["findings"])
        settings = f"{said['verdict']}: {named}" if named else said["verdict"]
        return {**result, "error": score["rms"], "noise": score["noise_std"], "settings": settings}

    def recorded(self, model, recording):
        """Stamps and values of the first output as Quell reads it: a tracker's point is an arc in the joint's frame."""
        with tempfile.TemporaryDirectory() as out:
            path = Path(out) / "prediction.csv"
            self.run("simulate", model, recording, "--out", path)
            with path.open() as lines:
                rows = [[float(cell) for cell in row[:2]] for row in list(csv.reader(lines))[1:]]
        return np.array(rows).T
