# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of dem-eval in a browser: its numbers and drawings, and that it requests no other file."""
import json
import math
import unittest

import h5py
import numpy as np
from matplotlib.image import imread

from harness import EVAL, REGRID, bins_of_picture, browser, read_bytes
from harness.page import WIDTHS, CommonPage, PageTest
from landfall import files
from landfall.plot import plot_profile, reduction, relief, scales

SECTIONS = ["requirements", "maps", "view-3d", "worst", "holes", "errors", "uncertainty", "provenance-chain"]
MAPS = ["z_est", "z_true", "count", "e_x", "e_y", "e_z", "abs_x", "abs_y", "abs_z", "rel_x", "rel_y", "rel_z", "invalid",
        "fail"]

UNCERTAINTY = ["--uncertainty", "--navigation-sigma", "position_m=0.05", "--navigation-sigma", "velocity_mps=0.1",
               "--navigation-sigma", "rpy_rad=0.0002", "--navigation-sigma", "rpy_rate_radps=0.001"]

# Every error map's scale and what its colour bar shows of the limit.
SCALES = """
return Object.fromEntries(panels.filter((p) => p.options.region && ["signed", "magnitude"].includes(p.raster.layer.style)).map(
    (p) => [p.raster.layer.name, {low: p.scale.low, high: p.scale.high, marks: p.svg.querySelectorAll("polygon.limit").length,
        limit: p.raster.layer.limit, note: p.noteText.textContent, text: [...p.svg.querySelectorAll("text")].map((t) => t.textContent)}]));
"""


class ReportCase(PageTest):
    def expected_rows(self):
        """The table that dem-eval prints, as eval.h5 keeps it."""
        with h5py.File(self.path("eval.h5")) as file:
            return [list(row.values()) for row in json.loads(file["verdict_json"].asstr()[()])]

    def report(self, dem=None, *arguments):
        """Opens the report of a DEM; returns its metrics."""
        config = self.config(EVAL)
        self.succeed("dem-eval", dem or self.chain.dem, "-c", config, "-o", self.path("eval.h5"), "-O", "--metrics",
                     self.path("metrics.json"), "--report", self.path("report.html"), *arguments)
        self.open("report.html")
        return self.results()

    def results(self):
        return json.loads(read_bytes(self.path("metrics.json")))

    def layers(self, *names):
        with h5py.File(self.path("eval.h5")) as evaluation, h5py.File(self.chain.dem) as dem:
            return [(evaluation if name in evaluation else dem)[name][()] for name in names]

    def choose_scales(self, value):
        self.set_field("#scales", value, "change")

    def set_field(self, selector, value, event):
        script = "const [field, value, event] = arguments; field.value = value; field.dispatchEvent(new Event(event))"
        self.window.run(script, self.element(selector), value, event)


@unittest.skipIf(browser.missing(), browser.missing())
class CommonReport(CommonPage, ReportCase):
    """The report of the chain's DEM."""

    def exaggerate(self, power):
        self.set_field("#exaggeration", power, "input")

    def color_by(self, layer):
        """Colours the 3-D view by a layer."""
        self.set_field("#terrain-layer", layer, "change")
        self.window.driver.execute_async_script("setTimeout(arguments[0], 300)")

    def test_numbers_are_those_of_metrics_json(self):
        metrics = self.report()
        self.assertEqual(self.text("h1"), "plane with cone features, hemisphere features and pyramid features, fsm scanner")
        self.assertEqual(self.cells("#verdicts"), self.expected_rows())
        self.assertEqual(self.text("#verdict").split(":")[0], "pass" if metrics["pass"] else "FAIL")
        self.assertEqual([row[1] for row in self.cells("#provenance")], ["terrain-gen", "scan-sim", "regrid", "dem-eval"])
        self.check_parts([s for s in SECTIONS if s != "uncertainty"], MAPS)
        self.assertEqual(len(self.texts(".crop canvas")), 2 * len(self.cells("#worst-footprints")))

    def test_values_under_the_pointer_are_those_of_the_file(self):
        self.report()
        with h5py.File(self.path("eval.h5")) as file:
            x, y, error = file["x"][()], file["y"][()], file["e_z"][()]
        step = self.step("e_z")
        for row, col in [(50, 50), (20, 77), (99, 3)]:
            found = self.window.run("const map = arguments; return rasterOf(layerNamed('e_z'), report.grid)"
                                    ".then((r) => { const v = r.value(r.indexAt(map[0], map[1]));"
                                    " return Number.isNaN(v) ? null : v; })", x[col], y[row])
            if math.isnan(error[row, col]):
                self.assertIsNone(found)
            else:
                self.assertAlmostEqual(found, error[row, col], delta=0.501 * step)
        self.point("e_z", [0, 0])
        readout = "return document.querySelector('#maps canvas[data-layer=e_z]').closest('figure').querySelector('.readout').textContent"
        self.assertRegex(self.window.run(readout), r"^x .?0\.0\d m, y .?0\.0\d m: ")

    def test_the_cursor_is_on_all_maps_with_all_values(self):
        self.report()
        x, y, z_est, rel_z, count = self.layers("x", "y", "z_est", "rel_z", "count")
        shown = self.values_under_cursor("abs_x", [x[40], y[57]])
        self.assertRegex(self.text("#values .place"), rf"^x {x[40]:.2f} m, y {y[57]:.2f} m$".replace("-", "\u2212"))
        self.assertAlmostEqual(float(shown["z_est"].split()[0].replace("\u2212", "-")), z_est[57, 40], delta=1e-3)
        self.assertAlmostEqual(float(shown["rel_z"].split()[0]) / 100, rel_z[57, 40], delta=1e-3)
        self.assertEqual(shown["count"], str(count[57, 40]))
        self.assertEqual(shown["fail"], self.window.run("return flagText(layerNamed('fail'), arguments[0])", int(self.layers("fail")[0][57, 40])))
        self.check_log_and_requests()

    def test_a_dragged_line_gives_the_profile_of_the_file(self):
        self.report()
        x, y, z_est, z_true, error = self.layers("x", "y", "z_est", "z_true", "e_z")
        self.point("e_z", [x[20], y[33]], [x[80], y[33]])
        lines = self.window.run("return panels.filter((p) => p.options.region && p.svg.querySelector('.profile-line')).length")
        self.assertEqual(lines, len(MAPS))
        for name, values in (("z_est", z_est), ("z_true", z_true), ("e_z", error)):
            found = self.window.run("return rasterOf(layerNamed(arguments[0]), report.grid).then((r) => profileOf(r, pointing.line)"
                                    ".map(([at, v]) => [at, Number.isNaN(v) ? null : v]))", name)
            step = self.step(name)
            self.assertIn(len(found), (60, 61, 62), name)
            for at, value in found[1:-1]:
                col = round((at + x[20] - x[0]) / 0.1)
                if math.isnan(values[33, col]):
                    self.assertIsNone(value)
                else:
                    self.assertAlmostEqual(value, values[33, col], delta=0.501 * step)
        self.assertGreater(self.window.run("return document.querySelectorAll('#profile polyline').length"), 2)
        self.assertEqual(self.window.run("return document.querySelectorAll('#profile line.limit').length"), 2)
        self.window.run("document.querySelectorAll('#profile input').forEach((field, k) => { field.value = [-1, -2, 3, 1][k];"
                        " field.dispatchEvent(new Event('change')); })")
        self.assertEqual(self.window.run("return [pointing.line.from.x_m, pointing.line.from.y_m, pointing.line.to.x_m, pointing.line.to.y_m]"),
                         [-1, -2, 3, 1])
        self.assertTrue(self.text("#profile .note").startswith("5.00 m; error: largest "), self.text("#profile .note"))
        self.check_log_and_requests()
        self.check_layout()

    def test_a_click_draws_no_line(self):
        self.report()
        before = self.window.run("return pointing.line")
        self.point("e_z", [1, 1], [1, 1])
        self.assertEqual(self.window.run("return pointing.line"), before)

    def test_blinks_between_estimated_and_true_elevation(self):
        self.report()
        panel = "#maps canvas[data-layer=z_est]"
        first = self.canvas(panel)["sum"]
        caption = "return document.querySelector('#maps canvas[data-layer=z_est]').closest('figure').querySelector('figcaption code').textContent"
        self.window.run("document.querySelector('button.blink').click()")
        self.assertEqual(self.window.run(caption), "z_true")
        self.assertNotEqual(self.canvas(panel)["sum"], first)
        self.window.wait(caption + " === 'z_est'", 5)
        self.assertEqual(self.canvas(panel)["sum"], first)
        self.window.run("document.querySelector('button.blink').click()")
        self.assertEqual((self.window.run(caption), self.text("button.blink")), ("z_est", "blink z_est / z_true"))
        scales = self.window.run("return ['z_est', 'z_true'].map((name) => panels.find("
                                 "(p) => p.raster.layer.name === name && p.options.region).scale).map(({low, high}) => [low, high])")
        self.assertEqual(*scales)
        self.check_log_and_requests()

    def test_dark_mode_follows_the_system_and_the_button(self):
        paper = "return getComputedStyle(document.querySelector('main > section')).backgroundColor"
        self.report()
        self.assertEqual((self.window.run(paper), self.text("#theme")), ("rgb(255, 255, 255)", "dark mode"))
        maps = self.canvas("#maps canvas[data-layer=e_z]")["sum"]
        self.scheme("dark")
        self.assertEqual((self.window.run(paper), self.text("#theme")), ("rgb(24, 29, 35)", "light mode"))
        self.assertEqual(self.canvas("#maps canvas[data-layer=e_z]")["sum"], maps)
        self.window.run("document.getElementById('theme').click()")
        self.assertEqual((self.window.run(paper), self.text("#theme")), ("rgb(255, 255, 255)", "dark mode"))
        self.check_log_and_requests()

    def test_buttons_name_what_they_enlarge(self):
        self.report()
        self.assertEqual(self.texts("#maps button.enlarge"), [f"enlarge {name}" for name in MAPS])
        self.window.run("document.querySelectorAll('#maps button.enlarge')[5].click()")
        self.assertEqual(self.text("#maps figure.wide button.enlarge"), "reduce e_z")
        self.window.run("document.querySelectorAll('#maps button.enlarge')[5].click()")
        self.assertIsNone(self.text("#maps figure.wide button.enlarge"))

    def test_profiles_are_those_of_plot_profile(self):
        self.report()
        with h5py.File(self.chain.dem) as file:
            grid, z = files.read_grid(file), file["z_est"][()]
        step = self.step("z_est")
        for start, end in (((-3.31, -2.2), (4.9, 3.87)), ((2.2, 4.7), (2.2, -1.1)), ((-5, -5), (5, 5))):
            found = self.window.run("""const [from, to] = [...arguments].map(([x_m, y_m]) => ({x_m, y_m}));
                return rasterOf(layerNamed("z_est"), report.grid).then((r) => profileOf(r, {from, to}));""", start, end)
            bins = plot_profile.bins_under(grid, start, end)
            np.testing.assert_allclose([at for at, _ in found], bins.at_m, atol=1e-9)
            np.testing.assert_allclose([np.nan if value is None else value for _, value in found], bins.of(z), atol=0.501 * step)

    def test_colours_are_those_of_the_figures(self):
        self.report()
        maps = self.window.run("return COLOR_MAPS")
        self.assertEqual(maps, {name: [list(map(int, c)) for c in scales.color_table(name)] for name in scales.ANCHORS})
        self.assertEqual(self.window.run("return NO_VALUE_COLOR"), list(scales.NO_VALUE))
        self.assertEqual(self.window.run("return MARK_COLOR"), "rgb({},{},{})".format(*scales.MARK))
        self.assertEqual(self.window.run("return [OUTLIERS, LIMIT_INSIDE, NEAR, MAX_MARKED]"),
                         [scales.OUTLIERS, scales.LIMIT_INSIDE, scales.LIMIT_NEAR, reduction.MAX_MARKED])
        found = self.window.run(SCALES)
        for kind, limits in (("e", [0.05] * 3), ("rel", [0.05] * 3), ("abs", [1, 1, None])):
            names = [f"{kind}_{axis}" for axis in "xyz"]
            with h5py.File(self.path("eval.h5")) as file:
                values = [file[name][()].astype(float) for name in names]
            for name, value, limit_m in zip(names, values, limits):
                make = scales.magnitude_scale if kind == "rel" else scales.error_scale
                expected = make(value, value, limit_m, peers=[*zip(values, limits)])
                for end in ("low", "high"):
                    self.assertAlmostEqual(found[name][end], getattr(expected, end), delta=max(map(self.step, names)), msg=name)

    def test_elevations_are_shaded_as_in_view(self):
        self.report()
        self.succeed("landfall-export", self.chain.dem, "--layers", "z_est", "-o", self.path("view.png"))
        view = np.round(255 * imread(self.path("view.png"))[..., :3])
        view = bins_of_picture(view, (101, 101))
        drawn = self.window.run("""return rasterOf(layerNamed("z_est"), report.grid).then((r) => {
            const alone = Object.assign(Object.create(r), {peers: undefined}), b = blocksOf(alone, 1);
            return [...reliefColors(alone, b, scaleOf(alone))]; })""")
        self.assertLess(np.abs(np.reshape(drawn, (101, 101, 3)) - view).max(), 4)
        with h5py.File(self.chain.dem) as file:
            z = file["z_est"][()]
        scale, step_m = scales.elevation_scale([z], [z]), 0.1
        figure = 255 * relief.image(z, step_m, scale, relief.factor(z, step_m), np.isnan(z).astype(float))
        self.assertLess(np.abs(figure - view).max(), 4)

    def test_view_fills_its_canvas(self):
        self.report()
        for width in WIDTHS:
            self.window.resize(width)
            share, border = self.drawn("#terrain")
            self.assertGreater(share, 0.3)
            self.assertEqual(border, 0)

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
        self.addCleanup(self.color_by, "z_est")
        for layer in ("e_z", "rel_z", "fail", "count"):
            before = self.canvas("#terrain")["sum"]
            self.color_by(layer)
            self.assertNotEqual(self.canvas("#terrain")["sum"], before, layer)
        before = self.canvas("#terrain")["sum"]
        self.addCleanup(self.exaggerate, self.window.run("return document.querySelector('#exaggeration').value"))
        self.exaggerate(0.5)
        self.assertNotEqual(self.canvas("#terrain")["sum"], before)
        self.check_log_and_requests()

    def test_view_keeps_exaggerated_heights_in_sight(self):
        self.report()
        self.addCleanup(self.exaggerate, self.window.run("return document.querySelector('#exaggeration').value"))
        for power in (0, 0.25, 0.5, 0.75, 1):
            self.exaggerate(power)
            share, border = self.drawn("#terrain")
            self.assertGreater(share, 0.001, power)
            self.assertEqual(border, 0, power)

    def test_view_has_a_legend_of_its_colours(self):
        self.report()
        legend = "#terrain-legend"
        self.assertIn("Estimated elevation (m)", self.text(legend))
        self.addCleanup(self.color_by, "z_est")
        for width in WIDTHS:
            self.window.resize(width)
            for layer, text in (("rel_z", "Relative error in z: |e \u2212 mean|, 95 % quantile (cm)"),
                                ("e_z", "Error in z: true \u2212 estimated (cm)"), ("fail", "relative z: "), ("count", "Returns in the bin")):
                self.color_by(layer)
                self.assertIn(text, self.text(legend))
                self.check_boxes(f"{layer}, {width} px")

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

    def test_the_layout_with_an_enlarged_map_fits_the_page(self):
        """report_screens_test.py looks at the page as it opens."""
        self.report()
        self.window.resize(800)
        self.window.run("document.querySelector('#maps button.enlarge').click()")
        self.check_layout()
        self.window.run("document.querySelector('#maps button.enlarge').click()")


@unittest.skipIf(browser.missing(), browser.missing())
class OtherReports(ReportCase):
    def dem(self, *options, grid=REGRID, terrain=True):
        """A DEM of the chain's scan."""
        path = self.path("dem.h5")
        self.succeed("regrid", self.chain.scan, *(["--terrain", self.chain.terrain] if terrain else []), "-c", self.config(grid, "r.json"),
                     *options, "-O", "-o", path)
        return path

    def sparse(self, valid):
        """A DEM of 401 x 401 bins of 2 cm, of which the fraction `valid` has an elevation."""
        dem = self.dem(grid={"resolution_m": 0.02, "half_width_m": 4})
        kept = np.random.default_rng(3).random((401, 401)) < valid
        with h5py.File(dem, "r+") as file:
            for layer, value in (("z_est", 0.5), ("z_true", 0.51), ("x_true", file["x"][()][None, :]),
                                 ("y_true", file["y"][()][:, None])):
                file[layer][...] = np.where(kept, value, np.nan)
        return dem

    def test_a_sparse_dem_is_not_hidden_by_its_marks(self):
        self.report(self.sparse(0.2))
        self.assertLess(self.share("#maps canvas[data-layer=z_est]", scales.MARK), 0.001)
        self.assertLess(self.share("#maps canvas[data-layer=invalid]", (0, 114, 178)), 0.7)
        self.assertGreater(self.drawn("#terrain")[0], 0.05)
        self.check_log_and_requests()
        self.check_layout()

    def test_single_invalid_bins_of_a_full_dem_are_visible(self):
        self.report(self.sparse(0.9998))
        with h5py.File(self.path("eval.h5")) as file:
            count = int(np.sum(file["invalid"][()]))
        self.assertTrue(5 < count < 60, count)
        width = self.window.run("return document.querySelector('#maps canvas[data-layer=invalid]').width")
        for layer, color in (("invalid", (0, 114, 178)), ("z_est", scales.MARK)):
            found = self.share(f"#maps canvas[data-layer={layer}]", color) * width ** 2 / count
            self.assertTrue(6 < found <= 9.5, f"{layer}: {found} pixels per bin")
        self.check_log_and_requests()

    def test_a_scale_reaches_a_limit_that_is_near_its_values(self):
        """A limit far beyond the errors would leave a map without colour, at first sight."""
        self.report(None, "--set", "limits.absolute_horizontal_m=1", "--set", "limits.relative_elevation_m=0.05")
        scales = self.window.run(SCALES)
        self.assertLess(scales["abs_x"]["high"], 0.1)
        self.assertEqual(scales["abs_x"]["marks"], 0)
        self.assertIn("limit", scales["abs_x"]["note"])
        self.assertEqual(scales["rel_z"]["marks"], 1)
        self.choose_scales("all")
        self.assertGreater(self.window.run(SCALES)["abs_x"]["high"], 1)

    def test_every_scale_of_an_error_holds_its_limit(self):
        for limit in (0.05, 30):  # far above and far below the errors, too
            limits = {"relative_elevation_m": limit, "relative_horizontal_m": limit, "absolute_horizontal_m": 20 * limit}
            self.report(None, *[argument for key, value in limits.items() for argument in ("--set", f"limits.{key}={value}")])
            self.choose_scales("all")
            scales = self.window.run(SCALES)
            self.assertEqual(set(scales), {f"{kind}_{axis}" for kind in ("e", "abs", "rel") for axis in "xyz"})
            for name, scale in scales.items():
                self.assertTrue(any("true \u2212 estimated" in text or "|e \u2212 mean|" in text for text in scale["text"]), name)
                if name == "abs_z":
                    self.assertIsNone(scale["limit"])
                    continue
                self.assertEqual(scale["limit"], limits["absolute_horizontal_m"] if name.startswith("abs") else limit)
                self.assertGreaterEqual(scale["high"], 1.1 * scale["limit"])
                self.assertEqual(scale["low"], 0 if name.startswith("rel") else -scale["high"])
                self.assertEqual(scale["marks"], 1 if name.startswith("rel") else 2, name)
                self.assertIn("limit", scale["note"])
        self.choose_scales("none")
        for name, scale in self.window.run(SCALES).items():
            self.assertEqual(scale["marks"], 0, name)
        self.check_layout()

    def test_scales_end_at_a_quantile_and_say_so(self):
        dem = self.dem()
        with h5py.File(dem, "r+") as file:
            file["z_est"][50, 50:52] = [7, -7]
        self.report(dem)
        with h5py.File(self.path("eval.h5")) as file:
            magnitudes = np.sort(np.abs(file["e_z"][()][~np.isnan(file["e_z"][()])]))
        scale = self.window.run(SCALES)["e_z"]
        expected = max(1.1 * 0.05, magnitudes[round(0.995 * (len(magnitudes) - 1))])
        self.assertAlmostEqual(scale["high"], expected, delta=self.step("e_z"))
        self.assertIn("colours end at \u00b1", scale["note"])

    def test_has_the_title_that_is_given(self):
        self.report(None, "--title", "Site 7 & <others>")
        self.assertEqual((self.text("h1"), self.window.driver.title), ("Site 7 & <others>",) * 2)

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

    def test_a_dem_with_sigma_maps(self):
        self.report(self.dem(*UNCERTAINTY))
        self.assertEqual(self.window.run("return document.querySelectorAll('#uncertainty svg[role=img]').length"), 4)
        self.check_log_and_requests()
        self.check_layout()

    def test_a_dem_of_nine_bins(self):
        """A footprint of one bin has no relative error: it has no distribution, and the worst footprints are those of the absolute error."""
        self.report(self.dem(grid={"resolution_m": 0.1, "half_width_m": 0.1}), "--set", "region_radius_m=0.15", "--set", "footprint_m=0.1")
        self.assertIn("2 of 6 not judged: the footprint has fewer than 5 x 5 bins", self.text("#verdict"))
        self.assertIn("footprint of 1 x 1 bins; truth nodes every 0.1 m; ", self.text("#assumptions"))
        self.assertEqual(self.window.run("return document.querySelectorAll('#errors figure').length"), 2)
        self.assertIn("absolute horizontal", self.text("#worst-footprints"))
        self.assertNotIn("relative x", self.text("#worst-footprints"))
        self.assertIn("1 bin across", self.text("#worst"))
        self.check_log_and_requests()
        self.check_layout()

    def test_a_dem_with_slope_corrected_elevations(self):
        found = self.report(self.dem("--corrected"))["statistics"]["z_corrected"]
        keys = ["mean_m", "std_m", "rmse_m", "median_m", "nmad_m", "le90_m", "p95_m"]
        self.assertEqual([row[4] for row in self.cells("#statistics")],
                         [f"{100 * found[key]:.3f}".replace("-", "\u2212") for key in keys])
        self.check_layout()

    def test_a_dem_without_truth(self):
        self.report(self.dem(terrain=False))
        self.assertEqual(self.cells("#verdicts"), self.expected_rows())
        self.assertEqual(self.maps(), ["z_est", "count", "invalid", "fail"])
        legend = self.texts("#maps .flags > span")
        self.assertEqual([entry.split(": ")[1] == "not judged" for entry in legend], [True] * 4 + [False] * 2)
        self.assertNotIn("numbered", self.text("#maps"))
        self.assertIsNone(self.text("#worst"))
        self.check_log_and_requests()
        self.check_layout()

    def test_a_dem_without_any_elevation(self):
        dem = self.dem(*UNCERTAINTY)
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
