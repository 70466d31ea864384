#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The receiver of scan-sim: closed forms on planes and steps, draws, kept echoes, replays, and the other tools' view of it."""
import json
import math
import os
import struct
import unittest

import h5py
import numpy as np

from harness import SCAN, Chain, ToolTest, columns, read_bytes, with_values

LIGHT_MPS = 299792458
FWHM_S = 1e-9
SIGMA_M = LIGHT_MPS / 2 * FWHM_S / (2 * math.sqrt(2 * math.log(2)))
RANGE_M = 500
PE = 100  # of the surface's centre, albedo 1, normal incidence
THRESHOLD_PE = 20
LINEAR = ("leading_edge", "constant_fraction", "peak", "centroid")
RETURN, DROPOUT, UNDETECTED = 0, 2, 7


def plane(slope=0.0):
    return {"grid": {"half_width_m": 10, "resolution_m": 1}, "base": {"type": "plane", "slope_x": slope}}


def reported_m(kind, x, w):
    """The range that a receiver reports of the waveform w at the ranges x, without noise."""
    if kind == "leading_edge":
        return x[np.argmax(w >= THRESHOLD_PE)]
    if kind == "constant_fraction":
        return x[np.argmax(w >= w.max() / 2)] + SIGMA_M * math.sqrt(2 * math.log(2))
    return x[w.argmax()] if kind == "peak" else np.sum(x * w) / np.sum(w)


def stare(**values):
    """A lidar at rest above the centre, one pixel of 0.1 mrad, 200 pulses; `values` as of with_values()."""
    config = {"detector": {"rows": 1, "columns": 1, "ifov_rad": 1e-4},
              "laser": {"pulse_rate_hz": 1000, "scan_time_s": 0.2},
              "scanner": {"type": "flash"},
              "trajectory": {"type": "constant_velocity", "position_m": [0.3, 0.2, RANGE_M], "velocity_mps": [0, 0, 0]},
              "noise": {}, "beam": {}, "surface": {}, "link": {"reference_pe": PE, "reference_range_m": RANGE_M},
              "receiver": {"type": "leading_edge", "threshold_pe": THRESHOLD_PE, "photon_noise": False}, "seed": 5}
    return with_values(config, **values)


REPLAY_OPTIONS = (["--keep-misses", "--keep-echoes"], [], ["--keep-misses"], ["--keep-echoes"], ["--float32"])


class ReceiverTest(ToolTest):
    def terrain(self, config, name="terrain.h5"):
        self.succeed("terrain-gen", "-c", self.config(config), "-O", "-o", self.path(name))
        return self.path(name)

    def scan(self, config, terrain, *options, output="scan.h5"):
        self.succeed("scan-sim", "-c", self.config(config), "--terrain", terrain, "-O", "-o", self.path(output), *options)
        return columns(self.path(output), "points")


class ClosedForms(ReceiverTest):
    def test_a_fixed_threshold_walks_with_the_signal(self):
        """t = -sigma sqrt(2 ln(A/threshold)): with albedo a the range is short by sigma sqrt(2 ln(100 a/20))."""
        terrain = self.terrain(plane())
        for albedo in (0.201, 0.3, 0.5, 1):
            points = self.scan(stare(surface__albedo=albedo), terrain)
            walk = SIGMA_M * math.sqrt(2 * math.log(PE * albedo / THRESHOLD_PE))
            np.testing.assert_allclose(points["range_measured"] - RANGE_M, -walk, atol=2e-9)
            points = self.scan(stare(surface__albedo=albedo, receiver__walk_correction=True), terrain)
            np.testing.assert_allclose(points["range_measured"], RANGE_M, atol=2e-9)

    def test_intensity_goes_with_albedo_cosine_and_range(self):
        for slope in (0, 0.5, 1.5):
            terrain = self.terrain(plane(slope))
            for height in (300, 500, 900):
                config = stare(trajectory__position_m=[0, 0, height], surface__albedo=0.6, receiver__threshold_pe=1)
                points = self.scan(config, terrain)
                expected = PE * 0.6 / math.hypot(1, slope) * (RANGE_M / height)**2
                np.testing.assert_allclose(points["intensity"], expected, rtol=1e-6)

    def test_the_share_of_detections_is_that_of_poisson_counts(self):
        terrain = self.terrain(plane())
        config = stare(receiver__photon_noise=True, laser__scan_time_s=20)
        for mean in (12, 20, 28):
            with_mean = with_values(config, link__reference_pe=mean)
            points = self.scan(with_mean, terrain, "--keep-misses")
            self.assertEqual(set(points["status"]), {RETURN, UNDETECTED})
            below = math.exp(-mean) * math.fsum(mean**n / math.factorial(n) for n in range(THRESHOLD_PE))
            n = len(points["status"])
            self.assertLess(abs(np.mean(points["status"] == RETURN) - (1 - below)), 4.5 * math.sqrt(below * (1 - below) / n))
            with h5py.File(self.path("scan.h5")) as file:
                self.assertEqual(file["points"].attrs["undetected_count"], np.sum(points["status"] == UNDETECTED))
            undetected = points["status"] == UNDETECTED
            for name in ("range_measured", "x_est", "intensity"):
                self.assertTrue(np.isnan(points[name][undetected]).all(), name)
            np.testing.assert_allclose(points["range_true"], RANGE_M, atol=1e-9)

    def test_geiger_reports_the_first_of_n_photoelectrons(self):
        """E[min] of a Poisson process of mean N and Gaussian shape, given that there is one, by quadrature."""
        terrain = self.terrain(plane())
        x = np.linspace(-9, 9, 200001)
        shape = np.exp(-x * x / 2) / math.sqrt(2 * math.pi)
        below = np.concatenate([[0], np.cumsum((shape[1:] + shape[:-1]) / 2 * (x[1] - x[0]))])
        for mean in (0.5, 3, 50):
            config = stare(receiver__type="geiger", link__reference_pe=mean, laser__scan_time_s=20)
            points = self.scan(config, terrain)
            density = mean * shape * np.exp(-mean * below)
            chance = -math.expm1(-mean)
            first = np.sum(x * density) * (x[1] - x[0]) / chance
            n, error = len(points["pixel"]), points["range_measured"] - RANGE_M
            self.assertLess(abs(error.mean() - SIGMA_M * first), 4.5 * error.std() / math.sqrt(n))
            self.assertLess(abs(n / 20000 - chance), 4.5 * math.sqrt(chance * (1 - chance) / 20000) + 1e-12)
            self.assertEqual(set(points["intensity"]), {1})

    def test_a_step_agrees_with_its_waveform(self):
        """Level terrain at 0 and, over x > 0, at `height`: a quarter or half of the sub-rays see each of two pulses."""
        x = np.linspace(-0.6, 0.4, 1000001)
        pulse = lambda at: np.exp(-(x - at)**2 / 2 / SIGMA_M**2)
        for height in (0.08, 0.12, 0.14, 0.3):
            corners = [(-9, 0), (0, 0), (0, height), (9, height)]
            with open(self.path("step.obj"), "w", encoding="utf-8") as file:
                for i, (east, up) in enumerate(corners):
                    file.write(f"v {east} -9 {up}\nv {east} 9 {up}\n" + f"f {2*i-1} {2*i+1} {2*i+2}\nf {2*i-1} {2*i+2} {2*i}\n" * (i > 0))
            terrain = self.terrain({"mesh": {"path": self.path("step.obj")}})
            for east, share in ((0, 0.5), (-0.0125, 0.25)):
                energy = PE * np.array([share * (RANGE_M / (RANGE_M - height))**2, 1 - share])
                w = energy[0] * pulse(-height) + (energy[1] * pulse(0) if height < SIGMA_M * 2 * math.sqrt(2 * math.log(2)) else 0)
                for kind in LINEAR:
                    points = self.scan(stare(trajectory__position_m=[east, 0, RANGE_M], detector__subpixels=16, receiver__type=kind,
                                             laser__scan_time_s=0.001), terrain)
                    self.assertAlmostEqual(points["range_measured"][0] - RANGE_M, reported_m(kind, x, w), delta=2e-5,
                                           msg=f"{height} {share} {kind}")

    def test_a_tilted_plane_agrees_with_its_waveform(self):
        """A box of the length L = pixel x slope, convolved with the pulse: (N/L) sigma sqrt(pi/2) (erf(...) - erf(...))."""
        x = np.linspace(-1, 1, 200001)
        for slope_deg in (45, 73):
            slope = math.tan(math.radians(slope_deg))
            terrain = self.terrain(plane(slope))
            length = RANGE_M * 1e-4 * slope
            erf = np.frompyfunc(math.erf, 1, 1)
            edge = lambda at: erf((x - at) / SIGMA_M / math.sqrt(2)).astype(float)
            w = PE / length * SIGMA_M * math.sqrt(math.pi / 2) * (edge(-length / 2) - edge(length / 2))
            for kind in LINEAR:
                points = self.scan(stare(trajectory__position_m=[0, 0, RANGE_M], detector__subpixels=25, receiver__type=kind,
                                         link__reference_pe=PE * math.hypot(1, slope), laser__scan_time_s=0.001), terrain)
                self.assertAlmostEqual(points["range_measured"][0] - RANGE_M, reported_m(kind, x, w), delta=5e-5,
                                       msg=f"{slope_deg} {kind}")

    def test_the_clock_comes_last(self):
        terrain = self.terrain(plane())
        step = LIGHT_MPS / 2 * 1e-10
        config = stare(receiver__clock_scale_ppm=50, receiver__timer_step_s=1e-10, receiver__type="none")
        del config["link"], config["receiver"]["threshold_pe"]
        points = self.scan(config, terrain)
        self.assertEqual(set(points["range_measured"]), {step * math.floor(RANGE_M * (1 + 50e-6) / step + 0.5)})
        self.assertNotIn("intensity", points)


class Draws(ReceiverTest):
    """Causes of errors are independent: switching one on changes no draw of another."""

    @classmethod
    def setUpClass(cls):
        cls.chain = Chain()
        cls.addClassCleanup(cls.chain.remove)

    def test_without_a_receiver_nothing_changes(self):
        terrain = self.terrain(plane())
        config = {key: value for key, value in stare().items() if key not in ("beam", "surface", "link", "receiver")}
        config["noise"] = {"range_sigma_m": 0.02, "dropout_frac": 0.1, "false_return_frac": 0.1}
        self.scan(config, terrain, "--keep-misses", output="without.h5")
        self.scan({**config, "receiver": {"type": "none"}, "beam": {}, "surface": {"albedo": 1}, "link": {}}, terrain,
                  "--keep-misses", output="off.h5")
        self.assertEqual(read_bytes(self.path("without.h5")), read_bytes(self.path("off.h5")))

    def test_each_term_leaves_the_draws_of_the_others(self):
        terrain = self.terrain(plane())
        base = stare(receiver__type="centroid", noise__range_sigma_m=0.01, noise__dropout_frac=0.1, noise__dead_pixel_frac=0.2,
                     noise__false_return_frac=0.05, detector__rows=5, detector__columns=6)
        before = self.scan(base, terrain, "--keep-misses")
        measured = before["status"] == RETURN
        for key, value in (("jitter_sigma_s", 1e-10), ("pixel_offset_sigma_m", 0.01), ("photon_noise", True),
                           ("clock_scale_ppm", 20), ("timer_step_s", 1e-10)):
            after = self.scan(with_values(base, **{"receiver__" + key: value}), terrain, "--keep-misses")
            np.testing.assert_array_equal(after["status"], before["status"], key)
            self.assertTrue(np.all(after["range_measured"][measured] != before["range_measured"][measured]), key)
            np.testing.assert_array_equal(after["range_measured"][~measured], before["range_measured"][~measured])
        pixel = before["pixel"][measured]
        offset = self.scan(with_values(base, receiver__pixel_offset_sigma_m=0.01), terrain, "--keep-misses")
        offset = (offset["range_measured"] - before["range_measured"])[measured]
        for number in set(pixel):
            np.testing.assert_allclose(offset[pixel == number], offset[pixel == number][0], atol=1e-11)
        self.assertEqual(len(set(np.round(offset, 9))), len(set(pixel)))

    def test_offsets_of_the_pixels_from_a_table(self):
        terrain = self.terrain(plane())
        base = stare(receiver__type="none", noise__range_sigma_m=0.01, noise__dropout_frac=0.1, detector__rows=5, detector__columns=6)
        before = self.scan(base, terrain, "--keep-misses")
        offsets_m = np.random.default_rng(1).normal(0, 0.02, (5, 6))
        rows = "".join(f"{row},{column},{offsets_m[row, column]}\n" for column in range(6) for row in range(5))
        table = {"path": self.write("offsets.csv", "row,column,offset_m\n" + rows)}
        after = self.scan({**base, "receiver": {"pixel_offset_table": table}}, terrain, "--keep-misses")
        for name in set(before) - {"range_measured", "x_est", "y_est", "z_est"}:
            np.testing.assert_array_equal(after[name], before[name], name)
        np.testing.assert_allclose(after["range_measured"] - before["range_measured"], np.where(
            before["status"] == RETURN, offsets_m.ravel()[before["pixel"]], np.nan), atol=1e-12)
        os.replace(self.path("scan.h5"), self.path("traced.h5"))
        self.scan({**base, "noise": {}}, terrain, "--keep-misses", output="source.h5")
        self.succeed(*self.replay({**base, "receiver": {"pixel_offset_table": table}}, "--keep-misses"))
        self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")))

    RICH = with_values(SCAN, detector__subpixels=3, detector__ifov_rad=0.003, noise__dropout_frac=0.1, noise__false_return_frac=0.02,
                       noise__false_range_m=[30, 60], laser__scan_time_s=0.05, scanner__pattern__rows=10, scanner__pattern__columns=10)

    def rich(self, kind, **receiver):
        return {**self.RICH, "beam": {"divergence_rad": 0.03}, "surface": {"albedo": 0.5},
                "link": {"reference_pe": 120, "reference_range_m": 50, "background_pe": 3},
                "receiver": {"type": kind, "pulse_fwhm_s": 3e-10, **({} if kind == "geiger" else {"threshold_pe": 10}),
                             "jitter_sigma_s": 1e-11, **receiver}}

    def test_threads_batches_and_engines_give_the_same_bytes(self):
        for kind in (*LINEAR, "geiger"):
            config = self.rich(kind, returns="all", max_returns=2)
            self.scan(config, self.chain.terrain, "-t", 1, "--keep-misses")
            expected = columns(self.path("scan.h5"), "points")
            whole = read_bytes(self.path("scan.h5"))
            self.assertIn(2, expected["return_number"], kind)
            for options in (["-t", 2], ["-t", 5, "--batch-points", 64], ["--batch-points", 1]):
                self.scan(config, self.chain.terrain, *options, "--keep-misses", output="other.h5")
                self.assertEqual(read_bytes(self.path("other.h5")), whole, (kind, options))
            found = self.scan(config, self.chain.terrain, "--engine", "cgal", "--keep-misses", output="other.h5")
            for name, values in expected.items():
                np.testing.assert_allclose(found[name], values, rtol=1e-6 if name == "intensity" else 0,
                                           atol=1e-9 if values.dtype == float else 0, err_msg=f"{kind} {name}")

    def replay(self, config, *options, source="source.h5", output="replayed.h5"):
        return ["scan-sim", "-c", self.config(config, "replay.json"), "--ranges-from", self.path(source), "-O", "-o",
                self.path(output), *options]

    def test_a_replay_of_kept_echoes_equals_a_trace(self):
        for number, kind in enumerate(LINEAR, 1):
            for returns in ("first", "last", "strongest"):
                config = self.rich(kind, returns=returns)
                self.scan(config, self.chain.terrain, "--keep-misses", "--keep-echoes", output="source.h5")
                other = with_values(config, receiver__jitter_sigma_s=2e-11, receiver__pixel_offset_sigma_m=0.01,
                                    receiver__timer_step_s=1e-10, noise__dropout_frac=0.2, noise__dead_pixel_frac=0)
                for options in (REPLAY_OPTIONS[0], *REPLAY_OPTIONS[number:number + (returns == "first")]):
                    self.scan(other, self.chain.terrain, "--seed", 8, *options, output="traced.h5")
                    self.succeed(*self.replay(other, "--seed", 8, *options))
                    self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")), (kind, options))
        lossless = with_values(config, noise__dropout_frac=0, noise__false_return_frac=0, noise__dead_pixel_frac=0)
        self.scan(lossless, self.chain.terrain, "--keep-misses", "--keep-echoes", output="source.h5")
        self.scan(lossless, self.chain.terrain, "--seed", 8, "--keep-misses", output="traced.h5")
        self.succeed(*self.replay(lossless, "--seed", 8, "--keep-misses"))
        self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")))

    def test_the_first_return_is_the_first_row_of_all(self):
        for kind in LINEAR:
            config = {**self.rich(kind, threshold_pe=25), "laser": SCAN["laser"], "scanner": SCAN["scanner"]}
            first = self.scan(config, self.chain.terrain, "--keep-misses", "--keep-echoes")
            with h5py.File(self.path("scan.h5")) as file:
                echoes = {name: file["echoes"][name][()] for name in file["echoes"]}
            key = echoes["pulse"].astype(np.int64) * first["pixel"].max() * 2 + echoes["pixel"]
            self.assertGreater(len(key), 50)
            self.assertTrue((np.diff(key) >= 0).all())
            self.assertTrue((echoes["number"][np.diff(key, prepend=-1) > 0] == 1).all())
            every = self.scan({**config, "receiver": {**config["receiver"], "returns": "all"}}, self.chain.terrain, "--keep-misses")
            begins = np.flatnonzero(every["return_number"] <= 1)
            self.assertEqual(len(begins), len(first["pixel"]))
            for name in ("status", "intensity", "range_measured", "x_est", "pulse", "pixel"):
                np.testing.assert_array_equal(first[name], every[name][begins], name)
            far = (first["status"] == RETURN) & (first["range_measured"] > first["echo_range"] + 0.1)
            self.assertGreater(np.count_nonzero(far), 3, "some first echo was too weak, and the next one was reported")

    def test_a_replay_refuses_echoes_out_of_order(self):
        config = self.rich("peak")
        for change in ("order", "pixel", "number", "table"):
            self.scan(config, self.chain.terrain, "--keep-misses", "--keep-echoes", output="source.h5")
            with h5py.File(self.path("source.h5"), "r+") as file:
                echoes = file["echoes"]
                if change == "order":
                    echoes["pulse"][:] = echoes["pulse"][()][::-1]
                elif change == "table":
                    del file["echoes"]
                else:
                    echoes[change][0] = -1 if change == "pixel" else 0
            if change == "table":
                self.refuse(2, *self.replay(config), words=["--keep-echoes"], output=self.path("replayed.h5"))
            else:
                self.refuse(1, *self.replay(config), words=["/echoes row 0" if change != "order" else "/echoes row"],
                            output=self.path("replayed.h5"))

    def test_kept_echoes_change_no_other_column(self):
        config = self.rich("leading_edge")
        plain = self.scan(config, self.chain.terrain, "--keep-misses")
        kept = self.scan(config, self.chain.terrain, "--keep-misses", "--keep-echoes")
        self.assertEqual(sorted(set(kept) - set(plain)), [f"echo_{name}" for name in ("edge", "peak", "range", "signal", "width")])
        for name, values in plain.items():
            np.testing.assert_array_equal(kept[name], values, name)

    def test_regrid_says_which_returns_it_uses(self):
        small = ["--set", "half_width_m=5", "--set", "resolution_m=0.1", "-O", "-o", self.path("dem.h5"), "--json"]
        scans = {"one": {**self.RICH}, "last": self.rich("peak", returns="last"), "all": self.rich("peak", returns="all")}
        for returns, config in scans.items():
            points = self.scan(config, self.chain.terrain, output=returns + ".h5")
            summary = json.loads(self.succeed("regrid", self.path(returns + ".h5"), *small).stdout)
            self.assertEqual(summary["returns_used"], returns)
            self.assertEqual(summary["inside_count"] + summary["outside_count"], len(points["pixel"]), returns)
        both = json.loads(self.succeed("regrid", self.path("all.h5"), self.path("one.h5"), *small).stdout)
        self.assertEqual(both["returns_used"], "all, one")

    def test_other_tools_show_the_columns(self):
        points = self.scan(self.rich("leading_edge", returns="all"), self.chain.terrain, "--keep-misses")
        shown = self.succeed("landfall-info", self.path("scan.h5")).stdout
        for name in ("intensity", "return_number"):
            self.assertIn(name, shown)
        undetected = int(np.sum(points["status"] == UNDETECTED))
        self.assertGreater(undetected, 0)
        self.assertRegex(shown, rf"outcomes .*, undetected {undetected}, dropout")
        self.succeed("landfall-export", self.path("scan.h5"), "-o", self.path("scan.ply"))
        header = read_bytes(self.path("scan.ply")).split(b"end_header\n")[0].decode()
        self.assertIn("property float scalar_intensity", header)
        self.assertRegex(header, r"property (char|int8) scalar_return_number")
        self.succeed("landfall-export", self.path("scan.h5"), "-o", self.path("scan.las"))
        self.check_las(read_bytes(self.path("scan.las")), points)

    def check_las(self, data, points):
        """LAS 1.2, point format 1 (ASPRS 2008): offset and count of records, then 28 bytes each."""
        begin, = struct.unpack_from("<I", data, 96)
        length, count, *by_return = struct.unpack_from("<H6I", data, 105)
        self.assertEqual((length, len(data)), (28, begin + 28 * count))
        records = np.frombuffer(data, np.dtype([("xyz", "<i4", 3), ("intensity", "<u2"), ("returns", "u1"), ("class", "u1"),
                                                ("rest", "V4"), ("t", "<f8")]), offset=begin)
        kept = np.isin(points["status"], (0, 6))
        pulse_pixel = points["pulse"].astype(np.int64) * 10**6 + points["pixel"]
        total = dict(zip(*np.unique(pulse_pixel[points["return_number"] > 0], return_counts=True)))
        self.assertEqual(set(total.values()) - {1, 2, 3, 4, 5}, set())
        self.assertGreater(max(total.values()), 1)
        number = points["return_number"][kept]
        np.testing.assert_array_equal(records["returns"] & 7, number)
        np.testing.assert_array_equal(records["returns"] >> 3 & 7, [total[key] for key in pulse_pixel[kept]])
        np.testing.assert_array_equal(records["intensity"],
                                      np.floor(np.nan_to_num(points["intensity"][kept].astype(float)) + 0.5).clip(0, 65535))
        self.assertEqual(list(by_return), [int(np.sum(number == n)) for n in range(1, 6)])
        np.testing.assert_array_equal(records["class"], np.where(points["status"][kept] == 6, 7, 1))

    def test_a_threshold_above_every_echo(self):
        terrain = self.terrain(plane())
        self.refuse(1, "scan-sim", "-c", self.config(stare(receiver__threshold_pe=1e6)), "--terrain", terrain, "-o",
                    self.path("scan.h5"), words=["no return: 200 too weak to be detected"], output=self.path("scan.h5"))

    def test_values_without_effect_are_warned_of(self):
        terrain = self.terrain(plane())
        off = {**stare(receiver__type="none"), "link": {}, "receiver": {}}
        on = stare(receiver__photon_noise=True)
        cases = [(with_values(on, receiver__type="peak", receiver__walk_correction=True), ["/receiver/walk_correction"]),
                 (with_values(on, receiver__type="peak", receiver__fraction=0.3), ["/receiver/fraction"]),
                 (with_values(on, receiver__dead_time_s=1e-9), ["/receiver/dead_time_s"]),
                 (with_values(on, receiver__max_returns=2), ["/receiver/max_returns"]),
                 (with_values(on, receiver__type="geiger", receiver__threshold_pe=20, receiver__photon_noise=True,
                              receiver__dead_time_s=1e-9), ["/receiver/dead_time_s"]),
                 (with_values(on, receiver__type="geiger", receiver__threshold_pe=20, receiver__photon_noise=True,
                              receiver__dead_time_s=1e-9, receiver__returns="last"), []),
                 (with_values(on, receiver__type="geiger", receiver__threshold_pe=7), ["/receiver/threshold_pe"]),
                 (with_values(on, beam__profile="top_hat"), ["/beam/profile"]),
                 (with_values(on, beam__offset_rad=[1e-3, 0]), ["/beam/offset_rad"]),
                 (with_values(on, receiver__photon_noise=False, link__background_pe=3), ["/link/background_pe"]),
                 (with_values(off, surface__albedo=0.5), ["/surface"]),
                 (with_values(off, beam__profile="top_hat"), ["/beam"]),
                 (with_values(off, beam__offset_rad=[1e-3, 0]), ["/beam"]),
                 (with_values(off, link__background_pe=3), ["/link"]),
                 (with_values(off, receiver__pulse_fwhm_s=2e-9), ["/receiver/pulse_fwhm_s"]),
                 (on, []), (off, []), (with_values(on, beam={"divergence_rad": 0.01, "profile": "top_hat"}), []),
                 (with_values(on, receiver__type="geiger", receiver__threshold_pe=20, link__background_pe=3,
                              receiver__photon_noise=True), [])]
        for config, keys in cases:
            result = self.succeed("scan-sim", "-c", self.config(config), "--terrain", terrain, "-O", "-o", self.path("scan.h5"))
            warned = [line.split()[2] for line in result.stderr.splitlines()]
            if config["receiver"].get("type", "none") != "none":  # one ray of the pixel
                keys = [*keys, "/detector/subpixels"]
            self.assertEqual(sorted(warned), sorted(keys), config)


if __name__ == "__main__":
    unittest.main()
