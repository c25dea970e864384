"""Cases of chosen kinds: which effects go together, and whether each of several can be seen beside the others."""

import numpy as np

from baseline import Baseline
from effects import EFFECTS, LAWS, SHAPED
from effects.effect import ALL_ROLES

COUNTS = {"clean": 0, "single": 1, "pair": 2, "triple": 3, "four": 4, "five": 5, "six": 6, "shaped": 1, "outside": 1}
LEAST = 1.05               # residual over noise that an effect has to leave beside the others

# Names of the catalogue that an engineer would look for in the same part: a case has one of each at most.
FAMILIES = [
    {"coulomb_friction", "presliding_hysteresis", "stribeck_friction", "hysteretic_stiffness"},
    {"cubic_stiffness", "bilinear_stiffness"},
    {"viscous_drag", "quadratic_drag", "quadratic_damping"},
    {"second_mode", "base_mode"},
    {"sensor_gain", "misalignment", "gravity_load"},
    {"payload_change", "stiffness_drift"},
]


def family(effect):
    """The family of an effect of the catalogue, as something to compare."""
    names = set(effect.catalogue)
    return next((k for k, group in enumerate(FAMILIES) if names & group), effect.catalogue)


def plan_of_kinds(rng, count, kinds):
    """What to hide in each of `count` cases, `kinds` in turn: lists (kind, effect classes)."""
    tables = {"single": [effect for effect in EFFECTS if effect.catalogue], "shaped": SHAPED,
              "outside": [effect for effect in EFFECTS if not effect.catalogue] + LAWS}
    left = {kind: [] for kind in tables}
    cases = []
    for kind in (kinds[i % len(kinds)] for i in range(count)):
        if kind in tables:
            # Every effect comes once before any comes twice.
            left[kind] = left[kind] or [tables[kind][i] for i in rng.permutation(len(tables[kind]))]
            cases.append((kind, [left[kind].pop()]))
        else:
            cases.append((kind, several(rng, COUNTS[kind])))
    return cases


def several(rng, count):
    """So many effects of different families that one sensor sees; none for 0."""
    table = [effect for effect in EFFECTS if effect.catalogue and effect.sized and effect.pairable]
    while True:
        chosen = [table[i] for i in rng.choice(len(table), count, replace=False)]
        roles = set.intersection(set(ALL_ROLES), *(set(effect.roles) for effect in chosen))
        stand_ins = any(set(one.catalogue) & set(two.equivalents) for one in chosen for two in chosen if one is not two)
        if roles and not stand_ins and len({family(effect) for effect in chosen}) == count:
            return chosen


def visible(case, sizes):
    """Whether each of several effects leaves more than noise when the nominal structure and the others' sizes are refitted.

    To first order: the change that an effect makes beside the others, without its part along the other sensitivities.
    """
    def values(scaled):
        return case.recording("train", scaled)["values"]
    recording = case.recording("train", sizes)
    both, own = recording["values"], nominal_sensitivities(Baseline(recording, case.nominal))
    changed = [[0.97 * s if i == j else s for j, s in enumerate(sizes)] for i in range(len(sizes))]
    slopes = [(values(row) - both).ravel() for row in changed]
    for index in range(len(sizes)):
        # Some effects have no limit at size 0.
        without = [0.01 * s if j == index else s for j, s in enumerate(sizes)]
        change = (values(without) - both).ravel()
        others = np.column_stack(own + slopes[:index] + slopes[index + 1:])
        others /= np.maximum(np.linalg.norm(others, axis=0), 1e-300)
        left = change - others @ np.linalg.lstsq(others, change, rcond=1e-9)[0]
        # Of a tracker's three columns only the path counts: all three hold no more than it.
        share = np.sqrt(np.sum(left ** 2) / len(both)) / case.chain.noise_std
        if not np.hypot(share, 1.0) >= LEAST:
            return False
    return True


def nominal_sensitivities(baseline):
    """Columns: f, xi, clock, initial state at their best fit, and what is free in the output (offset, or a frame)."""
    _, best = baseline.fit()
    centre, columns = baseline.prediction(best), []
    for index, step in enumerate([1e-4, 1e-3, 1e-6, 1e-6, 1e-5]):
        moved = best.copy()
        moved[index] += step
        columns.append((baseline.prediction(moved) - centre).ravel())
    width = centre.shape[1]
    columns += [np.tile(row, len(centre)) for row in np.eye(width)]
    if width == 3:
        columns += [np.cross(axis, centre - centre.mean(0)).ravel() for axis in np.eye(3)]
    return columns
