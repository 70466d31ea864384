# SPDX-License-Identifier: GPL-3.0-or-later
# A study's report shows the numbers of its figures: rates and quantiles with their intervals are read from
# `pass_rates.csv` and `percentiles.csv`, so that page and figures cannot differ. The description of how a case is made
# comes from the rules of `study.mk`, which the run itself used.
"""Writes a study's report: one self-contained HTML file, with the table of its cases, their configurations
and the figures of landfall plot study.

FOLDER is a study's, with results.h5 (make -f Makefile.studies study).
"""
import argparse
import collections
import copy
import csv
import io
import json
import math
import os
import re

from landfall import command, files, requirements, tools
from landfall.errors import DataError, printable, UsageError
from landfall.study import chain, names, page, results, session
from landfall.study.model import STAGES, with_paths
from landfall.study.table import metric_label, Results

# With more cases the page shows the first ones, and their number.
MAX_CASES = 20_000
DIGITS = 7
VERDICTS = {1: "pass", 0: "fail", None: "not judged"}


class Study:
    """A planned study with its table, as read from its folder.

    Throws DataError where the table or the figures' numbers are of another plan, landfall's other errors where a file is
    missing or broken.
    """

    def __init__(self, folder):
        self.folder = folder
        self.cases = results.read_cases(folder)
        self.rows = self.cases["cases"]
        self.axes = self.cases["axes"]
        self.chains = chain.Chains(folder)
        self.logs = chain.Logs(folder, self.chains)
        path = os.path.join(folder, "results.h5")
        with files.open_landfall(path, "landfall.results") as file:
            self.results = Results(file)
        self.row_of = {int(case): row for row, case in enumerate(self.results.columns["case"])}
        self._check_table(path)
        self.tools = command.read_text(os.path.join(folder, "tools.txt")).splitlines()
        missing = set(session.missing_targets(folder))
        self.stale = sum(not missing.isdisjoint(self.files_of(case)) for case in self.row_of)  # cases of the table made by earlier tools

    def _check_table(self, path):
        for case, row in self.row_of.items():
            for index, axis in enumerate(self.axes):
                column = self.results.columns.get(axis["name"])
                if case >= len(self.rows) or column is None or not _same(column[row], self.rows[case][index]):
                    raise DataError(f"{path}: case {case}: {axis['name']} differs from cases.json: the study was planned again "
                                    "later; make study-results updates the table")

    def files_of(self, case):
        return results.results_of(self.cases, self.rows[case])

    def value(self, case, column):
        """A case's value in a column of the table; None where the case or the value is not known."""
        row = self.row_of.get(case)
        value = self.results.columns[column][row] if row is not None and column in self.results.columns else None
        return None if isinstance(value, float) and math.isnan(value) else value

    def verdict(self, case, runs):
        if case in self.row_of:
            return VERDICTS[self.value(case, "pass")]
        return "error" if self.logs.failure(runs) else "not made"


def report(folder, figures):
    """The tree: name, title, tools, axes, columns, points, configs, runs and failures (lib/app/report/web/study_*.js read it)."""
    study = Study(folder)
    numbers = FigureNumbers(study, figures)
    shown = range(min(len(study.rows), MAX_CASES))
    chains = {case: study.chains.of(study.files_of(case)) for case in range(len(study.rows))}
    verdicts = {case: study.verdict(case, runs) for case, runs in chains.items()}
    config_table, run_table = ConfigTable(study.folder), RunTable(study)
    case_configs = [config_table.of_case(chains[case]) for case in shown]
    case_runs = [run_table.of_case(chains[case]) for case in shown]
    run_table.add_file_ids()
    seconds = [run_table.seconds(runs) for runs in case_runs]
    return {
        "name": study.cases["name"], "title": study.cases["title"], "description": study.cases.get("description", ""),
        "tools": study.tools, "axes": axes(study), "limits": study.cases["limits"], "count": len(study.rows), "stale": study.stale,
        "assumptions": requirements.assumption_texts(lambda path: study.results.columns.get(path, [])), "verdicts": dict(collections.Counter(verdicts.values())), "columns": columns(study, shown, verdicts, seconds, numbers.metrics),
        "points": points(study, numbers), "quantile": numbers.quantile, "metrics": numbers.metrics,
        "requirements": study.results.requirements(),
        "metricLimits": {name: limit for name in study.results.columns if (limit := study.results.limit(name)) is not None},
        "configs": config_table.tree(), "caseConfigs": case_configs, "runs": run_table.rows, "caseRuns": case_runs,
        "options": list(dict.fromkeys(option for run in chains[0] for option in run.options)),
        "failures": failures(study, chains, verdicts), "caseNames": case_names(study, verdicts), "reports": reports(study, shown)}


def axes(study):
    """Name, label, unit, role and values in order of each axis, of a repeat and of its drawn values; enough digits to distinguish the values."""
    made = []
    for index, axis in enumerate(study.axes):
        values = list({json.dumps(row[index]): row[index] for row in study.rows}.values())
        made.append({**{key: axis[key] for key in ("name", "label", "unit", "role", "numeric")}, "digits": names.digits_of(values),
                     "values": values})
    return made


def case_names(study, verdicts):
    """{case: name by the values of its axes} of the cases that were not made."""
    by_values = names.CaseNames(study.axes, study.rows)
    return {str(case): by_values.of(case) for case, verdict in verdicts.items() if verdict in ("error", "not made")}


# Columns of cases


def columns(study, shown, verdicts, seconds, metrics):
    """The columns of the cases' table: the case, its verdict, then all of results.csv; `first` are shown by default."""
    made = [_column("case", "case", "", "case", list(shown), True),
            _column("verdict", "verdict", "", "verdict", [verdicts[case] for case in shown], True)]
    for index, axis in enumerate(axes(study)):
        values = [study.rows[case][index] for case in shown]
        column = _column(axis["name"], axis["label"], axis["unit"], axis["role"], values, axis["role"] != "drawn")
        made.append({**column, "digits": axis["digits"]})
    made.append(_column("missed", "requirements missed", "", "text", [missed(study, case) for case in shown], True))
    known = {column["name"] for column in made}
    others = [name for name in study.results.columns if name not in known and name not in ("pass", "score.pass") and name not in metrics
              and not name.endswith((".metric", ".at_least"))]
    paths = tuple(study.results.path_of(name) + "." for name in study.results.requirements())
    requirements = [name for name in others if name.startswith(paths)]
    for name in [*metrics, *study.results.by_use(name for name in others if name not in requirements), *requirements]:
        values = [_rounded(study.value(case, name)) for case in shown]
        role = "pass" if name.endswith(".pass") else "metric"
        unit = study.results.units[name]
        made.append(_column(name, metric_label(name, unit), unit, role, values, name in metrics))
    made.append(_column("time_s", "time of its tools", "s", "time", seconds, True))
    return made


def _column(name, label, unit, role, values, first):
    """A column whose values are all the same holds one of them."""
    column = {"name": name, "label": label, "unit": "" if unit == "1" else unit, "role": role, "first": first}
    alike = len({json.dumps(value) for value in values}) == 1
    return {**column, "all": values[0]} if alike else {**column, "values": values}


def missed(study, case):
    """Names of the requirements that a case fails; None where it is not known."""
    if case not in study.row_of:
        return None
    names = [name.replace("_", " ") for name in study.results.requirements() if study.value(case, study.results.path_of(name) + ".pass") == 0]
    return ", ".join(names)


# Points


class FigureNumbers:
    """percentiles.csv and pass_rates.csv of landfall plot study, by point."""

    def __init__(self, study, folder):
        def key(row):
            return tuple(row.get(axis.name) for axis in study.results.axes)
        percentiles = _read_csv(folder, "percentiles.csv")
        self.metrics = list(dict.fromkeys(row["metric"] for row in percentiles))
        self.quantile = float(percentiles[0]["percentile"]) / 100 if percentiles else 0.5
        self.estimates = {(key(row), row["metric"]): [_number(row[name]) for name in ("value", "low_95", "high_95")]
                          for row in percentiles}
        self.rates = {(key(row), row["requirement"]):
                      [int(row["passed"]), int(row["count"]), float(row["low_95"]), float(row["high_95"])]
                      for row in _read_csv(folder, "pass_rates.csv")}
        keys = {tuple(map(str, point.values)) for point in study.results.points}
        if keys != {key for key, _ in self.estimates} or not set(self.metrics) <= study.results.columns.keys():
            raise DataError(f"{folder}: percentiles.csv is not of {study.folder}/results.h5; run landfall plot study again")


def _number(text):
    return _rounded(float(text)) if text else None


def points(study, numbers):
    """A row for each point of the axes: values, its cases, of them done, [passed, judged, low, high] of `all` and of each
    requirement, [value, low, high] of each metric."""
    places = [index for index, axis in enumerate(study.axes) if axis["role"] == "axis"]
    cases = {}
    for case, row in enumerate(study.rows):
        cases.setdefault(json.dumps([row[index] for index in places]), []).append(case)
    done = {int(study.results.columns["case"][row]): point for point in study.results.points for row in point.rows}
    made = []
    for key, numbers_of in cases.items():
        point = next((done[case] for case in numbers_of if case in done), None)
        name = tuple(map(str, point.values)) if point else None
        made.append({"values": json.loads(key), "cases": numbers_of, "done": sum(case in done for case in numbers_of),
                     "rates": [numbers.rates.get((name, requirement)) for requirement in ["all", *study.results.requirements()]],
                     "estimates": [numbers.estimates.get((name, metric)) for metric in numbers.metrics]})
    return made


# Configurations: the first one of each stage and the differences of the others, so that 5,000 of them take 0.4 MB. Numbers have 7 digits.


VARIES = "(varies)"


def without_folders(value):
    """The value with every "path" cut to the file's name, as in the configuration that landfall's files store."""
    return with_paths(value, lambda path: re.sub(r'[^":]*/', "", path))


def changes(base, tree, place=()):
    """[[place, value], ...] that make `tree` of `base`, a place being a list of keys and indices; [place] removes a key."""
    if isinstance(base, dict) and isinstance(tree, dict):
        found = [[[*place, key]] for key in base if key not in tree]
        for key, value in tree.items():
            found += changes(base[key], value, (*place, key)) if key in base else [[[*place, key], value]]
        return found
    if isinstance(base, list) and isinstance(tree, list) and len(base) == len(tree):
        return [change for index, (before, after) in enumerate(zip(base, tree))
                for change in changes(before, after, (*place, index))]
    return [] if base == tree and type(base) is type(tree) else [[list(place), tree]]


def shared(base, all_steps):
    """The base with VARIES wherever any of the others differs from it."""
    tree = {"": copy.deepcopy(base)}
    for place in {tuple(place): None for steps in all_steps for place, *_ in steps}:
        _mark(tree, ("", *place))
    return tree[""]


def _mark(tree, place):
    node = tree
    for key in place[:-1]:
        if node[key] == VARIES:
            return
        node = node[key]
    node[place[-1]] = VARIES


class ConfigTable:
    """Each stage's configurations: the first one, and what each other one changes."""

    def __init__(self, folder):
        self._folder, self._index, self._base = folder, {}, {}
        self._changes = {}

    def of_case(self, chain):
        """The index of each stage's configuration."""
        at = {run.kind: run.config for run in chain}
        return [self._add(kind, at[kind]) for kind in STAGES if kind in at]

    def _add(self, kind, name):
        if name not in self._index:
            tree = without_folders(results.read_json(os.path.join(self._folder, name)))
            base = self._base.setdefault(kind, tree)
            steps = self._changes.setdefault(kind, [])
            self._index[name] = len(steps)
            steps.append(changes(base, tree))
        return self._index[name]

    def tree(self):
        return {kind: {"base": self._base[kind], "changes": steps, "shared": shared(self._base[kind], steps)}
                for kind, steps in self._changes.items()}


# Runs, failures


class RunTable:
    """Each run of a tool once: [kind, output, seconds, CPU seconds, largest memory in bytes, file_id]; what is not known is null."""

    def __init__(self, study):
        self._study, self._index, self.rows = study, {}, []

    def of_case(self, chain):
        return [self._add(run) for run in chain]

    def _add(self, run):
        if run.output not in self._index:
            self._index[run.output] = len(self.rows)
            summary = self._study.logs.summary(run) or {}
            output = run.output if os.path.exists(os.path.join(self._study.folder, run.output)) else None
            self.rows.append([run.kind, output, *(_rounded(summary.get(key), 4) for key in ("wall_s", "cpu_s")),
                              summary.get("peak_memory_bytes"), None])
        return self._index[run.output]

    def add_file_ids(self):
        """Reads the file_id of each output that the tools would open."""
        paths = {os.path.join(self._study.folder, row[1]): row for row in self.rows if row[1] and row[1].endswith(".h5")}
        for path in tools.sound_files(list(paths)):
            paths[path][-1] = files.file_id(path)

    def seconds(self, runs):
        times = [self.rows[run][2] for run in runs]
        return _rounded(math.fsum(times), 4) if None not in times else None


def failures(study, chains, verdicts):
    """[log, how it ended, last lines, cases] of each recipe that failed, and of cases that were not made and did not fail."""
    found, not_made = {}, []
    for case, verdict in verdicts.items():
        if verdict == "error":
            log, end, tail = study.logs.failure(chains[case])
            found.setdefault(log, [log, end, tail, []])[3].append(case)
        elif verdict == "not made":
            not_made.append(case)
    return {"logs": list(found.values()), "notMade": not_made}


def reports(study, shown):
    """{case: name} of dem-eval's reports that lie next to the layers."""
    found = {}
    for case in shown:
        name = "eval/" + os.path.basename(study.files_of(case)[0])[:-5] + ".html"
        if os.path.exists(os.path.join(study.folder, name)):
            found[str(case)] = name
    return found


# Files and numbers


def _read_csv(folder, name):
    return list(csv.DictReader(io.StringIO(command.read_text(os.path.join(folder, name), "; landfall plot study makes it"), newline="")))


def _same(stored, planned):
    if isinstance(planned, (int, float)) and not isinstance(planned, bool):
        return stored == planned
    return stored == (planned if isinstance(planned, str) else json.dumps(planned))


def _rounded(value, digits=DIGITS):
    """To so many digits, which halves the page; whole numbers as they are."""
    if not isinstance(value, float):
        return value
    if not math.isfinite(value):
        return None
    return int(value) if value.is_integer() and abs(value) < 2 ** 53 else float(f"{value:.{digits}g}")


def parse(arguments):
    parser = command.Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER")
    parser.add_argument("-o", "--output", metavar="FILE.html", help="default: FOLDER/report.html")
    parser.add_argument("--figures", metavar="DIR", help="where landfall plot study wrote; default: FOLDER/figures")
    parser.add_argument("-O", "--overwrite", action="store_true", help="replace an existing report")
    return parser.parse_args(arguments)


def main(arguments):
    options = parse(arguments)
    output = options.output or os.path.join(options.folder, "report.html")
    if not output.endswith(".html"):
        raise UsageError(f"--output {output}: the name must end in .html")
    command.check_outputs([output], options.overwrite)
    figures = options.figures or os.path.join(options.folder, "figures")
    try:
        tree = report(options.folder, figures)
    except UsageError as error:
        raise DataError(error) from error
    page.write_page(page.page(tree, figures), output)
    print(f"{printable(output)}: {tree['count']} cases")
