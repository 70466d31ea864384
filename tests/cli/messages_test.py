#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The messages of a run beyond errors: its conclusion, warnings, the log, and which output names it refuses."""
import json
import re
import shutil
import unittest

import h5py

from harness import EVAL, REGRID, SCAN, TERRAIN, TOOLS, ChainTest, attributes, read_bytes, run, with_values


class Conclusion(ChainTest):
    """One line at the end of each tool, on a terminal (terminal_test.py) and with -v."""

    LINE = {"terrain-gen": r"14,641 nodes, 3 features", "scan-sim": r"25,600 rays: [0-9,]+ returns, 0 % missed the terrain",
            "regrid": r"[0-9,]+ returns in the map, [0-9,]+ outside it; [0-9,]+ of 10,201 bins are empty",
            "dem-eval": r".*dem\.h5: FAIL: [a-z_, ]+",
            "hazard-map": r".*dem\.h5: [0-9.]+ % safe, [0-9.]+ % hazard, [0-9.]+ % unknown; best site \([0-9.-]+, [0-9.-]+\) m, no probability: the map has no 1-sigma layer",
            "monte-carlo": r"0 of 2 draws pass all requirements; passes with a probability of at most 0\.6576 \(Wilson, 95 %\)"}

    def test_each_tool_says_its_result(self):
        for name in TOOLS:
            result = run(name, *self.chain.inputs(name), "-o", self.path("out.h5"), "-O", "-v")
            self.assertRegex(result.stderr.splitlines()[-1], rf"^{name}: {self.LINE[name]}$")

    def test_a_refused_dem_says_why_once(self):
        result = run("dem-eval", *self.chain.inputs("dem-eval"), "--metrics", self.path("m.json"), "--require-pass")
        self.assertEqual((result.returncode, result.stdout), (3, ""))
        self.assertRegex(result.stderr, r"\Adem-eval: .*dem\.h5: missed or not judged: [a-z_, ]+\n\Z")


class Warnings(ChainTest):
    """A warning is one line on stderr and in --json; -q suppresses it; the exit status stays 0."""

    def warning(self, name, *arguments):
        arguments = [name, *arguments, "-O"]
        quiet = run(*arguments, "-q")
        self.assertEqual((quiet.returncode, quiet.stderr), (0, ""))
        result = run(*arguments, "--json")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, rf"\A{name}: warning: [^\n]+\n\Z")
        text = result.stderr.removeprefix(f"{name}: warning: ").rstrip("\n")
        self.assertEqual(json.loads(result.stdout)["warnings"], [text])
        return text

    def test_rays_that_miss_the_terrain(self):
        small = self.path("small.h5")
        self.succeed("terrain-gen", "-c", self.config(with_values(TERRAIN, grid__half_width_m=3)), "-o", small)
        text = self.warning("scan-sim", "-c", self.chain.config("scan-sim"), "--terrain", small, "-o", self.path("s.h5"))
        self.assertRegex(text, r"^[0-9.]+ % of the rays missed the terrain; enlarge it, or narrow the scan$")
        summary = json.loads(run("scan-sim", "-c", self.chain.config("scan-sim"), "--terrain", small, "-o",
                                 self.path("s.h5"), "-O", "--json", "-q").stdout)
        share = summary["miss_count"] / sum(summary[f"{key}_count"] for key in ("miss", "return", "dropout", "false_return"))
        self.assertAlmostEqual(float(text.split()[0]), 100 * share, delta=0.1)
        self.assertGreater(share, 0.01)

    def test_a_region_beyond_the_scan(self):
        dem = self.path("wide.h5")
        self.succeed("regrid", self.chain.scan, "-o", dem, "-c", self.config(with_values(REGRID, half_width_m=8)))
        text = self.warning("dem-eval", dem, "-c", self.config(with_values(EVAL, region_radius_m=7.5)), "-o",
                            self.path("e.h5"))
        self.assertRegex(text, r"wide\.h5: the judged region reaches [0-9.]+ m beyond the scanned area; reduce it")

    def scan(self, **errors):
        """A scan with 1 cm of range noise and these errors."""
        config = with_values(SCAN, **{"noise": {"range_sigma_m": 0.01}, "navigation_error": {}, **errors})
        path = self.path("erring.h5")
        self.succeed("scan-sim", "-c", self.config(config), "--terrain", self.chain.terrain, "-O", "-o", path)
        return path

    def sigmas(self, scan, *options):
        """regrid's arguments for all sigmas of a scan."""
        return ["regrid", scan, "-c", self.chain.config("regrid"), "--uncertainty", "--corrected", *options, "-o",
                self.path("sigmas.h5")]

    def comments(self):
        """The comments of the layers that have one."""
        with h5py.File(self.path("sigmas.h5")) as file:
            found = {name: attributes(layer).get("comment") for name, layer in file.items() if isinstance(layer, h5py.Dataset)}
        return {name: comment for name, comment in found.items() if comment is not None}

    def test_sigmas_say_which_errors_they_leave_out(self):
        for errors, left_out in (
                ({"noise__range_bias_m": 0.05}, ["/noise/range_bias_m"]),
                ({"noise__false_return_frac": 0.01, "detector__subpixels": 2, "detector__estimator": "first",
                  "scanner__tof_lag": True}, ["/detector/estimator", "/noise/false_return_frac", "/scanner/tof_lag"])):
            text = self.warning(*self.sigmas(self.scan(**errors)))
            self.assertRegex(text, r"^--uncertainty: the sigmas leave out errors of the scans: ")
            self.assertEqual(text.split(": ")[2].split(", "), left_out)
            self.assertEqual(self.comments(), dict.fromkeys(
                ("z_sigma_abs", "z_sigma_rel", "z_sigma_noise", "z_corrected_sigma_abs", "z_corrected_sigma_rel", "xy_sigma"),
                "leaves out errors of the scans: " + ", ".join(left_out)))

    def test_sigmas_of_0_for_a_navigation_error_that_is_switched_on(self):
        scan = self.scan(navigation_error={"velocity_mps": [0, 0.1, 0], "position_m": [0, 0, 0.1]})
        text = self.warning(*self.sigmas(scan, "--navigation-sigma", "position_m=0.1"))
        self.assertEqual(text, "--uncertainty: the sigmas leave out errors of the scans: /navigation_error/velocity_mps")

    def test_sigmas_without_range_noise(self):
        text = self.warning(*self.sigmas(self.scan(noise__range_sigma_m=0)))
        self.assertEqual(text, "--uncertainty: the range noise is 0; give --range-sigma METRES or /uncertainty/range_sigma_m if the lidar has noise")
        self.assertEqual(self.comments(), {})

    def test_complete_sigmas_say_nothing(self):
        arguments = self.sigmas(self.scan(detector__subpixels=2))
        self.assertEqual(run(*arguments).stderr, "")
        self.assertEqual(self.comments(), {})

    def test_a_raster_coarser_than_a_quarter_of_the_site(self):
        raster = self.path("raster.tif")
        self.succeed("terrain-gen", "-o", raster, "--set", "grid.half_width_m=50", "--set", "grid.resolution_m=10")
        text = self.warning("terrain-gen", "--from", raster, "--half-width", "10", "--resolution", "1", "-o",
                            self.path("t.h5"))
        self.assertIn("one sample per 10 m, the site is only 20 m wide: its values are interpolated", text)
        text = self.warning("terrain-gen", "--from", raster, "--half-width", "25", "--resolution", "0.005", "-o",
                            self.path("t.h5"), "--set", "grid={\"half_width_m\": 25, \"resolution_m\": 0.0078125}")
        self.assertIn("one node per 0.00781 m: that is more than 1,000 times finer", text)
        self.succeed("terrain-gen", "--from", raster, "--half-width", "20", "--resolution", "1", "-o", self.path("u.h5"))


class Log(ChainTest):
    def test_it_keeps_what_quiet_omits_and_grows(self):
        log = self.path("run.log")
        for name in TOOLS:
            self.succeed(name, *self.chain.inputs(name), "-o", self.path("out.h5"), "-O", "-q", "--log", log)
            self.assertEqual(read_bytes(self.path("out.h5")), read_bytes(self.chain.output(name)))
        self.refuse(1, "dem-eval", self.path("nowhere.h5"), "--table", "--log", log)
        lines = read_bytes(log).decode().splitlines()
        self.assertEqual(lines[0], "# landfall log")
        self.assertEqual([line.split()[1] for line in lines if line.startswith("$ ")], [*TOOLS, "dem-eval"])
        for name in TOOLS:
            self.assertTrue(any(line.startswith(f"{name}: writes ") for line in lines), name)
        self.assertRegex(lines[-1], r"^dem-eval: .*nowhere\.h5: no such file$")

    def test_no_other_file_is_changed(self):
        before = read_bytes(self.chain.scan)
        self.refuse(2, "regrid", self.chain.scan, "-o", self.path("out.h5"), "--log", self.chain.scan,
                    words=["is not a log of landfall"])
        self.assertEqual(read_bytes(self.chain.scan), before)
        self.refuse(2, "regrid", self.chain.scan, "-o", self.path("out.h5"), "--log", self.folder, words=["--log"])
        self.refuse(2, "regrid", self.chain.scan, "-o", self.path("out.h5"), "--log", self.path("no/folder.log"),
                    words=["--log", "cannot be written"])


class OutputNames(ChainTest):
    """The extension of another format is refused with the command that makes that format."""

    def test_formats_that_landfall_export_writes(self):
        """Each format with each kind of file; the command itself tells which can become which."""
        formats = re.search(r"--format .*?\{(.*?)\}", self.succeed("landfall-export", "--help").stdout, re.DOTALL)[1].replace(",", " ").split()
        self.assertIn("html", formats)
        for name in TOOLS[1:5]:
            own = self.path("own.h5")
            shutil.copy(self.chain.output(name), own)
            for extension in [*formats, "TIFF", "xdmf"]:
                with self.subTest(f"{name} .{extension}"):
                    file = self.path("own." + extension)
                    sites = ["--sites"] if extension == "gpkg" else []
                    can = "which can become" not in run("landfall-export", own, "-o", self.path("made." + extension), "-O", *sites).stderr
                    result = self.refuse(2, name, *self.chain.inputs(name), "-o", file, words=[f"{name} writes HDF5; name it {own}"], output=file)
                    self.assertEqual(f", then run: landfall-export {own} -o {file}" in result.stderr, can)

    def test_formats_that_nobody_writes(self):
        result = self.refuse(2, "regrid", self.chain.scan, "-o", self.path("dem.json"), words=["name it "])
        self.assertNotIn("landfall-export", result.stderr)

    def test_the_command_of_the_message_works(self):
        message = run("regrid", *self.chain.inputs("regrid"), "-o", self.path("dem.tif")).stderr
        self.succeed("regrid", *self.chain.inputs("regrid"), "-o", self.path("dem.h5"))
        self.succeed(*message.rstrip("\n").split("then run: ")[1].split())
        self.assertEqual(read_bytes(self.path("dem.tif"))[:4], b"II*\0")

    def test_other_names_are_accepted(self):
        for name in ["dem.nc", "dem", "dem_0.05", "dem.h5.new"]:
            self.succeed("regrid", *self.chain.inputs("regrid"), "-o", self.path(name))
            self.assertEqual(read_bytes(self.path(name)), read_bytes(self.chain.dem))


class Evaluation(ChainTest):
    """The outputs that dem-eval needs: something to write, of any kind."""

    def test_a_report_needs_no_layers(self):
        self.succeed("dem-eval", *self.chain.inputs("dem-eval"), "--report", self.path("r.html"))
        self.assertIn("r.html", self.entries())

    def test_hazards_without_a_map_are_those_of_a_map(self):
        alone, beside = self.path("alone.json"), self.path("beside.json")
        self.succeed("hazard-map", *self.chain.inputs("hazard-map"), "--sites", alone)
        self.succeed("hazard-map", *self.chain.inputs("hazard-map"), "--sites", beside, "-o", self.path("h.h5"))
        self.assertEqual(read_bytes(alone), read_bytes(beside))
        self.assertEqual(self.entries(), ["alone.json", "beside.json", "h.h5"])
        self.refuse(2, "hazard-map", *self.chain.inputs("hazard-map"), "--table", "--view", self.path("v.png"), words=["--view shows the output"])

    def test_metrics_only_is_json_in_a_pipe(self):
        result = self.succeed("dem-eval", *self.chain.inputs("dem-eval"), "--metrics-only")
        self.assertEqual(json.loads(result.stdout)["format"], "landfall.metrics")

    def test_a_failure_outweighs_what_is_not_judged(self):
        dem = self.path("no_truth.h5")
        self.succeed("regrid", self.chain.scan, "-o", dem, "-c", self.chain.config("regrid"))
        table = run("dem-eval", dem, "-c", self.chain.config("dem-eval"), "--table", "-q").stdout
        self.assertRegex(table, r"(?m)^relative_elevation +no truth to compare with +5 cm +not judged$")
        self.assertRegex(table, r"(?m)^all +(FAIL|not judged)$")
        strict = run("dem-eval", dem, "--table", "-q", "-c", self.config(with_values(EVAL, limits__invalid_frac=0))).stdout
        self.assertRegex(strict, r"(?m)^all +FAIL$")


if __name__ == "__main__":
    unittest.main()
