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

from harness import EVAL, HAZARD, REGRID, browser, with_values
from harness.page import CANVAS, WIDTHS, PageTest

ROOT = os.environ["LANDFALL_ROOT"]
PRINT_WIDTH = 702  # A4 less two margins of 12 mm, pixels of 1/96 inch
DRAWS_CONFIG = {"draws": 4, "metrics": "full", "regrid": REGRID, "eval": with_values(EVAL, limits__relative_elevation_m=0.12), "hazard": HAZARD,
            "vary": {"scan.noise.range_sigma_m": {"type": "uniform", "low": 0.005, "high": 0.08}}}
STUDY = {"title": "Range noise", "base": {
    "terrain": {"grid": {"half_width_m": 6, "resolution_m": 0.1}},
    "scan": {"laser": {"scan_time_s": 0.02}, "scanner": {"pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}}},
    "regrid": {"half_width_m": 5, "resolution_m": 0.1}, "eval": {"region_radius_m": 3.5, "footprint_m": 0.7}},
    "axes": [{"key": "scan.noise.range_sigma_m", "list": [0.01, 0.05]}]}
IMAGES = """
return [...document.querySelectorAll("main img")].map((image) => image.complete && image.naturalWidth > 0);
"""


@unittest.skipIf(browser.missing(), browser.missing())
class ScreensTest(PageTest):
    def keep(self, name, content):
        folder = os.environ.get("LANDFALL_SCREENS")
        if folder:
            os.makedirs(folder, exist_ok=True)
            with open(os.path.join(folder, name), "wb") as file:
                file.write(content)

    def media(self, kind, scheme="light"):
        self.window.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": kind, "features": [{"name": "prefers-color-scheme", "value": scheme}]})

    def picture(self, name):
        """Keeps a picture of the whole page; to take one costs more than all checks."""
        if "LANDFALL_SCREENS" not in os.environ:
            return
        path = self.path("screen.png")
        self.window.picture(path)
        with open(path, "rb") as file:
            self.keep(name, file.read())

    def check_boxes(self, where):
        super().check_boxes(where)
        for canvas in self.window.run("return [...document.querySelectorAll('canvas')].filter((c) => c.getBoundingClientRect().width > 0)"):
            self.assertGreater(self.window.run(CANVAS, canvas)["colors"], 1, where)
        self.assertNotIn(False, self.window.run(IMAGES), where)

    def check_page(self, page):
        name = os.path.splitext(os.path.basename(page))[0]
        self.media("screen")
        self.open(page)
        self.assertGreater(self.window.run("return document.querySelectorAll('svg, canvas').length"), 0)
        for scheme in ("light", "dark"):
            self.media("screen", scheme)
            for width in WIDTHS:
                self.window.resize(width)
                self.check_boxes(f"{name}, {scheme}, {width} px")
                self.picture(f"{name}-{scheme}-{width}.png")
        self.media("print")
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

    def test_hazards(self):
        self.succeed("hazard-map", *self.chain.inputs("hazard-map"), "--report", self.path("hazards.html"))
        self.check_page("hazards.html")

    def test_draws(self):
        self.succeed("monte-carlo", self.chain.source, "--terrain", self.chain.terrain, "-c", self.config(DRAWS_CONFIG), "-o", self.path("d.h5"),
                     "--report", self.path("draws.html"))
        self.check_page("draws.html")

    def test_a_study(self):
        with open(self.path("noise.json"), "w", encoding="ascii") as file:
            json.dump(STUDY, file)
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
        with open(self.path("report.pdf"), "rb") as file:
            printed = file.read()
        self.assertGreater(images_in(printed), 10)
        self.assertEqual(images_in(printed), images_in(waited))


def images_in(pdf):
    """Maps are images, diagrams are not."""
    return len(re.findall(rb"/Subtype\s*/Image", pdf))


if __name__ == "__main__":
    unittest.main()
