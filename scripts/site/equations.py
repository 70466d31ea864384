#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/quality/credibility.md: where each equation of the paper is computed, and which tests check it. The comments that cite an
equation ("Eq. 12", "Eqs. 10-12") are its source; equations.py --write writes it."""
import os
import re
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
PAGE = "docs/quality/credibility.md"
TABLE = re.compile(r"(?m)^\| Eq\. .*\n(?:\|.*\n)*")
EQUATIONS = {1: "the point that a ray hits", 4: "the estimated pose", 5: "the rotation by which an attitude is wrong",
             6: "errors that are linear in time", 7: "the estimated point of a return", 8: "the elevation of a bin", 9: "the weight of a return in its bin",
             10: "the error of a bin", 11: "the absolute error of a footprint", 12: "the relative error of a footprint",
             13: "the largest quantisation error on a slope"}
# Whose text was not at hand: by their place, the transforms between the frames of Eq. 1. Their row has the files that compute and check these.
UNCITED = ("2, 3", "not cited, since their text was not at hand; by their place, the transforms from the lidar's frame to the body's and to D",
           ("lib/chain/lidar/simulation/pulse_simulator.h",), ("tests/unit/chain/lidar/simulation/pulse_simulator_test.cpp",), ("tests/oracle/scan.py",))
# Columns and their folders. The last one shares no code with lib: a second implementation in numpy, closed forms, data of a real instrument.
COLUMNS = {"computed in": ("lib",), "unit tests": ("tests/unit",), "checked by other means in": ("tests/oracle", "tests/chain")}
# Another publication is named with its year before its equation.
CITATION = re.compile(r"(?<!\d{4}, )\bEqs?\. (\d+)(?!\.?\d)(?:(-| and )(\d+))?")
LINE_OF_COMMENT = re.compile(r"\n\s*(?://+|#)\s*")


def cited(text):
    """The numbers of the paper's equations that a text cites."""
    found = set()
    for first, between, last in CITATION.findall(LINE_OF_COMMENT.sub(" ", text)):
        found |= {int(first)} if not last else set(range(int(first), int(last) + 1)) if between == "-" else {int(first), int(last)}
    return found


def citations():
    """{equation: {column: [paths of files]}}."""
    found = {number: {column: [] for column in COLUMNS} for number in EQUATIONS}
    for column, tops in COLUMNS.items():
        for top in tops:
            for folder, _, names in sorted(os.walk(os.path.join(ROOT, top))):
                for name in sorted(names):
                    if name.endswith((".h", ".cpp", ".py")):
                        path = os.path.join(folder, name)
                        with open(path, encoding="utf-8") as file:
                            for number in cited(file.read()):
                                if number not in found:
                                    raise KeyError(f"{path} cites Eq. {number}: name it in {__file__}")
                                found[number][column].append(os.path.relpath(path, ROOT))
    return found


def table():
    lines = ["| Eq. | gives | " + " | ".join(COLUMNS) + " |", "|---" * (len(COLUMNS) + 2) + "|"]
    rows = [(number, EQUATIONS[number], *columns.values()) for number, columns in citations().items()]
    for number, gives, *columns in [rows[0], UNCITED, *rows[1:]]:
        cells = [", ".join(f"[{os.path.basename(path)}](../../{path})" for path in paths) for paths in columns]
        lines.append(f"| {number} | {gives} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def page():
    """(the page, the page with this table)."""
    with open(os.path.join(ROOT, PAGE), encoding="utf-8") as file:
        text = file.read()
    return text, TABLE.sub(lambda _: table(), text)


if __name__ == "__main__":
    if sys.argv[1:] != ["--write"]:
        sys.exit("usage: equations.py --write")
    written = page()[1]
    with open(os.path.join(ROOT, PAGE), "w", encoding="utf-8") as out:
        out.write(written)
