#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutation testing of toy.cpp: which mutants are found, and which of them the checks in toy.cpp kill."""
import os
import subprocess
import tempfile
import unittest

import programs
import schema
from points import Finder

HERE = os.path.dirname(os.path.abspath(__file__))
TOY = os.path.join(HERE, "toy.cpp")
FOUND = {
    "clipped: `a < 0`: < -> <=": "lives",  # 0 is clipped to 0
    "clipped: `a < 0`: < -> >=": "dies",
    "clipped: 0 -> 1 in `if (a < 0) return 0;`": "lives",  # 0 is clipped to 0
    "clipped: returns a default, not `0`": "dies",
    "clipped: 0 -> 1 in `if (a < 0) return 0;` #2": "dies",
    "clipped: returns a default, not `std::min(a, limit)`": "dies",
    "clipped: `std::min(a, limit)`: min -> max": "dies",
    "only_first: `a && !b`: && -> ||": "dies",
    "only_first: `a` negated": "dies",
    "only_first: `!b`: ! removed": "dies",
    "steps: 0 -> 1 in `int total = 0;`": "dies",
    "steps: 0 -> 1 in `for (int i = 0; i < count; ++i) total += kStep;`": "dies",
    "steps: `i < count`: < -> <=": "dies",
    "steps: `i < count`: < -> >=": "dies",
    "steps: `total += kStep` removed": "dies",
    "steps: `total += kStep`: += -> -=": "dies",
    "steps: returns a default, not `total`": "dies",
    "half: returns a default, not `x * 0.5`": "dies",
    "half: `x * 0.5`: * -> /": "dies",
    "half: 0.5 -> -0.5 in `return x * 0.5;`": "dies",
    ": `constexpr int kStep = 3` changed": "dies",
}


class Toy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        finder = Finder(TOY, ["-std=c++20"])
        finder.find()
        for key, point in list(finder.points.items()):
            if point.function == "main":
                del finder.points[key]
        cls.mutants = schema.number_mutants({"toy.cpp": finder}, HERE)
        cls.source = schema.render("toy.cpp", finder, set())
        cls.program = os.path.join(cls.folder.name, "toy")
        os.mkdir(os.path.join(cls.folder.name, "landfall_mutant"))
        os.symlink(os.path.join(HERE, "schema.h"), os.path.join(cls.folder.name, "landfall_mutant", "schema.h"))
        with open(cls.program + ".cpp", "w", encoding="utf-8") as file:
            file.write(cls.source)
        subprocess.run(["g++", "-std=c++20", "-I", cls.folder.name, "-o", cls.program, cls.program + ".cpp"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_finds_each_mutant_once(self):
        self.assertEqual(sorted(m["key"] for m in self.mutants), sorted("toy.cpp: " + key for key in FOUND))

    def test_mutants_live_or_die_as_listed(self):
        for mutant in self.mutants:
            status = programs.run([self.program], {"LANDFALL_MUTANT": str(mutant["id"])}, 10)
            expected = FOUND[mutant["key"].removeprefix("toy.cpp: ")]
            self.assertEqual("dies" if status != 0 else "lives", expected, mutant["key"])

    def test_a_trace_has_all_reached_mutants(self):
        reached = programs.trace([self.program])["reached"]
        self.assertEqual(reached, [m["id"] for m in self.mutants])

    def test_a_dropped_mutant_does_not_change_the_text(self):
        finder = Finder(TOY, ["-std=c++20"])
        finder.find()
        mutants = schema.number_mutants({"toy.cpp": finder}, HERE)
        text = schema.render("toy.cpp", finder, {m["id"] for m in mutants})
        with open(TOY, encoding="utf-8") as file:
            self.assertTrue(text.endswith(file.read()))

    def test_a_hanging_program_is_killed(self):
        self.assertIsNone(programs.run(["sleep", "60"], {}, 0.1))


if __name__ == "__main__":
    unittest.main()
