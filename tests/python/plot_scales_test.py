#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of what figures are made of: reduced maps and marks, scales, shading and zooms."""
import os
import sys
import unittest

import numpy as np

sys.path.insert(0, os.path.join(os.environ["LANDFALL_ROOT"], "python"))

from landfall import files
from landfall.plot import captions, maps, reduction, relief, scales


class ReductionTest(unittest.TestCase):
    def test_extreme_keeps_the_sign_and_single_values(self):
        values = np.zeros((7, 9))
        values[6, 8] = -3
        values[0, :3] = [1, -2, np.nan]
        reduced = reduction.shrink_extreme(values, 3)
        self.assertEqual(reduced.shape, (3, 3))
        self.assertEqual((reduced[0, 0], reduced[2, 2], reduced[1, 1]), (-2, -3, 0))

    def test_blocks_without_a_value_stay_empty(self):
        values = np.full((4, 4), np.nan)
        values[0, 0], values[1, 1] = 1, 2
        for name, expected in (("shrink_extreme", 2), ("shrink_mean", 1.5)):
            reduced = getattr(reduction, name)(values, 2)
            self.assertEqual(reduced[0, 0], expected)
            self.assertTrue(np.isnan(reduced[0, 1]) and np.isnan(reduced[1, 1]))

    def test_a_single_flag_is_enlarged_anywhere(self):
        for row, col, blocks in ((0, 0, 4), (1000, 1001, 9), (2000, 2000, 4)):
            flags = np.zeros((2001, 2001), bool)
            flags[row, col] = True
            size = reduction.block_size(flags.shape, 400)
            marks = reduction.enlarged_marks(flags, size, flags.size)
            self.assertEqual(marks.shape, (334, 334))
            self.assertTrue(marks[row // size, col // size])
            self.assertEqual(marks.sum(), blocks)

    def test_only_marks_with_at_most_one_neighbour_are_enlarged(self):
        flags = np.zeros((300, 300), bool)
        flags[10:30, 10:30] = True
        flags[100, 100:102] = True
        marks = reduction.enlarged_marks(flags, 1, flags.size)
        self.assertEqual(marks.sum(), 400 + 3 * 4)

    def test_marks_of_1_percent_of_the_region_or_more_are_not_enlarged(self):
        flags = np.zeros((1000, 1000), bool)
        flags[0, :100] = True
        self.assertIsNotNone(reduction.enlarged_marks(flags, 2, 10001))
        self.assertIsNone(reduction.enlarged_marks(flags, 2, 10000))

    def test_enlarged_marks_cover_less_than_1_percent_of_the_map(self):
        for spacing, enlarged in ((32, True), (28, False)):  # 9 of 1024 blocks, 9 of 784
            flags = np.zeros((896, 896), bool)
            flags[1::spacing, 1::spacing] = True
            self.assertEqual(reduction.enlarged_marks(flags, 1, flags.size) is not None, enlarged)

    def test_bins_that_are_seen_are_not_enlarged(self):
        flags = np.zeros((200, 200), bool)
        flags[5, 5] = True
        np.testing.assert_array_equal(reduction.enlarged_marks(flags, 1, flags.size), flags)

    def test_the_share_of_a_block_ignores_what_lies_outside_the_map(self):
        flags = np.zeros((3, 3), bool)
        flags[0, 0] = flags[2, 2] = True
        np.testing.assert_array_equal(reduction.shrink_share(flags, 2), [[0.25, 0], [0, 1]])

    def test_enlarge_makes_squares(self):
        flags = np.zeros((9, 9), bool)
        flags[4, 3] = True
        expected = np.zeros((9, 9), bool)
        expected[2:7, 1:6] = True
        np.testing.assert_array_equal(reduction.enlarge(flags, 2), expected)
        np.testing.assert_array_equal(reduction.enlarge(flags, 0), flags)


def spread_values(n=1001):
    """From 0 to 1 in equal steps, shuffled, so that each quantile is known."""
    return np.random.default_rng(1).permutation(np.linspace(0, 1, n))


class ScaleTest(unittest.TestCase):
    def test_errors_end_at_the_quantile_of_their_magnitudes(self):
        values = spread_values() * np.tile([1, -1], 501)[:1001]
        scale = scales.error_scale(values, values, 0.05)
        self.assertEqual((scale.low, scale.high), (-0.995, 0.995))
        self.assertEqual(scale.clipping_text(), "colours end at ±0.995 m (99.5 % quantile)")
        self.assertIn(scale.extend, ("min", "max", "both"))
        self.assertEqual(scale.limits(), [0.05, -0.05])

    def test_the_limit_is_inside_the_scale(self):
        for make, low, limits in ((scales.error_scale, -0.055, [0.05, -0.05]), (scales.magnitude_scale, 0.0, [0.05])):
            values = spread_values() / 50
            scale = make(values, values, 0.05)
            self.assertAlmostEqual(scale.low, low)
            self.assertAlmostEqual(scale.high, 0.055)
            self.assertEqual(scale.limits(), limits)
            self.assertEqual(scale.clipping_text(), "")

    def test_values_beyond_a_scale_that_the_limit_sets(self):
        values = np.append(np.full(1000, 0.02), 0.07)
        scale = scales.magnitude_scale(values, values, 0.05)
        self.assertEqual(scale.clipping_text(), "colours end at 5.5 cm (1.1 x limit)")
        self.assertEqual(scale.extend, "max")
        below = np.append(np.full(1000, 0.02), -0.01)
        self.assertEqual(scales.magnitude_scale(below, below, 0.05).clipping_text(), "colours begin at 0")
        self.assertEqual(scale.limit_text(" of the relative error"), "▸ limit 5 cm of the relative error")

    def test_a_limit_far_away_and_data_only_leave_the_scale_to_the_data(self):
        for divisor, data_only in ((100, False), (50, True)):
            values = spread_values() / divisor
            scale = scales.error_scale(values, values, 0.05, data_only)
            self.assertAlmostEqual(scale.high, 0.995 / divisor)
            self.assertEqual(scale.limits(), [])
            self.assertEqual(scale.limit_text(), "▸ limit ±5 cm")

    def test_panels_of_one_kind_share_a_scale(self):
        x, z = spread_values() / 1000, spread_values() / 100
        shared = [scales.error_scale(values, values, limit, peers=[(x, 0.05), (z, 0.012)]) for values, limit in ((x, 0.05), (z, 0.012))]
        self.assertEqual({(scale.low, scale.high, scale.unit) for scale in shared}, {(-shared[0].high, shared[0].high, ("mm", 1000.0))})
        self.assertLess(shared[0].high, 0.01)
        near = [scales.magnitude_scale(values, values, limit, peers=[(x, 0.012), (z, None)]).high for values, limit in ((x, 0.012), (z, None))]
        self.assertEqual(near, [1.1 * 0.012] * 2)

    def test_rounding_noise_gets_no_colour(self):
        values = np.array([[1e-13, -1e-13]])
        scale = scales.error_scale(values, values)
        self.assertEqual((scale.low, scale.high, scale.unit[0]), (-1e-3, 1e-3, "mm"))
        self.assertEqual(scale.range_text(), "0 to 0 mm")

    def test_elevations_are_clipped_only_if_outliers_need_half_of_the_scale(self):
        values = spread_values()
        scale = scales.elevation_scale([values], [values])
        self.assertEqual((scale.low, scale.high, scale.clipping_text()), (0, 1, ""))
        values[:3] = 5
        scale = scales.elevation_scale([values], [values])
        self.assertAlmostEqual(scale.high, 0.997, delta=0.003)
        self.assertEqual(scale.clipped, (True, True))
        self.assertRegex(scale.clipping_text(), r"^colours from 5[.0-9]* mm to 0.99\d m \(0.5 and 99.5 % quantiles\)$")

    def test_counts_begin_at_0(self):
        values = np.full(1000, 3.0)
        scale = scales.count_scale(values, values)
        self.assertEqual((scale.low, scale.high, scale.colors, scale.clipping_text()), (0, 3, "count", ""))
        values[0] = 50
        scale = scales.count_scale(values, values)
        self.assertEqual((scale.high, scale.clipping_text()), (3, "colours end at 3 (99.5 % quantile)"))
        self.assertEqual(scale.range_text(), "3 to 50")

    def test_no_value_anywhere(self):
        nothing = np.full((3, 3), np.nan)
        for scale in (scales.error_scale(nothing, nothing, 0.05), scales.elevation_scale([nothing], [nothing]),
                      scales.count_scale(nothing, nothing)):
            self.assertEqual(scale.notes()[:2], ["no value anywhere", ""])
            self.assertLess(scale.low, scale.high)

    def test_two_lengths_in_one_unit(self):
        self.assertEqual(captions.metre_range(-0.145, 0.0134), "-14.5 to 1.34 cm")
        self.assertEqual(captions.metre_range(4e-14, 2.5), "0 to 2.5 m")

    def test_scale_bar_lengths(self):
        for span, length in ((20.0, 20.0), (19.9, 10.0), (0.7, 0.5), (4.9, 2.0)):
            self.assertAlmostEqual(maps.round_length_m(span), length)

    def test_lengths_are_written_with_a_fitting_unit(self):
        for value, text in ((1.381, "1.38 m"), (0.0831, "8.31 cm"), (-0.0026, "-2.6 mm"), (0.0, "0 mm"),
                            (1e-13, "< 1 µm"), (None, "–")):
            self.assertEqual(captions.metres(value), text)


class ReliefTest(unittest.TestCase):
    """Closed forms of lib/formats/picture/pixel_map.h."""

    def test_level_ground_has_the_colours_of_the_map(self):
        scale = scales.Scale("elevation", 0, 1, (0, 1), (0, 1), "")
        image = relief.image(np.full((4, 4), 0.5), 1.0, scale, 1, np.zeros((4, 4)))
        np.testing.assert_allclose(image[2, 1] * 255, scales.color_table("elevation")[128])

    def test_a_slope_is_lit_from_the_north_west(self):
        x, y = np.meshgrid(np.arange(5.0), np.arange(5.0))
        towards, away = 0.1 * (x - y), 0.1 * (y - x)  # rises to the south-east, and so faces the light
        expected = (0.2 + np.sqrt(2)) / np.sqrt(1.02) / np.sqrt(2)
        np.testing.assert_allclose(relief.light(towards, 1.0, 1), 0.25 + 0.75 * expected)
        expected = (-0.2 + np.sqrt(2)) / np.sqrt(1.02) / np.sqrt(2)
        np.testing.assert_allclose(relief.light(away, 1.0, 1), 0.25 + 0.75 * expected)

    def test_heights_are_scaled_to_an_rms_slope_of_two_fifths(self):
        x = np.tile(np.arange(9.0), (9, 1))
        for slope, factor in ((0.1, 4), (0.4, 1), (0.01, 5), (10, 0.25)):
            self.assertAlmostEqual(relief.factor(slope * x, 1.0), factor)
        self.assertEqual(relief.factor(0 * x, 1.0), 1)

    def test_missing_neighbours_are_ignored_and_missing_bins_are_grey(self):
        z = np.tile(np.arange(4.0), (3, 1))
        z[1, 1] = np.nan
        np.testing.assert_allclose(relief.slopes(z, 2.0)[0][1], [0, 0, 0.5, 0.5])
        scale = scales.Scale("elevation", 0, 3, (0, 3), (0, 3), "")
        missing = np.isnan(z).astype(float)
        missing[0, 0] = 0.5
        image = relief.image(z, 2.0, scale, 1, missing) * 255
        np.testing.assert_allclose(image[1, 1], scales.NO_VALUE)
        whole = relief.image(z, 2.0, scale, 1, np.isnan(z).astype(float)) * 255
        np.testing.assert_allclose(image[0, 0], (whole[0, 0] + scales.NO_VALUE) / 2)


class ZoomTest(unittest.TestCase):
    def setUp(self):
        centers = np.arange(-10, 11) * 1.0
        self.grid = files.MapGrid(centers, centers, 1.0)

    def test_the_window_stays_inside_the_map(self):
        window, rows, cols = maps.zoom_window(self.grid, (10.0, 0.0), 4.0)
        self.assertEqual((window.x[0], window.x[-1], window.y[0], window.y[-1]), (6, 10, -2, 2))
        self.assertEqual((rows, cols), (slice(8, 13), slice(16, 21)))

    def test_largest_bin(self):
        values = np.full((21, 21), np.nan)
        self.assertEqual(maps.largest_bin(self.grid, values), (0.0, 0.0))
        values[3, 15], values[4, 4] = -2, 1
        self.assertEqual(maps.largest_bin(self.grid, values), (5.0, -7.0))


if __name__ == "__main__":
    unittest.main()
