# SPDX-License-Identifier: GPL-3.0-or-later
# A study's report shows the numbers of its figures: rates and quantiles with their intervals are read from
# `pass_rates.csv` and `percentiles.csv`, so that page and figures cannot differ. The description of how a case is made
# comes from the rules of `study.mk`, which the run itself used.
"""Writes a study's report: one HTML file that needs nothing beside it, with the table of its cases, their configurations
and the figures of plot_study.py.

FOLDER is a study's, with results.h5 (make -f Makefile.studies study).
"""
import argparse
import os

from landfall import command
from landfall.errors import DataError, UsageError, printable
from landfall.study import page, report


def parse(arguments):
    parser = command.Parser(prog="report_study.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER")
    parser.add_argument("-o", "--output", metavar="FILE.html", help="default: FOLDER/report.html")
    parser.add_argument("--figures", metavar="DIR", help="where plot_study.py wrote; default: FOLDER/figures")
    parser.add_argument("-O", "--overwrite", action="store_true", help="replace an existing report")
    return parser.parse_args(arguments)


def write_page(text, path):
    try:
        command.write_text(path, text)
    except OSError as error:
        raise DataError(f"cannot write {path}: {error.strerror}") from error


def main(arguments):
    options = parse(arguments)
    output = options.output or os.path.join(options.folder, "report.html")
    if not output.endswith(".html"):
        raise UsageError(f"--output {output}: the name must end in .html")
    command.check_outputs([output], options.overwrite)
    figures = options.figures or os.path.join(options.folder, "figures")
    try:
        tree = report.report(options.folder, figures)
    except UsageError as error:
        raise DataError(error) from error
    write_page(page.page(tree, figures), output)
    print(f"{printable(output)}: {tree['count']} cases")
