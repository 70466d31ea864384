# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D275
"""Reduces a map of bins to the pixels of a panel.

A panel has fewer pixels than a map has bins. Values are reduced block by block to the extreme of each block, so that no
defect vanishes. Marked bins are enlarged only while they are few (as in reports); otherwise a block shows their share.
"""
import math

import numpy as np

MAX_MARKED = 0.01  # of the region, and of the map by enlarged marks: more would hide the map
WIDE_BLOCKS = 200   # of so many along an edge or fewer, a single one is seen without being enlarged


def block_size(shape, cells):
    """The edge, in bins, of blocks that cover `shape` with at most `cells` blocks along the longer side."""
    return max(1, math.ceil(max(shape) / cells))


def blocks(values, size, fill):
    """View of `values`, padded with `fill`, as (block row, row in block, block column, column in block)."""
    if np.isnan(fill) and values.dtype.kind != "f":
        values = values.astype(float)  # a layer of whole numbers has no NaN
    rows, cols = (math.ceil(n / size) for n in values.shape)
    padding = [(0, rows * size - values.shape[0]), (0, cols * size - values.shape[1])]
    padded = np.pad(values, padding, constant_values=fill)
    return padded.reshape(rows, size, cols, size)


def shrink_extreme(values, size):
    """The value of largest magnitude of each block; NaN where a block has none."""
    cut = blocks(values, size, np.nan)
    high, low = np.fmax.reduce(cut, axis=(1, 3)), np.fmin.reduce(cut, axis=(1, 3))
    return np.where(-low > high, low, high)


def shrink_max(values, size):
    """The largest value of each block; NaN where a block has none."""
    return np.fmax.reduce(blocks(values, size, np.nan), axis=(1, 3))


def shrink_min(values, size):
    """The smallest value of each block; NaN where a block has none."""
    return np.fmin.reduce(blocks(values, size, np.nan), axis=(1, 3))


def shrink_mean(values, size):
    """The mean of each block's values; NaN where a block has none."""
    cut = blocks(values, size, np.nan)
    known = ~np.isnan(cut)
    count = known.sum(axis=(1, 3))
    total = np.where(known, cut, 0).sum(axis=(1, 3))
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def shrink_any(flags, size):
    """Whether any bin of each block is set."""
    return blocks(flags, size, False).any(axis=(1, 3))


def surroundings(flags, radius):
    """View of the square of 2 radius + 1 cells about each cell, unset outside the map."""
    return np.lib.stride_tricks.sliding_window_view(np.pad(flags, radius), (2 * radius + 1, 2 * radius + 1))


def enlarge(flags, radius):
    """Grows set cells to squares of 2 radius + 1 cells."""
    return surroundings(flags, radius).any(axis=(2, 3))


def lone(marks):
    """The marks with at most one marked neighbour of eight; larger groups are visible."""
    return marks & (surroundings(marks, 1).sum(axis=(2, 3)) <= 2)


def enlarged_marks(flags, size, region_bins):
    """Blocks with a set bin, single ones enlarged to 3 x 3 blocks.

    None if the set bins are 1 % of `region_bins` or the result is 1 % of the map, or more.
    """
    if flags.sum() >= MAX_MARKED * region_bins:
        return None
    marks = shrink_any(flags, size)
    if max(marks.shape) <= WIDE_BLOCKS:
        return marks
    marks |= enlarge(lone(marks), 1)
    return marks if marks.sum() < MAX_MARKED * marks.size else None


def shrink_share(flags, size):
    """The share of set bins of each block."""
    return shrink_mean(flags.astype(float), size)
