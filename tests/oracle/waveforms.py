# SPDX-License-Identifier: GPL-3.0-or-later
"""The echoes of pixels and the points of their waveforms (lib/chain/lidar/receiver/echo.h, echo_timing.h), by sampling and bisection."""
import numpy as np

CLOSE = 2e-3  # heights whose relative difference is below it may be mistaken for each other by a search in steps
SAMPLES = 500  # of an echo, at once


def split(ranges, signals, gap):
    """The echoes of a pixel as (ranges, signals), nearest first, and whether rounding decides how many there are.

    The sub-rays keep their order if all lie within `gap`; else they are sorted. Draws of Geiger mode depend on the order.
    """
    seen = np.isfinite(ranges) & (signals > 0)
    ranges, signals = ranges[seen], signals[seen]
    if not len(ranges):
        return [], False
    order = np.argsort(ranges, kind="stable")
    steps = np.diff(ranges[order])
    cuts = np.flatnonzero(steps > gap) + 1
    if np.ptp(ranges) <= gap:
        order = np.arange(len(ranges))
    doubtful = bool(np.any(abs(steps - gap) < 1e-9))
    ranges, signals, ends = ranges[order], signals[order], [0, *cuts, len(order)]
    return [(ranges[begin:end], signals[begin:end]) for begin, end in zip(ends, ends[1:])], doubtful


class Echoes:
    """Waveforms w(x) = sum_j e_j exp(-(x - x_j)^2/2), one per row; x in units of sigma from the mean."""

    def __init__(self, echoes, sigma):
        shape = len(echoes), max((len(ranges) for ranges, _ in echoes), default=1)
        self.e, ranges = np.zeros(shape), np.empty(shape)
        for row, (r, signals) in enumerate(echoes):
            self.e[row, :len(r)], ranges[row, :len(r)], ranges[row, len(r):] = signals, r, r[-1]
        self.signal = self.e.sum(1)
        self.mean_m = ranges[:, 0] + (self.e * (ranges - ranges[:, :1])).sum(1) / self.signal
        self.x = (ranges - self.mean_m[:, None]) / sigma
        self.width = np.sqrt(1 + (self.e * self.x**2).sum(1) / self.signal)
        self.nearest, self.farthest = self.x.min(1, initial=np.inf), self.x.max(1, initial=-np.inf)
        self.doubtful = np.zeros(len(self.e), bool)
        self.find_peaks()

    def value(self, at, rows=slice(None)):
        """w at positions (echoes, any)."""
        away = at[:, :, None] - self.x[rows][:, None]
        return (self.e[rows][:, None] * np.exp(-away**2 / 2)).sum(-1)

    def slope(self, at):
        away = self.x - at[:, None]
        return (self.e * away * np.exp(-away**2 / 2)).sum(-1)

    def curvature(self, at):
        away = self.x - at[:, None]
        return (self.e * (away**2 - 1) * np.exp(-away**2 / 2)).sum(-1)

    def sampled(self, begin, end):
        """Positions and values on a grid, in blocks of rows."""
        for rows in np.array_split(np.arange(len(begin)), len(begin) // 50 + 1):
            if len(rows):
                at = np.linspace(begin[rows], end[rows], SAMPLES, axis=1)
                yield rows, at, self.value(at, rows)

    def find_peaks(self):
        low, high = self.nearest.copy(), self.farthest.copy()
        for rows, at, value in self.sampled(self.nearest, self.farthest):
            best, row = value.argmax(1), np.arange(len(rows))
            low[rows] = at[row, np.maximum(best - 1, 0)]
            high[rows] = at[row, np.minimum(best + 1, SAMPLES - 1)]
            summit = (value[:, 1:-1] > value[:, :-2]) & (value[:, 1:-1] > value[:, 2:])
            rival = summit & (value[:, 1:-1] > (1 - CLOSE) * value[row, best][:, None])
            far = abs(at[:, 1:-1] - at[row, best][:, None]) > 2 * (at[:, 1] - at[:, 0])[:, None]
            self.doubtful[rows] |= (rival & far).any(1)
        self.peak = bisect(lambda x: self.slope(x) < 0, low, high)
        self.height = self.value(self.peak[:, None])[:, 0]
        self.peak_sigma = np.sqrt(-self.height / self.curvature(self.peak))

    def first_crossing(self, level):
        """The time at which w first reaches a level below its maximum; marks doubtful rows in which it nearly does before."""
        begin = self.nearest - 1 - np.sqrt(2 * np.log(np.maximum(1, self.signal / level)))
        low, high = begin.copy(), self.peak.copy()
        for rows, at, value in self.sampled(begin, self.peak):
            row = np.arange(len(rows))
            above = value >= level[rows, None]
            above[:, -1] = True
            first = above.argmax(1)
            low[rows], high[rows] = at[row, np.maximum(first - 1, 0)], at[row, first]
            summit = (value[:, 1:-1] > value[:, :-2]) & (value[:, 1:-1] > value[:, 2:])
            near = summit & (abs(value[:, 1:-1] / level[rows, None] - 1) < CLOSE)
            self.doubtful[rows] |= (near & (np.arange(1, SAMPLES - 1) < first[:, None] + 3)).any(1)
        return bisect(lambda x: self.value(x[:, None])[:, 0] >= level, low, high)


def bisect(is_beyond, low, high):
    """The positions between low and high from which on is_beyond(x) holds."""
    for _ in range(60):
        middle = (low + high) / 2
        beyond = is_beyond(middle)
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return (low + high) / 2
