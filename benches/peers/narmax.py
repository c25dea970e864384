"""SysIdentPy: a polynomial difference equation by forward regression (FROLS), and a free run of what it found.

Settings are chosen on the fitted part alone: the first 70 % are regressed, the free run over the rest is compared. Then all
of it is regressed.

- what drives it (the case's choices), how many samples are one, lags, degree, number of terms, least squares plain or
  extended (a model of the noise takes the bias out); inputs may act within their sample (`lead`)
- first each number of samples with each drive by small polynomials, then lags, degree, terms and bias of the best

Source: Lacerda et al., SysIdentPy, JOSS 5 (2020) 2384; Billings, Nonlinear System Identification (2013).
"""

import itertools

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import decimate
from sysidentpy.basis_function import Polynomial
from sysidentpy.model_structure_selection import FROLS
from sysidentpy.parameter_estimation import LeastSquares

REGRESSED = 0.7
EVERY = (1, 2, 4, 8, 16)
LAGS = (2, 3, 4, 5, 6)
DEGREES = (1, 2, 3)
TERMS = (4, 6, 8, 12, 16, 20, 30, 40)
LEADS = (0, 1)
CANDIDATES = 700              # regressors at most: a minute a fit


class Series:
    """Inputs and output of a stretch, every so many samples, in units of the fitted part's."""

    def __init__(self, case, stretch, every, names, units=None):
        self.case, self.stretch, self.every, self.names = case, stretch, every, names
        output = stretch.position - (stretch.drives[case.output[1]] if len(case.output) > 1 else 0.0)
        raw = [output, *(stretch.drives[name] for name in names)]
        thin = [decimate(values, every, ftype="fir") if every > 1 else values for values in raw]
        self.units = units or [values.std() or 1.0 for values in thin]
        self.output, *inputs = (values / unit for values, unit in zip(thin, self.units))
        self.inputs = np.column_stack(inputs)

    def shifted(self, lead):
        """Inputs such that the lag 1 is the sample itself where they lead."""
        return np.vstack([self.inputs[lead:], self.inputs[-1:].repeat(lead, axis=0)])

    def positions(self, output):
        """The model's output as positions at the samples of the stretch."""
        count = len(self.stretch.position)
        known = self.every * np.arange(len(output))
        if not np.all(np.isfinite(output)):
            return np.full(count, np.nan)
        if self.every > 1:
            output = CubicSpline(known, output)(np.minimum(np.arange(count), known[-1]))
        drive = self.stretch.drives[self.case.output[1]] if len(self.case.output) > 1 else 0.0
        return output * self.units[0] + drive


def candidates(settings):
    """Number of regressors of a polynomial."""
    lags = settings["lags"] * (1 + len(settings["names"]))
    return int(np.prod([(lags + k) / k for k in range(1, settings["degree"] + 1)]) + 0.5)


def model(series, settings):
    """A fitted model; none where the regression fails."""
    lags = list(range(1, settings["lags"] + 1))
    inputs = lags if len(settings["names"]) == 1 else [lags] * len(settings["names"])
    fitted = FROLS(ylag=lags, xlag=inputs, elag=2, basis_function=Polynomial(degree=settings["degree"]), order_selection=False,
                   n_terms=min(settings["terms"], candidates(settings)), estimator=LeastSquares(unbiased=settings["extended"]))
    try:
        fitted.fit(X=series.shifted(settings["lead"]), y=series.output[:, None])
    except (np.linalg.LinAlgError, ValueError, IndexError):
        return None
    return fitted


def free_run(fitted, series, settings):
    """Positions from measured first samples."""
    if fitted is None:
        return np.full(len(series.stretch.position), np.nan)
    first = series.output[:fitted.max_lag, None]
    return series.positions(fitted.predict(X=series.shifted(settings["lead"]), y=first)[:, 0])


class Search:
    """Errors of settings on the part that was not regressed."""

    def __init__(self, case):
        self.case, self.known, self.best, self.series = case, {}, None, {}
        split = int(REGRESSED * len(case.fitted.position))
        self.parts = case.fitted.part(slice(0, split)), case.fitted.part(slice(split, None))

    def of(self, every, names):
        """The two parts as series."""
        if (every, names) not in self.series:
            regressed = Series(self.case, self.parts[0], every, names)
            compared = Series(self.case, self.parts[1], every, names, regressed.units)
            self.series[every, names] = regressed, compared
        return self.series[every, names]

    def look(self, **settings):
        """Tries settings, once."""
        key = tuple(sorted(settings.items()))
        if key in self.known or candidates(settings) > CANDIDATES:
            return
        regressed, compared = self.of(settings["every"], settings["names"])
        error = self.parts[1].error(free_run(model(regressed, settings), compared, settings))
        self.known[key] = error
        if error is not None and (self.best is None or error < self.best[0]):
            self.best = error, settings


def search(case):
    """The settings whose free run is best; none where all diverged."""
    known = Search(case)
    for every, names, lead in itertools.product(EVERY, case.inputs, LEADS):
        for lags, degree, terms in itertools.product((2, 3), DEGREES, (6, 12)):
            known.look(every=every, names=names, lead=lead, lags=lags, degree=degree, terms=terms, extended=False)
    if known.best is None:
        return None
    chosen = known.best[1]
    for lags, degree, terms in itertools.product(LAGS, DEGREES, TERMS):
        known.look(**{**chosen, "lags": lags, "degree": degree, "terms": terms})
    for every in EVERY:
        known.look(**{**known.best[1], "every": every})
    known.look(**{**known.best[1], "extended": True})
    return known.best[1]


def fit(case, settings):
    """The model, from all that is fitted."""
    series = Series(case, case.fitted, settings["every"], settings["names"])
    return model(series, settings), settings, series.units


def predict(case, found):
    """A free run over what was held out."""
    fitted, settings, units = found
    return free_run(fitted, Series(case, case.judged, settings["every"], settings["names"], units), settings)
