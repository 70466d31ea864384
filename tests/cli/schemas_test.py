#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tools accept the configurations that python3-jsonschema accepts by the same schema, and no others."""
import collections
import copy
import json
import os
import random
import subprocess
import unittest

import jsonschema

from harness import ROOT, read_bytes
from landfall.schema import read_json

SEED = int(os.environ.get("LANDFALL_TEST_SEED", "20261126"))
COUNT = 1500  # configurations of each schema
SCHEMAS = ("terrain", "scan", "regrid", "eval", "hazard", "draws")
WRONG = (None, True, False, "", "x", "cone", 0, 1, -1, 1.5, 2.0, -0.0, 2 ** 53, 2 ** 63, -2 ** 63, 1e16, 1e300, [], {}, [0], [1, 2, 3], {"type": "plane"},
         {"x": 1}, [[1]], [{}])


def schema_of(name):
    return json.loads(read_bytes(os.path.join(ROOT, "schemas", f"{name}.schema.json")))


class Writer:
    """Writes configurations that are mostly valid by a schema."""

    def __init__(self, root, chance):
        self.root, self.chance = root, chance

    def value(self, node):
        while "$ref" in node:
            node = self.at(node["$ref"])
        if "oneOf" in node:
            return self.value(self.chance.choice(node["oneOf"]))
        if "const" in node or "enum" in node:
            return node.get("const", self.chance.choice(node.get("enum", [None])))
        kind = node.get("type")
        if kind in ("number", "integer"):
            return self.number(node, kind == "integer")
        if kind == "array":
            minimum = node.get("minItems", 0)
            return [self.value(node.get("items", {})) for _ in range(self.chance.randint(minimum, min(node.get("maxItems", 9), minimum + 2)))]
        if kind == "object":
            return {key: self.value(inner) for key, inner in node.get("properties", {}).items()
                    if key in node.get("required", []) or key == "type" or self.chance.random() < 0.3}
        return {"boolean": self.chance.random() < 0.5, "string": "s"}.get(kind)

    def at(self, reference):
        node = self.root
        for key in reference.removeprefix("#/").split("/"):
            node = node[key]
        return node

    def number(self, node, whole):
        """A bound, a number between the bounds, or rarely a number beyond a bound."""
        bounds = [node[key] for key in ("minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum") if key in node] or [0]
        inner = [bound for bound in bounds if bound in (node.get("minimum"), node.get("maximum"))]
        beyond = [*bounds, *(bound + step for bound in bounds for step in (-1, 1))]
        value = self.chance.choice(beyond if self.chance.random() < 0.02 else [*inner, (min(bounds) + max(bounds)) // 2 + 1])
        return int(value) if whole and self.chance.random() < 0.8 else value


def places(tree, found=None):
    """(container, key) of each value within the tree."""
    found = [] if found is None else found
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, inner in items:
        found.append((tree, key))
        places(inner, found)
    return found


def mutated(tree, chance):
    """The tree with a value replaced, removed, added or renamed."""
    tree = copy.deepcopy(tree)
    if not places(tree):
        return copy.deepcopy(chance.choice(WRONG))
    container, key = chance.choice(places(tree))
    how = chance.randrange(4)
    if how == 0:
        container[key] = copy.deepcopy(chance.choice(WRONG))
    elif how == 1:
        del container[key]
    elif isinstance(container, list):
        container.append(copy.deepcopy(container[key]))
    elif how == 2:
        container["no_such_key"] = 1
    else:
        container[key + "s"] = container.pop(key)
    return tree


def resolved(cases):
    """The answers of resolve_configs to (schema, configuration)."""
    lines = "".join(f"{name} {json.dumps(tree)}\n" for name, tree in cases)
    result = subprocess.run([os.path.join(os.environ["LANDFALL_BIN"], "..", "tests", "resolve_configs")], input=lines, capture_output=True, text=True,
                            timeout=600, check=True)
    return result.stdout.splitlines()


class Acceptance(unittest.TestCase):
    def cases(self):
        chance = random.Random(SEED)
        for name in SCHEMAS:
            writer = Writer(schema_of(name), chance)
            for number in range(COUNT):
                tree = writer.value(writer.root)
                for _ in range(number % 3):
                    tree = mutated(tree, chance)
                yield name, tree

    def test_equals_that_of_jsonschema(self):
        """A resolved configuration is valid; a refused one was not. (Where `type` has a default, a valid one may lack it.)"""
        validators = {name: jsonschema.Draft7Validator(schema_of(name)) for name in SCHEMAS}
        cases = list(self.cases())
        counts = collections.Counter()
        for (name, tree), answer in zip(cases, resolved(cases), strict=True):
            refused = answer.startswith("! ")
            counts[name, refused] += 1
            with self.subTest(schema=name, config=tree, answer=answer, seed=SEED):
                self.assertEqual(validators[name].is_valid(tree if refused else json.loads(answer)), not refused)
        for name in SCHEMAS:
            for refused in (False, True):
                self.assertGreater(counts[name, refused], COUNT / 20, (name, refused, counts))


class Sections(unittest.TestCase):
    """As an editor sees them: the schemas of chains, runs of draws and studies have those of the tools in their sections."""

    def test_unknown_keys_of_a_section_are_found(self):
        for words in (["landfall", "run"], ["monte-carlo"]):
            printed = subprocess.run([os.path.join(os.environ["LANDFALL_BIN"], words[0]), *words[1:], "--print-schema"], capture_output=True, text=True, check=True)
            validator = jsonschema.Draft7Validator(json.loads(printed.stdout))
            self.assertTrue(validator.is_valid({"terrain": {"from": "a.tif", "center": [1, 2]}, "eval": "eval.json", "hazard": None,
                                                "scan": ["preset:paper", {"noise": {"range_sigma_m": 1}, "scanner": {"max_deflection_deg": 9}}]}))
            for wrong in ({"scan": {"noise": {"range_sigma": 1}}}, {"scan": ["preset:paper", {"noise": {"range_sigma": 1}}]}, {"eval": {"quantile": 2}},
                          {"terrain": {"features": [{"type": "cone", "radius": 1}]}}, {"regrid": 3}, {"scan": {"from": "a.tif"}}):
                self.assertFalse(validator.is_valid(wrong), (words, wrong))

    def test_the_studies_that_ship_are_valid(self):
        folder, count = os.path.join(os.environ["LANDFALL_BIN"], "..", "schemas"), collections.Counter()
        for name in os.listdir(os.path.join(ROOT, "studies")):
            kind = name.split(".")[-2] if name.count(".") > 1 else "study"
            tree = read_json(os.path.join(ROOT, "studies", name)) if name.endswith(".json") else {}
            if kind in ("design", "sensitivity", "draws") or kind == "study" and {"base", "axes"} & tree.keys():
                jsonschema.Draft7Validator(json.loads(read_bytes(os.path.join(folder, f"{kind}.schema.json")))).validate(tree)
                count[kind] += 1
        self.assertTrue(all(count[kind] for kind in ("study", "design", "sensitivity", "draws")), count)


if __name__ == "__main__":
    unittest.main()
