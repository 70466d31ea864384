#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets of studies/presets and the default patterns have the coverage that the pages of docs/user/lidar state."""
import glob
import json
import os
import re
import unittest

from harness import ToolTest, read_bytes

ROOT = os.environ["LANDFALL_ROOT"]
PAGE = os.path.join(ROOT, "docs", "user", "lidar", "presets.md")
ROW = re.compile(r"^\| `([\w-]+)` \| ([\d,]+) \| ([\d.]+) \| ([\d.]+) m, ([\d.]+) m \| ([\d.]+) \| ([\d.]+) % \|$", re.MULTILINE)


def rows():
    return ROW.findall(read_bytes(PAGE).decode())


def leaves(value, key=""):
    """Every value of a configuration with its dotted key."""
    if not isinstance(value, dict):
        yield key, value
        return
    for name, item in value.items():
        yield from leaves(item, f"{key}.{name}" if key else name)


class Presets(ToolTest):
    def test_every_preset_is_in_the_table(self):
        files = glob.glob(os.path.join(ROOT, "studies", "presets", "*.scan.json"))
        self.assertEqual(sorted(os.path.basename(path).removesuffix(".scan.json") for path in files),
                         sorted(row[0] for row in rows()))

    def test_plans_give_the_numbers_of_the_table(self):
        for name, returns, seconds, radius, resolution, per_bin, uncovered in rows():
            with self.subTest(name):
                config = os.path.join(ROOT, "studies", "presets", name + ".scan.json")
                plan = json.loads(self.succeed("scan-sim", "-c", config, "--plan", "--plan-radius", radius,
                                               "--plan-resolution", resolution, "--json").stdout)["plan"]
                self.assertEqual(f"{plan['returns']['count']:,}", returns)
                self.assertAlmostEqual(plan["time"]["total"]["time_s"], float(seconds))
                self.assertEqual(f"{plan['returns_per_bin']['mean']:.2f}", per_bin)
                self.assertEqual(f"{100 * plan['coverage']['uncovered_frac']:.2f}", uncovered)


    def test_how_the_papers_example_2_differs_from_the_defaults(self):
        """As docs/user/scan-sim.md says; and it is the set-up of the studies with the noise of Example 2."""
        preset, defaults = ({key: value for key, value in leaves(json.loads(
            self.succeed("scan-sim", "--print-config", *config).stdout))} for config in (["-c", "preset:paper"], []))
        differing = {key: (value, preset[key]) for key, value in defaults.items() if value != preset[key]}
        pattern = "scanner.pattern."
        self.assertEqual(differing, {pattern + "rows": (200, 247), pattern + "columns": (200, 161), pattern + "half_width_m": (50, 50.1),
                                     "detector.roll_deg": (0, 7.73), "noise.range_sigma_m": (0, 0.05 / 3)})
        studied = json.loads(self.succeed("scan-sim", "--print-config", "-c", os.path.join(ROOT, "studies", "paper-like.scan.json"),
                                          "--set", "noise.range_sigma_m=0.016666666666666666").stdout)
        self.assertEqual(dict(leaves(studied)), preset)


FSM = '{"type":"fsm","pattern":%s}'
UNCOVERED = [
    ("pattern-lissajous.md", '{"type":"lissajous"}', "leave 13.1 %", 13.1, 0.05),
    ("pattern-rosette.md", '{"type":"rosette"}', "leave 7.7 %", 7.7, 0.05),
    ("pattern-rosette.md", '{"type":"rosette","rates_hz":[100,99.5]}', "0.37 %", 0.37, 0.005),
    ("pattern-spiral.md", '{"type":"spiral"}', "leave 0.037 %", 0.037, 0.0005),
    ("pattern-spiral.md", '{"type":"spiral","radius_m":50.25}', "50.25", 0, 0),
]


class PatternPages(ToolTest):
    def test_the_uncovered_shares_are_those_of_plans(self):
        for page, pattern, words, uncovered_percent, rounding in UNCOVERED:
            with self.subTest(pattern):
                self.assertIn(words, read_bytes(os.path.join(ROOT, "docs", "user", "lidar", page)).decode())
                plan = json.loads(self.succeed("scan-sim", "--plan", "--json", "--set", "scanner=" + FSM % pattern).stdout)
                self.assertAlmostEqual(100 * plan["plan"]["coverage"]["uncovered_frac"], uncovered_percent, delta=rounding)


if __name__ == "__main__":
    unittest.main()
