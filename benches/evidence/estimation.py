"""The tables of estimation.md."""

from .table import SHORT, Table, below, found, markdown, split

PAGE = "estimation.md"
BOUND = "cargo bench --features full --bench cramer_rao -- "


def periods(outputs):
    """Periods until the estimate is right, 95th percentile, by rate."""
    lines = found(r"^(\S.*?) +(\d+)Hz(.*)$", outputs[0])
    cells = {(name, rate): figures.split() for name, rate, figures in lines}
    rates = list(dict.fromkeys(line[1] for line in lines))
    rows = []
    for name in dict.fromkeys(line[0] for line in lines):
        # Of the bound there is no median.
        column = 0 if len(cells[name, rates[0]]) == 1 else 1
        called = name if column else "Cramér-Rao bound"
        rows.append([called, *(cells[name, rate][column] for rate in rates)])
    return markdown(["95th percentile, periods (aim of the likelihood: 0.75 at 333 Hz, 0.6 at 1 kHz)", *(f"{rate} Hz" for rate in rates)], rows)


def efficiency(outputs):
    """The likelihood estimator against the bound, with the level of the noise learned."""
    rows = []
    for count in found(r"^ *([\d.]+) periods, learned", outputs[0]):
        lines = below(outputs[0], f"{count} periods, learned", "periods,")
        joined = next(split(line) for line in lines if "all below 30 %" in line)
        _, cases, silent, f, xi, inside_f, inside_xi = joined
        rows.append([count, f"{f}, {xi}", f"{inside_f}, {inside_xi} %", f"{silent} of {cases}"])
    head = ["periods measured", "efficiency, f and xi (aim: 0.8 at 0.75, 0.9 at 1)"]
    return markdown([*head, "within 1.96 stated deviations, f and xi (aim: 93 to 97 %)", "silent"], rows)


def convergence(outputs):
    """Periods until an estimate is right, and until it says so."""
    lines = [split(line.replace("inf", "  -")) for line in below(outputs[0], "never, %")]
    rows = [["bound: 1.96 deviations within 2 % of f and 0.02 of xi", *lines[0][1:]]]
    for within, converged in zip(lines[1::2], lines[2::2]):
        rows.append([within[0].removesuffix(", within"), *("; ".join(pair) for pair in zip(within[1:], converged[1:]))])
    return markdown(["periods until: within, for good; converged", "10 %", "median", "90 %", "95 %", "never, %"], rows)


def spoiled(outputs):
    """Errors where the samples are not as the methods assume."""
    lines = [split(line.replace("inf", "  -")) for line in below(outputs[0], "silent  inside")]
    of = {(spoil, name): (f"{median}, {most}", inside) for spoil, name, median, most, _, _, _, inside in lines}
    # The paper's estimator errs as the algebraic one does here, and the one for two modes as the likelihood.
    names = ["likelihood", "algebraic", "algebraic_integrated", "super_twisting"]
    rows = [[spoil, *(of[spoil, name][0] for name in names), of[spoil, names[0]][1]] for spoil in dict.fromkeys(line[0] for line in lines)]
    return markdown(["", *names, "likelihood: within 1.96 stated, %"], rows)


def two_modes(outputs):
    """Two close modes told apart."""
    rows = []
    for line in below(outputs[0], "ratio, periods"):
        if "not separable" in line:
            continue
        words = line.replace(",", " ").split()
        ratio, count, couples, _, separated, *figures = words
        e, inside, two, one = figures[0:2], figures[4:6], figures[6:8], figures[8:10]
        pairs = [", ".join(pair) for pair in (e, inside)]
        rows.append([f"{ratio}; {count}", couples, f"{separated} %", *pairs, "; ".join(", ".join(pair) for pair in (two, one))])
    head = ["ratio; periods of the slower", "separable", "of these separated", "efficiency, f and xi", "inside, f and xi, %"]
    return markdown([*head, "error of the stronger one's f, %, median and 90 %: told of two; by one mode"], rows)


def one_as_two(outputs):
    """How often one mode is told as two."""
    rows = [split(line) for line in below(outputs[0], "One mode told as two")]
    return markdown(["", "in the end, %", "ever since their start, %"], rows)


TABLES = [
    Table("periods", PAGE, ("cargo bench --features full --bench estimation",), periods, SHORT),
    Table("efficiency", PAGE, (BOUND + "efficiency",), efficiency),
    Table("convergence", PAGE, (BOUND + "convergence",), convergence),
    Table("spoiled", PAGE, (BOUND + "spoiled",), spoiled),
    Table("two_modes", PAGE, (BOUND + "two_modes",), two_modes),
    Table("one_as_two", PAGE, (BOUND + "two_modes",), one_as_two),
]
