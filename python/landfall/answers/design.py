# SPDX-License-Identifier: GPL-3.0-or-later
"""The cheapest lidar whose DEM passes with a given probability (docs/user/studies/design.md)."""
from landfall import command
from landfall.answers import design_report, design_search, model, progress, runs
from landfall.answers.design_problem import Problem
from landfall.errors import Error, printable_lines


def main(arguments):
    parser = command.Parser(prog="design.py", description="The cheapest lidar whose DEM passes with a given probability.")
    runs.add_options(parser, "design file (docs/user/studies/design.md)")
    options = parser.parse_args(arguments)
    model.optuna()
    prefix = runs.prepare(options)
    problem = Problem(options.file)
    answer = design_search.Design(problem, options.out, options.workers, prefix, progress.Progress()).run()
    design_report.write(problem, answer, options.out)
    print(printable_lines(design_report.text_of(problem, answer)))
    if answer["winner"] is None:
        raise Error(f"{problem.path}: no candidate passes with a probability of {problem.probability}")
