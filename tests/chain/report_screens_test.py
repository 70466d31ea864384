#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""All reports as readers see them: at 1400 and 800 px, light and dark, and in print.

Nothing overlaps, nothing is wider than the page, no drawing is empty, and one command prints all of it. LANDFALL_SCREENS=DIR keeps the pictures and PDFs, to be looked at.
"""
import base64
import json
import os
import re
import subprocess
import unittest

from harness import EVAL, HAZARD, REGRID, ROOT, browser, read_bytes, with_values, write_file
from harness.page import CANVAS, IMAGES, WIDTHS, PageTest

PRINT_WIDTH = 702  # A4 less two margins of 12 mm, pixels of 1/96 inch
DRAWS_CONFIG = {"draws": 4, "metrics": "full", "regrid": REGRID, "eval": with_values(EVAL, limits__relative_elevation_m=0.12), "hazard": HAZARD,
            "vary": {"scan.noise.range_sigma_m": {"type": "uniform", "low": 0.005, "high": 0.08}}}
STUDY = {"title": "Range noise", "base": {
    "terrain": {"grid": {"half_width_m": 6, "resolution_m": 0.1}},
    "scan": {"laser": {"scan_time_s": 0.02}, "scanner": {"pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}}},
    "regrid": {"half_width_m": 5, "resolution_m": 0.1}, "eval": {"region_radius_m": 3.5, "footprint_m": 0.7}},
    "axes": [{"key": "scan.noise.range_sigma_m", "values": [0.01, 0.05]}]}
CLICK = """
const canvas = document.getElementById("points"), box = canvas.getBoundingClientRect();
canvas.setPointerCapture = () => {};
for (const [type, buttons] of [["pointerdown", 1], ["pointerup", 0]])
  canvas.dispatchEvent(new PointerEvent(type, {pointerId: 1, button: 0, buttons, bubbles: true, clientX: box.left + box.width / 2,
                                               clientY: box.top + box.height / 2}));
"""


@unittest.skipIf(browser.missing(), browser.missing())
class ScreensTest(PageTest):
    def keep(self, name, content):
        folder = os.environ.get("LANDFALL_SCREENS")
        if folder:
            os.makedirs(folder, exist_ok=True)
            write_file(os.path.join(folder, name), content)

    def picture(self, name):
        """Keeps a picture of the whole page; to take one costs more than all checks."""
        if "LANDFALL_SCREENS" not in os.environ:
            return
        path = self.path("screen.png")
        self.window.picture(path)
        self.keep(name, read_bytes(path))

    def check_boxes(self, where):
        super().check_boxes(where)
        for canvas in self.window.run("return [...document.querySelectorAll('canvas')].filter((c) => c.getBoundingClientRect().width > 0)"):
            self.assertGreater(self.window.run(CANVAS, canvas)["colors"], 1, where)
        self.assertNotIn(False, self.window.run(IMAGES), where)

    def check_page(self, page, prepare=""):
        """`prepare` is a script that runs on the open page."""
        name = os.path.splitext(os.path.basename(page))[0]
        self.scheme("light", "screen")
        self.open(page)
        self.window.run(prepare)
        self.assertGreater(self.window.run("return document.querySelectorAll('svg, canvas').length"), 0)
        for scheme in ("light", "dark"):  # which have the same layout
            self.scheme(scheme, "screen")
            self.check_contrast(f"{name}, {scheme}")
            for width in WIDTHS if scheme == "light" or "LANDFALL_SCREENS" in os.environ else WIDTHS[-1:]:
                self.window.resize(width)
                self.check_boxes(f"{name}, {scheme}, {width} px")
                self.picture(f"{name}-{scheme}-{width}.png")
        self.scheme("light", "print")
        self.window.resize(PRINT_WIDTH)
        self.check_boxes(f"{name}, print")
        self.picture(f"{name}-print.png")
        pdf = base64.b64decode(self.window.driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True, "preferCSSPageSize": True})["data"])
        self.keep(f"{name}.pdf", pdf)
        self.assertTrue(pdf.startswith(b"%PDF"))
        self.check_log_and_requests()

    def test_the_evaluation(self):
        self.succeed("dem-eval", *self.chain.inputs("dem-eval"), "--report", self.path("evaluation.html"))
        self.check_page("evaluation.html")

    def test_a_comparison(self):
        """Files of each kind are compared; the last page is the one that is looked at."""
        self.succeed("dem-eval", *self.chain.inputs("dem-eval"), "-o", self.path("other.h5"), "--set", "limits.relative_elevation_m=0.01")
        for a, b in ((self.chain.terrain,) * 2, (self.chain.scan,) * 2, (self.chain.dem,) * 2, (self.chain.hazards,) * 2, (self.chain.draws,) * 2,
                     (self.chain.eval, self.path("other.h5"))):
            self.succeed("landfall-info", "--compare", a, b, "--report", self.path("comparison.html"), "-O")
            self.open("comparison.html")
            self.assertEqual(self.text("#message"), "")
        self.check_page("comparison.html")
        answer = json.loads(self.succeed("landfall-info", "--compare", a, b, "--json").stdout)["answer"]
        self.assertEqual(self.text("#verdict"), answer["sentence"])
        self.assertEqual(self.texts("#answer-points li"), [f"{point['name']}: {point['text']}" for point in answer["points"]])
        self.assertEqual(len(self.texts("#maps canvas")), 3 * 6 + 2)  # fail has no difference

    def test_hazards(self):
        self.succeed("hazard-map", *self.chain.inputs("hazard-map"), "--report", self.path("hazards.html"))
        self.check_page("hazards.html")

    def test_a_cloud(self):
        """With the values of a point that was clicked on."""
        self.succeed("landfall-export", self.chain.scan, "-o", self.path("cloud.html"))
        self.check_page("cloud.html", CLICK)

    def test_draws(self):
        self.succeed("monte-carlo", self.chain.source, "--terrain", self.chain.terrain, "-c", self.config(DRAWS_CONFIG), "-o", self.path("d.h5"),
                     "--report", self.path("draws.html"))
        self.check_page("draws.html")

    def test_a_study(self):
        self.write("noise.json", json.dumps(STUDY))
        environment = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
        subprocess.run(["make", "-C", ROOT, "-f", "Makefile.studies", "study", f"STUDY={self.path('noise.json')}", f"RUNS={self.path('runs')}",
                        f"BIN={os.environ['LANDFALL_BIN']}"], check=True, capture_output=True, env=environment)
        self.check_page("runs/studies/noise/report.html")

    def test_one_command_prints_a_complete_pdf(self):
        """The command of docs/user/report.md: as many images as a browser prints that waits until all is drawn."""
        self.succeed("dem-eval", *self.chain.inputs("dem-eval"), "--report", self.path("report.html"))
        self.open("report.html")
        waited = base64.b64decode(self.window.driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True, "preferCSSPageSize": True})["data"])
        subprocess.run([browser.CHROMIUM, "--headless", "--no-sandbox", f"--user-data-dir={self.path('profile')}", "--no-pdf-header-footer", "--virtual-time-budget=20000",
                        f"--print-to-pdf={self.path('report.pdf')}", self.path("report.html")], check=True, capture_output=True, timeout=120)
        printed = read_bytes(self.path("report.pdf"))
        self.assertGreater(images_in(printed), 10)
        self.assertEqual(images_in(printed), images_in(waited))


def images_in(pdf):
    """Maps are images, diagrams are not."""
    return len(re.findall(rb"/Subtype\s*/Image", pdf))


if __name__ == "__main__":
    unittest.main()
