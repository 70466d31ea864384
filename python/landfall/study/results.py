# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D323
"""A study's table: a row a case, its axes and all numbers of its metrics, as CSV and as HDF5."""
import json
import os

import h5py
import numpy as np

from landfall import command, dictionary, files, tools
from landfall.errors import DataError, UsageError
from landfall.numbers import unit_of
from landfall.requirements import flatten
from landfall.schema import check, read_json
from landfall.study import session

# Per cent of the roughness limit.
MARGINS = (10, 20)
# The parts of cases.json that are used; sweep.py plan writes it.
AXIS = {"name": {"type": "string", "minLength": 1, "pattern": "^[^/]*$"}, "label": {"type": "string"}, "unit": {"type": "string"},
        "role": {"enum": ["axis", "repeat", "drawn"]}, "dimension": {"type": "integer", "minimum": 0}, "numeric": {"type": "boolean"},
        "log": {"type": "boolean"}}
CASES = {"type": "object", "required": ["title", "axes", "cases", "plot", "limits"], "properties": {
    "title": {"type": "string"}, "description": {"type": "string"}, "name": {"type": "string"}, "plot": {"type": "object"}, "limits": {"type": "object"},
    "axes": {"type": "array", "items": {"type": "object", "required": ["name", "unit"], "properties": AXIS}},
    "cases": {"type": "array", "minItems": 1, "items": {"type": "array", "items": {"type": ["string", "number", "boolean"]}}}}}
# The columns of a rate of a run of draws.
INTERVAL = ("wilson_low", "wilson_high", "exact_lower_bound")


def read_cases(folder):
    """cases.json of a planned study."""
    path = os.path.join(folder, "cases.json")
    if not os.path.exists(path):
        raise UsageError(f"{folder}: no planned study (no cases.json)")
    cases = read_json(path)
    check(cases, CASES, path)
    for number, row in enumerate(cases["cases"]):
        results = results_of(cases, row)
        if not results or len(row) != len(cases["cases"][0]):
            raise UsageError(f"{path}: /cases/{number}: needs a value for each of {len(cases['axes'])} axes, and the files of the results")
        for name in results:
            session.result_name(name, f"{path}: /cases/{number}")
    return cases


def results_of(cases, row):
    """The files of a case's results, by its row of cases.json: metrics, and of a study that has them a score and the verdict of a run of draws."""
    return row[len(cases["axes"]):]


def read_result(folder, name):
    """The numbers of one file of results: those of a score begin with score., those of the best of its sites with site., those of a
    run of draws. The score of a map on which no place could be judged has the text score.remark."""
    if session.kind_of(name) == "verdict":
        return draws_numbers(_read_json(folder, name))
    if session.kind_of(name) != "score":
        return flatten(_read_json(folder, name))
    score, sites = _read_json(folder, name), _read_json(folder, session.sites_of(name))["sites"]
    best = {key: value for key, value in sites[0].items() if key != "rank"} if sites else {}
    remark = {} if sum(score["counts"].values()) > score["counts"]["unknown"] else {"score.remark": "nothing to judge"}
    return {**remark, **flatten({**score, **shares_of(score["counts"]), **margins_of(score["roc"])}, "score."), **flatten(best, "site.")}


def draws_numbers(verdict):
    """{"draws.REQUIREMENT.passed": number, ...}. A sequential test leaves no valid interval; it has draws.accepted, None if it did not end."""
    stopped = "sprt" in verdict
    hazard = {**verdict.get("hazard", {})}
    rates = {rate["requirement"]: rate for rate in [*verdict["rates"], *([hazard.pop("chosen_place_safe")] if hazard else [])]}
    numbers = {}
    for name, rate in rates.items():
        numbers |= rate_numbers(rate, stopped, f"draws.{'hazard.' if name == 'chosen_place_safe' else ''}{name}.")
    numbers |= flatten(hazard, "draws.hazard.")
    numbers |= landing_numbers(verdict["landing"], stopped) if "landing" in verdict else {}
    if stopped:
        numbers["draws.accepted"] = {"accepted": 1, "rejected": 0}.get(verdict["sprt"])
    return numbers


def rate_numbers(rate, stopped, prefix):
    is_judged = rate.get("judged", rate["draws"]) > 0
    kept = {"passed": rate["passed"], "draws": rate["draws"], "passed_frac": rate["passed"] / rate["draws"] if is_judged else None}
    return flatten(kept if stopped else {**kept, **{key: rate[key] if is_judged else None for key in INTERVAL}}, prefix)


def landing_numbers(landing, stopped):
    """{"draws.landing.safe.passed": number, ...}: both arms, the paired table and, unless a sequential test stopped it, what is tested of it."""
    numbers = {name: value for arm in ("safe", "blind") for name, value in rate_numbers(landing[arm], stopped, f"draws.landing.{arm}.").items()}
    pairs = {key: landing[key] for key in ("off_terrain", "both", "only_lidar", "only_blind", "neither")}
    tested = {"difference": {"value": landing["difference"]["value"]}} if stopped else {key: landing[key] for key in ("mcnemar_p", "difference")}
    return numbers | flatten({**pairs, **tested}, "draws.landing.")


def shares_of(counts):
    """Shares of hazards in the map and in the truth, among the places known in both; and of unknown ones among all."""
    known = sum(counts.values()) - counts["unknown"]
    return {"judged_hazard_frac": (counts["hazard_safe"] + counts["hazard_hazard"]) / known if known else None,
            "true_hazard_frac": (counts["safe_hazard"] + counts["hazard_hazard"]) / known if known else None,
            "unknown_frac": counts["unknown"] / (known + counts["unknown"])}


def margins_of(roc):
    """The score of a map that is judged by a lower roughness limit than the true terrain, from the ROC's 21 limits."""
    return {f"margin_{margin}_percent": {key: roc[key][(100 - margin) // 10] for key in ("missed_hazard_frac", "false_alarm_frac")}
            for margin in MARGINS}


def _read_json(folder, name):
    path, expected = os.path.join(folder, name), session.FORMATS[session.kind_of(name)]
    try:
        with open(path, encoding="utf-8") as file:
            tree = json.load(file)
        if tree["format"] != expected:
            raise ValueError(f"\"format\" is not \"{expected}\"")
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise DataError(f"{path}: {getattr(error, 'strerror', None) or error}") from error
    del tree["version"]
    return tree


def rows_of(folder, cases, partial):
    """(number, axis values, metrics) of each case; with `partial`, of those that are done."""
    seen, rows = {}, []
    for number, row in enumerate(cases["cases"]):
        names = results_of(cases, row)
        if partial and not all(session.age_of(folder, name) for name in names):
            continue
        for name in names:
            if name not in seen:
                with files.naming(os.path.join(folder, name)):
                    seen[name] = read_result(folder, name)
        rows.append((number, row[:len(cases["axes"])], with_own_of_score({key: value for name in names for key, value in seen[name].items()})))
    if not rows:
        raise DataError(f"{folder}: no case is done")
    return rows


def with_own_of_score(numbers):
    """A case passes where its score also meets the user's own requirements."""
    return {**numbers, "pass": 0} if numbers.get("score.pass") == 0 and "pass" in numbers else numbers


def unit_of_metric(name):
    parts = name.split(".")
    if parts[0] == "requirements":
        known = dictionary.requirements().get(parts[1])
        return "1" if parts[-1] == "pass" else "" if known is None else known.stored_unit
    return unit_of("_" + parts[-1]) or "1"


class Table:
    """Columns by name, in order; numbers are None where they are not known."""

    def __init__(self, cases, rows):
        self.cases = cases
        self.columns = {"case": [number for number, _, _ in rows]}
        self.units = {"case": "1"}
        for index, axis in enumerate(cases["axes"]):
            self.columns[axis["name"]] = [values[index] for _, values, _ in rows]
            self.units[axis["name"]] = axis["unit"]
        names = dict.fromkeys(name for _, _, metrics in rows for name in metrics)
        for name in names:
            column = [metrics.get(name) for _, _, metrics in rows]
            if name == "pass" or any(value is not None for value in column):
                self.columns[name] = column
                self.units[name] = unit_of_metric(self._measured(name, rows))

    @staticmethod
    def _measured(name, rows):
        """The metric whose unit a column has: that of one of the user's own requirements where all cases agree."""
        own = dictionary.OWN_NUMBER.fullmatch(name)
        metrics = {numbers.get(own[1] + ".metric") for _, _, numbers in rows} - {None} if own else set()
        return metrics.pop() if len(metrics) == 1 else name

    def csv(self):
        return command.csv_text([self.columns, *zip(*([_cell(value) for value in column] for column in self.columns.values()))])


def _cell(value):
    return "" if value is None else repr(float(value)) if isinstance(value, float) else value


def write_h5(table, path, version):
    """One dataset a column with `units` and `long_name`; _columns is their order, _study_json is cases.json less its cases.

    No column begins with _. The file has the seal of the tools' files.
    """
    def write_to(name):
        with h5py.File(name, "w", track_order=False) as file:
            file.attrs["title"] = table.cases["title"]
            file.attrs["source"] = version
            file.attrs["format_name"] = "landfall.results"
            file.attrs["format_version"] = 1
            for column, values in table.columns.items():
                _write_column(file, column, values, table.units[column])
            head = {key: value for key, value in table.cases.items() if key != "cases"}
            file.create_dataset("_study_json", data=json.dumps(head), dtype=h5py.string_dtype())
            file.create_dataset("_columns", data=list(table.columns), dtype=h5py.string_dtype())
            file.attrs["complete"] = 1
        tools.seal_file(name)
    command.write_whole(path, write_to)


def _write_column(file, name, values, unit):
    if all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        data, dtype = values, np.int64
    elif all(value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)) for value in values):
        data, dtype = [np.nan if value is None else value for value in values], np.float64
    else:
        data, dtype = ["" if value is None else value if isinstance(value, str) else json.dumps(value) for value in values], h5py.string_dtype()
    dataset = file.create_dataset(name, data=np.array(data, dtype=dtype) if dtype in (np.int64, np.float64) else data,
                                  dtype=dtype, track_times=False)
    dataset.attrs["units"] = unit
    dataset.attrs["long_name"] = name
