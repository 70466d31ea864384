# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaded relief, as lib/formats/picture/pixel_map.cpp computes it: light from the north-west, 45 degrees high."""
import math

import numpy as np

from landfall.plot import scales


def slopes(z, step_m):
    """(slope to the east, slope to the north) of each value, rows from south to north. A missing neighbour is ignored."""
    padded = np.pad(z, 1, constant_values=np.nan)
    return (_between(padded[1:-1, :-2], z, padded[1:-1, 2:]) / step_m, _between(padded[:-2, 1:-1], z, padded[2:, 1:-1]) / step_m)


def _between(before, middle, after):
    result = (after - before) / 2
    for one_sided in (after - middle, middle - before, np.zeros_like(middle)):
        result = np.where(np.isnan(result), one_sided, result)
    return np.where(np.isnan(middle), 0, result)


def factor(z, step_m):
    """The factor for heights, in [1/4, 5], that brings the rms slope nearest to 0.4."""
    east, north = slopes(z, step_m)
    count = np.count_nonzero(~np.isnan(z))
    rms = math.sqrt((np.sum(east**2) + np.sum(north**2)) / count) if count else 0
    return min(5, max(0.25, 0.4 / rms)) if rms > 0 else 1


def light(z, step_m, heights):
    """The factor by which colours are multiplied, 1 on level terrain; `heights` multiplies the elevations."""
    east, north = (heights * slope for slope in slopes(z, step_m))
    shade = np.maximum(0, (east - north + math.sqrt(2)) / np.sqrt(1 + east**2 + north**2) / math.sqrt(2))
    return np.clip(0.25 + 0.75 * shade, 0, 1.25)


def image(z, step_m, scale, heights, missing):
    """Shaded colours, 0 to 1, greyer the larger the share of missing bins."""
    table, known = scales.color_table(scale.colors), ~np.isnan(z)
    at = np.where(known, z, scale.low)
    index = np.clip(np.floor(255 * (at - scale.low) / (scale.high - scale.low) + 0.5), 0, 255).astype(int)
    lit = np.minimum(255, table[index] * light(z, step_m, heights)[..., None])
    lit = np.where(known[..., None], lit, scales.NO_VALUE)
    return (lit + missing[..., None] * (np.array(scales.NO_VALUE) - lit)) / 255
