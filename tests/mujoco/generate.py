"""Generates concealed cases with the MuJoCo physics engine: `generate.py OUT --cases 60 --seed 1`."""

import argparse
import json
import time
from pathlib import Path

import numpy as np

from case import Case, plan
from layout import write_model, write_recording
from simulate import Unstable

ATTEMPTS = 4               # draws of a case before its residual is taken as it is


def generate_case(seed, index, kind, wanted):
    """Builds one case; draws again where no size brings the residual into the wanted range."""
    for attempt in range(ATTEMPTS):
        case = Case(np.random.default_rng([seed, index, attempt]), kind, wanted)
        try:
            built = case, *case.build()
        except Unstable:
            continue
        if case.acceptable(built[2]):
            break
    return built


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, help="folder to fill")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, nargs="*", help="numbers of the cases to make anew in a folder that is there")
    arguments = parser.parse_args()
    known = arguments.out / "truth.json"
    truths = json.loads(known.read_text()) if arguments.only is not None and known.exists() else {}
    for index, (kind, wanted) in enumerate(plan(np.random.default_rng(arguments.seed), arguments.cases)):
        if arguments.only is not None and index not in arguments.only:
            continue
        began, name = time.perf_counter(), f"case-{index:02d}"
        case, recordings, truth = generate_case(arguments.seed, index, kind, wanted)
        folder = arguments.out / name
        folder.mkdir(parents=True, exist_ok=True)
        write_model(folder / "model.toml", case.nominal)
        for which, recording in recordings.items():
            write_recording(folder / which, f"{name}/{which}", recording)
        truths[name] = truth
        # Written after every case, so that a run that is stopped leaves a folder that can be used.
        (arguments.out / "truth.json").write_text(json.dumps(truths, indent=1) + "\n")
        print(f"{name}  {truth['effect']:45s} {truth['output']:17s} {truth['programme']:8s} "
              f"residual / noise {truth['baseline_residual_over_noise']:6.2f}  {time.perf_counter() - began:5.1f} s", flush=True)


if __name__ == "__main__":
    main()
