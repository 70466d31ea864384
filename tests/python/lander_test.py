#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The lander of examples/lander.py: it lands where its map and its errors say, upright, on a safe place."""
import importlib.util
import os
import tempfile
import unittest

import numpy as np

from harness import ROOT


def example():
    path = os.path.join(ROOT, "examples", "lander.py")
    spec = importlib.util.spec_from_file_location("lander", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@unittest.skipUnless(importlib.util.find_spec("dartpy"), "python3-dartpy is not installed")
class Lander(unittest.TestCase):
    def test_it_lands_at_the_site_plus_its_error(self):
        lander = example()
        landing = lander.fly(1)
        self.assertTrue(landing["stands"] and landing["safe"])
        self.assertLess(landing["tilt_deg"], 15)
        off_m = landing["place"] - landing["target"][:2] - landing["error_m"]
        self.assertLess(np.hypot(*off_m), 0.5)
        self.assertLess(lander.TOUCHDOWN_MPS, 1)
        with tempfile.TemporaryDirectory() as folder:
            picture = os.path.join(folder, "landing.png")
            lander.draw(landing, picture)
            self.assertGreater(os.path.getsize(picture), 20000)

    def test_a_falling_lander_gains_the_speed_of_gravity(self):
        lander = example()
        import landfall
        falling = lander.Lander(landfall.Terrain({"grid": {"half_width_m": 4, "resolution_m": 1}}))
        falling.place([0, 0, 100], [1, 0, 0])
        for _ in range(500):
            falling.step(np.zeros(3), np.zeros(3))
        position, velocity, rotation, _ = falling.state()
        np.testing.assert_allclose(velocity, [1, 0, -lander.GRAVITY], atol=1e-6)
        np.testing.assert_allclose(position, [1, 0, 100 - lander.GRAVITY / 2], atol=2e-3)
        np.testing.assert_allclose(rotation, np.eye(3), atol=1e-9)


if __name__ == "__main__":
    unittest.main()
