"""Generates concealed cases with the MuJoCo physics engine: `generate.py OUT --cases 60 --seed 1`."""

import argparse
import json
import time
from pathlib import Path

import numpy as np

from case import Case, Unseen, plan
from kinds import COUNTS, plan_of_kinds, several
from layout import write_model, write_recording
from simulate import Unstable

ATTEMPTS = 4               # draws of a case before its residual is taken as it is
SEARCH = 40                # draws of a case with several effects, each of which is to be seen


def generate_case(seed, index, kind, wanted, chosen):
    """Builds one case; draws again where no size brings the residual into the wanted range.

    Of a chosen kind with several effects others are tried where one of them cannot be seen.
    """
    built = None
    for attempt in range(SEARCH if chosen else ATTEMPTS):
        rng = np.random.default_rng([seed, index, attempt])
        if chosen and attempt and COUNTS[kind] > 1:
            wanted = several(rng, COUNTS[kind])
        case = Case(rng, kind, wanted)
        try:
            built = case, *case.build(chosen)
        except (Unstable, Unseen):
            continue
        if case.acceptable(built[2]) or attempt + 1 >= ATTEMPTS:
            return built
    if built is None:
        raise SystemExit(f"case {index}: in {SEARCH} draws no machine shows all that the kind {kind} hides")
    return built


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, help="folder to fill")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", type=lambda text: text.split(","), help=f"what to hide, in turn: {', '.join(COUNTS)}")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of the cases to make anew in a folder that is there")
    arguments = parser.parse_args()
    strange = set(arguments.kinds or []) - set(COUNTS)
    if strange:
        parser.error(f"no such kind: {', '.join(sorted(strange))}; there are {', '.join(COUNTS)}")
    known = arguments.out / "truth.json"
    truths = json.loads(known.read_text()) if arguments.only is not None and known.exists() else {}
    rng, chosen = np.random.default_rng(arguments.seed), bool(arguments.kinds)
    cases = plan_of_kinds(rng, arguments.cases, arguments.kinds) if chosen else plan(rng, arguments.cases)
    for index, (kind, wanted) in enumerate(cases):
        if arguments.only is not None and index not in arguments.only:
            continue
        began, name = time.perf_counter(), f"case-{index:02d}"
        case, recordings, truth = generate_case(arguments.seed, index, kind, wanted, chosen)
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
