#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages that scripts/site/keys.py makes of the schemas name every key, with what the schema and the manual say of it."""
import json
import os
import re
import subprocess
import sys
import unittest

ROOT = os.path.abspath(os.environ.get("LANDFALL_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")))
sys.path.insert(0, os.path.join(ROOT, "scripts", "site"))
# pylint: disable=wrong-import-position
import keys

# The commands whose manual, written in C++ from the same schemas, lists the same keys.
TOOLS = {**{page: [page] for page in ("terrain-gen", "scan-sim", "regrid", "dem-eval", "hazard-map", "monte-carlo")}, "landfall-run": ["landfall", "run"]}

TEXTS = keys.texts()


def read(name):
    with open(os.path.join(ROOT, name), encoding="utf-8") as file:
        return file.read()


def page_of(name):
    return TEXTS[f"{keys.FOLDER}/{name}.md"]


def properties(node):
    """(name, description) of every key that a schema defines, wherever it stands; None without a description of its own."""
    if isinstance(node, list):
        for inner in node:
            yield from properties(inner)
    if isinstance(node, dict):
        for word, inner in node.items():
            if word == "properties":
                yield from ((name, value.get("description")) for name, value in inner.items())
            yield from properties(inner)


def required(node):
    """The names of the required keys that a schema defines, wherever they stand."""
    for inner in node if isinstance(node, list) else node.values() if isinstance(node, dict) else ():
        yield from required(inner)
    if isinstance(node, dict) and isinstance(node.get("required"), list):
        yield from (name for name in node["required"] if name in node.get("properties", {}))


def headings(page):
    return re.findall(r"(?m)^##+ `(.*)`$", page_of(page))


def manual(command):
    """{key: its type, unit, bounds and default} of a manual's section CONFIGURATION."""
    result = subprocess.run([os.path.join(os.environ["LANDFALL_BIN"], command[0]), *command[1:], "--print-man"], capture_output=True, text=True, check=True)
    section = re.search(r"\n\.SH CONFIGURATION\n(.*?)\n\.SH ", result.stdout, re.DOTALL)[1]
    plain = section.replace("\\-", "-").replace("\\(dq", '"').replace("\\(aq", "'")
    return re.findall(r"(?m)^\\fB([^\\]+)\\fR \((.*)\)$", plain)


class Keys(unittest.TestCase):
    maxDiff = None

    def test_every_schema_has_a_page(self):
        there = {name.removesuffix(".schema.json") for name in os.listdir(os.path.join(ROOT, "schemas")) if name.endswith(".schema.json")}
        self.assertEqual(there, set(keys.PAGES))

    def test_every_key_of_every_schema_is_there(self):
        for kind, page in keys.PAGES.items():
            names = {path.split(".")[-1] for path in headings(page)}
            text, found = page_of(page), list(properties(json.loads(read(f"schemas/{kind}.schema.json"))))
            self.assertGreater(len(found), 5)
            self.assertEqual([name for name, _ in found if name not in names], [], page)
            self.assertEqual([name for name, description in found if description and description.rstrip(".") not in text], [], page)

    def test_required_keys_are_marked(self):
        self.assertIn("*number, m, above 0 and at most 1e9, required*", page_of("terrain-gen").split("### `patterns.N.feature.diameter_m`")[1])
        for kind in keys.PAGES:
            schema = json.loads(read(f"schemas/{kind}.schema.json"))
            marked = {key.path.split(".")[-1] for key in keys.keys_of(kind).keys if key.is_required}
            self.assertEqual(marked, set(required(schema)), kind)

    def test_the_keys_are_those_of_the_manuals(self):
        for page, command in TOOLS.items():
            self.assertEqual(sorted(headings(page)), sorted({path for path, _ in manual(command)}), page)

    def test_effects_are_those_of_scan_keys(self):
        """A path whose types differ has the first of scan_keys.EFFECTS, as for a redraw that does not know the type."""
        found = {}
        for key in keys.keys_of("scan").keys:
            found.setdefault(key.path, set()).add(key.effect)
        expected = {path: keys.scan_keys.effect_of(*(part for part in path.split(".") if part != "N")) for path in found}
        self.assertEqual({path: min(effects, key=keys.scan_keys.EFFECTS.index) for path, effects in found.items()}, expected)

    def test_numbers_and_units_are_those_of_the_manuals(self):
        """Every bound and unit that a manual states stands in the entry of its key."""
        compared = 0
        for page, command in TOOLS.items():
            entries = dict(re.findall(r"(?ms)^##+ `([^\n]*)`\n(.*?)(?=^##|\Z)", page_of(page)))
            for path, facts in manual(command):
                stated = re.findall(r"(?:at least|at most|above|below) [-\w.]+|(?<=, )(?:m|s|rad|degrees|m/s)(?=,|;|$)", facts)
                compared += len(stated)
                self.assertEqual([fact for fact in stated if fact not in entries[path]], [], (page, path, facts))
        self.assertGreater(compared, 300)


if __name__ == "__main__":
    unittest.main()
