#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/reference/places.md is that of schemas/dictionary/meetings.json, from which the tools take it; --write renews it."""
import json
import os
import re
import sys
import unittest

ROOT = os.environ.get("LANDFALL_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
PAGE = os.path.join(ROOT, "docs/reference/places.md")
MARK = "## Who meets whom\n"
MOVES = {"metres": "moved", "bins": "moved by whole bins", "centre": "taken around the first one's centre", "map": "read at its own coordinates"}


def table():
    with open(os.path.join(ROOT, "schemas/dictionary/meetings.json"), encoding="utf-8") as file:
        meetings = json.load(file)["meetings"]
    lines = ["| tool | first | second | another centre on one map | another map |", "|---|---|---|---|---|"]
    for meeting in meetings:
        other = "reprojected" if meeting["reprojects"] else "not compared" if meeting["name"] == "compared" else "refused"
        lines.append(f"| {meeting['tools']} | {meeting['first']} | {meeting['second']} | {MOVES[meeting['moves']]} | {other} |")
    return "\n".join(lines) + "\n"


def page():
    with open(PAGE, encoding="utf-8") as file:
        return file.read()


class Places(unittest.TestCase):
    def test_the_table_is_that_of_the_tools(self):
        shown = page().partition(MARK)[2].lstrip("\n").partition("\n\n")[0] + "\n"
        self.assertEqual(shown, table(), "run tests/docs/places_test.py --write")


if __name__ == "__main__":
    if "--write" in sys.argv:
        before, mark, after = page().partition(MARK)
        rest = re.sub(r"\A\n*(\|[^\n]*\n)*\n*", "", after)
        with open(PAGE, "w", encoding="utf-8") as output:
            output.write(before + mark + "\n" + table() + "\n" + rest)
    else:
        unittest.main()
