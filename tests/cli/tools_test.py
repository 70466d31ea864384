#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Behaviour specific to each tool: its own options, and the inputs that it refuses."""
import json
import os
import shutil
import unittest

import h5py
import numpy as np

from harness import ChainTest, read_bytes, run, set_text


class TerrainGen(ChainTest):
    def make(self, *arguments):
        self.succeed("terrain-gen", "-c", self.chain.config("terrain-gen"), "-o", self.path("t.h5"), "-O", *arguments)
        with h5py.File(self.path("t.h5")) as file:
            return file["x"][()], file["y"][()], file["z"][()]

    def test_plane_and_features_have_their_heights(self):
        x, y, z = self.make()
        plane = 0.25 + 0.05 * x[None, :] - 0.03 * y[:, None]
        at = lambda px, py: (round(py / 0.1) + 60, round(px / 0.1) + 60)
        self.assertAlmostEqual(z[at(-5, -5)], plane[at(-5, -5)], places=14)
        for px, py, height in [(1.5, 0.5, 1.5), (-2, -1, 0.8), (-1, 2, 0.7)]:
            self.assertAlmostEqual(z[at(px, py)], plane[at(px, py)] + height, places=12)

    def test_bases_are_summed(self):
        base = [{"type": "plane", "elevation_m": 1}, {"type": "plane", "slope_x": 0.5}]
        x, _, z = self.make("--set", "features=[]", "--set", "base=" + json.dumps(base))
        np.testing.assert_allclose(z, np.broadcast_to(1 + 0.5 * x, z.shape), rtol=0, atol=1e-14)

    def test_ring(self):
        ring = [{"type": "ring", "count": 4, "radius_m": 3, "first_azimuth_deg": 90,
                 "feature": {"type": "cone", "radius_m": 0.5, "height_m": 2}}]
        _, _, z = self.make("--set", "features=[]", "--set", 'base={"type":"plane"}', "--set",
                            "patterns=" + json.dumps(ring))
        tops = sorted(map(tuple, np.argwhere(z > 1.99) - 60))
        self.assertEqual(tops, [(-30, 0), (0, -30), (0, 30), (30, 0)])

    def test_raster_that_is_missing_or_invalid(self):
        for path in [self.path("none.tif"), self.write("text.tif", "no raster"), self.folder]:
            base = json.dumps({"type": "dem", "path": path})
            self.refuse(1, "terrain-gen", "-o", self.path("t.h5"), "--set", f"base={base}", words=[path],
                        output=self.path("t.h5"))

    def write_raster(self, size, spacing_m=1.0):
        """An ESRI ASCII grid of a tilted plane, without a CRS; its middle is the origin."""
        path = self.path("dem.asc")
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"ncols {size}\nnrows {size}\nxllcorner {-size * spacing_m / 2}\n"
                       f"yllcorner {-size * spacing_m / 2}\ncellsize {spacing_m}\n")
            for row in range(size):
                file.write(" ".join(str(0.5 * col - 0.25 * row) for col in range(size)) + "\n")
        return path

    def test_site_must_lie_inside_the_raster(self):
        base = {"type": "dem", "path": self.write_raster(11), "horizontal_scale_m": 1}
        self.refuse(1, "terrain-gen", "-c", self.chain.config("terrain-gen"), "-o", self.path("t.h5"), "--set",
                    "base=" + json.dumps(base), words=["dem.asc"], output=self.path("t.h5"))

    def test_a_plane_is_imported_unchanged(self):
        base = {"type": "dem", "path": self.write_raster(15), "horizontal_scale_m": 1}
        x, y, z = self.make("--set", "features=[]", "--set", "base=" + json.dumps(base))
        np.testing.assert_allclose(z, 0.5 * x[None, :] + 0.25 * y[:, None], rtol=0, atol=1e-6)

    def test_horizontal_scale_is_required_without_a_crs(self):
        base = {"type": "dem", "path": self.write_raster(15)}
        result = run("terrain-gen", "-c", self.chain.config("terrain-gen"), "-o", self.path("t.h5"), "--set",
                     "base=" + json.dumps(base))
        self.assertIn(result.returncode, (1, 2))
        self.check_message("terrain-gen", result.stderr, ["horizontal_scale_m"])

    def test_two_centres_exclude_each_other(self):
        base = {"type": "dem", "path": "x.tif", "center": [0, 0], "center_pixel": [1, 1]}
        self.refuse(2, "terrain-gen", "--check", "--set", "base=" + json.dumps(base), words=["center_pixel"])


class ScanSim(ChainTest):
    FLASH = ["--set", 'scanner={"type":"flash"}']

    def refuse_scan(self, code, *arguments, words=()):
        self.refuse(code, "scan-sim", *self.chain.inputs("scan-sim"), "-o", self.path("s.h5"), *arguments,
                    words=words, output=self.path("s.h5"))

    def test_a_scan_without_a_return(self):
        self.refuse_scan(1, *self.FLASH, "--set", "mount.rpy_deg=[0,0,0]", words=["no return", "misses"])
        self.refuse_scan(1, "--set", "noise.dropout_frac=1", words=["no return", "dropouts"])
        self.refuse_scan(1, "--set", "noise.dead_pixel_frac=1", words=["no return", "dead"])
        self.refuse_scan(1, "--keep-misses", "--set", "noise.dropout_frac=1", words=["no return"])

    def test_a_scan_without_a_return_gives_the_reason(self):
        def reason_for(scanner):
            result = self.refuse(1, "scan-sim", *self.chain.inputs("scan-sim"), "-o", self.path("s.h5"), "--set",
                                 "scanner=" + json.dumps(scanner), "--set", "noise.dead_pixel_frac=0")
            return result.stderr.partition("no return: ")[2].strip()

        # Every pulse falls between two facets.
        between = {"type": "polygon", "facets": 10, "rate_hz": 200, "phase_deg": 18, "duty_frac": 0.01}
        self.assertEqual(reason_for(between), "25600 of blanked pulses")
        reflecting = {"type": "risley", "index": [1.5, 1.5], "wedge_deg": [60, 60]}
        self.assertEqual(reason_for(reflecting), "25600 lost in the scanner (total reflection)")

    def test_a_lidar_at_or_below_the_terrain_is_refused_by_pulse(self):
        mounting = ["--set", "mount.position_m=[0,0,0]", "--set", "trajectory.rpy_deg=[0,0,0]"]
        self.refuse_scan(1, *self.FLASH, *mounting, "--set", "trajectory.position_m=[0,0,-1]",
                         words=["pulse 0:", "below the terrain"])
        # From 0.5 m above the plane (0.25 m at the origin) at 5 m/s, the lidar meets it after about 0.1 s.
        self.refuse_scan(1, *self.FLASH, *mounting, "--set", "trajectory.position_m=[0,0,0.75]", "--set",
                         "trajectory.velocity_mps=[0,0,-5]", words=["pulse 200:", "below the terrain"])

    def test_an_aim_beyond_the_mirrors_range(self):
        self.refuse_scan(1, "--set", "scanner.max_deflection_deg=1", words=["pulse 0 ", "degrees"])

    def write_table(self, text):
        return ["--set", "trajectory=" + json.dumps({"type": "table", "path": self.write("table.csv", text)})]

    HEADER = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n"

    def test_a_trajectory_table_gives_the_same_scan_as_its_formula(self):
        table = self.write_table(self.HEADER + "0,0,0,50,1,0,0,0\n0.3,0,0,48.5,1,0,0,0\n")
        straight = {"type": "constant_velocity", "position_m": [0, 0, 50], "velocity_mps": [0, 0, -5]}
        for name, values in [("a.h5", table), ("b.h5", ["--set", "trajectory=" + json.dumps(straight)])]:
            self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-o", self.path(name), *values)
        with h5py.File(self.path("a.h5")) as one, h5py.File(self.path("b.h5")) as two:
            for column in ("x_est", "y_est", "z_est", "range_true"):
                np.testing.assert_allclose(one["points"][column], two["points"][column], rtol=0, atol=1e-8)

    def test_trajectory_tables_that_are_refused(self):
        row = "{},0,0,50,1,0,0,0\n"
        for text, words in [
                ("", ["empty"]), (self.HEADER, ["0 rows"]), (self.HEADER + row.format(0), ["1 rows"]),
                ("t_s,x_m\n0,0\n", ["line 1", "y_m"]),
                (self.HEADER + row.format(0) + "0.1,0,0\n", ["line 3", "3 values"]),
                (self.HEADER + row.format(0) + row.format("soon"), ["line 3", "t_s 'soon'"]),
                (self.HEADER + row.format(0) + row.format("nan"), ["row 2", "finite"]),
                (self.HEADER + row.format(0) + row.format(0), ["row 2", "t_s"]),
                (self.HEADER + row.format(0) + "1,0,0,50,0.5,0,0,0\n", ["row 2", "norm"])]:
            self.refuse_scan(1, *self.write_table(text), words=["table.csv", *words])
        self.refuse_scan(1, *self.write_table(self.HEADER + row.format(0) + row.format(0.1)),
                         words=["outside the table", "table.csv"])

    def test_a_trajectory_table_that_cannot_be_read(self):
        for path in [self.path("none.csv"), self.folder]:
            self.refuse_scan(1, "--set", "trajectory=" + json.dumps({"type": "table", "path": path}), words=[path])

    def test_ifov_and_fov_exclude_each_other(self):
        self.refuse_scan(2, "--set", "detector.fov_deg=1", words=["/detector", "ifov_rad", "fov_deg"])

    def test_detectors_that_are_refused(self):
        for key, value, words in [
                ("fill_factor", 0, ["/detector/fill_factor", "0"]), ("fill_factor", 1.5, ["/detector/fill_factor", "1.5"]),
                ("estimator", '"mode"', ["/detector/estimator", "strongest"]),
                ("range_resolution_m", 0, ["/detector/range_resolution_m"]),
                ("distortion.k1", '"much"', ["/detector/distortion/k1"]),
                ("distortion.k1", -50000, ["/detector/distortion", "folds at radius"]),
                ("distribution", '"even"', ["/detector/distribution", "uniform"])]:
            self.refuse_scan(2, "--set", f"detector.{key}={value}", words=words)

    def test_tables_of_pixels_that_are_refused(self):
        for text, words in [("row,column,u\n", ["line 1", "v"]), ("row,column,u,v\n0,0,0,0\n", ["row 0, column 1", "no row"]),
                            ("row,column,u,v\n0,0,0,0\n9,0,0,0\n", ["row 2", "row 9", "0..7"]),
                            ("row,column,u,v\n0,0,0,0\n0,0,1,0\n", ["row 2", "already"]),
                            ("row,column,u,v\n0,0,nan,0\n", ["row 1", "finite"])]:
            self.refuse_scan(1, "--set", "detector.distribution=" + json.dumps({"path": self.write("pixels.csv", text)}),
                             words=["pixels.csv", *words])

    def test_unknown_engine(self):
        self.refuse_scan(2, "--engine", "magic", words=["--engine", "magic"])

    def test_a_mesh_or_damaged_terrain(self):
        shutil.copy(self.chain.terrain, self.path("t.h5"))
        for value, word in [(np.inf, "infinite"), (np.nan, "finite")]:
            with h5py.File(self.path("t.h5"), "r+") as file:
                file["z"][...] = value
            self.refuse(1, "scan-sim", "--terrain", self.path("t.h5"), "-c", self.chain.config("scan-sim"), "-o",
                        self.path("s.h5"), words=["t.h5", word], output=self.path("s.h5"))


class Regrid(ChainTest):
    def refuse_dem(self, code, *arguments, words=()):
        self.refuse(code, "regrid", "-c", self.chain.config("regrid"), "-o", self.path("d.h5"), *arguments,
                    words=words, output=self.path("d.h5"))

    def changed_scan(self, change):
        return self.changed(self.chain.scan, change, "s.h5")

    def test_layers_may_precede_or_follow_the_scans(self):
        for arguments in (["--layers", "z_est,count", self.chain.scan], [self.chain.scan, "--layers", "z_est,count"]):
            self.succeed("regrid", *arguments, "-c", self.chain.config("regrid"), "-O", "-o", self.path("d.h5"))
            with h5py.File(self.path("d.h5")) as file:
                layers = {name for name, item in file.items() if len(getattr(item, "shape", ())) == 2}
            self.assertEqual(layers, {"z_est", "count"})

    def test_an_output_that_is_an_input_is_refused(self):
        shutil.copy(self.chain.scan, self.path("s.h5"))
        before = read_bytes(self.path("s.h5"))
        self.refuse(2, "regrid", self.path("s.h5"), "-O", "-o", self.path("s.h5"), words=["s.h5", "input"])
        self.assertEqual(read_bytes(self.path("s.h5")), before)
        shutil.copy(self.chain.dem, self.path("d.h5"))
        for output in (["-o", self.path("d.h5")], ["-o", self.path("e.h5"), "--metrics", self.path("d.h5")]):
            self.refuse(2, "dem-eval", self.path("d.h5"), "-c", self.chain.config("dem-eval"), "-O", *output,
                        words=["d.h5"])
        self.assertEqual(read_bytes(self.path("d.h5")), read_bytes(self.chain.dem))

    def test_a_grid_too_large_is_refused_by_check_too(self):
        for name, values in (("regrid", ["half_width_m=600000"]), ("terrain-gen", ["grid.half_width_m=60000"])):
            self.refuse(2, name, "--check", *[word for value in values for word in ("--set", value)],
                        words=["half_width_m", "2^30"])

    def test_layers(self):
        self.refuse_dem(2, self.chain.scan, "--layers", "z_est,zest", words=["--layers", "'zest'", "z_est"])
        self.refuse_dem(2, self.chain.scan, "--layers", "z_true", words=["z_true", "--terrain"])

    def test_a_different_terrain_needs_same_frame(self):
        self.succeed("terrain-gen", *self.chain.inputs("terrain-gen"), "--set", "base.elevation_m=0", "-o",
                     self.path("t.h5"))
        self.refuse_dem(1, self.chain.scan, "--terrain", self.path("t.h5"), words=["scan.h5", "t.h5", "--same-frame"])
        for option in ("--same-frame", "--other-terrain"):
            self.succeed("regrid", self.chain.scan, "--terrain", self.path("t.h5"), option, "-O", "-o", self.path("d.h5"),
                         "-c", self.chain.config("regrid"))

    def test_a_return_that_is_not_finite_is_named_by_row(self):
        for value in (np.nan, np.inf):
            def change(file, value=value):
                file["points/y_est"][123] = value
            self.refuse_dem(1, self.changed_scan(change), words=["s.h5", "y_est[123]"])

    def test_a_pulse_number_out_of_range(self):
        for number in (-1, 400):
            def change(file, number=number):
                file["points/pulse"][7] = number
            self.refuse_dem(1, self.changed_scan(change), words=["s.h5", "pulse[7]", str(number)])

    def test_columns_of_different_length(self):
        self.refuse_dem(1, self.changed_scan(lambda file: file["points/z_true"].resize((5,))),
                        words=["s.h5", "z_true", "length"])

    def test_points_outside_the_grid_are_counted(self):
        text = self.succeed("regrid", self.chain.scan, "-o", self.path("d.h5"), "--json", "--set", "half_width_m=1",
                            "--set", "resolution_m=0.1").stdout
        counts = json.loads(text)
        with h5py.File(self.chain.scan) as file:
            x, y = file["points/x_est"][()], file["points/y_est"][()]
        inside = (np.abs(np.floor(x / 0.1 + 0.5)) <= 10) & (np.abs(np.floor(y / 0.1 + 0.5)) <= 10)
        self.assertEqual((counts["inside_count"], counts["outside_count"]), (inside.sum(), (~inside).sum()))

    def test_an_invalid_history_is_ignored(self):
        for text in ("[1, 2]", '{"tool": 1}', '[{"tool": 1, "file_id": "a"}]', "no JSON"):
            def change(file, text=text):
                set_text(file, "provenance/chain_json", text)
            self.succeed("regrid", self.changed_scan(change), "--terrain", self.chain.terrain, "-O", "-o",
                         self.path("d.h5"), "-c", self.chain.config("regrid"))

    def test_truth_at(self):
        self.refuse_dem(2, self.chain.scan, "--truth-at", "middle", words=["--truth-at", "middle"])


class DemEval(ChainTest):
    def arguments(self, *more):
        return [self.chain.dem, "-c", self.chain.config("dem-eval"), *more]

    LENIENT = ["--set", "limits.invalid_frac=0.1", "--set", "limits.relative_elevation_m=0.5"]

    def test_region_that_does_not_fit(self):
        self.refuse(2, "dem-eval", *self.arguments("--set", "region_radius_m=50"), "-o", self.path("e.h5"),
                    words=["/region_radius_m", "50", "fit", self.chain.dem], output=self.path("e.h5"))

    def metrics(self, *sets):
        arguments = self.arguments("--metrics-only", *[word for value in sets for word in ("--set", value)])
        return json.loads(self.succeed("dem-eval", *arguments).stdout)

    def test_square_region_and_disc(self):
        metrics = self.metrics('region={"shape": "square", "half_width_m": 3}', 'footprint_shape="disc"')
        self.assertEqual(metrics["region"], {"radius_m": None, "bin_count": 61 * 61, "shape": "square",
                                             "half_width_m": 3, "center_x_m": None, "center_y_m": None})
        self.assertEqual(metrics["accuracy"]["footprint_bins"], 7)
        self.assertNotEqual(metrics["accuracy"]["relative"]["z"], self.metrics()["accuracy"]["relative"]["z"])

    def write_mask(self, name, shape=(101, 101), **datasets):
        with h5py.File(self.path(name), "w") as file:
            mask = np.zeros(shape, datasets.pop("dtype", np.int8))
            mask[20:30, 40:80] = 1
            file["mask"] = mask
            for key, values in datasets.items():
                file[key] = values
        return self.path(name)

    def test_region_of_a_mask(self):
        for dtype in (np.int8, np.uint8, np.float32):
            path = self.write_mask("mask.h5", dtype=dtype)
            metrics = self.metrics('region={"shape": "mask", "path": "%s"}' % path)
            self.assertEqual(metrics["region"]["bin_count"], 400)
            self.assertEqual(metrics["statistics"]["z"]["count"],
                             400 - metrics["coverage"]["invalid_count"])
        # in_region of the chain's evaluation is the default circle.
        metrics = self.metrics('region={"shape": "mask", "path": "%s", "layer": "in_region"}' % self.chain.eval)
        self.assertEqual(metrics["coverage"], self.metrics()["coverage"])

    def test_masks_that_are_refused(self):
        def refuse(path, words, layer="mask"):
            region = json.dumps({"shape": "mask", "path": path, "layer": layer})
            self.refuse(1, "dem-eval", *self.arguments("--set", f"region={region}"), "-o", self.path("e.h5"),
                        words=words, output=self.path("e.h5"))
        refuse(self.path("none.h5"), ["none.h5", "no such file"])
        refuse(self.write_mask("a.h5"), ["a.h5", "/other"], layer="other")
        refuse(self.write_mask("b.h5", shape=(101, 100)), ["b.h5", "/mask", "(101, 101)"])
        refuse(self.write_mask("c.h5", x=np.arange(101) * 0.1), ["c.h5", "/x"])
        with h5py.File(self.write_mask("d.h5"), "r+") as file:
            file["mask"][...] = 0
        refuse(self.path("d.h5"), ["region/path", "no bin"])

    def test_require_pass_is_3_and_writes_the_evaluation(self):
        result = run("dem-eval", *self.arguments("--require-pass"), "-o", self.path("e.h5"))
        self.assertEqual((result.returncode, result.stdout), (3, ""))
        self.check_message("dem-eval", result.stderr, [self.chain.dem, "coverage", "relative_elevation"])
        self.assertNotIn("hole_size", result.stderr)
        self.assertEqual(read_bytes(self.path("e.h5")), read_bytes(self.chain.eval))

    def test_require_pass_is_0_if_all_requirements_pass(self):
        self.succeed("dem-eval", *self.arguments("--require-pass", *self.LENIENT), "-o", self.path("e.h5"))

    def test_require_pass_without_truth_is_3(self):
        self.succeed("regrid", self.chain.scan, "-c", self.chain.config("regrid"), "-o", self.path("d.h5"))
        result = run("dem-eval", self.path("d.h5"), "-c", self.chain.config("dem-eval"), "--require-pass",
                     "--metrics-only", *self.LENIENT)
        self.assertEqual(result.returncode, 3)
        self.check_message("dem-eval", result.stderr, ["relative_elevation", "absolute_horizontal"])
        metrics = json.loads(result.stdout)
        self.assertIsNone(metrics["pass"])
        self.assertIs(metrics["requirements"]["coverage"]["pass"], True)
        self.assertEqual(metrics["requirements"]["relative_elevation"]["pass"], None)
        self.assertIsNone(metrics["accuracy"]["absolute"]["x"]["p95_m"])
        self.assertEqual(set(metrics), set(json.loads(read_bytes(self.chain.metrics))))

    def test_metrics_go_to_stdout_in_the_documented_order(self):
        text = self.succeed("dem-eval", *self.arguments("--metrics-only")).stdout
        self.assertEqual(text, read_bytes(self.chain.metrics).decode())
        metrics = json.loads(text)
        self.assertEqual(list(metrics), ["format", "version", "pass", "region", "assumptions", "coverage", "accuracy",
                                         "requirements", "statistics", "uncertainty"])
        self.assertEqual((metrics["format"], metrics["version"]), ("landfall.metrics", 2))
        self.assertEqual(list(metrics["requirements"]), [
            "coverage", "hole_size", "hole_distance", "relative_elevation", "relative_horizontal",
            "absolute_horizontal"])
        self.assertEqual(list(metrics["coverage"]), [
            "invalid_count", "invalid_frac", "hole_count", "largest_hole_bins", "holes_over_limit",
            "max_distance_bins", "distance_over_limit_count", "hole_size_histogram"])
        self.assertEqual(self.entries(), [])

    def test_existing_metrics_are_refused_before_the_run(self):
        self.refuse(2, "dem-eval", "/nowhere/dem.h5", "-o", self.path("e.h5"), "--metrics", self.write("m.json", "precious"),
                    words=["m.json", "-O"], output=self.path("e.h5"))
        self.assertEqual(read_bytes(self.path("m.json")), b"precious")
        self.succeed("dem-eval", *self.arguments("-O"), "-o", self.path("e.h5"), "--metrics", self.path("m.json"))
        self.assertEqual(read_bytes(self.path("m.json")), read_bytes(self.chain.metrics))

    def test_output_and_metrics_must_differ(self):
        os.symlink(self.folder, self.path("alias"))
        for other in ("same", "./same", "alias/same"):
            for more in ([], ["-O"]):
                self.refuse(2, "dem-eval", *self.arguments(*more), "-o", self.path("same"), "--metrics",
                            os.path.join(self.folder, other), words=["--metrics"], output=self.path("same"))

    def test_report_is_the_same_for_any_threads_and_with_or_without_layers(self):
        reports = [self.path(f"r{k}.html") for k in range(3)]
        self.succeed("dem-eval", *self.arguments("-t", "1"), "-o", self.path("e.h5"), "--report", reports[0])
        self.succeed("dem-eval", *self.arguments("-t", "2"), "-o", self.path("f.h5"), "--report", reports[1])
        self.assertEqual(read_bytes(reports[0]), read_bytes(reports[1]))
        self.assertEqual(read_bytes(self.path("e.h5")), read_bytes(self.chain.eval))
        result = self.succeed("dem-eval", *self.arguments("--metrics-only"), "--report", reports[2])
        self.assertEqual(result.stdout, "")
        data = [read_bytes(path).split(b'id="report-data"')[1] for path in (reports[0], reports[2])]
        self.assertEqual(data[0], data[1])
        self.assertEqual(self.entries(), ["e.h5", "f.h5", "r0.html", "r1.html", "r2.html"])

    def test_an_existing_report_is_refused_before_the_run(self):
        outputs = ["-o", self.path("e.h5"), "--report", self.write("r.html", "precious")]
        self.refuse(2, "dem-eval", "/nowhere/dem.h5", *outputs, words=["r.html", "-O"], output=self.path("e.h5"))
        self.assertEqual(read_bytes(self.path("r.html")), b"precious")
        self.succeed("dem-eval", *self.arguments("-O"), *outputs)
        self.assertIn(b"<!DOCTYPE html>", read_bytes(self.path("r.html")))

    def test_report_must_differ_from_the_other_files(self):
        shutil.copy(self.chain.dem, self.path("d.h5"))
        for arguments, word in ((["-o", self.path("e.h5"), "--report", self.path("d.h5")], "d.h5 is an input of this run"),
                                (["-o", self.path("e.h5"), "--report", "-"], "--report needs a file")):
            self.refuse(2, "dem-eval", self.path("d.h5"), "-O", *arguments, words=[word])
            self.assertEqual(self.entries(), ["d.h5"])
        self.assertEqual(read_bytes(self.path("d.h5")), read_bytes(self.chain.dem))

    def test_table_and_json_exclude_each_other(self):
        self.refuse(2, "dem-eval", *self.arguments("--table", "--json"), "-o", self.path("e.h5"), words=["--table"])

    def test_table(self):
        text = self.succeed("dem-eval", *self.arguments("--table"), "-o", self.path("e.h5")).stdout
        for word in ["coverage", "hole_size", "hole_distance", "relative_elevation", "relative_horizontal",
                     "absolute_horizontal", "pass", "FAIL"]:
            self.assertIn(word, text)


if __name__ == "__main__":
    unittest.main()
