#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scanners that steer by mirrors or turn the camera, in whole scans: replay as tables, blanking, errors of the estimate."""
import unittest

import numpy as np

from harness import CONFIGS, ChainTest, columns

LINES = 20
PULSES_PER_LINE = 20
PULSE_RATE_HZ = 2000


class Mirrors(ChainTest):
    def arguments(self, scanner, *options):
        """Arguments of a scan without errors other than the scanner's."""
        config = dict(CONFIGS["scan-sim"], scanner=scanner)
        for part in ("noise", "navigation_error"):
            del config[part]
        return ["scan-sim", "-c", self.config(config), "--terrain", self.chain.terrain, "-O", "-o", self.path("scan.h5"),
                "--keep-misses", *options]

    def scan(self, scanner, *options):
        self.succeed(*self.arguments(scanner, *options))
        return columns(self.path("scan.h5"), "points"), columns(self.path("scan.h5"), "pulses")

    def table(self, pulses):
        path = self.path("angles.csv")
        with open(path, "w", encoding="utf-8") as file:
            print("t_s,angle_1_rad,angle_2_rad", file=file)
            for row in zip(pulses["t"], pulses["angle_1"], pulses["angle_2"]):
                print(",".join(repr(float(value)) for value in row), file=file)
        return path

    def fsm(self, **keys):
        pattern = {"type": "line_search", "rows": LINES, "columns": PULSES_PER_LINE, "half_width_m": 4}
        return {"type": "fsm", "incidence_deg": 45, "fold_azimuth_deg": 10, "pattern": pattern, **keys}

    def assert_same_points(self, first, second, tolerance_m):
        np.testing.assert_array_equal(first["status"], second["status"])
        for name in ("x_true", "y_true", "z_true", "x_est", "y_est", "z_est"):
            np.testing.assert_allclose(first[name], second[name], rtol=0, atol=tolerance_m)

    def test_the_angles_of_an_fsm_replayed_as_a_table_give_its_points(self):
        points, pulses = self.scan(self.fsm())
        table = {"type": "table", "path": self.table(pulses), "mechanism": "fsm", "incidence_deg": 45,
                 "fold_azimuth_deg": 10}
        replayed, _ = self.scan(table)
        self.assertGreater(np.count_nonzero(points["status"] == 0), 10000)
        self.assert_same_points(points, replayed, 1e-9)

    def test_the_angles_of_a_gimbal_replayed_as_a_table_give_its_points(self):
        points, pulses = self.scan({"type": "gimbal", "pattern": self.fsm()["pattern"]})
        replayed, _ = self.scan({"type": "table", "path": self.table(pulses)})
        self.assert_same_points(points, replayed, 1e-9)

    def test_a_table_that_ends_too_early_is_refused(self):
        _, pulses = self.scan(self.fsm())
        half = {name: values[:len(values) // 2] for name, values in pulses.items()}
        path = self.table(half)
        result = self.refuse(1, *self.arguments({"type": "table", "path": path}))
        self.assertIn(f"{path}: scanner table: pulse 399, 0.1995 s after the first", result.stderr)

    def test_pulses_in_a_turnaround_are_blanked(self):
        blanked_pulses = 5
        points, _ = self.scan(self.fsm(turnaround_time_s=blanked_pulses / PULSE_RATE_HZ))
        blanked = np.zeros(LINES * PULSES_PER_LINE, dtype=bool)
        blanked[points["pulse"][points["status"] == 4]] = True
        expected = np.arange(blanked.size) % PULSES_PER_LINE < blanked_pulses
        expected[:PULSES_PER_LINE] = False  # no jump precedes the first line
        np.testing.assert_array_equal(blanked, expected)

    def test_settling_moves_truth_and_estimate_equally(self):
        points, _ = self.scan(self.fsm(settle_time_s=0.002))
        ideal, _ = self.scan(self.fsm())
        off = np.hypot(points["x_true"] - ideal["x_true"], points["y_true"] - ideal["y_true"])
        position_in_line = points["pulse"] % PULSES_PER_LINE
        first_line = points["pulse"] < PULSES_PER_LINE
        self.assertEqual(np.nanmax(off[first_line]), 0)
        self.assertGreater(np.nanmin(off[~first_line & (position_in_line == 0)]), 6)  # still at the end of the previous line
        self.assertLess(np.nanmax(off[~first_line & (position_in_line > 12)]), 0.02)
        self.assert_equal_where_hit(points, "est", points, "true")

    def assert_equal_where_hit(self, first, first_kind, second, second_kind):
        hit = first["status"] == 0
        for axis in "xyz":
            np.testing.assert_array_equal(first[f"{axis}_{first_kind}"][hit], second[f"{axis}_{second_kind}"][hit])

    def test_encoder_noise_moves_only_the_estimate_and_changes_no_draw(self):
        noise = ["--set", "noise.range_sigma_m=0.01", "--set", "noise.dropout_frac=0.1"]
        plain, _ = self.scan(self.fsm(), *noise)
        noisy, _ = self.scan(self.fsm(encoder_sigma_rad=1e-4), *noise)
        for name in ("status", "x_true", "y_true", "z_true", "range_true", "range_measured"):
            np.testing.assert_array_equal(plain[name], noisy[name])
        moved = np.hypot(plain["x_est"] - noisy["x_est"], plain["y_est"] - noisy["y_est"])
        # At 50 m, 1e-4 rad with gains 2 and 2 cos 45 deg give an RMS of sqrt(4 + 2) x 5 mm.
        self.assertAlmostEqual(np.sqrt(np.nanmean(moved**2)), np.sqrt(6) * 0.005, delta=0.0015)

    def test_lag_is_the_motion_of_the_aim_during_the_time_of_flight(self):
        points, _ = self.scan(self.fsm(tof_lag=True), "--set", "laser.pulse_rate_hz=20000", "--set",
                              "laser.scan_time_s=0.02")
        inside = points["status"] == 0
        step_m = 8 / (PULSES_PER_LINE - 1)
        flight_s = 2 * 50 / 299792458
        lag = np.hypot(points["x_true"] - points["x_est"], points["y_true"] - points["y_est"])[inside]
        # The estimated point lies on the beam at pulse time; the slope of the terrain changes the distance slightly.
        self.assertAlmostEqual(np.median(lag), step_m * flight_s * 20000, delta=2e-4)
        self.assertLess(lag.max(), 2 * np.median(lag))  # also at the ends of lines

    def test_encoder_harmonics_move_only_the_estimate(self):
        plain, pulses = self.scan(self.fsm())
        waves, _ = self.scan(self.fsm(encoder_harmonics=[{"axis": 2, "order": 100, "amplitude_rad": 1e-4}]))
        for name in ("status", "x_true", "y_true", "z_true", "range_true", "range_measured"):
            np.testing.assert_array_equal(plain[name], waves[name])
        moved = np.hypot(plain["x_est"] - waves["x_est"], plain["y_est"] - waves["y_est"])
        expected = 50 * 2 * np.cos(np.pi / 4) * 1e-4 * abs(np.sin(100 * pulses["angle_2"]))[plain["pulse"]]
        hit = plain["status"] == 0
        np.testing.assert_allclose(moved[hit], expected[hit], rtol=0.1, atol=2e-4)

    def test_tilted_facets_move_the_beams_and_the_lander_may_know_them(self):
        polygon = {"type": "polygon", "facets": 40, "rate_hz": 2}
        tilted = {**polygon, "facet_tilt_rad": [0, 1e-4] * 20}
        plain, pulses = self.scan(polygon)
        unknown, _ = self.scan(tilted)
        known, _ = self.scan({**tilted, "facet_tilt_known": True})
        # A facet takes 1/80 s, and is at its middle at multiples of this time.
        odd = np.floor(pulses["t"] * 80 + 0.5).astype(int)[plain["pulse"]] % 2 == 1
        hit = (plain["status"] == 0) & (unknown["status"] == 0)
        across = np.abs(unknown["y_true"] - plain["y_true"])[hit]
        self.assertLess(across[~odd[hit]].max(), 1e-12)
        self.assertAlmostEqual(np.median(across[odd[hit]]), 2e-4 * 50, delta=1e-3)
        apart = np.abs(unknown["y_true"] - unknown["y_est"])[hit & odd]
        self.assertAlmostEqual(np.median(apart), 2e-4 * 50, delta=1e-3)
        for axis in "xyz":
            np.testing.assert_allclose(known[f"{axis}_est"], known[f"{axis}_true"], rtol=0, atol=1e-9)

    def test_a_redraw_requires_the_seed_of_drawn_facets(self):
        drawn, given = ({"type": "polygon", **tilts} for tilts in ({"facet_tilt_sigma_rad": 1e-4}, {"facet_tilt_rad": [1e-4] * 48}))
        for scanner, word in ((drawn, "/scanner/facet_tilt_sigma_rad"), (given, None)):
            self.scan(scanner)
            arguments = self.arguments(scanner, "--seed", 9, "--ranges-from", self.path("scan.h5"))
            arguments[arguments.index("-o") + 1] = self.path("redrawn.h5")
            if word:
                self.refuse(2, *arguments, words=["/seed", word])
            else:
                self.succeed(*arguments)

    def test_a_mirror_that_accelerates_slowly_loses_pulses(self):
        """A line of 8 m in 20 pulses from 50 m, flown back: 4.57 degrees of tilt, 0.0840 rad and 20/19 of it in the frame of the new line."""
        _, pulses = self.scan(self.fsm(incidence_deg=0, fold_azimuth_deg=0))
        points, _ = self.scan(self.fsm(incidence_deg=0, fold_azimuth_deg=0, max_acceleration_radps2=1e4))
        blanked = np.bincount(points["pulse"][points["status"] == 4], minlength=len(pulses["t"])) > 0
        lines = blanked.reshape(-1, PULSES_PER_LINE)
        self.assertFalse(lines[0].any())
        way = np.abs(pulses["angle_2"].reshape(-1, PULSES_PER_LINE)[:, 0] - pulses["angle_2"].reshape(-1, PULSES_PER_LINE)[:, -1])
        needed_s = 2 * np.sqrt(way * 20 / 19 / 1e4)
        expected = np.ceil(needed_s * PULSE_RATE_HZ - 1e-5).astype(int) - 1
        self.assertLessEqual(np.abs(lines.sum(axis=1) - expected)[1:].max(), 1)
        self.assertGreater(lines.sum(axis=1)[1:].min(), 5)
        self.assertTrue((np.diff(lines.astype(int), axis=1) <= 0).all())  # from the begin of each line

    def test_bad_values_are_refused_by_name(self):
        bad = {"/scanner/facet_tilt_rad: 2 is not the number of facets": {"type": "polygon", "facet_tilt_rad": [0, 0]},
               "/scanner/facet_tilt_rad/1": {"type": "polygon", "facet_tilt_rad": [0, 0.2]},
               "/scanner/facet_tilt_sigma_rad": {"type": "polygon", "facet_tilt_sigma_rad": 0.02},
               "/scanner/facet_tilt_known": {"type": "polygon", "facet_tilt_known": 1},
               "/scanner/encoder_harmonics/0/order": self.fsm(encoder_harmonics=[{"order": 1.5, "amplitude_rad": 0}]),
               "/scanner/encoder_harmonics/0/axis": self.fsm(encoder_harmonics=[{"axis": 0, "order": 1, "amplitude_rad": 0}]),
               "/scanner/encoder_harmonics: ": {"type": "gimbal", "encoder_harmonics": 3},
               "/scanner/max_acceleration_radps2": self.fsm(max_acceleration_radps2=-1),
               "/scanner/focal_distance_m": self.fsm(focal_distance_m=-1),
               "/scanner/pivot_m/1": self.fsm(pivot_m=[0, "x", 0]),
               "/scanner/encoder_sigma_rad": self.fsm(encoder_sigma_rad=-1e-9),
               "/scanner/turnaround_time_s": self.fsm(turnaround_time_s=-1),
               "/scanner/tof_lag": self.fsm(tof_lag=1),
               "/scanner/max_deflection_deg": {"type": "gimbal", "max_deflection_deg": 90},
               "/scanner/facets": {"type": "polygon", "facets": 1},
               "/scanner/duty_frac": {"type": "polygon", "duty_frac": 1.5},
               "/scanner/max_deflection_deg: 180 ": self.fsm(incidence_deg=0, max_deflection_deg=180),
               "/scanner/frame_amplitude_deg: 50 is not >= 0 and below 90 - 360 duty_frac / facets":
               {"type": "polygon", "facets": 6, "frame_amplitude_deg": 50},
               "/scanner/rate_hz": {"type": "palmer", "rate_hz": 0},
               "/scanner/mechanism": {"type": "table", "path": "a.csv", "mechanism": "risley"}}
        for key, scanner in bad.items():
            with self.subTest(key):
                result = self.refuse(2, *self.arguments(scanner))
                self.assertIn(key, result.stderr)


if __name__ == "__main__":
    unittest.main()
