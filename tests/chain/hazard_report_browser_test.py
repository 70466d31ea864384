# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of hazard-map in a browser: its numbers are those of the files, its drawings those of the lander."""
import json
import math
import unittest

import h5py
import numpy as np

from harness import HAZARD, REGRID, browser, columns, read_bytes, with_values
from harness.page import CommonPage, PageTest

SECTIONS = ["places", "maps", "sites", "score", "provenance-chain"]
MAPS = ["safe", "outcome", "p_safe", "p_touchdown", "cost", "distance_to_hazard", "slope", "roughness", "z_est", "slope_true",
        "roughness_true", "z_true"]
NOISE = with_values(HAZARD, z_sigma_m=0.01)

# The parts of a site's pose figure: pads and deciding bin on the map, in metres; the plane and the pads from the side, as (along, z).
POSE = """
return [...document.querySelectorAll(`.site[data-rank="${arguments[0]}"]`)].map((site) => {
  const panel = panels.find((p) => site.contains(p.canvas));
  const metres = (x, y) => [panel.raster.left_m + (x - panel.box.left) / panel.pixels_per_m,
                            panel.raster.bottom_m + (panel.box.top + panel.box.height - y) / panel.pixels_per_m];
  const number = (e, ...names) => names.map((name) => Number(e.getAttribute(name)));
  // Everything is drawn twice: white, and over it in colour.
  const drawn = (selector) => [...panel.svg.querySelectorAll(selector)].filter((_, k) => k % 2 === 1);
  const side = site.querySelector("svg.side");
  return {
    title: site.querySelector("h3").textContent,
    pads: drawn("circle.pad").map((e) => [...metres(...number(e, "cx", "cy")), e.classList.contains("hanging")]),
    bin: drawn("rect.deciding").map((e) => {
      const [x, y, width, height] = number(e, "x", "y", "width", "height");
      return metres(x + width / 2, y + height / 2);
    })[0],
    plane: number(side.querySelector("line.plane"), "x1", "y1", "x2", "y2"),
    side_pads: [...side.querySelectorAll("rect.pad")].map((e) => {
      const [x, y, width, height] = number(e, "x", "y", "width", "height");
      return [x + width / 2, y + height];
    }),
    side_bin: number(side.querySelector("circle.deciding"), "cx", "cy"),
    label: [...side.querySelectorAll("text.haloed")].map((t) => t.textContent),
  };
});
"""


def plane_height(pose, site, place):
    return pose["centre_z_m"] + pose["east"] * (place["x_m"] - site["x_m"]) + pose["north"] * (place["y_m"] - site["y_m"])


class HazardReport(PageTest):
    def make(self, source=None, config=NOISE, *arguments):
        """Makes the report of a map."""
        score = [] if "--no-truth" in arguments or source else ["--score", self.path("score.json")]
        self.succeed("hazard-map", source or self.chain.dem, "-c", self.config(config), "-o", self.path("h.h5"), "-O", "--sites",
                     self.path("sites.json"), "--report", self.path("hazards.html"), *score, *arguments)

    def report(self, *arguments):
        """Makes the report of a map and opens it; returns its layers and its sites."""
        self.make(*arguments)
        self.open("hazards.html")
        return self.results()

    def results(self):
        return columns(self.path("h.h5")), json.loads(read_bytes(self.path("sites.json")))["sites"]

    def data(self, path="report"):
        return self.window.run(f"return {path}")

    def check_page(self):
        self.check_log_and_requests()
        self.check_layout()


@unittest.skipIf(browser.missing(), browser.missing())
class CommonReport(CommonPage, HazardReport):
    def test_layers_are_those_of_the_file(self):
        layers, _ = self.report()
        self.check_parts(SECTIONS, MAPS, 2)
        dem = columns(self.chain.dem)
        region = ~np.isnan(layers["p_touchdown"])
        for name in MAPS:
            step = self.step(name)
            if name in ("safe", "outcome"):
                expected = np.where(region, 1 << layers[name].astype(int), 0)
            else:
                expected = {**dem, **layers}[name]
            if name.startswith("z_"):  # small holes are filled
                expected = np.where(np.isnan(expected), self.values(name, expected.shape), expected)
            np.testing.assert_allclose(self.values(name, expected.shape), expected, rtol=0, atol=0.501 * step, err_msg=name)
        self.check_page()

    def test_counts_and_shares(self):
        layers, _ = self.report()
        region = ~np.isnan(layers["p_touchdown"])
        total = np.count_nonzero(region)
        counts = {name: [np.count_nonzero(layers[name][region] == value) for value in range(5)] for name in ("safe", "outcome")}
        self.assertEqual([row[:2] for row in self.cells("#places .scroll > #places")],
                         [[name, f"{counts['safe'][value]:,}"] for name, value in (("safe", 1), ("hazard", 0), ("unknown", 2))])
        rows = self.cells("#outcomes")
        names = [("missed hazard", 2), ("false alarm", 3), ("hazard found", 0), ("safe found", 1), ("unknown", 4)]
        self.assertEqual([row[:2] for row in rows], [[name, f"{counts['outcome'][value]:,}"] for name, value in names])
        for row, (_, value) in zip(rows, names):
            self.assertAlmostEqual(float(row[2].split()[0]), 100 * counts["outcome"][value] / total, delta=0.006 * float(row[2].split()[0]))
        legend = self.window.run("return [...document.querySelectorAll('canvas[data-layer=outcome]')][0].closest('figure')"
                                 ".querySelectorAll('.legend span').length")
        self.assertEqual(legend, 5)
        score = json.loads(read_bytes(self.path("score.json")))
        missed = counts["outcome"][2] / (counts["outcome"][2] + counts["outcome"][0])
        self.assertAlmostEqual(score["missed_hazard_frac"], missed)
        self.assertIn(f"{float(f'{100 * missed:.3g}'):g} % of the true hazards are missed", self.text("#score"))
        self.assertEqual(self.data("report.score"), score)

    def test_wrong_places_are_painted_on_the_outcome(self):
        layers, _ = self.report()
        pixels = self.pixels("#maps canvas[data-layer=outcome]")
        wrong = {value: np.argwhere(layers["outcome"] == value) for value in (2, 3)}
        for value, color in ((2, [255, 0, 255]), (3, [0, 114, 178])):
            self.assertGreater(len(wrong[value]), 0)
            for row, col in wrong[value]:
                down = (1 - (row + 0.5) / layers["outcome"].shape[0]) * len(pixels)
                right = (col + 0.5) / layers["outcome"].shape[1] * pixels.shape[1]
                self.assertEqual(list(pixels[int(down), int(right)]), color)

    def test_the_sites_are_those_of_sites_json(self):
        _, sites = self.report()
        rows = [[cell.replace("\u2212", "-").lstrip("\u2265") for cell in row] for row in self.cells("#landing-sites")]
        self.assertEqual(len(rows), len(sites))
        for row, site in zip(rows, sites):
            expected = [site["rank"], site["x_m"], site["y_m"], site["cost"], site["p_touchdown"], site["p_safe"], site["slope_deg"],
                        100 * site["roughness_m"], site["distance_to_hazard_m"]]
            np.testing.assert_allclose([float(cell) for cell in row[:-1]], expected, atol=0.051)
            self.assertEqual(float(row[3]), float(f"{site['cost']:.4f}"))
            self.assertEqual(row[-1].split()[0], "safe" if site["true_safe"] else "hazard")
        self.assertEqual("\u2265: at least so much" in self.text("#sites"), any(site["p_capped"] for site in sites))
        self.assertIn(f"{sites[0]['p_touchdown']:.4f}", self.text("#verdict"))
        self.assertEqual(self.window.run("return document.querySelectorAll('#maps .reach').length"), 2)

    def test_the_cursor_is_on_all_maps_with_all_values(self):
        layers, sites = self.report()
        shown = self.values_under_cursor("cost", [layers["x"][40], layers["y"][57]])
        self.assertEqual(shown["safe"], ["hazard", "safe", "unknown"][layers["safe"][57, 40]])
        self.assertAlmostEqual(float(shown["p_touchdown"]), layers["p_touchdown"][57, 40], delta=1e-4)
        self.assertAlmostEqual(float(shown["slope"].split()[0]), layers["slope"][57, 40], delta=0.05)
        self.point("slope", [sites[0]["x_m"], sites[0]["y_m"]])
        crops = self.window.run("return panels.filter((p) => p.options.footprint && p.svg.querySelector('.cursor')).length")
        self.assertGreater(crops, 0)

    def test_limits_are_on_their_scales(self):
        self.report()
        scales = self.window.run("return Object.fromEntries(panels.filter((p) => p.options.region).map((p) => [p.raster.layer.name, "
                                 "[p.raster.layer.limit, p.scale.low, p.scale.high, p.svg.querySelectorAll('polygon.limit').length]]))")
        for name, (limit, low, high, marks) in scales.items():
            expected = {"slope": 14, "roughness": 0.08}.get(name.replace("_true", ""))
            self.assertEqual((limit, marks), (expected, 0 if expected is None else 1), name)
            if expected:
                self.assertTrue(low == 0 and high > 1.09 * expected, name)
        self.assertEqual(scales["p_safe"][1:3], [0, 1])
        self.assertEqual(scales["slope"][1:3], scales["slope_true"][1:3])
        self.assertIn("limit 14 deg", self.text("#maps"))

    def test_the_score_is_drawn(self):
        self.report()
        score = self.data("report.score")
        charts = self.window.run("return [...document.querySelectorAll('#score figure.chart')].map("
                                 "(f) => [f.querySelector('figcaption').textContent, f.querySelectorAll(':scope > svg circle').length])")
        known = sum(a is not None and b is not None for a, b in zip(score["roc"]["missed_hazard_frac"], score["roc"]["false_alarm_frac"]))
        classes = sum(share is not None for share in score["reliability"]["safe_frac"])
        self.assertEqual(charts, [["Other roughness limits of the map", known], ["Reliability of p_safe", classes]])


@unittest.skipIf(browser.missing(), browser.missing())
class OtherReports(HazardReport):
    def check_poses(self, sites, legs):
        """The poses of the data explain slope and roughness, and are what is drawn."""
        for site, listed in zip(self.data("report.sites"), sites):
            poses = site["poses"]
            self.assertAlmostEqual(poses["steepest"]["slope_deg"], listed["slope_deg"], places=9)
            self.assertAlmostEqual(poses["roughest"]["roughness_m"], listed["roughness_m"], places=9)
            drawn = self.window.run(POSE, site["rank"])
            keys = ["steepest", "roughest"] if len(drawn) == 2 else ["roughest"]
            for key, figure in zip(keys, drawn):
                pose = poses[key]
                self.assertEqual(len(pose["pads"]), legs)
                self.assertEqual(sum(pad["touches"] for pad in pose["pads"]), min(legs, 3))
                np.testing.assert_allclose([pad[:2] for pad in figure["pads"]], [[p["x_m"], p["y_m"]] for p in pose["pads"]] or
                                           np.empty((0,)), atol=1e-6)
                self.assertEqual([pad[2] for pad in figure["pads"]], [not pad["touches"] for pad in pose["pads"]])
                np.testing.assert_allclose(figure["bin"], [pose["highest"]["x_m"], pose["highest"]["y_m"]], atol=1e-6)
                above = pose["highest"]["z_m"] - plane_height(pose, site, pose["highest"])
                distance = abs(above) * math.cos(math.radians(pose["slope_deg"]))
                self.assertAlmostEqual(distance, abs(pose["roughness_m"]), places=9)
                self.check_side(figure, pose)

    def check_side(self, figure, pose):
        """The plane is a line, on which every pad lies; the deciding bin lies above it as far as it does."""
        x1, y1, x2, y2 = figure["plane"]
        on = lambda x: y1 + (y2 - y1) * (x - x1) / (x2 - x1)
        for x, y in figure["side_pads"]:
            self.assertAlmostEqual(y, on(x), delta=0.05)
        x, y = figure["side_bin"]
        if pose["roughness_m"] > 1e-3 and pose["pads"]:
            self.assertLess(y, on(x))

    def test_the_lander_stands_in_its_worst_poses(self):
        for name, config, legs in (("four legs", NOISE, 4), ("three legs", with_values(NOISE, lander__legs=3), 3),
                                   ("plane", with_values(NOISE, method="plane", limits__roughness_m=0.12), 0)):
            with self.subTest(name):
                _, sites = self.report(None, config)
                self.assertGreater(len(sites), 2)
                self.check_poses(sites, legs)
                titles = [title.split(": ")[1] for title in self.texts(".site h3")]
                self.assertEqual(set(titles) <= ({"fitted plane"} if legs == 0 else
                                                 {"steepest pose", "roughest pose", "steepest and roughest pose"}), True, titles)
                self.check_page()

    def test_without_truth_and_p_safe(self):
        _, sites = self.report(None, HAZARD, "--no-truth")
        self.assertEqual(self.maps(), ["safe", "p_touchdown", "cost", "distance_to_hazard", "slope", "roughness", "z_est"])
        self.assertIsNone(self.text("#score"))
        self.assertIsNone(self.text("#outcomes"))
        self.assertEqual([len(row) for row in self.cells("#landing-sites")], [7] * len(sites))
        self.check_page()

    def test_truth_without_p_safe(self):
        self.report(None, HAZARD)
        self.assertEqual(self.texts("#score figcaption"), ["Other roughness limits of the map"])
        self.check_log_and_requests()

    def test_a_terrain(self):
        self.report(self.chain.terrain, HAZARD)
        self.assertEqual(self.maps()[-1], "z")
        self.assertIn("of terrain", self.text("header .note"))
        self.check_page()

    def test_no_safe_place(self):
        _, sites = self.report(None, with_values(HAZARD, limits__slope_deg=0.01))
        self.assertEqual(sites, [])
        self.assertIn("No landing site", self.text("#sites"))
        self.assertEqual(self.window.run("return document.getElementById('verdict').className"), "banner fail")
        self.assertEqual(self.window.run("return document.querySelectorAll('.site').length"), 0)
        self.check_page()

    def test_only_the_best_sites_are_drawn(self):
        _, sites = self.report(None, with_values(HAZARD, sites__count=12, sites__separation_m=0.3))
        self.assertEqual(len(sites), 12)
        self.assertEqual(len(self.cells("#landing-sites")), 12)
        ranks = self.window.run("return [...document.querySelectorAll('.site')].map((s) => Number(s.dataset.rank))")
        self.assertEqual(sorted(set(ranks)), list(range(1, 11)))
        self.check_log_and_requests()

    def test_a_method_without_poses(self):
        self.make(None, HAZARD)
        page = read_bytes(self.path("hazards.html")).decode()
        begin = page.index('id="report-data">') + len('id="report-data">')
        end = page.index("</script>", begin)
        data = json.loads(page[begin:end])
        for site in data["sites"]:
            site["poses"] = None
        self.write("bare.html", page[:begin] + json.dumps(data) + page[end:])
        self.open("bare.html")
        self.assertIn("without a pose", self.text("#no-poses"))
        self.assertEqual(self.window.run("return document.querySelectorAll('.site').length"), 0)
        self.check_log_and_requests()

    def test_truth_that_is_nowhere_known(self):
        dem = self.path("blind.h5")
        self.succeed("regrid", self.chain.scan, "-c", self.config(REGRID, "r.json"), "--terrain", self.chain.terrain, "-o", dem)
        with h5py.File(dem, "r+") as file:
            file["z_true"][...] = np.nan
        self.report(dem, HAZARD)
        self.assertIn("No diagram", self.text("#score"))
        self.check_page()


if __name__ == "__main__":
    unittest.main()
