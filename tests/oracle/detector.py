# SPDX-License-Identifier: GPL-3.0-or-later
"""The directions of pixels and sub-pixels, and the range of a pixel from its sub-ranges (docs/user/lidar/detector-*.md)."""
import numpy as np

from oracle import tables
from oracle.frames import normalised


def pair(value):
    return np.array(value if isinstance(value, list) else [value, value], float)


def pitch(config):
    counts = np.array([config["columns"], config["rows"]])
    if "fov_deg" in config:
        return 2 * np.tan(np.radians(pair(config["fov_deg"])) / 2) / counts
    return pair(config.get("ifov_rad", 1.6e-3 / 18))


def centres(config):
    """u (to the right) and v (up) of each pixel, row by row from the top."""
    rows, columns = config["rows"], config["columns"]
    if isinstance(config["distribution"], dict):
        c = tables.read(config["distribution"]["path"])
        order = np.argsort(c["row"] * columns + c["column"])
        return c["u"][order], c["v"][order]
    a, b = np.divmod(np.arange(rows * columns), columns)
    across, down = pitch(config)
    return (b - (columns - 1) / 2) * across, ((rows - 1) / 2 - a) * down


def directions(config, u, v):
    """Unit vectors in L: distorted, then rotated by the roll about -z_L."""
    square = u * u + v * v
    k = config["distortion"]
    scale = 1 + k["k1"] * square + k["k2"] * square**2 + k["k3"] * square**3
    flat = normalised(np.stack([u * scale, -v * scale, np.ones_like(u)], -1))
    roll = np.radians(config["roll_deg"])
    turn = np.array([[np.cos(roll), np.sin(roll), 0], [-np.sin(roll), np.cos(roll), 0], [0, 0, 1]])
    return flat @ turn.T


def pixels(config):
    return directions(config, *centres(config))


def subpixels(config):
    """Directions of the sub-pixels, (pixels, m m, 3), row by row from the top."""
    m = config["subpixels"]
    across, down = pitch(config) * (np.sqrt(config["fill_factor"]) if m > 1 else 1)
    offset = (np.arange(m) - (m - 1) / 2) / m
    du, dv = (grid.ravel() for grid in np.meshgrid(offset * across, -offset * down))
    u, v = centres(config)
    return directions(config, u[:, None] + du, v[:, None] + dv)


def strongest(ranges, extent):
    """Mean of the ranges in the fullest window of length `extent`, ends included; among equally full ones, in the nearest."""
    ranges = np.sort(ranges[np.isfinite(ranges)])
    if not len(ranges):
        return np.nan
    counts = [np.sum((ranges >= first) & (ranges - first <= extent)) for first in ranges]
    best = int(np.argmax(counts))
    return ranges[best:best + counts[best]].mean()


def estimated(config, ranges):
    """The range of each row of sub-ranges (..., m m); NaN if there is no return."""
    if ranges.shape[-1] == 1:
        return ranges[..., 0]
    name, hits = config["estimator"], np.sum(np.isfinite(ranges), axis=-1)
    enough = 2 * hits >= ranges.shape[-1] if name in ("mean", "median") else hits > 0
    result = np.full(hits.shape, np.nan)
    if name == "strongest":
        values = [strongest(row, config["range_resolution_m"]) for row in ranges[enough]]
    else:
        values = {"mean": np.nanmean, "median": np.nanmedian, "first": np.nanmin}[name](ranges[enough], axis=-1)
    result[enough] = values
    return result
