# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of a scan's points in a browser: points drawn, click, box, colours, schemes, and that it requests no other file."""
import unittest

import h5py
import numpy as np

from harness import browser, returns_of
from harness.page import PageTest

# A click, or a drag, from and to a fraction of the canvas.
POINTER = """
const [from, to, shift] = arguments, canvas = document.getElementById("points"), box = canvas.getBoundingClientRect();
canvas.setPointerCapture = () => {};
const event = (type, [x, y], buttons) => canvas.dispatchEvent(new PointerEvent(type, {pointerId: 1, button: 0, buttons, bubbles: true,
  shiftKey: shift, clientX: box.left + x * box.width, clientY: box.top + y * box.height}));
event("pointerdown", from, 1);
if (from.some((value, k) => value !== to[k])) event("pointermove", to, 1);
event("pointerup", to, 0);
"""
SET = "const field = document.querySelector(arguments[0]); field.value = arguments[1]; field.dispatchEvent(new Event('change'));"
COLORS = "return [...document.querySelectorAll('#color option')].map((o) => o.value)"
TRUTH = ["e_z", "e_horizontal", "e_range"]
MAGENTA = (255, 0, 255)


@unittest.skipIf(browser.missing(), browser.missing())
class CloudTest(PageTest):
    def cloud(self, scan=None, *arguments):
        """Opens the page of a scan."""
        self.succeed("landfall-export", scan or self.chain.scan, "-o", self.path("scan.html"), "-O", *arguments)
        self.open("scan.html")
        self.clicks = 0

    def drawn(self, selector="#points"):
        """The fraction of the canvas that shows points."""
        self.settle()
        return super().drawn(selector)[0]

    def color(self, name):
        self.window.run(SET, "#color", name)
        self.window.wait(f"return document.getElementById('points').dataset.color === '{name}'", 10)
        self.settle()

    def click(self, x=0.5, y=0.5):
        self.clicks += 1
        self.window.run(POINTER, [x, y], [x, y], False)
        self.window.wait("return document.getElementById('choice').dataset.clicks === arguments[0]".replace("arguments[0]", f"'{self.clicks}'"), 10)
        self.settle()

    def chosen(self):
        """The shown values of the point that was clicked on."""
        return self.window.run("return Object.fromEntries([...document.querySelectorAll('#chosen tr')].map("
                               "(row) => [row.dataset.column, row.cells[1].textContent]))")

    @staticmethod
    def number(text):
        """In metres, seconds, or as it is."""
        value, *unit = text.split()
        return float(value.replace("\u2212", "-")) * {"cm": 0.01, "mm": 0.001}.get("".join(unit), 1)

    def test_points_are_drawn_in_the_colours_of_every_column(self):
        self.cloud()
        self.assertGreater(self.drawn(), 0.1)
        self.assertGreater(self.canvas("#points")["colors"], 20)
        self.assertEqual(self.window.run(COLORS), ["z_est", *TRUTH, "range_measured", "t", "status", "pulse", "pixel"])
        seen = {}
        for name in self.window.run(COLORS):
            self.color(name)
            seen.setdefault(self.canvas("#points")["sum"], name)
            self.assertGreater(self.drawn(), 0.1, name)
        self.assertEqual(len(seen), 8, seen)  # time and pulse grow alike
        count = len(returns_of(self.chain.scan)["x_est"])
        self.assertEqual(self.text("#thinning"), f"All {count:,} returns of the scan are shown.")
        self.check_log_and_requests()
        self.check_layout()

    def test_a_click_shows_the_values_of_the_file(self):
        self.cloud()
        self.click()
        shown = self.chosen()
        points = returns_of(self.chain.scan)
        mine = (points["pulse"] == int(shown["pulse"])) & (points["pixel"] == int(shown["pixel"]))
        self.assertEqual(mine.sum(), 1)
        row = int(np.flatnonzero(mine)[0])
        for name in ("x_est", "y_est", "z_est", "range_measured", "range_true"):
            self.assertAlmostEqual(self.number(shown[name]), points[name][row], delta=2e-3, msg=name)
        self.assertAlmostEqual(self.number(shown["e_range"]), points["range_measured"][row] - points["range_true"][row], delta=1e-3)
        with h5py.File(self.chain.scan) as file:
            self.assertAlmostEqual(self.number(shown["t"]), file["pulses/t"][int(shown["pulse"])] - file["pulses/t"][0], delta=1e-6)
        self.assertEqual(shown["status"], "return")
        others = int((points["pulse"] == int(shown["pulse"])).sum()) - 1
        self.assertTrue(self.text("#siblings").startswith(f"{others} other returns of its pulse are"), self.text("#siblings"))
        self.assertGreater(self.share("#points", MAGENTA) * self.pixels("#points")[..., 0].size, 5 * others)
        self.click(0.01, 0.01)
        self.assertIn("No point there.", self.text("#choice"))
        self.assertEqual(self.share("#points", MAGENTA), 0)
        self.check_log_and_requests()

    def test_it_opens_on_elevations_from_above(self):
        self.cloud()
        self.assertEqual(self.window.run("return [document.getElementById('points').dataset.color, document.getElementById('color').value]"), ["z_est"] * 2)
        self.assertIn("Elevation", self.text("#points-legend"))
        places = []
        for x, y in ((0.4, 0.5), (0.6, 0.5), (0.5, 0.4)):
            self.click(x, y)
            places.append([self.number(self.chosen()[name]) for name in ("x_est", "y_est")])
        west, east, north = places
        self.assertGreater(east[0], west[0])
        self.assertGreater(north[1], (west[1] + east[1]) / 2)

    def noisy(self, change):
        """The page of a scan whose elevations are the true ones and change(random numbers, their count), with large points seen from the side."""
        def noise(file):
            points, count = file["points"], len(file["points/z_est"])
            points["z_est"][...] = points["z_true"][()] + change(np.random.default_rng(1), count)
        self.cloud(self.changed(self.chain.scan, noise))
        self.window.run("const field = document.getElementById('dots'); field.value = '0.5'; field.dispatchEvent(new Event('input'));")
        self.window.run(POINTER, [0.5, 0.5], [0.5, 0.35], False)

    def test_points_in_front_are_not_those_with_the_largest_errors(self):
        self.noisy(lambda random, count: random.normal(0, 0.1, count))
        self.color("e_z")
        shown = self.window.run("const column = columnOf('e_z'), scale = scaleOf(column);"
                                "return Array.from({length: report.count}, (_, i) => colorOf(scale, column.value(i)))")
        pixels = self.pixels("#points").reshape(-1, 3).astype(float)
        pixels = pixels[(pixels != pixels[0]).any(-1)]
        red = [(colors[:, 0] > colors[:, 2]).mean() for colors in (np.array(shown, float), pixels)]
        self.assertGreater(len(pixels), 20000)
        self.assertAlmostEqual(red[0], red[1], delta=0.06)  # 0.16 where the nearest of some depths is in front

    def test_near_points_hide_far_ones(self):
        self.noisy(lambda random, count: 4.0 * random.integers(0, 2, count))
        self.window.run("document.querySelector('#cloud button:last-child').click()")  # from above again
        self.settle()
        low, high = self.window.run("const scale = scaleOf(columnOf('z_est')); return [colorOf(scale, scale.low + 0.5), colorOf(scale, scale.high - 0.5)]")
        pixels = self.pixels("#points").reshape(-1, 3).astype(float)
        pixels = pixels[(pixels != pixels[0]).any(-1)]
        below = np.abs(pixels - low).sum(-1) < np.abs(pixels - high).sum(-1)
        self.assertLess(below.mean(), 0.05)

    def test_a_box_cuts_the_cloud(self):
        self.cloud()
        whole = self.drawn()
        points = returns_of(self.chain.scan)
        self.window.run(SET, "#box tbody tr:nth-child(1) td:nth-child(2) input", "0.5")
        self.window.run(SET, "#box tbody tr:nth-child(2) td:nth-child(3) input", "-0.25")
        step = self.window.run("return Math.max(...report.layers.slice(0, 2).map((l) => l.step))")
        inside = [int(((points["x_est"] >= 0.5 + d) & (points["y_est"] <= -0.25 - d)).sum()) for d in (step, -step)]
        shown = int(self.text("#inside").split()[0].replace(",", ""))
        self.assertTrue(inside[0] <= shown <= inside[1], f"{shown} {inside}")
        self.assertGreater(self.drawn(), 0.5 * whole, "the box fills the view")
        inside = points["z_est"][(points["x_est"] >= 0.5) & (points["y_est"] <= -0.25)]
        ends = self.window.run("const scale = scaleOf(columnOf('z_est')); return [scale.low, scale.high]")
        legend = [float(text.replace("\u2212", "-")) for text in self.texts("#points-legend text")]
        self.assertLess(np.ptp(inside), np.ptp(ends))
        self.assertTrue(all(inside.min() - 0.01 <= value <= inside.max() + 0.01 for value in legend), (legend, inside.min(), inside.max()))
        self.window.run("document.getElementById('whole').click()")
        self.assertAlmostEqual(self.drawn(), whole, delta=0.001)
        self.click()
        self.window.run("[...document.querySelectorAll('#choice button')].at(-1).click()")
        around = int(self.text("#inside").split()[0].replace(",", ""))
        self.assertTrue(0 < around < len(points["x_est"]) / 10, around)
        self.window.run(SET, "#box tbody tr:nth-child(1) td:nth-child(2) input", "")
        self.assertEqual(int(self.text("#inside").split()[0].replace(",", "")), around)
        self.check_log_and_requests()
        self.check_layout()

    def test_the_view_turns_moves_and_zooms(self):
        self.cloud()
        self.settle()
        seen = {self.canvas("#points")["sum"]}
        share = self.drawn()
        for act in (lambda: self.window.run(POINTER, [0.5, 0.5], [0.6, 0.5], False), lambda: self.window.run(POINTER, [0.5, 0.5], [0.6, 0.6], True)):
            act()
            self.settle()
            seen.add(self.canvas("#points")["sum"])
        self.assertEqual(len(seen), 3)
        key = "document.getElementById('points').dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0]}))"
        for _ in range(20):
            self.window.run(key, "-")
        self.assertLess(self.drawn(), 0.5 * share)
        self.window.run("[...document.querySelectorAll('#cloud button')].find((b) => b.textContent === 'reset the view').click()")
        self.assertAlmostEqual(self.drawn(), share, delta=1e-9)
        self.assertIsNone(self.text("#chosen"), "a drag is not a click")
        self.check_log_and_requests()

    def test_both_schemes(self):
        self.cloud()
        for scheme, low, high in (("light", 200, 255), ("dark", 0, 60)):
            self.scheme(scheme)
            background = self.pixels("#points")[0, 0]
            self.assertTrue(low < background.min() and background.max() < high + 1, f"{scheme} {background}")
            self.assertGreater(self.drawn(), 0.1, scheme)

    def test_a_thinned_cloud_says_so(self):
        self.cloud(None, "--max-points", "500")
        count = len(returns_of(self.chain.scan)["x_est"])
        shown = self.window.run("return report.count")
        self.assertTrue(300 < shown <= 500, shown)
        self.assertRegex(self.text("#thinning"), rf"^{shown} of the scan's {count:,} returns are shown: one at random of each cell of [\d.]+ c?m, seen from above\.")
        self.assertGreater(self.drawn(), 0.001)
        self.check_log_and_requests()

    def test_an_imported_scan(self):
        def change(file):
            for name in list(file["points"]):
                if name not in ("x_est", "y_est", "z_est"):
                    del file["points"][name]
            del file["pulses"]
        self.cloud(self.changed(self.chain.scan, change))
        self.assertEqual(self.window.run(COLORS), ["z_est"])
        self.assertGreater(self.drawn(), 0.1)
        self.click()
        self.assertEqual(list(self.chosen()), ["x_est", "y_est", "z_est"])
        self.assertEqual(self.text("#siblings"), "The file has no pulse numbers.")
        self.check_log_and_requests()

    def test_an_imported_scan_with_times_and_intensities(self):
        def change(file):
            count = len(file["points/x_est"])
            for name in [name for name in file["points"] if name.endswith("_true") or name == "range_measured"]:
                del file["points"][name]
            del file["pulses"]
            for name, values in (("t", 1.4e9 + 0.001 * np.arange(count)), ("intensity", np.float32(np.arange(count) % 7)),
                                 ("return_number", np.int8(1 + np.arange(count) % 3))):
                file["points"].create_dataset(name, data=values)
        self.cloud(self.changed(self.chain.scan, change))
        self.assertEqual(self.window.run(COLORS), ["z_est", "t", "status", "intensity", "return_number", "pulse", "pixel"])
        self.color("intensity")
        self.click()
        shown = self.chosen()
        rows = returns_of(self.path("changed.h5"))
        row = int(np.flatnonzero((rows["pulse"] == int(shown["pulse"])) & (rows["pixel"] == int(shown["pixel"])))[0])
        self.assertAlmostEqual(self.number(shown["t"]), 0.001 * row, delta=1e-5)
        self.assertEqual(int(shown["return_number"]), rows["return_number"][row])
        self.assertEqual(float(shown["intensity"]), rows["intensity"][row])
        self.check_log_and_requests()
        self.check_layout()


if __name__ == "__main__":
    unittest.main()
