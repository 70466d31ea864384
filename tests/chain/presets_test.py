#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets of studies/presets and the default patterns have the coverage that the pages of docs/user/lidar state."""
import glob
import json
import os
import re
import unittest

from harness import ROOT, ToolTest, read_bytes

PAGE = os.path.join(ROOT, "docs", "user", "lidar", "presets.md")
FLIGHTS = os.path.join(ROOT, "docs", "reference", "flights.md")
ROW = re.compile(r"^\| (`[\w-]+`(?:, `[\w-]+`)*) \| ([\d,]+) \| ([\d.]+) \| ([\d.]+) m, ([\d.]+) m \| ([\d.]+) \| ([\d.]+) % \|$", re.MULTILINE)


def rows():
    return [(name, *row[1:]) for row in ROW.findall(read_bytes(PAGE).decode()) for name in re.findall("`(.*?)`", row[0])]


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


def preset(name):
    """The keys that a preset sets."""
    with open(os.path.join(ROOT, "studies", "presets", name + ".scan.json"), encoding="utf-8") as file:
        return dict(leaves({key: value for key, value in json.load(file).items() if key != "$comment"}))


class Sources(unittest.TestCase):
    def setUp(self):
        page, self.sources = read_bytes(FLIGHTS).decode().split("\n## Sources\n")
        self.sections = {tuple(re.findall("`(.*?)`", title)): text for title, _, text in
                         (section.partition("\n") for section in re.split(r"(?m)^### ", page)[1:])}

    def rows(self):
        """(names, base, {key: (value, source)}) of each section; other keys are those of the preset `base`, if there is one."""
        for names, text in self.sections.items():
            found = re.findall(r"(?m)^\| `([\w.]+)` \| `(.*?)` \| (.*) \|$", text)
            self.assertEqual(len(found), text.count("\n| `"), names)
            base = re.search(r"(?m)^Every other key is that of `(.*?)`: assumed\.", text)
            yield names, base and base[1], {key: (json.loads(value), source) for key, value, source in found}

    def test_the_page_has_every_key_and_value(self):
        for names, base, found in self.rows():
            stated = {**(preset(base) if base else {}), **{key: value for key, (value, _) in found.items()}}
            for name in names:
                self.assertEqual(stated, preset(name), name)

    def test_each_key_has_a_sentence_and_its_source_or_is_assumed(self):
        for names, _, found in self.rows():
            for key, (_, source) in found.items():
                with self.subTest(names[0] + " " + key):
                    self.assertRegex(source, r'^assumed: \w.{5}|"[^"]{25,}" \[S\d+\]')

    def test_each_source_is_listed_and_cited(self):
        listed = dict(re.findall(r"(?ms)^- \*\*(S\d+)\*\* (.*?)(?=^- |\n\n|\Z)", self.sources))
        self.assertEqual([name for name, text in listed.items() if not re.search(r"https?://\S+", text)], [])
        cited = set(re.findall(r"\[(S\d+)\]", read_bytes(FLIGHTS).decode()))
        self.assertEqual(set(listed), cited)

    def test_every_preset_has_its_sources_on_one_page(self):
        table = re.search(r"(?ms)^## Presets\n(.*?)^## ", read_bytes(os.path.join(ROOT, "docs", "reference", "sources.md")).decode())[1]
        named = re.findall(r"(?m)^\| `([\w-]+)` \|", table) + [name for names in self.sections for name in names]
        self.assertEqual(sorted(named), sorted(row[0] for row in rows()))


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
