# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D146, D148
"""A study's results.h5: its axes, the points at which cases repeat, and estimates over the repeats."""
import json
import math
from dataclasses import dataclass

import numpy as np

from landfall import dictionary
from landfall.errors import DataError
from landfall.study import model

REQUIREMENTS = dictionary.requirements()
# Metrics that a limit of dem-eval bounds; the others' limits are in the results.
LENGTH_LIMITS = {metric.rpartition(".")[0]: r.worst_limit for r in REQUIREMENTS.values() for metric in r.worst if metric.startswith("accuracy.")}
VALUES_OF = {r.value: name for name, r in REQUIREMENTS.items() if r.value}

# Ends the metrics that are a run's estimate of a probability: draws.REQUIREMENT.passed_frac.
PASSED = ".passed_frac"
SAFE_LANDING, BLIND_LANDING = "draws.landing.safe.passed_frac", "draws.landing.blind.passed_frac"

# Constants of the 95 % intervals: the 0.975 quantile of the normal distribution, and draws of a bootstrap.
Z = 1.959963984540054
RESAMPLES = 4000

# The names of metrics in figures and reports.
METRIC_NAMES = {**dictionary.table("metrics")["names"],
                **{f"draws.{name}{PASSED}": f"probability of meeting the requirement on {r.words}" for name, r in REQUIREMENTS.items()}}
# Their absolute values are taken; a mean or median has its sign.
SIZES = ("max_m", "p95_m", "le90_m")


def metric_label(metric, unit):
    """The name of a metric in a figure or a report, without the unit, which it gives separately."""
    own = dictionary.OWN_NUMBER.fullmatch(metric)
    if own:
        return f"custom requirement {own[2]}, {metric.rpartition('.')[2]}"
    return METRIC_NAMES.get(metric) or model.without_unit(metric, unit)


def is_probability(metric):
    """Whether a run of draws estimates it."""
    return metric.startswith("draws.") and metric.endswith(PASSED)


def error_sign(metrics):
    """The sign convention, where some of the metrics are errors; else empty."""
    errors = [metric for metric in metrics if metric.startswith(("accuracy.", "statistics.")) and metric.endswith("_m")]
    if not errors:
        return ""
    return "error = true - estimated" + (", absolute value" if all(metric.rpartition(".")[2] in SIZES for metric in errors) else "")


@dataclass(frozen=True)
class StudyAxis:
    """An axis that is not a repeat, and its values in the order of the study."""

    name: str
    label: str
    unit: str
    log: bool
    numeric: bool
    values: tuple


@dataclass(frozen=True)
class Point:
    """One point of the axes: its values, in their order, and the rows of its repeats."""

    values: tuple
    rows: tuple


class Results:
    """Reads an open results.h5. Throws DataError where it does not hold together."""

    def __init__(self, file):
        try:
            head = json.loads(file["_study_json"].asstr()[()])
            names = [name for name in file["_columns"].asstr()[()]]
            self.columns = {name: _column(file[name]) for name in names}
            if len(set(map(len, self.columns.values()))) != 1:
                raise ValueError("its columns are of different lengths")
            self.units = {name: file[name].attrs["units"] for name in names}
            self.title, self.plot, self.limits = head["title"], head["plot"], head["limits"]
            self.axes = [StudyAxis(*(axis[key] for key in ("name", "label", "unit", "log", "numeric")),
                                   tuple(dict.fromkeys(self.columns[axis["name"]])))
                         for axis in head["axes"] if axis["role"] == "axis"]
            self.own = dictionary.own_paths(self.columns)
            self._axis_names = {axis["name"] for axis in head["axes"]} | {"case"}
        except (KeyError, ValueError, TypeError) as error:
            raise DataError(f"{file.filename}: no table of a study ({error})") from error
        rows = {}
        for row in range(len(self.columns["case"])):
            rows.setdefault(tuple(self.columns[axis.name][row] for axis in self.axes), []).append(row)
        self.points = [Point(values, tuple(numbers)) for values, numbers in rows.items()]

    def follows(self, axis, leader):
        """Whether each value of `leader` has one of `axis`, as where both are zipped."""
        pairs = set(zip(self.columns[leader.name], self.columns[axis.name]))
        return len(pairs) == len(leader.values)

    def is_metric(self, name):
        return name in self.columns and name not in self._axis_names and not isinstance(self.columns[name][0], str)

    def values(self, point, metric):
        """The values of a metric at a point, one number a repeat."""
        column = self.columns.get(metric)  # none where it is not known of any case
        values = np.array([column[row] for row in point.rows] if column else [], float)
        return values[np.isfinite(values)]

    def estimate(self, point, metric, quantile):
        """(quantile over the repeats, low, high); NaN where nothing is known. Of a run of draws, which repeats share, the share that passed."""
        values = self.values(point, metric)
        if values.size == 0:
            return math.nan, math.nan, math.nan
        if is_probability(metric) and len(set(values)) == 1:
            passed, count, low, high = self.draws_rate(point, metric.removeprefix("draws.").removesuffix(PASSED))
            return passed / count, low, high
        return (float(np.quantile(values, quantile)), *bootstrap(values, quantile))

    def requirements(self):
        """The names of all requirements: those of every evaluation, then the user's own."""
        return [*REQUIREMENTS, *self.own]

    def path_of(self, requirement):
        """The path with which the columns of a requirement begin."""
        return self.own.get(requirement) or f"requirements.{requirement}"

    def pass_rate(self, point, requirement):
        """(passed, judged, low, high); `all` are all requirements."""
        values = self.values(point, "pass" if requirement == "all" else self.path_of(requirement) + ".pass")
        passed = int(values.sum())
        return (passed, len(values), *wilson(passed, len(values)))

    def draws_rate(self, point, name):
        """(passed, draws, low, high) of a run of draws: of its first one, where the repeats of a point have several. NaN where not known."""
        columns = (self.columns.get(f"draws.{name}.{key}") for key in ("passed", "draws", "wilson_low", "wilson_high"))
        return tuple(column[point.rows[0]] if column else math.nan for column in columns)

    def share_of_limit(self, point, requirement, quantile):
        """How much of a requirement's limit is used, 1 for all of it; NaN where the metric or one limit of all cases is not known.

        A quantile over the repeats of the largest metric that the requirement bounds. Where 0.95 of the footprints must keep the absolute limit, a
        requirement is met by a case whose share is at most 1.
        """
        if requirement in self.own:
            return self._own_share(point, self.own[requirement], quantile)
        metrics = [metric for metric in REQUIREMENTS[requirement].worst if metric in self.columns]
        limits = [self.limit(metric) for metric in metrics]
        if not metrics or not all(limits):
            return math.nan
        shares = [[self.columns[metric][row] / limit for row in point.rows] for metric, limit in zip(metrics, limits)]
        largest = np.max(np.array(shares, float), axis=0)
        return float(np.nanquantile(largest, quantile)) if np.isfinite(largest).any() else math.nan

    def _own_share(self, point, path, quantile):
        """The value over its limit; of a smallest value that passes the limit over the value."""
        value, limit, at_least = (self.columns.get(f"{path}.{key}") for key in ("value", "limit", "at_least"))
        rows = [row for row in point.rows if value and value[row] is not None and math.isfinite(value[row])]
        parts = [(limit[row], value[row]) if at_least[row] else (value[row], limit[row]) for row in rows]
        shares = [part / whole for part, whole in parts if whole > 0]
        return float(np.quantile(shares, quantile)) if shares and len(shares) == len(rows) else math.nan

    def by_use(self, metrics):
        """The metrics by how much of their limits they use at most: the largest first, then those without a limit, then constant ones."""
        def order(metric):
            share = self.share_used(metric)
            return self.is_constant(metric), math.isnan(share), -share if not math.isnan(share) else 0
        return sorted(metrics, key=order)

    def is_constant(self, metric):
        """Whether it is one number in all cases of several."""
        values = {value for value in self.columns[metric] if value is not None and value == value}
        return len(self.columns[metric]) > 1 and len(values) <= 1

    def share_used(self, metric):
        """The largest share of its limit that a case uses; of a metric that counts or rates what exceeds a limit, that of its requirement."""
        requirement = requirement_of(metric)
        if requirement is None:
            return math.nan
        is_length = metric.endswith("_m") and metric.rpartition(".")[0] in LENGTH_LIMITS
        def largest(name):
            return max((abs(value) for value in self.columns[name] if value is not None and math.isfinite(value)), default=math.nan)
        shares = [largest(name) / limit for name in ([metric] if is_length else REQUIREMENTS[requirement].worst)
                  if name in self.columns and (limit := self.limit(name))]
        return max(shares, default=math.nan)

    def repeats(self):
        return max(len(point.rows) for point in self.points)

    def limit(self, metric):
        """The requirement on a metric, where all cases share one; None otherwise."""
        parent, _, last = metric.rpartition(".")
        if parent in LENGTH_LIMITS and last in ("p95_m", "max_m"):
            return self.limits.get(LENGTH_LIMITS[parent])
        requirement = self.own_of(metric) or requirement_of(metric)
        column = self.columns.get(f"{self.path_of(requirement)}.limit", [])
        return column[0] if len(set(column)) == 1 else None

    def own_of(self, metric):
        """The name of the user's own requirement on a metric; None without one."""
        def is_on(path):
            whole = "score." if path.startswith("score.") else ""
            return metric == path + ".value" or {whole + text for text in self.columns.get(path + ".metric", [])} == {metric}
        return next((name for name, path in self.own.items() if is_on(path)), None)

    def bound(self, metric):
        """Whether a metric must be at least or at most its limit."""
        own = self.own_of(metric)
        if own:
            return "at least" if self.columns[self.own[own] + ".at_least"][0] else "at most"
        return next((r.bound for name, r in REQUIREMENTS.items() if metric in (r.value, f"requirements.{name}.value")), "at most")


def requirement_of(metric):
    """The requirement that a metric is judged by; None where there is none."""
    parent, _, last = metric.rpartition(".")
    if parent in LENGTH_LIMITS and last in ("p95_m", "max_m"):
        return LENGTH_LIMITS[parent].removesuffix("_m")
    found = metric.split(".")[1] if metric.startswith("requirements.") and last == "value" else VALUES_OF.get(metric)
    return found if found in REQUIREMENTS else None


def _column(dataset):
    if len(dataset.shape) != 1:
        raise ValueError(f"{dataset.name} has shape {dataset.shape}")
    return dataset.asstr()[()].tolist() if dataset.dtype.kind == "O" else dataset[()].tolist()


# 95 % confidence intervals over the repeats of a study


def wilson(passed, count):
    """(low, high) of a rate: Wilson, JASA 22 (1927) 209-212. (0, 1) of nothing."""
    if count == 0:
        return 0.0, 1.0
    rate, z2 = passed / count, Z * Z / count
    centre = (rate + z2 / 2) / (1 + z2)
    half = Z / (1 + z2) * math.sqrt(rate * (1 - rate) / count + z2 / (4 * count))
    # The bounds at 0 and 1 are exact; rounding must not move them.
    return (0.0 if passed == 0 else centre - half), (1.0 if passed == count else centre + half)


def bootstrap(values, quantile, seed=1):
    """(low, high) of a quantile of what `values` were drawn from: percentile bootstrap (Efron 1979), fixed seed.

    Both are NaN for fewer than two values. RandomState, because its numbers are the same in all versions of numpy.
    """
    values = np.asarray(values, float)
    if values.size < 2:
        return math.nan, math.nan
    draws = np.random.RandomState(seed).randint(0, values.size, (RESAMPLES, values.size))
    estimates = np.quantile(values[draws], quantile, axis=1)
    low, high = np.quantile(estimates, [0.025, 0.975])
    return float(low), float(high)
