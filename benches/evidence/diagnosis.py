"""The tables of diagnosis.md."""

import json

from .table import Table, as_printed, found, markdown

PAGE = "diagnosis.md"
# Seed and number of cases: those of today first.
SEEDS = {"50321": 24, "24681": 24, "90017": 24, "73301": 24, "60311": 24, "55117": 16, "9005": 40}
# Example: what is judged, factor from the unit of its scores to that of the row, and this.
REAL = {
    "emps": ("position of the carriage, moves 7 and 8", 1e6, "um"),
    "silverbox": ("free run over the arrow", 1e3, "mV"),
    "quanser": ("hub, second period", 180.0 / 3.141592653589793, "deg"),
    "friction_damper": ("force at 0.5 Hz", 1.0, "N"),
    "daisy_robot_arm": ("the last third", 1.0, "raw"),
    "flexarm": ("hub angle, second turn", 180.0 / 3.141592653589793, "deg"),
}
FOLDERS = {"quanser": "quanser_2dsfl", "friction_damper": "arts_friction_backlash", "flexarm": "flexarm_ist"}


def decimals(value, digits):
    """A figure; a dash where no case has one."""
    return "-" if value is None else f"{value:.{digits}f}"


def concealed(outputs):
    """Rates of `quell prove`, by seed."""
    scores = [json.loads(text) for text in outputs]

    def rate(score, *keys):
        for key in keys:
            score = score.get(key, {})
        return f"{score['right']} of {score['of']}" if score.get("of") else "-"

    def sure(score):
        bins = [one["so"] for one in score["reliability"] if one["low"] >= 99.0]
        return f"{sum(one['right'] for one in bins)} of {sum(one['of'] for one in bins)}"

    def spread(score, key, digits):
        one = score["figures"][key]
        return ", ".join(decimals(one[which], digits) for which in ("median", "ninth_decile"))

    rows = [
        ("single effects: family found", lambda s: rate(s, "kinds", "single", "all_families")),
        ("pairs: both families found", lambda s: rate(s, "kinds", "pair", "all_families")),
        ("triples: all families found", lambda s: rate(s, "kinds", "triple", "all_families")),
        ("clean cases: false alarms", lambda s: rate(s, "rates", "false_alarms")),
        ("findings that are not there", lambda s: rate(s, "rates", "spurious")),
        ("probabilities of 99 to 100 % that are true", sure),
        ("95 % intervals that hold the truth", lambda s: rate(s, "rates", "coverage")),
        ("residual over noise on moves never shown, median and 90th percentile", lambda s: spread(s, "test_over_noise", 2)),
        ("seconds of a case, median and 90th percentile", lambda s: spread(s, "seconds", 1)),
    ]
    return markdown(["", *(f"seed {seed}" for seed in SEEDS)], [[name, *map(cell, scores)] for name, cell in rows])


def full(outputs):
    """The full run, and the cases of another simulator."""
    scores = [json.loads(text) for text in (outputs[0], outputs[-1])]

    def rate(key):
        cells = [score["rates"][key] for score in scores]
        return [f"{c['right']} of {c['of']}, {c['percent']:.0f} %" if c["of"] else "-" for c in cells]

    def spread(key):
        figures = (score["figures"][key] for score in scores)
        return ["; ".join(decimals(one[which], 2) for which in ("median", "ninth_decile")) for one in figures]

    rows = [
        ["mismatch noticed", "", *rate("detected")],
        ["family, single effects", "98 %", *rate("family")],
        ["exact name", "92 %", *rate("exact")],
        ["truth in the set", "97 %", *rate("in_set")],
        ["size of the set, mean", "1.3", *(decimals(score["figures"]["set_size"]["mean"], 2) for score in scores)],
        ["two effects, both families", "94 %", *rate("two_families")],
        ["false alarms", "1 %", *rate("false_alarms")],
        ["outside the catalogue, flagged", "85 %", *rate("outside_flagged")],
        ["residual over noise on moves never shown, median and 90th percentile", "1.03; 1.10", *spread("test_over_noise")],
        ["coverage of the 95 % intervals", "90 to 98 %", *rate("coverage")],
        ["seconds of a case, median and 90th percentile", "", *spread("seconds")],
    ]
    return markdown(["", "aim", *(f"{name}, {score['cases']}" for name, score in zip(("own generator", "MuJoCo"), scores))], rows)


def short(value):
    """Three digits, without a power of ten where it is not needed."""
    return f"{float(f'{value:.3g}'):.12g}"


def left(score, factor, unit):
    """A misfit, and the number of windows in which the recording was predicted, each with a start of its own."""
    windows = f", {score['windows']} windows" if score["windows"] > 1 else ""
    return f"{short(factor * score['rms'])} {unit}{windows}"


def told(finding):
    """A finding with its place and its parameters; of a learned law what its curve says."""
    name = f"{finding['effect'].replace('_', ' ')} at the {finding['place']}"
    if learned := finding.get("curve", {}).get("learned"):
        return f"{name}: {learned['sentence'].rstrip('.')}"
    values = (f"{p['name'].replace('_', ' ')} {short(p['value'])} {p['unit'].removeprefix('1')}".strip() for p in finding["parameters"])
    return f"{name} ({', '.join(values)})"


def real(outputs):
    """What is said of the public recordings."""
    rows = []
    for (name, (what, factor, unit)), text in zip(REAL.items(), outputs):
        answer = json.loads(text)
        # What `quell score` says of it: a misfit that is coupled to the measured motion shows less than a prediction.
        score = next(score for score in answer["fit"]["scores"] if score["held_out"])
        sizes = [left(score[when], factor, unit) for when in ("before", "after")]
        named = [told(finding) for finding in answer["findings"]]
        verdict = answer["verdict"].replace("_", " ")
        rows.append([f"`{name}`: {what}", *sizes, f"{'; '.join(named) or 'nothing'}; verdict \"{verdict}\""])
    return markdown(["recording", "before", "after", "named"], rows)


def speed(outputs):
    """Seconds of a diagnosis, for 13 s of recording."""
    ((median, ninth),) = found(r"^seconds for 13 s: median ([\d.]+), 90th percentile ([\d.]+)", outputs[0])
    nothing = found(r"^ {10,}.* ([\d.]+)$", outputs[0])
    rows = [["median (aim: 1)", median], ["one case in ten takes more than", ninth], ["where nothing is hidden, most", max(nothing, key=float)]]
    return markdown(["", "seconds"], rows)


def diagnose(name):
    folder = f"{{work}}/{name}"
    return f"quell diagnose --model {folder}/model.toml {folder}/train.toml --held-out {folder}/held_out.toml --json --force --out {{work}}/out"


COPIES = tuple((f"examples/{name}", FOLDERS.get(name, name)) for name in REAL)
PROVE = "quell prove --cases {} --seed {} --kinds single,clean,pair,triple --json"
TABLES = [
    Table("concealed", PAGE, tuple(PROVE.format(cases, seed) for seed, cases in SEEDS.items()), concealed),
    Table(
        "full",
        PAGE,
        ("quell prove --cases 500 --seed 1 --json", "tests/mujoco/run.sh {work}/arms --cases 60 --seed 101", "quell prove --from {work}/arms --json"),
        full,
    ),
    Table("real", PAGE, tuple(map(diagnose, REAL)), real, copies=COPIES),
    Table("speed", PAGE, ("cargo bench --features full --bench diagnosis",), speed),
    Table("peers", PAGE, ("python3 benches/peers/diagnosis.py --shared {recordings}/.. --markdown",), as_printed),
]
