# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a study's results: metrics against its axes with the requirements, maps for two axes, and pass rates.

Writes into a folder: METRIC.png for each metric (the median of the repeats, or another percentile, with a bootstrap 95 %
interval), METRIC-map.png where two axes are numbers, overview.png (the metrics side by side against an axis of numbers),
requirements.png (pass rates with Wilson 95 % intervals), shares.png (how much of each limit is used), hazards.png (scores and
best sites, of a study with hazard maps), campaigns.png (draws that meet each requirement, of a study with runs of draws), landings.png (safe
landings with the lidar and without, of draws that land), crossing.png (where one metric exceeds a level, against another metric, if the study asks for it), and the numbers behind them, pass_rates.csv,
percentiles.csv and crossings.csv.
"""
import argparse
import os

from landfall import command, dictionary, files
from landfall.errors import UsageError, printable
from landfall.plot import plot_command
from landfall.study import crossing, figures, verdicts
from landfall.study.table import Results

DEFAULT_METRICS = [*(dictionary.requirements()[name].value for name in ("coverage", "hole_size")), "accuracy.relative.z.max_m",
                   "requirements.relative_elevation.value", "accuracy.absolute.horizontal.p95_m"]
HAZARD_METRICS = ["score.missed_hazard_frac", "score.false_alarm_frac"]
DRAWS_METRICS = ["draws.all.passed_frac", "draws.all_and_own.passed_frac"]


def parse(arguments):
    parser = command.Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", metavar="RESULTS.h5")
    parser.add_argument("-o", "--output", metavar="DIR", required=True)
    parser.add_argument("--metrics", metavar="A,B", help="columns of the results; default: the study's, or five of the requirements, those of hazards and of draws")
    parser.add_argument("--x", metavar="AXIS", help="axis to the right; default: the study's, or the first that is a number")
    parser.add_argument("--percentile", type=percentile, default=50, help="of the repeats, 0..100, default 50")
    plot_command.add_output_options(parser)
    return parser.parse_args(arguments)


def percentile(text):
    value = float(text)
    if not 0 <= value <= 100:
        raise argparse.ArgumentTypeError(f"{text} is not in [0, 100]")
    return value


def chosen_metrics(options, results):
    """In the order of --metrics; else those that use most of their limits first."""
    if options.metrics:
        names = options.metrics.split(",")
    else:
        names = results.plot.get("metrics") or [name for name in DEFAULT_METRICS + HAZARD_METRICS + DRAWS_METRICS if name in results.columns]
    for name in names:
        if not results.is_metric(name):
            raise UsageError(f"--metrics: '{name}' is not a metric of {options.results}")
    return names if options.metrics else results.by_use(names)


def chosen_x(options, results):
    """The axis to the right, None where there is none."""
    name = options.x or results.plot.get("x")
    if not name:
        return next((axis for axis in results.axes if axis.numeric), results.axes[0] if results.axes else None)
    for axis in results.axes:
        if axis.name == name:
            return axis
    raise UsageError(f"--x: '{name}' is not one of {', '.join(axis.name for axis in results.axes)}")


def chosen_crossing(options, results):
    """The study's `crossing`; None where it has none."""
    spec = results.plot.get("crossing")
    for name in [*spec["metrics"], spec["against"]] if spec else []:
        if not results.is_metric(name):
            raise UsageError(f"{options.results}: plot.crossing: '{name}' is not a metric")
    return spec


def pass_rate_rows(results):
    rows = []
    for point in results.points:
        for requirement in [*results.requirements(), "all"]:
            passed, count, low, high = results.pass_rate(point, requirement)
            if count:
                rows.append([*point.values, requirement, passed, count, passed / count, low, high])
    return rows


def percentile_rows(results, metrics, quantile):
    rows = []
    for metric in metrics:
        for point in results.points:
            value, low, high = results.estimate(point, metric, quantile)
            rows.append([*point.values, metric, len(results.values(point, metric)), 100 * quantile, value, low, high])
    return rows


def write_csv(path, head, rows):
    known = ([cell if cell == cell else "" for cell in row] for row in rows)  # NaN is not
    command.write_text(path, command.csv_text([head, *known]))
    print(printable(path))


def draw_all(options, results, metrics):
    """{path: figure}."""
    x, quantile, made = chosen_x(options, results), options.percentile / 100, {}
    for metric in metrics:
        path = os.path.join(options.output, metric)
        made[path + ".png"] = figures.metric_figure(results, metric, x, quantile)
        pair = figures.map_axes(results, x)
        if pair:
            made[path + "-map.png"] = figures.map_figure(results, metric, pair, quantile)
    spec = chosen_crossing(options, results)
    wholes = {"overview": figures.overview_figure(results, metrics, x, quantile),
              "crossing": crossing.crossing_figure(results, x, spec) if spec else None,
              "hazards": verdicts.hazards_figure(results, quantile),
              "campaigns": verdicts.draws_figure(results),
              "landings": figures.landings_figure(results, x, quantile),
              "requirements": verdicts.requirements_figure(results),
              "shares": verdicts.shares_figure(results, quantile)}
    return made | {os.path.join(options.output, name + ".png"): figure for name, figure in wholes.items() if figure}


def main(arguments):
    options = parse(arguments)
    with files.open_landfall(options.results, "landfall.results") as file:
        results = Results(file)
    with files.drawing([options.results]):
        write(options, results)


def write(options, results):
    """Writes the figures and tables."""
    metrics = chosen_metrics(options, results)
    spec = chosen_crossing(options, results)
    tables = [os.path.join(options.output, name) for name in ("percentiles.csv", "pass_rates.csv", *["crossings.csv"] * bool(spec))]
    command.check_outputs(tables, options.overwrite, makes_folder=True)
    made = draw_all(options, results, metrics)
    command.check_outputs(made, options.overwrite, makes_folder=True)
    plot_command.save(made, options.dpi)
    axes = [axis.name for axis in results.axes]
    if spec:
        x = chosen_x(options, results)
        write_csv(tables[2], [*(axis.name for axis in results.axes if axis is not x), *crossing.HEAD], crossing.rows(results, x, spec))
    write_csv(tables[0], [*axes, "metric", "count", "percentile", "value", "low_95", "high_95"],
              percentile_rows(results, metrics, options.percentile / 100))
    write_csv(tables[1], [*axes, "requirement", "passed", "count", "rate", "low_95", "high_95"], pass_rate_rows(results))
