# SPDX-License-Identifier: GPL-3.0-or-later
"""Scales of maps: the colour map of each quantity, which values the colours show, and what the figure says about it.

The rules are those of the report (lib/app/report/web/scales.js) and of --view (lib/formats/picture/map_picture.cpp).
"""
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import ListedColormap

from landfall import dictionary
from landfall.plot import captions

OUTLIERS = dictionary.table("maps")["outliers"]          # on either side
LIMIT_INSIDE = dictionary.table("maps")["limit_inside"]  # a scale that reaches the limit reaches this times the limit
LIMIT_NEAR = dictionary.table("maps")["limit_near"]      # which it does if that is at most this times the largest value shown
MIN_M = 1e-3                                             # of a scale of lengths, so that rounding errors do not appear in colour



def parsed(text):
    """(red, green, blue) of #rrggbb."""
    return tuple(bytes.fromhex(text.removeprefix("#")))


# Colours, the same in figures, reports and the pictures of --view, at equal distances from 0 to 1; colours between are interpolated.
ANCHORS = {entry["name"]: tuple(map(parsed, entry["anchors"])) for entry in dictionary.table("maps")["color_maps"]}
NAMED = {entry["name"]: parsed(entry["color"]) for entry in dictionary.table("maps")["colors"]}
NO_VALUE = NAMED["no_value"]  # unlike any colour of the maps
MARK = NAMED["mark"]          # bins that stand out from every map


def color_table(name):
    """The 256 colours of a map, one in a row, 0 to 255."""
    anchors = np.array(ANCHORS[name], float)
    at = np.arange(256) / 255 * (len(anchors) - 1)
    return np.floor(np.column_stack([np.interp(at, range(len(anchors)), channel) for channel in anchors.T]) + 0.5)


def css(color):
    return "#{:02x}{:02x}{:02x}".format(*color)


def color_map(name):
    """The map for matplotlib, with the colour of missing values."""
    result = ListedColormap(color_table(name) / 255, name)
    result.set_bad(css(NO_VALUE))
    return result


@dataclass(frozen=True)
class Scale:
    """The colour map of the quantity and the values at its ends, in `base` units.

    `extremes` are those of all values, `shown` those of the blocks that the panel shows, `rule` says what set the ends, and `limit`
    is the limit of an error.
    """

    colors: str
    low: float
    high: float
    extremes: tuple
    shown: tuple
    rule: str
    limit: float = None
    base: str = "m"

    @property
    def unit(self):
        """(name, factor) of the unit that the colour bar and the texts show."""
        return captions.length_unit(max(abs(self.low), abs(self.high))) if self.base == "m" else (self.base, 1.0)

    @property
    def clipped(self):
        """Whether values that the panel shows lie (below, above) the ends."""
        slack = 1e-9 * (self.high - self.low)
        return (bool(self.shown[0] < self.low - slack), bool(self.shown[1] > self.high + slack))

    @property
    def extend(self):
        """Which ends of the colour bar are pointed, as matplotlib names them."""
        return {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[self.clipped]

    def limits(self):
        """The limits on the scale."""
        if self.limit is None:
            return []
        both = [self.limit, -self.limit] if self.colors == "error" else [self.limit]
        return [limit for limit in both if self.low < limit < self.high]

    def text(self, value):
        """A value with its unit."""
        return captions.metres(value) if self.base == "m" else f"{value:.4g} {self.base}".rstrip()

    def range_text(self):
        """The extremes of all values."""
        low, high = self.extremes
        if np.isnan(low):
            return "no value anywhere"
        if self.base == "m":
            return captions.metre_range(low, high)
        return f"{low:.4g} to {high:.4g} {self.base}".rstrip()

    def notes(self, of=""):
        """A label: the values, where the colours end, and the limit of an error."""
        return [self.range_text(), self.clipping_text(), self.limit_text(of)]

    def clipping_text(self):
        """The values at which the colours end, and why, if values lie beyond; empty otherwise."""
        if not any(self.clipped):
            return ""
        low, high = "0" if self.low == 0 else self.text(self.low), self.text(self.high)
        if self.colors == "error":
            return f"colours end at ±{high} ({self.rule})"
        if not self.clipped[1]:
            return f"colours begin at {low}"
        return f"colours from {low} to {high} ({self.rule})" if self.clipped[0] else f"colours end at {high} ({self.rule})"

    def limit_text(self, of=""):
        if self.limit is None:
            return ""
        return f"▸ limit {'±' if self.colors == 'error' else ''}{self.text(self.limit)}{of}"


def extremes(*layers):
    """(lowest, highest) value of all layers; (nan, nan) where there is none."""
    return (float(np.fmin.reduce([np.fmin.reduce(layer, axis=None) for layer in layers])),
            float(np.fmax.reduce([np.fmax.reduce(layer, axis=None) for layer in layers])))


def quantiles(shares, *layers):
    """The values below which these shares of all values lie; 0 where there is no value."""
    values = np.concatenate([layer[~np.isnan(layer)] for layer in layers])
    if values.size == 0:
        return [0.0 for _ in shares]
    ranks = [int(np.floor(share * (values.size - 1) + 0.5)) for share in shares]
    ordered = np.partition(values, ranks)
    return [float(ordered[rank]) for rank in ranks]


def error_scale(values, shown, limit_m=None, data_only=False, peers=()):
    """Symmetric about 0, up to the 99.5 % quantile of the magnitudes that the panel shows and, unless `data_only`, to the limit if that is near.
    `peers`: (values shown, limit) of each panel that has the same scale, this one too."""
    high, rule = _magnitude_end(peers or [(shown, limit_m)], data_only)
    return Scale("error", -high, high, extremes(values), extremes(shown), rule, limit_m)


def magnitude_scale(values, shown, limit_m=None, data_only=False, peers=()):
    """From 0, otherwise as error_scale."""
    high, rule = _magnitude_end(peers or [(shown, limit_m)], data_only)
    return Scale("magnitude", 0.0, high, extremes(values), extremes(shown), rule, limit_m)


def _magnitude_end(peers, data_only):
    ends = {"99.5 % quantile": quantiles([1 - OUTLIERS], *(np.abs(shown) for shown, _ in peers))[0], "least end": MIN_M}
    limit = LIMIT_INSIDE * max(limit or 0 for _, limit in peers)
    if not data_only and limit <= LIMIT_NEAR * max(ends.values()):
        ends[f"{LIMIT_INSIDE:g} x limit"] = limit
    rule = max(ends, key=ends.get)
    return ends[rule], rule


def elevation_scale(layers, shown):
    """All values or, if these reach over more than twice the range between the 0.5 and 99.5 % quantiles, this range."""
    low, high = span = extremes(*shown)
    if np.isnan(low):
        return Scale("elevation", 0.0, 1.0, span, span, "")
    minimum, maximum = quantiles([OUTLIERS, 1 - OUTLIERS], *shown)
    if maximum > minimum and high - low > 2 * (maximum - minimum):
        low, high = minimum, maximum
    return Scale("elevation", low, max(high, low + MIN_M), extremes(*layers), span, "0.5 and 99.5 % quantiles")


def count_scale(values, shown, colors="count", base="", minimum=1.0):
    """From 0 to the largest value or, if that is more than twice the 99.5 % quantile, to this; at least to `least`."""
    span = extremes(shown)
    high = 0.0 if np.isnan(span[1]) else span[1]
    maximum = quantiles([1 - OUTLIERS], shown)[0]
    end = maximum if maximum >= minimum and high > 2 * maximum else max(high, minimum)
    return Scale(colors, 0.0, end, extremes(values), span, "99.5 % quantile", base=base)
