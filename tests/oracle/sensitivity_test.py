#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison of chain_test.py detects a small change of any column, layer or number, and of any key of a scan."""
import copy
import json
import os
import tempfile
import unittest
from unittest import mock

import h5py
import numpy as np

from oracle import cases, comparison, draws, evaluate, surface
from oracle.ledger import Ledger

# Changes of keys that must be detected: a little above the bounds of 1e-9 m for floats, 1 for integers.
SCAN_CHANGES = {
    "mount.position_m.0": 1e-8, "mount.rpy_deg.1": 1e-5, "trajectory.position_m.2": 1e-8, "trajectory.velocity_mps.0": 1e-6,
    "trajectory.rpy_deg.0": 1e-8, "trajectory.rpy_rate_degps.2": 1e-5, "detector.roll_deg": 1e-6, "detector.ifov_rad": 1e-8,
    "detector.distortion.k1": 1e-3, "detector.fill_factor": 1e-5, "scanner.incidence_deg": 1e-6,
    "scanner.fold_azimuth_deg": 1e-3, "scanner.pivot_m.2": 1e-5, "scanner.focal_distance_m": 1e-5,
    "scanner.encoder_sigma_rad": 1e-8, "scanner.encoder_harmonics.0.amplitude_rad": 1e-8,
    "scanner.encoder_harmonics.0.phase_deg": 1e-3, "scanner.max_acceleration_radps2": -999000, "scanner.turnaround_time_s": 0.001, "scanner.settle_time_s": 1e-6,
    "scanner.settle_damping": 1e-6, "scanner.pattern.half_width_m": 1e-8, "noise.range_sigma_m": 1e-8,
    "noise.range_sigma_per_m": 1e-9, "noise.incidence_sigma_rad": 1e-9, "noise.range_bias_m": 1e-8,
    "noise.dead_pixel_frac": 0.3, "noise.dropout_frac": 0.05, "noise.false_return_frac": 0.1, "noise.false_range_m.0": 1e-8,
    "pointing_error.misalignment_rpy_rad.0": 1e-9, "pointing_error.jitter_sigma_rad": 1e-9, "pointing_error.jitter_time_s": 1e-7,
    "pointing_error.time_stamp_bias_s": 1e-8, "pointing_error.time_stamp_sigma_s": 1e-8,
    "pointing_error.mirror_time_bias_s": 1e-9, "pointing_error.mirror_time_sigma_s": 1e-9,
    "beam.divergence_rad": 1e-8, "beam.offset_rad.0": 1e-7, "surface.albedo": 1e-7, "link.reference_pe": 1e-4,
    "link.reference_range_m": 1e-5, "link.background_pe": 1e-4, "receiver.pulse_fwhm_s": 1e-16, "receiver.threshold_pe": 1e-5,
    "receiver.jitter_sigma_s": 1e-16, "receiver.pixel_offset_sigma_m": 1e-8, "receiver.clock_scale_ppm": 1e-3,
    "navigation_error.position_m.1": 1e-8, "navigation_error.velocity_mps.1": 1e-6, "navigation_error.rpy_rad.0": 1e-9,
    "navigation_error.rpy_rate_radps.0": 1e-7, "navigation_error.interval_s": 1e-5,
    "navigation_error.random_walk.position_m_per_sqrt_s.0": 1e-6, "navigation_error.random_walk.velocity_mps_per_sqrt_s.0": 1e-4,
    "navigation_error.random_walk.rpy_rad_per_sqrt_s.0": 1e-7, "navigation_error.gauss_markov.position_sigma_m.0": 1e-7,
    "navigation_error.gauss_markov.position_time_s": 1e-3, "navigation_error.gauss_markov.velocity_sigma_mps.0": 1e-5,
    "navigation_error.gauss_markov.rpy_sigma_rad.0": 1e-7, "seed": 1,
}
OTHER_CHANGES = {
    "regrid": {"uncertainty.range_sigma_m": 1e-3, "uncertainty.navigation_sigma.position_m.0": 1e-2,
               "uncertainty.navigation_sigma.velocity_mps.0": 0.3, "uncertainty.navigation_sigma.rpy_rad.0": 1e-3,
               "uncertainty.navigation_sigma.rpy_rate_radps.0": 0.05},
    "eval": {"region_radius_m": 0.1, "footprint_m": 0.2, "quantile": 1e-4, "limits.hole_bins": 1000,
             "limits.relative_elevation_m": -0.02, "limits.absolute_horizontal_m": -0.2, "limits.invalid_frac": 1e-6},
}


def changed(config, path, delta):
    config = copy.deepcopy(config)
    *folders, key = path.split(".")
    target = config
    for folder in folders:
        target = target[int(folder) if isinstance(target, list) else folder]
    key = int(key) if isinstance(target, list) else key
    target[key] += delta
    return config


def rich_case(folder):
    """A case in which every key of SCAN_CHANGES affects the results."""
    case = cases.CaseGenerator(12, folder).case(
        terrain="all", pattern="line_search", scanner="fsm", trajectory="constant_velocity", navigation="all",
        method="bilinear_nearest", region="circle", receiver="none")
    case["options"] = {"keep_misses": True, "float32": False, "truth": True, "uncertainty": True, "corrected": True}
    scan = case["scan"]
    scan["laser"]["scan_time_s"] /= 2  # 75 pulses of 20 pixels: few rays detect a change
    scan["detector"] = {"rows": 4, "columns": 5, "ifov_rad": 0.0022, "roll_deg": 5, "subpixels": 2, "fill_factor": 0.7,
                        "distortion": {"k1": 2.0}}
    scan["scanner"] = {"type": "fsm", "incidence_deg": 30, "fold_azimuth_deg": 20, "pivot_m": [0.01, 0, 0.01],
                       "focal_distance_m": 0.1, "encoder_sigma_rad": 1e-4, "turnaround_time_s": 0.001,
                       "encoder_harmonics": [{"order": 7, "amplitude_rad": 1e-4, "phase_deg": 20}], "max_acceleration_radps2": 1e6,
                       "settle_time_s": 0.004, "settle_damping": 0.6, "tof_lag": True,
                       "pattern": {"type": "line_search", "rows": 8, "columns": 8, "half_width_m": 2}}
    scan["noise"] = {"range_sigma_m": 0.01, "range_sigma_per_m": 1e-4, "incidence_sigma_rad": 5e-4, "range_bias_m": 0.01,
                     "dead_pixel_frac": 0.1, "dropout_frac": 0.05, "false_return_frac": 0.05, "false_range_m": [35, 65]}
    scan["beam"] = {"divergence_rad": 0.02, "offset_rad": [1e-3, 0]}
    scan["surface"] = {"albedo": 0.5}
    scan["link"] = {"reference_pe": 200, "reference_range_m": 50, "background_pe": 500}
    scan["receiver"] = {"type": "leading_edge", "threshold_pe": 10, "jitter_sigma_s": 1e-11, "pixel_offset_sigma_m": 0.01,
                        "clock_scale_ppm": 10}
    scan["pointing_error"] = {"misalignment_rpy_rad": [1e-3, 0, 0], "jitter_sigma_rad": 1e-4, "jitter_time_s": 0.01,
                              "time_stamp_bias_s": 0.001,
                              "time_stamp_sigma_s": 1e-4, "mirror_time_bias_s": 1e-5, "mirror_time_sigma_s": 1e-6}
    scan["navigation_error"].update({
        "random_walk": {"position_m_per_sqrt_s": [0.1] * 3, "velocity_mps_per_sqrt_s": [0.5] * 3, "rpy_rad_per_sqrt_s": [1e-3] * 3},
        "gauss_markov": {"position_sigma_m": [0.05] * 3, "position_time_s": 0.5, "velocity_sigma_mps": [0.5] * 3,
                         "rpy_sigma_rad": [1e-3] * 3}})
    case["eval"]["limits"].update({"relative_elevation_m": 0.03, "absolute_horizontal_m": 0.2, "hole_bins": 20})
    return case


class Sensitivity(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="landfall-proof-"))
        cls.before = os.getcwd()
        os.chdir(cls.folder)
        cls.addClassCleanup(os.chdir, cls.before)
        cls.case = rich_case(cls.folder)
        comparison.run_chain(cls.case)
        cls.ground = surface.of_file("terrain.h5")

    STAGES = {"scan.h5": lambda self, ledger: comparison.check_scan(self.case, ledger, self.ground),
              "dem.h5": lambda self, ledger: comparison.check_dem(self.case, ledger, self.ground),
              "eval.h5": lambda self, ledger: comparison.check_evaluation(self.case, ledger)}

    def failures(self, path):
        ledger = Ledger()
        with np.errstate(divide="ignore", invalid="ignore"):
            self.STAGES[path](self, ledger)
        return ledger.failures

    def test_without_changes_there_are_no_failures(self):
        for path in self.STAGES:
            self.assertEqual(self.failures(path), [])

    def check_changed_keys_are_detected(self, path, changes):
        plain = comparison.config_of(path)
        self.addCleanup(setattr, comparison, "config_of", comparison.config_of)
        for key, delta in changes.items():
            comparison.config_of = lambda _, config=changed(plain, key, delta): config
            with self.subTest(key):
                self.assertNotEqual(self.failures(path), [])

    def test_keys_of_a_scan(self):
        self.check_changed_keys_are_detected("scan.h5", SCAN_CHANGES)

    def test_keys_of_an_evaluation(self):
        self.check_changed_keys_are_detected("eval.h5", OTHER_CHANGES["eval"])

    def test_sigmas_of_a_map(self):
        for key, delta in OTHER_CHANGES["regrid"].items():
            ledger, case = Ledger(), {**self.case, "regrid": changed(self.case["regrid"], key, delta)}
            with self.subTest(key), np.errstate(divide="ignore", invalid="ignore"):
                comparison.check_dem(case, ledger, self.ground)
                self.assertNotEqual(ledger.failures, [])

    def check_changed_values_are_detected(self, path, group="/"):
        with h5py.File(path) as file:
            names = [name for name, item in file[group].items() if isinstance(item, h5py.Dataset) and item.shape]
        for name in names:
            if group == "/" and name in "xy":
                continue  # the axes
            with self.subTest(name), h5py.File(path, "r+") as file:
                values = file[group][name][()]
                index = np.unravel_index(np.flatnonzero(np.isfinite(values))[-1], values.shape)
                file[group][name][index] = self.near(values[index])
                file.close()
                self.assertNotEqual(self.failures(path), [])
            with h5py.File(path, "r+") as file:
                file[group][name][index] = values[index]

    @staticmethod
    def near(value):
        if value.dtype.kind in "iu":
            return value + 1
        return value + 1e-8 if value.dtype == np.float64 else value * (1 + 1e-3) + 1e-4

    def test_every_column_of_a_scan(self):
        """The expected columns follow from the configuration, which does not change: they are computed once."""
        expected = comparison.scan.columns(comparison.config_of("scan.h5"), self.ground, surface.albedo("terrain.h5"))
        with mock.patch.object(comparison.scan, "columns", return_value=expected):
            self.assertEqual(self.failures("scan.h5"), [])
            for group in ("points", "pulses", "detector"):
                self.check_changed_values_are_detected("scan.h5", group)

    def test_every_layer_of_a_map(self):
        self.check_changed_values_are_detected("dem.h5")

    def test_every_layer_and_hole_of_an_evaluation(self):
        self.check_changed_values_are_detected("eval.h5")
        self.check_changed_values_are_detected("eval.h5", "holes")

    def test_every_number_of_the_metrics(self):
        dem = comparison.columns("dem.h5")
        spacing = comparison.node_spacing(comparison.config_of("terrain.h5"))
        expected = comparison.expected_metrics(evaluate.Evaluation(dem, comparison.config_of("eval.h5"), truth_spacing_m=spacing), dem)
        with open("metrics.json", encoding="utf-8") as file:
            metrics = json.load(file)
        seen = 0
        for path in leaves(metrics):
            other, ledger = with_other(metrics, path), Ledger()
            with self.subTest(path):
                comparison.compare_metrics(ledger, other, expected)
                self.assertNotEqual(ledger.failures, [])
            seen += 1
        self.assertGreater(seen, 200)


class Draws(unittest.TestCase):
    """The draws of this package compared with numpy's generator."""

    def test_blocks_are_those_of_numpy(self):
        for seed, draw, stream, i, j in ((7, 0, 3, 5, 9), (2**53 - 1, 2**31 - 1, 13, 0, 2**32 + 4), (0, 4, 1, 1, 0)):
            generator = np.random.Philox(key=[seed, stream], counter=[i, j, draw, 0])
            found = [int(word) for word in draws.blocks((seed, draw), stream, i + 1, j)]
            self.assertEqual(found, [int(word) for word in generator.random_raw(4)])


def leaves(value, path=()):
    """The paths of all numbers, texts and booleans in a JSON value."""
    if isinstance(value, (dict, list)):
        for key, part in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(part, (*path, key))
    elif value is not None:
        yield path


def with_other(value, path):
    value = copy.deepcopy(value)
    target = value
    for key in path[:-1]:
        target = target[key]
    old = target[path[-1]]
    if isinstance(old, (bool, str)):
        target[path[-1]] = None
    else:
        target[path[-1]] = old + 1 if isinstance(old, int) else old * (1 + 1e-8) + 1e-11
    return value


if __name__ == "__main__":
    unittest.main()
