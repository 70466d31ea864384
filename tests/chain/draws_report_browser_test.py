# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of monte-carlo in a browser: its numbers are those of the file, and its commands give the same draw."""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import BIN, EVAL, LONGEST_S, REGRID, SCAN, TERRAIN, browser, read_bytes, with_values
from harness.page import CommonPage, PageTest

SECTIONS = ["requirements", "distributions", "causes", "failures", "maps", "provenance-chain"]
PROBABILITIES = ["p_invalid", "p_fail_rel_z", "p_fail_rel_x", "p_fail_rel_y", "p_fail_absolute"]
MAPS = [*PROBABILITIES, "e_z_mean", "e_z_std", "e_map_std", "z_sigma_abs", "e_map_std_over_sigma", "z_true_map"]
VELOCITY = "scan.navigation_error.velocity_mps.0"
NOISE = "scan.noise.range_sigma_m"
DRAWS_CONFIG = {"draws": 8, "metrics": "full", "sigma": True, "regrid": {**REGRID, "uncertainty": {"navigation_sigma": {}}},
            "eval": with_values(EVAL, limits__relative_elevation_m=0.12, limits__invalid_frac=0.04),
            "vary": {VELOCITY: {"type": "normal", "sigma": 0.3}, NOISE: {"type": "uniform", "low": 0.005, "high": 0.08},
                     "scan.navigation_error.rpy_rate_radps.2": {"type": "normal", "sigma": 1e-5}}}
# The least brightness of a probability above 0, over that of its colour in the colour bar.
BRIGHTNESS = """
const panel = panels.find((one) => one.raster.layer.name === arguments[0]);
const blocks = blocksOf(panel.raster, 1), colors = panel.shadedColors(blocks);
return Math.min(...Array.from(blocks.values).map((value, i) => value > 0 ? colors[3 * i + 1] / colorOf(panel.scale, value)[1] : 1));
"""
SET_VALUE = "const e = document.getElementById(arguments[0]); e.value = arguments[1]; e.dispatchEvent(new Event(arguments[2]));"


class DrawsReport(PageTest):
    def report(self, *arguments, config=DRAWS_CONFIG, output="draws.h5"):
        """Makes draws and opens its report; the draws by column, and the layers."""
        if not os.path.exists(self.path("scan.h5")):
            os.symlink(self.chain.terrain, self.path("terrain.h5"))
            self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--keep-misses", "-o", self.path("scan.h5"))
        self.succeed("monte-carlo", self.path("scan.h5"), "--terrain", self.path("terrain.h5"), "-c", self.config(config), "-o",
                     self.path(output), "--report", self.path("draws.html"), "-O", *arguments)
        self.open("draws.html")
        return self.results(output)

    def results(self, output="draws.h5"):
        with h5py.File(self.path(output)) as file:
            self.verdict = json.loads(file["verdict_json"][()])
            layers = {name: file[name][()] for name in file if isinstance(file[name], h5py.Dataset) and file[name].ndim == 2}
            return {name: item[()] for name, item in file["draws"].items()}, layers


@unittest.skipIf(browser.missing(), browser.missing())
class CommonReport(CommonPage, DrawsReport):
    def test_numbers_maps_and_layout(self):
        draws, layers = self.report()
        passed = int(np.count_nonzero(draws["pass"]))
        self.assertTrue(0 < passed < 8, "the case must have both")
        self.check_parts(SECTIONS, MAPS)
        rows = self.cells("#rates")
        self.assertEqual([row[1] for row in rows], [f"{rate['passed']} of 8" for rate in self.verdict["rates"]])
        self.assertEqual([row[3:] for row in rows], [[f"{rate['wilson_low']:.4f} \u2026 {rate['wilson_high']:.4f}",
                                                      f"{rate['exact_lower_bound']:.4f}"] for rate in self.verdict["rates"]])
        self.assertIn(f"{passed} of 8 draws pass all requirements", self.text("#verdict"))
        for name in MAPS:
            np.testing.assert_allclose(self.values(name, layers[name].shape), layers[name], rtol=0, atol=0.501 * self.step(name) + 1e-7,
                                       err_msg=name)
        self.assertEqual(len(self.texts("#distributions figure")), 6)
        for name in PROBABILITIES:
            self.assertTrue(0.849 < self.window.run(BRIGHTNESS, name) <= 1, name)

    def test_failed_draws_and_the_points_of_the_diagrams(self):
        draws, _ = self.report()
        failed = np.flatnonzero(draws["pass"] == 0)
        rows = self.cells("#failed-draws")
        self.assertEqual([row[0] for row in rows], [str(i) for i in failed])
        names = [rate["requirement"] for rate in self.verdict["rates"][:-1]]
        for row, i in zip(rows, failed):
            missed = [name for name in names if draws[f"requirements.{name}.pass"][i] == 0]
            self.assertEqual([part.split(":")[0] for part in row[1].split("; ")], missed)
        colors = "return [...document.querySelectorAll('#causes figure:first-of-type circle')].filter((c) => c.getAttribute('r') === '3').map((c) => c.getAttribute('fill'))"
        metric = self.window.run("return document.querySelector('#metric option').textContent")
        expected = int(np.count_nonzero(draws[f"requirements.{metric}.pass"] == 0))
        self.assertEqual([self.window.run(colors).count(f"var(--{color})") for color in ("vermilion", "blue")], [expected, 8 - expected])

    def test_the_requirement_that_decides_comes_first_as_a_length_against_its_limit(self):
        draws, _ = self.report()
        failures = {name: np.count_nonzero(draws[f"requirements.{name}.pass"] == 0) for name in (rate["requirement"] for rate in self.verdict["rates"][:-1])}
        self.assertEqual([failures[name] for name in self.texts("#distributions figcaption")], sorted(failures.values(), reverse=True))
        elevation = "return report.requirements.find((r) => r.name === 'relative_elevation').deciding"
        found = self.window.run(elevation)
        np.testing.assert_array_equal(found["values"], draws["accuracy.relative.z.max_m"])
        self.assertEqual((found["limit"], found["metrics"]), (0.12, ["accuracy.relative.z.max_m"]))
        figure = next(text for text in self.texts("#distributions figure") if text.startswith("relative_elevation"))
        self.assertIn("worst footprint (cm)", figure)
        self.assertIn("limit: at most 12 cm", figure)
        options = self.texts("#metric option")
        self.assertIn(options[0], failures)
        self.assertNotIn("region.half_width_m", options)  # it is null in each draw
        self.assertIn("accuracy.relative.z.max_m", options)

    def test_the_commands_give_the_same_draw(self):
        draws, _ = self.report()
        self.window.run(SET_VALUE, "draw", "5", "input")
        commands = f"set -e\n{self.text('#configurations')}\n{self.text('#commands')}\n"
        self.assertEqual(commands.count("--set"), 4)
        done = subprocess.run(["bash", "-c", commands], cwd=self.folder, capture_output=True, text=True, timeout=LONGEST_S, check=False,
                              env={**os.environ, "PATH": BIN + ":" + os.environ["PATH"]})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        metrics = json.loads(read_bytes(self.path("draw-5-metrics.json")))
        compared = 0
        for name, column in draws.items():
            if name in ("seed", "draw", "pass") or name.startswith("scan."):
                continue
            value = metrics
            for key in name.split("."):
                value = value[key]
            np.testing.assert_equal(column[5], np.nan if value is None else float(value), err_msg=name)
            compared += 1
        self.assertGreater(compared, 30)
        self.assertEqual(metrics["pass"], bool(draws["pass"][5]))


@unittest.skipIf(browser.missing(), browser.missing())
class OtherReports(DrawsReport):
    def test_parts_and_merge(self):
        self.report()
        whole = read_bytes(self.path("draws.html"))
        self.report("--draws", "0:3", output="a.h5")
        self.assertEqual(self.cells("#rates")[0][1].split(" of ")[1], "3")
        self.report("--draws", "3:8", output="b.h5")
        self.window.run(SET_VALUE, "draw", "3", "input")
        self.assertIn("-o draw-3-scan.h5", self.text("#commands"))
        self.succeed("monte-carlo", "merge", self.path("b.h5"), self.path("a.h5"), "-o", self.path("c.h5"), "--report", self.path("c.html"))
        self.assertEqual(read_bytes(self.path("c.html")), whole)
        self.assertEqual(read_bytes(self.path("c.h5")), read_bytes(self.path("draws.h5")))

    def test_a_sequential_test_and_no_maps(self):
        config = {**with_values(DRAWS_CONFIG, sigma=False), "layers": False, "metrics": "verdict", "vary": {},
                  "stop": {"type": "sprt", "p0": 0.9, "p1": 0.5}}
        self.report("--title", "Cones & <rocks>", config=config)
        self.assertEqual(self.text("h1"), "Cones & <rocks>")
        self.assertIn(f"sequential test: {self.verdict['sprt']}", self.text("#verdict"))
        for row in self.cells("#rates"):
            self.assertTrue(all("not valid after stopping" in cell for cell in row[3:]), row)
        self.assertIn("without maps", self.text("#maps"))
        self.assertIn("No key is varied", self.text("#causes"))
        self.check_log_and_requests()
        self.check_layout()

    def test_terrains_that_vary(self):
        """Without a ground that all draws share, probabilities have their plain colours."""
        config = {"draws": 3, "metrics": "verdict", "terrain": TERRAIN, "scan": SCAN, "regrid": REGRID, "eval": EVAL,
                  "vary": {"terrain.features.0.x_m": {"type": "uniform", "low": -3, "high": 3}}}
        self.succeed("monte-carlo", "-c", self.config(config), "-o", self.path("draws.h5"), "--report", self.path("draws.html"))
        self.open("draws.html")
        self.assertEqual(self.maps(), [*PROBABILITIES, "e_z_mean", "e_z_std"])
        self.check_log_and_requests()

    def test_what_is_refused(self):
        inputs = [self.chain.scan, "--terrain", self.chain.terrain, "-o", self.path("d.h5")]
        for options, message in ((["--title", "x"], "--title needs --report"), (["--report", "-"], "--report needs a file"),
                                 (["--report", self.chain.scan], "scan.h5")):
            self.refuse(2, "monte-carlo", *inputs, *options, words=[message], output=self.path("d.h5"))


if __name__ == "__main__":
    unittest.main()
