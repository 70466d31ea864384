#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_receiver.py, which scans tilted planes with each receiver and draws the errors of the range."""
import math
import os
import tempfile
import types
import unittest

from harness import BIN
from harness.commands import run_command

import matplotlib.image
import numpy as np
from landfall.plot import plot_receiver


def crossing_of_a_plane(slope_deg, level):
    """The range at which the waveform of a tilted plane, a box convolved with the pulse, first reaches `level` of an unstretched maximum (metres)."""
    sigma = plot_receiver.SIGMA_M
    length = plot_receiver.RANGE_M * plot_receiver.PITCH_RAD * math.tan(math.radians(slope_deg))

    def waveform(at):
        if length < 1e-9:
            return math.exp(-(at / sigma) ** 2 / 2)
        upper, lower = ((at + half) / (sigma * math.sqrt(2)) for half in (length / 2, -length / 2))
        return sigma * math.sqrt(math.pi / 2) / length * (math.erf(upper) - math.erf(lower))
    low, high = -10 * sigma - length, 0.0
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if waveform(middle) < (level if level else 0.5 * waveform(0)) else (low, middle)
    return high


class Errors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.errors = plot_receiver.errors_of_slopes(folder, types.SimpleNamespace(bin=BIN))

    def test_a_threshold_on_slopes_follows_the_error_functions(self):
        share = plot_receiver.THRESHOLD_PE / plot_receiver.SIGNAL_PE
        expected = [crossing_of_a_plane(slope, share) for slope in plot_receiver.SLOPES_DEG]
        np.testing.assert_allclose(self.errors["leading_edge"], expected, atol=5e-4)

    def test_a_constant_fraction_follows_them_too(self):
        level = crossing_of_a_plane(0, None)
        expected = [crossing_of_a_plane(slope, None) - level for slope in plot_receiver.SLOPES_DEG]
        np.testing.assert_allclose(self.errors["constant_fraction"], expected, atol=5e-4)

    def test_peak_and_centroid_have_no_error_on_a_plane(self):
        for kind in ("peak", "centroid"):
            np.testing.assert_allclose(self.errors[kind], 0, atol=2e-4)

    def test_the_first_photoelectron_on_level_ground(self):
        x = np.arange(-9, 9, 1e-3)
        below = np.array([0.5 * math.erfc(-value / math.sqrt(2)) for value in x])
        first = (x * plot_receiver.SIGNAL_PE * np.exp(-x ** 2 / 2) / math.sqrt(2 * math.pi) * np.exp(-plot_receiver.SIGNAL_PE * below)).sum() * 1e-3
        self.assertAlmostEqual(self.errors["geiger"][0], plot_receiver.SIGMA_M * first, delta=0.003)


class Picture(unittest.TestCase):
    def test_both_panels_are_drawn(self):
        with tempfile.TemporaryDirectory() as folder:
            png = os.path.join(folder, "receiver.png")
            result = run_command("plot_receiver", "-o", png, "--bin", BIN, "--dpi", 50)
            self.assertEqual((result.returncode, result.stderr, result.stdout), (0, "", png + "\n"))
            for panel in np.array_split(matplotlib.image.imread(png), 2, axis=1):
                self.assertGreater(np.count_nonzero(panel[..., :3].min(axis=2) < 0.8), 200)


if __name__ == "__main__":
    unittest.main()
