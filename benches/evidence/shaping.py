"""The tables of shaping.md."""

from .table import SHORT, Table, below, between, found, markdown, split

PAGE = "shaping.md"


def residual(outputs):
    """Worst residual of the scenarios of the closed loop, by shaper."""
    lines = found(r"^(zvd?), .*: first ([\d.]+) %, next ([\d.]+) %, miss ([\d.e+-]+) rad", outputs[0])
    rows = []
    for name, aim, column, unit in [
        ("adaptive within the first move", "5 %", 1, " %"),
        ("adaptive on the next move", "2 %", 2, " %"),
        ("miss of the target", "1e-9 rad", 3, " rad"),
    ]:
        worst = [max((line[column] for line in lines if line[0] == shaper), key=float) for shaper in ("zv", "zvd")]
        rows.append([name, aim, *(f"{float(value):g}{unit}" for value in worst)])
    return markdown(["", "aim", f"ZV, worst of {sum(line[0] == 'zv' for line in lines)}", "ZVD"], rows)


def shapers(outputs):
    """Robustness of each shaper of `quell compare`."""
    head = ["shaper", "delay, s", "band of V <= 5 %", "V at -25 %", "-10 %", "0 %", "+10 %", "+25 %", "sum of \\|A\\|"]
    lines = below(outputs[0], "V at -25 %")
    rows = [split(line) for line in lines]
    # Without the worst for 95 % of the machines, which depends on what is known of the mode.
    return markdown(head, [row[:8] + row[9:] for row in rows])


def optimum_box(outputs):
    """The shapers beside the best that is possible for a box of modes."""
    lines = found(r"^\+- *(\d+) %, .*ratio +([\d.]+); with optimal .*ratio ([\d.]+), \d+ impulses", outputs[0])
    rows = []
    for spread in dict.fromkeys(line[0] for line in lines):
        ratios = [[float(line[k]) for line in lines if line[0] == spread] for k in (1, 2)]
        rows.append([f"{spread} %", between(ratios[0], 2), between(ratios[1], 3)])
    return markdown(["frequency known to", "the shaper of the table that is recommended", "`optimal`, solved for that box"], rows)


def optimum_estimate(outputs):
    """The same for the box of an estimate."""
    pattern = r"^deviations ([\d.]+) %, xi [\d.]+: ([\d.]+) periods, +([\d.]+) %; optimum .*ratio ([\d.]+); (\d+) us"
    lines = found(pattern, outputs[0])
    rows = []
    for deviation in dict.fromkeys(line[0] for line in lines):
        periods, left, ratio, time = ([float(line[k]) for line in lines if line[0] == deviation] for k in (1, 2, 3, 4))
        cells = [between(periods, 2), between(left, 1) + " %", between(ratio, 3), between([t / 1e3 for t in time], 2) + " ms"]
        rows.append([f"{float(deviation):g} %", *cells])
    return markdown(["deviations", "periods", "worst residual", "over the optimum", "solved in"], rows)


def tolerance(outputs):
    """Durations within a tolerance, over those with ZVD."""
    rows = []
    for line in below(outputs[0], "left, % of unshaped"):
        name, moves, median, ninety, most, unattained, times = split(line)
        rows.append([name if "as ZVD" in name else f"{name} %".replace(", long %", " %, long"), moves, median, ninety, most, unattained, times])
    return markdown(["left", "moves", "median (aim: 0.9)", "90 %", "most", "refused", "solved in, ms: median, most"], rows)


def step(outputs):
    """A step of the filter beside a loop in C."""
    lines = found(r"^(shaping|adaptive) +(\d+) impulses +(\d+) taps +([\d.]+) ns a step; (?:C +([\d.]+) ns|no C)", outputs[0])
    of = {(kind, impulses): (taps, own, loop or "-") for kind, impulses, taps, own, loop in lines}
    rows = []
    for impulses in dict.fromkeys(line[1] for line in lines):
        taps, own, loop = of["shaping", impulses]
        rows.append([f"{impulses} ({taps})", own, of["adaptive", impulses][1], loop])
    return markdown(["impulses (taps on the grid)", "train alone", "with fades and corrections", "loop in C"], rows)


def tick(outputs):
    """A tick of the controller."""
    lines = [split(line) for line in below(outputs[0], "instructions", "Microseconds")]
    return markdown(["", "shaper", "axes", "mean (aim: 500; 3000)", "median", "99 %", "most", "instructions"], lines)


def planning(outputs):
    """Times of a plan, by planner."""
    lines = found(r"^(\d+) axes (\w+) +([\d.]+) us, ratio +([\d.]+); .*, (\d+) of \d+ differ", outputs[0])
    rows = []
    for axes in dict.fromkeys(line[0] for line in lines):
        of = {name: (time, ratio, differ) for number, name, time, ratio, differ in lines if number == axes}
        times = [f"{of[name][0]} us" for name in ("ruckig", "kept", "rsruckig", "quell")]
        rows.append([axes, *times, of["quell"][1], of["quell"][2]])
    return markdown(["axes", "Ruckig (the crate `ruckig`)", "its objects kept", "`rsruckig`", "Quell", "over Ruckig", "durations that differ"], rows)


TABLES = [
    Table("residual", PAGE, ("cargo test --release --features full --test closed_loop -- --nocapture",), residual, SHORT),
    Table("shapers", PAGE, ("quell compare --out {work}",), shapers, SHORT),
    Table("optimum_box", PAGE, ("cargo bench -p quell-shapers --bench optimum",), optimum_box, SHORT),
    Table("optimum_estimate", PAGE, ("cargo bench -p quell-shapers --bench optimum",), optimum_estimate, SHORT),
    Table("tolerance", PAGE, ("cargo bench --features full --bench tolerance",), tolerance),
    Table("step", PAGE, ("cargo bench -p quell-shapers --bench step",), step, SHORT),
    Table("tick", PAGE, ("cargo bench --features full --bench tick",), tick, SHORT),
    Table("planning", PAGE, ("cargo bench -p quell-trajectories --bench planning",), planning, SHORT),
]
