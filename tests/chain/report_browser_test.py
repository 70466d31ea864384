# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of dem-eval in a browser: its numbers and drawings, and that it requests no other file."""
import json
import math
import unittest

import h5py
import numpy as np

from harness import EVAL, REGRID, Chain, ToolTest, browser

WIDTHS = (1400, 800)
SECTIONS = ["requirements", "maps", "view-3d", "worst", "holes", "errors", "uncertainty", "provenance-chain"]
MAPS = ["z_est", "z_true", "count", "e_x", "e_y", "e_z", "abs_x", "abs_y", "abs_z", "rel_x", "rel_y", "rel_z", "invalid",
        "fail"]

UNCERTAINTY = ["--uncertainty", "--navigation-sigma", "position_m=0.05", "--navigation-sigma", "velocity_mps=0.1",
               "--navigation-sigma", "rpy_rad=0.0002", "--navigation-sigma", "rpy_rate_radps=0.001"]

# The number of different colours in a canvas, and a checksum of its pixels.
CANVAS = """
const canvas = arguments[0], flat = document.createElement("canvas");
Object.assign(flat, {width: canvas.width, height: canvas.height});
const context = flat.getContext("2d");
context.drawImage(canvas, 0, 0);
const data = new Uint32Array(context.getImageData(0, 0, flat.width, flat.height).data.buffer);
let sum = 0;
for (const pixel of data) sum = (Math.imul(sum, 31) + pixel) | 0;
return {colors: new Set(data).size, sum};
"""
# The fraction of a map's pixels with the colour [r, g, b].
SHARE = """
const canvas = document.querySelector(`#maps canvas[data-layer=${arguments[0]}]`);
const flat = document.createElement("canvas");
Object.assign(flat, {width: canvas.width, height: canvas.height});
const context = flat.getContext("2d", {willReadFrequently: true});
context.drawImage(canvas, 0, 0);
const data = context.getImageData(0, 0, canvas.width, canvas.height).data;
let found = 0;
for (let i = 0; i < data.length; i += 4) found += arguments[1].every((c, k) => c === data[i + k]) ? 1 : 0;
return found / (canvas.width * canvas.height);
"""
# The fractions of the 3-D view's pixels, and of its border pixels, that show the DEM.
VIEW = """
const canvas = document.getElementById("terrain"), flat = document.createElement("canvas");
const {width, height} = Object.assign(flat, {width: canvas.width, height: canvas.height});
const context = flat.getContext("2d", {willReadFrequently: true});
context.drawImage(canvas, 0, 0);
const data = new Uint32Array(context.getImageData(0, 0, width, height).data.buffer);
let all = 0, border = 0;
data.forEach((pixel, i) => {
  if (pixel === data[0]) return;
  const x = i % width, y = Math.floor(i / width);
  ++all;
  if (x === 0 || y === 0 || x === width - 1 || y === height - 1) ++border;
});
return [all / data.length, border];
"""
# Pairs of texts that overlap, in a diagram or on the page, and elements wider than the page.
LAYOUT = """
const boxes = (list) => [...list].map((e) => ({text: e.textContent, box: e.getBoundingClientRect()}))
    .filter(({box}) => box.width > 0);
const cross = ({box: a}, {box: b}) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 &&
    b.top < a.bottom - 1;
const pairs = [];
for (const svg of document.querySelectorAll("svg")) {
  const texts = boxes(svg.querySelectorAll("text:not(.haloed)"));
  texts.forEach((a, i) => texts.slice(i + 1).forEach((b) => { if (cross(a, b)) pairs.push([a.text, b.text]); }));
}
const page = document.documentElement;
const wide = [...document.querySelectorAll("body *")].filter((e) => !e.closest(".scroll") && !e.closest("pre") &&
    !e.closest("svg.sample") && e.getBoundingClientRect().right > page.clientWidth + 0.5);
for (const e of document.querySelectorAll(".scroll")) if (e.scrollWidth > e.clientWidth) wide.push(e);
return {pairs, scroll: page.scrollWidth - page.clientWidth,
        wide: wide.map((e) => e.tagName + "." + e.className + "#" + e.id + ": " + e.textContent.slice(0, 40))};
"""


def shown(value, unit="", percent=False):
    """A number as the table of requirements shows it."""
    if value is None:
        return "\u2013"
    text = ("\u2212" if value < 0 else "") + f"{abs(100 * value if percent else value):.6g}"
    return "1 bin" if unit == "bins" and text == "1" else f"{text} {unit}".strip()


def expected_rows(metrics):
    rows = []
    for name, unit, sign in [("coverage", "%", 1), ("hole_size", "bins", 1), ("hole_distance", "bins", 1),
                             ("relative_elevation", "", 1), ("relative_horizontal", "", 1),
                             ("absolute_horizontal", "%", -1)]:
        r = metrics["requirements"][name]
        margin = None if r["value"] is None else sign * (r["limit"] - r["value"])
        rows.append([name, shown(r["value"], unit, unit == "%"),
                     ("at most " if sign > 0 else "at least ") + shown(r["limit"], unit, unit == "%"),
                     shown(margin or (None if margin is None else 0), unit, unit == "%"),
                     {True: "pass", False: "FAIL", None: "not judged"}[r["pass"]]])
    return rows


@unittest.skipIf(browser.missing(), browser.missing())
class ReportTest(ToolTest):
    """All tests use one case and one browser."""

    @classmethod
    def setUpClass(cls):
        cls.chain = Chain()
        cls.window = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.window.close()
        cls.chain.remove()

    def report(self, dem=None, *arguments):
        """Opens the report of a DEM; returns its metrics."""
        config = self.config(EVAL)
        self.succeed("dem-eval", dem or self.chain.dem, "-c", config, "-o", self.path("eval.h5"), "-O", "--metrics",
                     self.path("metrics.json"), "--report", self.path("report.html"), *arguments)
        self.window.driver.get_log("browser")
        self.window.requests()
        self.window.resize(WIDTHS[0])
        self.window.open(self.path("report.html"))
        with open(self.path("metrics.json"), encoding="utf-8") as file:
            return json.load(file)

    def text(self, selector):
        return self.window.run("return document.querySelector(arguments[0])?.textContent ?? null", selector)

    def cells(self, table):
        return self.window.run("return [...document.querySelectorAll(arguments[0] + ' tbody tr')]"
                               ".map((row) => [...row.cells].map((cell) => cell.textContent))", table)

    def canvas(self, selector):
        element = self.window.run("return document.querySelector(arguments[0])", selector)
        return self.window.run(CANVAS, element)

    def check_log_and_requests(self):
        """Checks that the browser logged no error and requested the file only."""
        errors = [entry for entry in self.window.driver.get_log("browser") if "GL Driver Message" not in entry["message"]]
        self.assertEqual(errors, [])
        self.assertEqual({url.split(":")[0] for url in self.window.requests()}, {"file"})
        self.assertEqual(self.text("#message"), "")

    def check_layout(self):
        for width in WIDTHS:
            self.window.resize(width)
            layout = self.window.run(LAYOUT)
            self.assertEqual(layout, {"pairs": [], "scroll": 0, "wide": []}, f"{width} px")

    def test_numbers_are_those_of_metrics_json(self):
        metrics = self.report()
        self.assertEqual([row[:1] + row[2:] for row in self.cells("#verdicts")], expected_rows(metrics))
        self.assertEqual(self.text("#verdict").split(":")[0], "pass" if metrics["pass"] else "FAIL")
        self.assertEqual(self.window.run("return [...document.querySelectorAll('main > section')].map((s) => s.id)"),
                         [s for s in SECTIONS if s != "uncertainty"])
        self.assertEqual([row[1] for row in self.cells("#provenance")], ["terrain-gen", "scan-sim", "regrid", "dem-eval"])
        self.check_log_and_requests()

    def test_draws_every_map(self):
        self.report()
        names = self.window.run("return [...document.querySelectorAll('#maps canvas')].map((c) => c.dataset.layer)")
        self.assertEqual(names, MAPS)
        for name in MAPS:
            self.assertGreater(self.canvas(f"#maps canvas[data-layer={name}]")["colors"], 1, name)
        self.assertEqual(self.window.run("return document.querySelectorAll('.crop canvas').length"),
                         2 * len(self.cells("#worst-footprints")))
        self.check_log_and_requests()

    def sparse(self, name, valid):
        """A DEM of 401 x 401 bins of 2 cm, of which the fraction `valid` has an elevation."""
        dem = self.path(name)
        self.succeed("regrid", self.chain.scan, "--terrain", self.chain.terrain, "-o", dem,
                     "-c", self.config({"resolution_m": 0.02, "half_width_m": 4}, "r.json"))
        kept = np.random.default_rng(3).random((401, 401)) < valid
        with h5py.File(dem, "r+") as file:
            for layer, value in (("z_est", 0.5), ("z_true", 0.51), ("x_true", file["x"][()][None, :]),
                                 ("y_true", file["y"][()][:, None])):
                file[layer][...] = np.where(kept, value, np.nan)
        return dem

    def test_a_sparse_dem_is_not_hidden_by_its_marks(self):
        self.report(self.sparse("sparse.h5", 0.2))
        self.assertLess(self.window.run(SHARE, "z_est", [255, 255, 255]), 0.001)
        self.assertLess(self.window.run(SHARE, "z_est", [29, 39, 51]), 0.001)
        self.assertLess(self.window.run(SHARE, "invalid", [0, 114, 178]), 0.7)
        self.assertGreater(self.window.run(VIEW)[0], 0.05)
        self.check_log_and_requests()
        self.check_layout()

    def test_single_invalid_bins_of_a_full_dem_are_visible(self):
        self.report(self.sparse("full.h5", 0.9998))
        with h5py.File(self.path("eval.h5")) as file:
            count = int(np.sum(file["invalid"][()]))
        self.assertTrue(5 < count < 60, count)
        width = self.window.run("return document.querySelector('#maps canvas[data-layer=invalid]').width")
        for layer, color in (("invalid", [0, 114, 178]), ("z_est", [255, 255, 255])):
            found = self.window.run(SHARE, layer, color) * width ** 2 / count
            self.assertTrue(6 < found <= 9.5, f"{layer}: {found} pixels per bin")
        self.check_log_and_requests()

    def test_values_under_the_pointer_are_those_of_the_file(self):
        self.report()
        with h5py.File(self.path("eval.h5")) as file:
            x, y, error = file["x"][()], file["y"][()], file["e_z"][()]
        step = self.window.run("return layerNamed('e_z').step")
        for row, col in [(50, 50), (20, 77), (99, 3)]:
            found = self.window.run("const map = arguments; return rasterOf(layerNamed('e_z'), report.grid)"
                                    ".then((r) => { const v = r.value(r.indexAt(map[0], map[1]));"
                                    " return Number.isNaN(v) ? null : v; })", x[col], y[row])
            if math.isnan(error[row, col]):
                self.assertIsNone(found)
            else:
                self.assertAlmostEqual(found, error[row, col], delta=0.501 * step)
        self.window.run("""
            const plot = document.querySelector('#maps canvas[data-layer=e_z]').parentElement;
            const box = plot.querySelector('canvas').getBoundingClientRect();
            plot.dispatchEvent(new PointerEvent('pointermove', {clientX: box.left + box.width / 2,
                                                                clientY: box.top + box.height / 2}));""")
        readout = self.window.run("return document.querySelector('#maps canvas[data-layer=e_z]').closest('figure')"
                                  ".querySelector('.readout').textContent")
        self.assertRegex(readout, r"^x .?0\.0\d m, y .?0\.0\d m: ")

    def test_view_turns_and_changes_its_colour(self):
        self.report()
        first = self.canvas("#terrain")
        self.assertGreater(first["colors"], 20)
        turn = "document.querySelector('#terrain').dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0]}))"
        seen = {first["sum"]}
        for key in ("ArrowLeft", "ArrowUp", "+"):
            self.window.run(turn, key)
            seen.add(self.canvas("#terrain")["sum"])
        self.assertEqual(len(seen), 4)
        for layer in ("e_z", "rel_z", "fail", "count"):
            before = self.canvas("#terrain")["sum"]
            self.window.run("const s = document.querySelector('#terrain-layer'); s.value = arguments[0];"
                            "s.dispatchEvent(new Event('change'))", layer)
            self.window.wait("return true")
            self.window.driver.execute_async_script("setTimeout(arguments[0], 300)")
            self.assertNotEqual(self.canvas("#terrain")["sum"], before, layer)
        before = self.canvas("#terrain")["sum"]
        self.window.run("const s = document.querySelector('#exaggeration'); s.value = 0.5;"
                        "s.dispatchEvent(new Event('input'))")
        self.assertNotEqual(self.canvas("#terrain")["sum"], before)
        self.check_log_and_requests()

    def test_view_keeps_exaggerated_heights_in_sight(self):
        self.report()
        for power in (0, 0.25, 0.5, 0.75, 1):
            self.window.run("const s = document.querySelector('#exaggeration'); s.value = arguments[0];"
                            "s.dispatchEvent(new Event('input'))", power)
            share, border = self.window.run(VIEW)
            self.assertGreater(share, 0.001, power)
            self.assertEqual(border, 0, power)

    def test_view_has_a_legend_of_its_colours(self):
        self.report()
        legend = "#terrain-legend"
        self.assertIn("Estimated elevation (m)", self.text(legend))
        for layer, text in (("rel_z", "Relative error in z (cm)"), ("fail", "relative z: "), ("count", "Returns in the bin")):
            self.window.run("const s = document.querySelector('#terrain-layer'); s.value = arguments[0];"
                            "s.dispatchEvent(new Event('change'))", layer)
            self.window.driver.execute_async_script("setTimeout(arguments[0], 300)")
            self.assertIn(text, self.text(legend))
            self.check_layout()

    def test_tables_sort(self):
        self.report()
        click = "document.querySelectorAll('#worst-footprints th button')[arguments[0]].click()"

        def values(column):
            return self.window.run("return [...document.querySelectorAll('#worst-footprints tbody tr')]"
                                   ".map((row) => Number(row.cells[arguments[0]].dataset.value))", column)

        self.assertGreater(len(values(1)), 2)
        for column in (1, 5):
            self.window.run(click, column)
            self.assertEqual(values(column), sorted(values(column)))
            self.window.run(click, column)
            self.assertEqual(values(column), sorted(values(column), reverse=True))

    def test_worst_footprints_are_the_worst(self):
        """Compared with the layers of eval.h5."""
        self.report()
        with h5py.File(self.path("eval.h5")) as file:
            layers = {name: file[name][()] for name in ("rel_x", "rel_y", "rel_z", "abs_x", "abs_y", "x", "y")}
        share = np.fmax.reduce([layers[f"rel_{axis}"] / 0.05 for axis in "xyz"] +
                               [np.hypot(layers["abs_x"], layers["abs_y"])])
        found = self.window.run("return report.worst")
        half = self.window.run("return report.footprint.half_bins")
        for footprint in found:
            row = int(np.argmin(abs(layers["y"] - footprint["y_m"])))
            col = int(np.argmin(abs(layers["x"] - footprint["x_m"])))
            self.assertAlmostEqual(footprint["share"], np.nanmax(share), places=5)
            self.assertAlmostEqual(footprint["relative_m"][2], layers["rel_z"][row, col], places=7)
            share[max(0, row - 2 * half):row + 2 * half + 1, max(0, col - 2 * half):col + 2 * half + 1] = np.nan
        self.assertTrue(len(found) == 10 or np.isnan(share).all())

    def test_numbers_of_worst_footprints_do_not_overlap(self):
        """The worst footprints, of one bin each, lie close together; a map shows as many numbers as fit."""
        self.report(self.chain.dem, "--set", "footprint_m=0.1", "--set", "region_radius_m=0.5")
        overlaps = """
            const boxes = [...document.querySelectorAll("#maps text.number")].map((e) => e.getBoundingClientRect());
            const cross = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 3 && b.top < a.bottom - 3;
            return [boxes.length, boxes.filter((a, i) => boxes.slice(i + 1).some((b) => cross(a, b))).length];"""
        for width in WIDTHS:
            self.window.resize(width)
            shown, crossing = self.window.run(overlaps)
            self.assertGreater(shown, 3)
            self.assertEqual(crossing, 0)
        self.check_log_and_requests()

    def test_the_layout_fits_the_page(self):
        self.report()
        self.check_layout()
        self.window.resize(800)
        self.window.run("document.querySelector('#maps button.enlarge').click()")
        self.check_layout()

    def test_a_dem_with_sigma_maps(self):
        dem = self.path("uncertain.h5")
        self.succeed("regrid", self.chain.scan, "--terrain", self.chain.terrain, "-c", self.config(REGRID, "r.json"),
                     *UNCERTAINTY, "-o", dem)
        self.report(dem)
        self.assertEqual(self.window.run("return document.querySelectorAll('#uncertainty svg[role=img]').length"), 4)
        self.check_log_and_requests()
        self.check_layout()

    def test_a_dem_of_nine_bins(self):
        """A footprint is one bin, so all relative errors are 0, and their distribution is a step at 0."""
        dem = self.path("nine.h5")
        self.succeed("regrid", self.chain.scan, "--terrain", self.chain.terrain, "-o", dem,
                     "-c", self.config({"resolution_m": 0.1, "half_width_m": 0.1}, "r.json"))
        self.report(dem, "--set", "region_radius_m=0.15", "--set", "footprint_m=0.1")
        points = self.window.run("return [...document.querySelectorAll('#errors figure:nth-child(3) polyline')]"
                                 ".slice(0, 3).map((line) => line.getAttribute('points').split(' ').map((p) => p.split(',').map(Number)))")
        self.assertEqual(len(points), 3)
        for line in points:
            self.assertEqual(line, [[58, 254], *line[1:-1], [414, 14]])
        texts = self.window.run("return [...document.querySelectorAll('#errors figure:nth-child(3) text')].map((t) => t.textContent)")
        self.assertIn("relative error (\u00b5m)", texts)
        self.assertLessEqual(max(len(text) for text in texts if text[0].isdigit()), 3)
        self.assertIn("1 bin across", self.text("#worst"))
        self.check_log_and_requests()
        self.check_layout()

    def test_a_dem_with_slope_corrected_elevations(self):
        dem = self.path("corrected.h5")
        self.succeed("regrid", self.chain.scan, "--terrain", self.chain.terrain, "-c", self.config(REGRID, "r.json"),
                     "--corrected", "-o", dem)
        found = self.report(dem)["statistics"]["z_corrected"]
        keys = ["mean_m", "std_m", "rmse_m", "median_m", "nmad_m", "le90_m", "p95_m"]
        self.assertEqual([row[4] for row in self.cells("#statistics")],
                         [f"{100 * found[key]:.3f}".replace("-", "\u2212") for key in keys])
        self.check_layout()

    def test_a_dem_without_truth(self):
        dem = self.path("blind.h5")
        self.succeed("regrid", self.chain.scan, "-c", self.config(REGRID, "r.json"), "-o", dem)
        metrics = self.report(dem)
        self.assertEqual([row[:1] + row[2:] for row in self.cells("#verdicts")], expected_rows(metrics))
        names = self.window.run("return [...document.querySelectorAll('#maps canvas')].map((c) => c.dataset.layer)")
        self.assertEqual(names, ["z_est", "count", "invalid", "fail"])
        legend = self.window.run("return [...document.querySelectorAll('#maps .legend > span')].map((s) => s.textContent)")
        self.assertEqual([entry.split(": ")[1] == "not judged" for entry in legend], [True] * 4 + [False] * 2)
        self.assertNotIn("numbered", self.text("#maps"))
        self.assertIsNone(self.text("#worst"))
        self.check_log_and_requests()
        self.check_layout()

    def test_a_dem_without_any_elevation(self):
        dem = self.path("empty.h5")
        self.succeed("regrid", self.chain.scan, "--terrain", self.chain.terrain, "-c", self.config(REGRID, "r.json"),
                     *UNCERTAINTY, "-o", dem)
        with h5py.File(dem, "r+") as file:
            for name in ("z_est", "x_true", "y_true", "z_true"):
                file[name][...] = np.nan
        self.report(dem)
        self.assertIn("No footprint could be judged", self.text("#worst"))
        self.assertIn("Nothing to show: no bin of the DEM is valid", self.text("#view-3d"))
        self.assertIsNone(self.text("#uncertainty"))
        self.check_log_and_requests()
        self.check_layout()


if __name__ == "__main__":
    unittest.main()
