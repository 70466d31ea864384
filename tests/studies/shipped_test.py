#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
# Quantities held constant by the included studies: pulse rate: the scan time and the shape of the raster; overlap: the
# number of pulses; detector size: the field of view; altitude: the aims on the ground; resolution: the returns, and
# limits of holes in bins; cone slope: the radius; scanners: rays and time.
#
# A page belongs to a study as it is shipped: a test compares the number of cases, and requires the command, the figure
# and the run time.
"""The studies of the repository: each can be planned, and has a page with its command and its figure."""
import functools
import glob
import json
import math
import os
import re
import struct
import subprocess
import unittest

from case import BIN, ROOT, StudyTest, read

# pylint: disable=wrong-import-order
from landfall import tools
from landfall.answers import design_problem, sensitivity
from landfall.study import sweep

PAGES = os.path.join(ROOT, "docs", "user", "studies")
# Their pages: docs/quality/performance.md, docs/user/lidar/risley-coverage.md.
WITHOUT_PAGE = {"example-2-draws", "risley-coverage"}
DRAWS_CONFIG = "campaign-example-2"  # the page of studies/example-2.draws.json, which is no study
ANSWERS = {"model", "sensitivity", "design"}  # pages of recipes that are no studies
MAX_BYTES = 200_000


@functools.cache
def shipped():
    """{name: number of cases}."""
    return {study.name: study.case_count() for study in sweep.studies_of(os.path.join(ROOT, "studies"))}


def names():
    return sorted(shipped().keys() - WITHOUT_PAGE)


def page(name):
    return read(os.path.join(PAGES, name + ".md")).decode()


class Shipped(StudyTest):
    def test_the_list_is_complete(self):
        self.assertLessEqual({"altitude", "attitude-rate-error", "campaign-velocity", "cone-slope", "dead-pixels", "detector-size", "dropout",
                              "error-budget", "flyback", "hazards-noise", "hazards-pattern", "hazards-resolution", "hazards-velocity", "landing-altitude", "landing-noise", "landing-rocks", "landing-velocity", "noise", "overlap",
                              "pulse-rate", "receiver", "requirement", "resolution", "scanners", "velocity-error"}, set(names()))

    def test_each_can_be_planned(self):
        for name, count in shipped().items():
            with self.subTest(name):
                result = self.plan_file(os.path.join(ROOT, "studies", name + ".json"), name=name)
                self.assertRegex(result.stdout + result.stderr, rf"(?m)^{name}: {count} cases: ")

    def test_make_lists_all_studies(self):
        result = subprocess.run(["make", "-C", ROOT, "--no-print-directory", "-f", "Makefile.studies", "studies"], capture_output=True,
                                text=True, env=self.environment(), timeout=60, check=True)
        self.assertEqual([line.split()[0] for line in result.stdout.splitlines()], sorted(shipped()))
        self.assertRegex(result.stdout, r"(?m)^noise +28 cases  Range noise on the paper's cones$")

    def test_the_list_names_wrong_studies(self):
        self.write({"base": {}, "axis": []}, "bad")
        result = self.sweep("studies", self.folder, code=2)
        self.assertEqual(result.stdout, "")
        self.assertRegex(result.stderr, "^landfall study: .*bad.json.*axis")

    def test_each_page_has_the_number_of_cases(self):
        """The number on the page is that of the study file, so that a page is updated when its study changes."""
        for name in names():
            with self.subTest(name):
                self.assertIn(f"\n{shipped()[name]} cases: ", page(name))

    def test_each_has_a_page_with_its_command_and_a_run_time(self):
        run_times = read(os.path.join(ROOT, "docs", "quality", "performance.md")).decode()
        for name in names():
            with self.subTest(name):
                text = page(name)
                self.assertRegex(text, rf"(?m)^landfall study {name}( |$)")
                self.assertIn(f"\n| [{name}](", run_times)

    def test_each_figure_exists_and_is_small(self):
        for name in names():
            with self.subTest(name):
                self.assertIn(f"](../../images/study-{name}.png)", page(name))
                image = read(os.path.join(ROOT, "docs", "images", f"study-{name}.png"))
                self.assertLessEqual(len(image), MAX_BYTES)
                self.assertEqual(image[:8], b"\x89PNG\r\n\x1a\n")
                width, _ = struct.unpack(">II", image[16:24])
                self.assertGreaterEqual(width, 600)

    def test_the_index_links_all_pages(self):
        index = page("README")
        linked = set(re.findall(r"\]\(([a-z0-9-]+)\.md\)", index))
        self.assertEqual(linked, {*names(), *ANSWERS, DRAWS_CONFIG})
        self.assertEqual(linked, {os.path.basename(path)[:-3] for path in glob.glob(os.path.join(PAGES, "*.md"))} - {"README"})


class Answers(StudyTest):
    """The sensitivity and design files: each is valid, and its page has its command."""

    def test_each_is_valid_and_on_its_page(self):
        tools.BIN = BIN
        for kind, problem in (("sensitivity", sensitivity.Problem), ("design", design_problem.Problem)):
            paths = glob.glob(os.path.join(ROOT, "studies", f"*.{kind}.json"))
            self.assertNotEqual(paths, [])
            for path in paths:
                problem(path)
                self.assertRegex(page(kind), rf"(?m)^make -f Makefile\.studies {kind} STUDY={os.path.basename(path).split('.')[0]}( |$)")

    def test_the_sensitivity_of_example_2_takes_1152_draws(self):
        tools.BIN = BIN
        self.assertEqual(sensitivity.Problem(os.path.join(ROOT, "studies", "example-2.sensitivity.json")).draw_count(), 1152)


class DrawSeries(StudyTest):
    """Makefile.studies' recipe `campaign` and its page."""

    def test_the_recipe(self):
        plan = subprocess.run(["make", "-n", "-C", ROOT, "-f", "Makefile.studies", "campaign", f"BIN={BIN}", f"RUNS={self.folder}"],
                              capture_output=True, text=True, env=self.environment(), timeout=60, check=True).stdout
        [command] = [line for line in plan.replace("\\\n", "").splitlines() if "/monte-carlo " in line]
        for words in (f"{self.folder}/example-2/scan.h5 --terrain {self.folder}/example-2/terrain.h5", "-c studies/example-2.draws.json",
                      f"-o {self.folder}/campaign/draws.h5", f"--report {self.folder}/campaign/draws.html"):
            self.assertIn(words, command)
        self.assertIn(f"plot_draws.py {self.folder}/campaign/draws.h5", plan)
        for tool, config in (("terrain-gen", "studies/presets/paper.terrain.json"), ("scan-sim", "studies/presets/paper.scan.json")):
            self.assertRegex(plan, rf"/{tool} .*-c {config}")

    def test_the_configuration_is_valid_and_that_of_the_page(self):
        path = os.path.join(ROOT, "studies", "example-2.draws.json")
        subprocess.run([os.path.join(BIN, "monte-carlo"), "--check", "-c", path], check=True)
        draws = json.loads(read(path))["draws"]
        self.assertIn(f"# {draws} draws of Example 2", page(DRAWS_CONFIG))
        self.assertIn(f"passed of {draws} |", page(DRAWS_CONFIG))

    def test_intervals_and_bounds(self):
        """Wilson's interval in closed form; the exact bound as the p with which k or more of n pass with 5 %."""
        rows = re.findall(r"(?m)^\| \w[\w ]* \| (\d+) \| ([\d.]+) % \| ([\d.]+) to ([\d.]+) \| ([\d.]+) \|$", page(DRAWS_CONFIG))
        self.assertEqual(len(rows), 7)
        n, z = 299, 1.959963984540054
        for row in rows:
            k, share, low, high, bound = int(row[0]), *map(float, row[1:])
            half = z * math.sqrt(k * (n - k) / n**3 + z * z / (4 * n * n))
            self.assertAlmostEqual(share, 100 * k / n, delta=0.0501)
            for found, expected in ((low, k / n + z * z / (2 * n) - half), (high, k / n + z * z / (2 * n) + half)):
                self.assertAlmostEqual(found, expected / (1 + z * z / n), delta=0.00005001)

            def tail(p, minimum=k):
                return sum(math.comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(minimum, n + 1))
            self.assertLessEqual(tail(max(0, bound - 0.00005)), 0.05 if k else 1)
            self.assertGreaterEqual(tail(bound + 0.00005), 0.05)


if __name__ == "__main__":
    unittest.main()
