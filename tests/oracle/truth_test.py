#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands of docs/quality/validation.md: a real conical scan predicted, hazard maps of real points judged."""
import os
import sys
import tempfile
import unittest

import numpy as np

ROOT = os.environ["LANDFALL_ROOT"]
sys.path[:0] = [os.path.join(ROOT, "python"), os.path.join(ROOT, "bench")]
# pylint: disable=wrong-import-position
import landfall
import validate_atm
import validate_isprs
import validate_likeness

DATA = os.environ.get("LANDFALL_DATA", os.path.join(ROOT, "..", "shared", "data"))
SHOTS, SAMPLE, OUTSIDE = (os.path.join(DATA, name) for name in ("truth/atm_14-word.qi", "truth/isprs_samp31.pcd", "outside"))


class Conical(unittest.TestCase):
    @unittest.skipUnless(os.path.exists(SHOTS), f"no real conical scan: {SHOTS} (LANDFALL_DATA)")
    def test_the_second_half_is_predicted_and_a_wrong_azimuth_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            result = validate_atm.validate(SHOTS, folder, 0.5)
            shots = validate_atm.Shots(SHOTS, folder)
            odd = shots.revolution % 2 == 1
            fitted, _, sense = validate_atm.fit(shots)
        for half in result["halves"].values():
            self.assertLess(max(half["two_sigma_cm"]), 1.3 * max(result["rounding_two_sigma_cm"]))
        for key, factor, tolerance in (("tilt_rad", 2, 0.01), ("incidence_rad", 1, 0.005), ("roll_rad", 1, 0.005)):
            self.assertAlmostEqual(np.degrees(result["numbers"][key][0]) * factor, result["header"][key], delta=tolerance)
        shots.azimuth[odd] += 1e-3
        simulated = validate_atm.simulated(fitted, shots, sense, odd)
        np.testing.assert_allclose(simulated, validate_atm.predicted(fitted, shots, sense)[odd], atol=1e-6)
        error, _ = validate_atm.residuals(fitted, shots, simulated, odd)
        causes = {one["cause"]: one for one in validate_atm.causes(fitted, shots, sense, odd, error)}
        self.assertAlmostEqual(causes["azimuth zero"]["value"], -1, delta=0.05)
        self.assertGreater(causes["azimuth zero"]["variance_frac"], 0.8)

    def test_a_file_that_is_not_qfit_is_refused(self):
        with tempfile.NamedTemporaryFile() as file, self.assertRaisesRegex(SystemExit, "is not QFIT"):
            file.write(b"12345678")
            file.flush()
            validate_atm.Shots(file.name, ".")


class Hazards(unittest.TestCase):
    def test_wilsons_interval(self):
        np.testing.assert_allclose(validate_isprs.wilson(10, 100), (0.05523, 0.17437), atol=1e-5)  # Wilson 1927, z = 1.96
        self.assertEqual(validate_isprs.wilson(0, 0), (0, 1))

    @unittest.skipUnless(os.path.exists(SAMPLE), f"no points of the ISPRS filter test: {SAMPLE} (LANDFALL_DATA)")
    def test_the_ground_alone_has_no_wrong_places(self):
        """A map that is the truth; its objects, the same map a storey higher, are wrong by that."""
        with tempfile.TemporaryDirectory() as folder:
            sample = validate_isprs.Sample(SAMPLE, folder)
        config = {**sample.grid(5), "method": "mean"}
        ground = landfall.grid(*sample.ground.T, config=config, quiet=True)
        terrain = landfall.Terrain.from_array(ground.values("z_est").astype(float), 5)
        surface = sample.surface(*np.meshgrid(ground.values("x"), ground.values("x")))
        for raised, on_objects in ((0, False), (4, True)):
            dem = landfall.grid(*(sample.ground + [0, 0, raised]).T, terrain=terrain, config=config, quiet=True)
            result = validate_isprs.judged(sample, dem, "contact", surface, 5)
            counts = result["counts"]
            self.assertGreater(min(counts["hazard found"], counts["safe found"]), 20)
            self.assertEqual(counts["missed hazard"] + counts["false alarm"], 0)
            self.assertEqual(result["safe_on_objects"] > 0.9 * result["judged_safe"], on_objects)
            self.assertEqual(result["safe_on_objects"] == 0, not on_objects)


@unittest.skipUnless(os.path.exists(OUTSIDE), f"no real waveforms: {OUTSIDE} (LANDFALL_DATA)")
class Likeness(unittest.TestCase):
    def test_widths_of_echoes_are_compared_and_a_mount_error_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            near, far = ({row["name"]: row for row in one["statistics"]} for one in validate_likeness.waveforms(OUTSIDE, folder).values())
        for name in ("position", "elevation", "elevation_spread", "shift", "tilt", "density_map", "coverage"):
            self.assertGreater(far[name]["distance"], near[name]["distance"], name)
        width = near["echo_width"]
        self.assertAlmostEqual(width["a"], 0.149896229 * 4.4 / 2.354820045, delta=1e-6)  # RIEGL's median
        self.assertAlmostEqual(width["b"] / width["a"], 1, delta=0.05)


if __name__ == "__main__":
    unittest.main()
