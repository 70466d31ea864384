# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D358, D359
"""Sobol indices of groups of errors: which cause makes the numbers of a DEM vary (docs/user/studies/sensitivity.md).

OpenTURNS makes the sample and estimates indices and intervals; landfall.model computes the draws.
"""
import os

import numpy as np

from landfall import command, schema
from landfall.answers import answer_page, cost, model, runs
from landfall.errors import DataError, UsageError, printable_lines

RANDOM = "random numbers"  # the group of the draw: which noise, dropouts and dead pixels are drawn
KINDS = {"first": "first order", "total": "total"}
PARTS = ("value", "low", "high")
ESTIMATORS = {"martinez": "MartinezSensitivityAlgorithm", "saltelli": "SaltelliSensitivityAlgorithm", "jansen": "JansenSensitivityAlgorithm",
              "mauntz-kucherenko": "MauntzKucherenkoSensitivityAlgorithm"}
MIN_POINTS = 16
ROUNDING = 1e-9  # of an index
# Kind of distribution: its keys, and those that it needs.
DISTRIBUTIONS = {"normal": (("mean", "sigma"), ("sigma",)), "uniform": (("low", "high"), ("low", "high"))}


class Problem:
    """A sensitivity file (schemas/sensitivity.schema.json)."""

    def __init__(self, path):
        self.path, self.tree = path, schema.read_checked(path, "sensitivity")
        self.base = runs.read_base(self.tree["base"], os.path.dirname(os.path.abspath(path)), path)
        self.base["scan"]["seed"] = self.tree.get("seed", 1)
        self.title, self.traced = self.tree.get("title", os.path.basename(path).removesuffix(".json")), self.tree.get("traced_draws")
        self.outputs, self.size, self.seed = self.tree["outputs"], self.tree.get("size", 128), self.tree.get("seed", 1)
        self.groups = [*self.tree["groups"], RANDOM]
        self.keys = [(group, key) for group, keys in self.tree["groups"].items() for key in keys]
        names = [key for _, key in self.keys]
        for group, key in self.keys:
            if names.count(key) > 1 or key in (model.SEED, model.DRAW):
                raise UsageError(f"{path}: /groups/{group}/{key}: " + ("is the key of the group \"random numbers\", which is always there"
                                                                       if names.count(key) == 1 else "is given twice"))
        self.marginals = [self._distribution(group, key) for group, key in self.keys]

    def _distribution(self, group, key):
        module, given, where = model.openturns(), self.tree["groups"][group][key], f"{self.path}: /groups/{group}/{key}"
        if group == RANDOM:
            raise UsageError(f"{self.path}: /groups/{group}: this group is always there; give yours another name")
        allowed, needed = DISTRIBUTIONS[given["type"]]
        for name in given:
            if name not in ("type", *allowed):
                raise UsageError(f"{where}/{name}: is not a key of the type {given['type']}, which has {', '.join(allowed)}")
        for name in needed:
            if name not in given:
                raise UsageError(f"{where}: needs the key \"{name}\", because its type is {given['type']}")
        if given["type"] == "normal":
            if not given["sigma"] > 0:
                raise UsageError(f"{where}/sigma: {given['sigma']} is not > 0")
            return module.Normal(float(given.get("mean", 0)), float(given["sigma"]))
        if not given["low"] < given["high"]:
            raise UsageError(f"{where}/low: {given['low']} is not < high, {given['high']}")
        return module.Uniform(float(given["low"]), float(given["high"]))

    def draw_count(self):
        return self.size * (len(self.groups) + 2)

    def design(self):
        """The sample: points A, points B, and for each group the points A with the group's columns from B; a row per draw, a column
        per key and the number of the draw last. A has the draws 0, 1, ..., B the next ones."""
        module = model.openturns()
        module.RandomGenerator.SetSeed(self.seed)
        # Two samples of their own, not the halves of one sequence of low discrepancy in twice the dimension: with a hundred points
        # and tens of keys such halves correlate, which falsifies every first-order index by the same number.
        experiment = module.LHSExperiment(module.ComposedDistribution(self.marginals), self.size, True)
        points = [np.array(experiment.generate()) for _ in range(2)]
        draws = np.arange(2 * self.size).reshape(2, self.size, 1)
        first, second = (np.hstack([part, draw]) for part, draw in zip(points, draws))
        columns = np.array([group for group, _ in self.keys] + [RANDOM])
        return np.vstack([first, second, *(np.where(columns == group, second, first) for group in self.groups)])


def indices(values, group_count, estimator="martinez"):
    """The indices of one output, whose values are in the order of Problem.design(): for each group its first-order and total index, with 95 % intervals."""
    module, size = model.openturns(), len(values) // (group_count + 2)
    # The algorithm computes from the outputs alone; from the inputs it takes the number of groups.
    inputs = module.Sample(np.zeros((len(values), group_count)).tolist())
    outputs = module.Sample((values - np.mean(values))[:, None].tolist())
    algorithm = getattr(module, ESTIMATORS[estimator])(inputs, outputs, size)
    algorithm.setUseAsymptoticDistribution(True)
    algorithm.setConfidenceLevel(0.95)
    found = {"first": (algorithm.getFirstOrderIndices(), algorithm.getFirstOrderIndicesInterval()),
             "total": (algorithm.getTotalOrderIndices(), algorithm.getTotalOrderIndicesInterval())}
    return [{kind: dict(zip(PARTS, (value[i], interval.getLowerBound()[i], interval.getUpperBound()[i]))) for kind, (value, interval) in found.items()}
            for i in range(group_count)]


def analyse(problem, of):
    """{"outputs": {name: {"mean", "std", "groups": [{"group", "first", "total"}] or None if it does not vary}}, ...}."""
    table = of(problem.design())
    kept = np.isfinite(table).all(axis=1).reshape(-1, problem.size).all(axis=0)  # points that have all numbers in all of their draws
    if np.count_nonzero(kept) < MIN_POINTS:
        empty = [name for name, column in zip(problem.outputs, table.T) if not np.isfinite(column).any()]
        why = of.failures[min(of.failures)] if of.failures else f"{empty[0]} has no value in any draw" if empty else "a metric has no value"
        raise DataError(f"{problem.path}: only {np.count_nonzero(kept)} of {problem.size} points have all their numbers, {MIN_POINTS} are needed; {why}")
    table = table[np.tile(kept, len(problem.groups) + 2)]
    answer = {"format": "landfall.sensitivity", "version": 1, "title": problem.title, "draws": problem.draw_count(), "points": int(np.count_nonzero(kept)),
              "points_left_out": int(np.count_nonzero(~kept)), "confidence": 0.95, "estimator": problem.tree.get("estimator", "martinez"),
              "failures": sorted(set(of.failures.values())), "outputs": {}}
    for name, column in zip(problem.outputs, table.T):
        independent = column[:2 * answer["points"]]  # A and B
        groups = None
        if np.ptp(column) > 0:
            groups = [{"group": group, **found} for group, found in
                      zip(problem.groups, indices(column, len(problem.groups), answer["estimator"]))]
        answer["outputs"][name] = {"mean": float(np.mean(independent)), "std": float(np.std(independent, ddof=1)), "groups": groups}
    return answer


def text_of(problem, answer):
    """The answer as a person reads it."""
    lines = [f"{answer['draws']:,} draws, {len(problem.groups)} groups; index (95 % interval)"]
    if answer["points_left_out"]:
        lines.append(f"{answer['points_left_out']} of {problem.size} points left out, because a draw failed or a metric has no value: "
                     + "; ".join(answer["failures"] or ["no value"]))
    for name, output in answer["outputs"].items():
        lines += ["", f"{problem.outputs[name]}: mean {output['mean']:.4g}, standard deviation {output['std']:.3g}"]
        if output["groups"] is None:
            lines.append("  the same in all draws")
            continue
        lines.append(f"  {'group':18}" + "".join(f"{label:>24}" for label in KINDS.values()))
        lines += [f"  {row['group']:18}" + "".join(f"{interval_text(row[kind]):>24}" for kind in KINDS) for row in output["groups"]]
    return "\n".join(lines)


def interval_text(index):
    return f"{index['value']:.2f} ({index['low']:.2f} to {index['high']:.2f})"


def write_csv(path, answer):
    rows = [["output", "group", *(f"{kind}_{part}" for kind in KINDS for part in PARTS)]]
    for output, found in answer["outputs"].items():
        rows += [[output, row["group"], *(row[kind][part] for kind in KINDS for part in PARTS)] for row in found["groups"] or []]
    command.write_text(path, command.csv_text(rows))


def figure_of(problem, answer):
    """A panel per output: bars of both indices with their intervals, hollow where these reach 0. Outputs that do not vary are named."""
    command.import_matplotlib()
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    from landfall.plot import maps

    shown = {name: output["groups"] for name, output in answer["outputs"].items() if output["groups"]}
    figure = Figure(figsize=(9, 1.2 + 2.3 * max(len(shown), 1)), constrained_layout=True)
    panels = figure.subplots(max(len(shown), 1), 1, squeeze=False, sharex=True, sharey=True)[:, 0]
    places = np.arange(len(problem.groups))
    for axes, (name, rows) in zip(panels, shown.items()):
        for shift, kind, color in ((-0.19, "first", maps.BLUE), (0.19, "total", maps.VERMILION)):
            value, low, high = (np.array([row[kind][part] for row in rows]) for part in PARTS)
            error = np.maximum([value - low, high - value], 0)
            colors = ["none" if bound < ROUNDING else color for bound in low]
            axes.bar(places + shift, value, 0.36, color=colors, edgecolor=color, yerr=error, capsize=2, error_kw={"linewidth": 0.8})
        axes.set_title(problem.outputs[name], fontsize=10, loc="left")
        axes.set_ylabel("share of\nvariance")
        axes.axhline(0, color="black", linewidth=0.6)
        axes.grid(axis="y", alpha=0.3)
        axes.set_axisbelow(True)
    bounds = [row[kind][part] for rows in shown.values() for row in rows for kind in ("first", "total") for part in PARTS]
    panels[-1].set_ylim(min([-0.05, *bounds]) - 0.05, max([1, *bounds]) + 0.05)
    panels[-1].set_xticks(places, problem.groups, rotation=25, ha="right", rotation_mode="anchor")
    if shown:
        panels[0].legend(handles=[Patch(color=maps.BLUE, label="first order: the group alone"),
                                  Patch(color=maps.VERMILION, label="total: with its interactions"),
                                  Patch(facecolor="none", edgecolor="black", label="hollow: the interval reaches 0, no effect is shown")], fontsize=8)
    constant = ", ".join(problem.outputs[name] for name, output in answer["outputs"].items() if not output["groups"])
    figure.suptitle(f"{problem.title}\nSobol indices with 95 % intervals, {answer['draws']:,} draws"
                    + (f"\nthe same in all draws: {constant}" if constant else ""), fontsize=11)
    return figure


def main(arguments):
    parser = command.Parser(description="Sobol indices of groups of errors.")
    runs.add_options(parser, "sensitivity file (docs/user/studies/sensitivity.md)")
    options = parser.parse_args(arguments)
    model.openturns()
    prefix = runs.prepare(options)
    problem = Problem(options.file)
    of = model.Model(problem.base, [key for _, key in problem.keys] + [model.DRAW], problem.outputs, options.out, options.workers, prefix,
                     runs.Progress(), problem.traced)
    runs.say_cost(cost.text_of_rows(of, problem.design()))
    answer = analyse(problem, of)
    runs.write_json(os.path.join(options.out, "sensitivity.json"), answer)
    write_csv(os.path.join(options.out, "sensitivity.csv"), answer)
    answer_page.write(problem, options.out, "sensitivity", figure_of(problem, answer),
                      lambda *parts: answer_page.sensitivity_sections(problem, answer, *parts))
    print(printable_lines(text_of(problem, answer)))
