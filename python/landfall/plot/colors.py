# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour map of each quantity, the same in figures, reports and the pictures of --view (schemas/dictionary/maps.json)."""
import numpy as np
from matplotlib.colors import ListedColormap

from landfall import dictionary

SHADES = 256


def parts(rrggbb):
    return rrggbb >> 16, rrggbb >> 8 & 255, rrggbb & 255


def parsed(text):
    return parts(int(text.removeprefix("#"), 16))


# Colours at equal distances from 0 to 1; colours between are interpolated.
ANCHORS = {entry["name"]: tuple(map(parsed, entry["anchors"])) for entry in dictionary.table("maps")["color_maps"]}
NAMED = {entry["name"]: parsed(entry["color"]) for entry in dictionary.table("maps")["colors"]}
NO_VALUE = NAMED["no_value"]  # unlike any colour of the maps
MARK = NAMED["mark"]          # bins that stand out from every map


def table(name):
    """The 256 colours of a map, one in a row, 0 to 255."""
    anchors = np.array(ANCHORS[name], float)
    at = np.arange(SHADES) / (SHADES - 1) * (len(anchors) - 1)
    below = np.minimum(at.astype(int), len(anchors) - 2)
    return np.floor(anchors[below] + (at - below)[:, None] * (anchors[below + 1] - anchors[below]) + 0.5)


def css(color):
    return "#{:02x}{:02x}{:02x}".format(*color)


def color_map(name):
    """The map for matplotlib, with the colour of missing values."""
    result = ListedColormap(table(name) / 255, name)
    result.set_bad(css(NO_VALUE))
    return result
