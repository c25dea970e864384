"""One concealed case: an arm, its sensors, its programmes, what is hidden in it, and how large that is made."""

import copy

import numpy as np

from arm import random_arm
from baseline import Baseline
from effects import EFFECTS
from effects.transmission import HYSTERETIC
from effects.effect import Setting
from kinds import visible
from layout import OUTPUTS
from motion import programme
from sensors import random_chain, record
from simulate import simulate

TARGET = (1.6, 12.0)       # residual over noise aimed at, logarithmically uniform
ACCEPT = (1.5, 13.0)


class Unseen(Exception):
    """What should be found cannot be."""


class Case:
    """Draws a case of a kind ("none", "single", "outside", "pair", or one that was chosen) and simulates it at a given size."""

    def __init__(self, rng, kind, wanted):
        self.rng, self.kind = rng, kind
        self.arm = random_arm(rng)
        role = rng.choice(["tip_position", "deformation", "tip_acceleration"], p=[0.76, 0.14, 0.10])
        roles = set.intersection(*(set(effect.roles) for effect in wanted)) if wanted else {role}
        role = role if role in roles else "tip_position"
        self.chain = random_chain(rng, role, rng.random() < 0.15, self.arm.lever)
        peak = rng.uniform(1e-3, 3e-3)
        reach = round(rng.uniform(0.4, 0.65), 3)
        # A ramp of acceleration a leaves a / w^2 and, at worst, as much overshoot.
        acceleration = peak * self.arm.frequency ** 2 / 1.5
        train = rng.choice(["train", "few", "rich"], p=[0.72, 0.14, 0.14])
        self.programmes = {"train": programme(rng, str(train), reach, acceleration),
                           "test": programme(rng, "test", reach, acceleration)}
        self.programme = str(train)
        durations = {name: p["duration_s"] for name, p in self.programmes.items()}
        starts = [move["start"] for move in self.programmes["train"]["moves"]]
        setting = Setting(self.arm, role, reach, peak, durations, [t - 0.15 for t in starts[1:]])
        self.effects = [effect(rng, setting) for effect in wanted]
        self.arm.timestep = min([2e-4, *(effect.timestep for effect in self.effects)])
        if any(effect.integrator == "implicitfast" for effect in self.effects):
            self.arm.integrator = "implicitfast"
        self.begin = self.choose_begin(rng, train)
        xi = self.arm.damping_ratio
        self.nominal = {"natural_frequency_hz": round(self.arm.frequency / (2 * np.pi) * (1 + rng.uniform(-0.05, 0.05)), 3),
                        "damping_ratio": round(xi * (1 + rng.uniform(-0.25, 0.25)), 3),
                        "lever_arm_m": self.arm.lever, "tip_height_m": self.arm.height}
        self.seed = int(rng.integers(2 ** 31))

    def choose_begin(self, rng, train):
        """Start of the training recording: sometimes just after the first move, while the arm still rings."""
        if len(self.programmes["train"]["moves"]) < 3 or any(effect.timed for effect in self.effects) or rng.random() > 0.15:
            return 0.0
        self.programme = "ringing"
        # On the engine's and the encoder's common grid
        return round((self.programmes["train"]["moves"][1]["start"] - rng.uniform(0.45, 0.6)) / 0.004) * 0.004

    def recording(self, which, sizes):
        """Simulates and records the programme `which` ("train" or "test") with the effects at `sizes`."""
        arm, chain = copy.deepcopy(self.arm), copy.deepcopy(self.chain)
        for effect, size in zip(self.effects, sizes):
            effect.change_arm(size, arm)
            effect.change_chain(size, chain)
        hooks = [effect.hook(size, arm, which) for effect, size in zip(self.effects, sizes)]
        run = simulate(arm, self.programmes[which], [hook for hook in hooks if hook])
        # The same noise at every size, so that the search for a size is smooth
        rng = np.random.default_rng([self.seed, which == "test"])
        return record(rng, run, chain, arm.lever, self.begin if which == "train" else 0.0)

    def ratio(self, recording):
        """Residual of the refitted nominal structure over the noise."""
        return Baseline(recording, self.nominal).fit()[0] / self.chain.noise_std

    def size_one(self, index):
        """Size of one effect alone at which the residual meets a random target; falls back on the best found."""
        effect, sizes = self.effects[index], [0.0] * len(self.effects)
        if not effect.sized:
            return effect.start
        low, high = TARGET if len(self.effects) == 1 else (2.0, 7.0)
        target = float(np.exp(self.rng.uniform(np.log(low), np.log(high))))
        alone = copy.copy(self)
        alone.effects = [effect]
        size, best, low, high = effect.start, None, effect.low, effect.high
        for turn in range(8):
            ratio = alone.ratio(alone.recording("train", [size]))
            miss = abs(np.log(ratio / target))
            if best is None or miss < best[0]:
                best = (miss, size)
            if miss < 0.15:
                break
            low, high = (size, high) if ratio < target else (low, size)
            # What the effect adds in squares grows about as its size; where that fails, halve the bracket.
            factor = np.sqrt((target ** 2 - 1) / max(ratio ** 2 - 1, 0.02))
            guess = size * np.clip(factor, 0.15, 8.0)
            size = float(guess if low < guess < high and turn < 4 else np.sqrt(low * high))
        return best[1]

    def build(self, chosen=False):
        """Sizes, both recordings and the line of truth; `chosen` where the kind was asked for."""
        sizes = [self.size_one(i) for i in range(len(self.effects))]
        if chosen and len(sizes) > 1 and not visible(self, sizes):
            raise Unseen("one of several effects is hidden by the others")
        recordings = {which: self.recording(which, sizes) for which in ("train", "test")}
        ratio = self.ratio(recordings["train"])
        parameters, names = {}, [effect.name for effect in self.effects]
        for i, (effect, size) in enumerate(zip(self.effects, sizes)):
            for key, value in effect.parameters(size).items():
                parameters[key if key not in parameters else f"{key}_{i + 1}"] = value
        # By the catalogue's names where it has them; the key `effect` keeps the engine's
        effects = [{"effect": (*effect.catalogue, effect.name)[0], "place": effect.place,
                    "parameters": effect.parameters(size)} for effect, size in zip(self.effects, sizes)]
        truth = {
            "effect": "+".join(names) or "none", "place": "+".join(effect.place for effect in self.effects),
            "parameters": parameters, "effects": effects,
            "natural_frequency_hz": float(self.arm.frequency / (2 * np.pi)), "damping_ratio": float(self.arm.damping_ratio),
            "clock_offset_s": self.chain.clock_offset, "programme": self.programme,
            "baseline_residual_over_noise": float(ratio),
            "in_catalogue": all(effect.catalogue for effect in self.effects),
            "catalogue_names": [name for effect in self.effects for name in effect.catalogue],
            "equivalents": sorted({name for effect in self.effects for name in effect.equivalents}),
            "output": self.chain.role, "noise_std": self.chain.noise_std, "noise_unit": OUTPUTS[self.chain.role][2],
            "noise": self.chain.noise_kind,
        }
        if chosen:
            truth["kind"] = self.kind
            shapes = [effect.shape for effect in self.effects if effect.shape]
            truth |= {"shape": "+".join(shapes)} if shapes else {}
        if self.chain.role == "tip_position":
            truth["tracker_noise_m"] = self.chain.noise_std
        return recordings, truth

    def acceptable(self, truth):
        """Whether the residual is in the wanted range, where the effect's size is ours to choose."""
        return not any(effect.sized for effect in self.effects) or \
            ACCEPT[0] <= truth["baseline_residual_over_noise"] <= ACCEPT[1]


def plan(rng, count):
    """What to hide in each of `count` cases: lists (kind, effect classes), shuffled; every effect before any twice."""
    known = [effect for effect in EFFECTS if effect.catalogue]
    unknown = [effect for effect in EFFECTS if not effect.catalogue]
    clean, outside, pairs = (int(np.ceil(share * count)) for share in (0.16, 0.12, 0.12))

    def cycle(table, length):
        return [table[i] for _ in range(length // len(table) + 1) for i in rng.permutation(len(table))][:length]
    cases = [("none", [])] * clean + [("outside", [effect]) for effect in cycle(unknown, outside)]
    pairable = [effect for effect in known if effect.sized and effect.pairable]
    while len(cases) < clean + outside + pairs:
        one, two = (pairable[i] for i in rng.choice(len(pairable), 2, replace=False))
        alike = one.catalogue == two.catalogue or set(one.catalogue) & set(two.equivalents) or {one, two} <= set(HYSTERETIC)
        if not alike and set(one.roles) & set(two.roles):
            cases.append(("pair", [one, two]))
    cases = cases[:count]
    cases += [("single", [effect]) for effect in cycle(known, count - len(cases))]
    return [cases[i] for i in rng.permutation(count)]
