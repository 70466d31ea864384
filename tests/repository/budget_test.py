#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of text beside the chain may not exceed budget.json. A line that is added there takes one away; to raise a number is a commit of its own
that says why."""
import json
import os
import pathlib
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
NOT_OURS = {"node_modules", "__pycache__"}


def is_chain(path):
    return path.relative_to(ROOT).parts[:2] == ("lib", "chain")


def lines(path):
    try:
        return path.read_text(encoding="utf-8").count("\n")
    except UnicodeDecodeError:  # a picture
        return 0


def lines_below(top):
    return sum(lines(path) for path in (ROOT / top).rglob("*") if path.is_file() and not NOT_OURS & set(path.parts) and not is_chain(path))


class Budget(unittest.TestCase):
    def test_no_part_is_over_its_budget(self):
        with open(pathlib.Path(__file__).with_name("budget.json"), encoding="utf-8") as file:
            budget = json.load(file)
        self.assertEqual(set(budget), {"lib", "tests", "docs"})
        over = {top: f"{count - budget[top]} lines over {budget[top]}" for top in budget if (count := lines_below(top)) > budget[top]}
        self.assertEqual(over, {})


if __name__ == "__main__":
    unittest.main()
