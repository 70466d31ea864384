#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a study's report: one HTML file that needs nothing beside it, with the table of its cases, their configurations
and the figures of plot_study.py.

FOLDER is a study's, with results.h5 (make -f Makefile.studies study).
"""
import argparse
import os
import sys

sys.dont_write_bytecode = True
import landfall_plots as lp
import landfall_results
import landfall_study_page
import landfall_study_report
from landfall_schema import ConfigError

HERE = os.path.dirname(os.path.abspath(__file__))
# The look that all reports share: in the repository, or where it is installed.
ASSET_FOLDERS = [os.path.join(HERE, "..", "lib", "report", "assets"), os.path.join(HERE, "..", "report"), "/usr/share/landfall/report"]


def parse(arguments):
    parser = lp.Parser(prog="report_study.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER")
    parser.add_argument("-o", "--output", metavar="FILE.html", help="default: FOLDER/report.html")
    parser.add_argument("--figures", metavar="DIR", help="where plot_study.py wrote; default: FOLDER/figures")
    parser.add_argument("-O", "--overwrite", action="store_true", help="replace an existing report")
    return parser.parse_args(arguments)


def asset(name):
    for folder in ASSET_FOLDERS:
        path = os.path.join(folder, name)
        if os.path.isfile(path):
            return read_text(path)
    raise lp.DataError(f"{name} is in none of {', '.join(map(os.path.normpath, ASSET_FOLDERS))}")


def read_text(path):
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except OSError as error:
        raise lp.DataError(f"{path}: {error.strerror}") from error


def write_page(text, path):
    def write_to(name):
        with open(name, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
    try:
        landfall_results.write(path, write_to)
    except OSError as error:
        raise lp.DataError(f"cannot write {path}: {error.strerror}") from error


def main(arguments):
    options = parse(arguments)
    output = options.output or os.path.join(options.folder, "report.html")
    if not output.endswith(".html"):
        raise lp.UsageError(f"--output {output}: the name must end in .html")
    lp.check_outputs([output], options.overwrite)
    figures = options.figures or os.path.join(options.folder, "figures")
    try:
        tree = landfall_study_report.report(options.folder, figures)
    except ConfigError as error:
        raise lp.DataError(error) from error
    styles = [asset("report.css"), read_text(os.path.join(HERE, "report_study.css"))]
    scripts = [asset("table.js"), read_text(os.path.join(HERE, "report_study.js"))]
    write_page(landfall_study_page.page(tree, figures, styles, scripts), output)
    print(f"{output}: {tree['count']} cases")


if __name__ == "__main__":
    lp.run(main)
