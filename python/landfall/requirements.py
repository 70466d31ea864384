# SPDX-License-Identifier: GPL-3.0-or-later
"""The verdicts of an evaluation's numbers, how far they are from their limits, and what they assume. `numbers` are those of metrics.json by their
dotted paths, verdicts as 1 and 0."""
import math

from landfall import dictionary
from landfall.numbers import number, unit_of, with_unit

# Name in metrics.json, text, factor.
ASSUMPTIONS = (("footprint_bins", "footprint of {} bins on an edge", 1), ("truth_spacing_m", "truth nodes every {} m", 1),
               ("median_returns_per_bin", "{} returns per bin (median)", 1), ("single_return_frac", "{} % of the bins with a single return", 100))


def assumption_texts(values_of):
    """The assumptions that are known. values_of(path): the values of a number; the text has the smallest and the largest."""
    made = []
    for name, text, factor in ASSUMPTIONS:
        known = [value for value in values_of(f"assumptions.{name}") if value is not None and not math.isnan(value)]
        if known:
            made.append(text.format(" to ".join(dict.fromkeys(number(factor * value) for value in (min(known), max(known))))))
    return made


def verdicts_of(numbers):
    """{requirement: whether it passes, None where it is not judged}, the user's own ones last."""
    paths = {**{name: f"requirements.{name}" for name in dictionary.requirements()}, **dictionary.own_paths(numbers)}
    return {name: None if numbers[path + ".pass"] is None else numbers[path + ".pass"] == 1 for name, path in paths.items()}


def all_of(verdicts):
    """Whether all pass: None where none fails and some are not judged."""
    return False if False in verdicts.values() else None if None in verdicts.values() else True


def is_decided_by_worst(requirement, limits):
    """Whether the worst value and its limit give the verdict: that of a share of the footprints is the 95th percentile."""
    return not requirement.at_least or limits[requirement.limit] == 0.95


def margins_of(numbers, evaluation):
    """{requirement: {"worst", "limit", "margin_frac"}} of the numbers and the configuration of dem-eval. The worst value is the one that is compared
    with a limit, of the absolute horizontal error the 95th percentile; None where it is not judged. It has no margin where another share than 95 % of
    the footprints is judged."""
    found, verdicts = {}, verdicts_of(numbers)
    for name, requirement in dictionary.requirements().items():
        worst = [numbers[metric] for metric in requirement.worst]
        is_known = None not in worst and verdicts[name] is not None
        found[name] = _margin(max(worst) if is_known else None, evaluation["limits"][requirement.worst_limit])
        if not is_decided_by_worst(requirement, evaluation["limits"]):
            found[name]["margin_frac"] = None
    own = {one["name"]: one for one in evaluation.get("requirements", [])}
    for name, path in dictionary.own_paths(numbers).items():
        found[name] = _margin(numbers[path + ".value"], numbers[path + ".limit"], "min" in own.get(name, {}))
    return found


def _margin(worst, limit, at_least=False):
    """1 - worst/limit; of a number that is to be at least its limit worst/limit - 1. None where the limit is not > 0, unless both are 0."""
    margin = None
    if worst is not None and limit > 0:
        margin = worst / limit - 1 if at_least else 1 - worst / limit
    elif worst == limit == 0:
        margin = 0.0
    return {"worst": worst, "limit": limit, "margin_frac": margin}


def unit_of_requirement(name):
    known = dictionary.requirements().get(name)
    return unit_of(known.worst_limit) if known else ""


def value_text(value, unit):
    return "not judged" if value is None else with_unit(value, unit, 4)


def margin_text(margin):
    return "–" if margin is None else f"{100 * margin:+.1f} %"


def flatten(tree, prefix=""):
    """{"a.b": number} of all numbers and truth values (as 1 and 0) in nested objects; lists and texts are left out, but for the metrics
    of the user's own requirements."""
    flat = {}
    for key, value in tree.items():
        name = prefix + key
        if isinstance(value, dict):
            flat.update(flatten(value, name + "."))
        elif isinstance(value, bool):
            flat[name] = int(value)
        elif value is None or isinstance(value, (int, float)) or dictionary.OWN_METRIC.fullmatch(name):
            flat[name] = value
    return flat
