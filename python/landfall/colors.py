# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour map of each quantity, the same in figures, reports and the pictures of --view.

The table is that of lib/picture/color_map.cpp.
"""
import numpy as np
from matplotlib.colors import ListedColormap

# Colours at equal distances from 0 to 1; colours between are interpolated.
ANCHORS = {
    # cividis (Nunez, Anderton, Renslow, PLOS ONE 2018)
    "elevation": (0x00224e, 0x002e6a, 0x1a386f, 0x32436d, 0x434e6c, 0x535a6d, 0x61656f, 0x6f7073, 0x7d7c78, 0x8c8878, 0x9b9476,
                  0xaba072, 0xbcae6c, 0xcdbb63, 0xdec958, 0xf0d846, 0xfee838),
    # ColorBrewer RdBu, blue for negative
    "error": (0x053061, 0x175290, 0x2a71b2, 0x3f8ec0, 0x6bacd1, 0x9bc9e0, 0xc2ddec, 0xe0ecf3, 0xf7f6f6, 0xfbe5d8, 0xfbccb4, 0xf5aa89,
              0xe48066, 0xd05548, 0xba2832, 0x930e26, 0x67001f),
    # ColorBrewer YlOrBr
    "count": (0xffffe5, 0xfffbd0, 0xfff7bc, 0xfeeda6, 0xfee390, 0xfed36f, 0xfec34f, 0xfeae3b, 0xfe9829, 0xf5841e, 0xeb6f14, 0xdb5d0b,
              0xcb4b02, 0xb13f03, 0x983404, 0x7e2c05, 0x662506),
    # viridis (van der Walt, Smith 2015)
    "magnitude": (0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c, 0x1fa088, 0x28ae80,
                  0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725),
}
SHADES = 256


def parts(rrggbb):
    return rrggbb >> 16, rrggbb >> 8 & 255, rrggbb & 255


NO_VALUE = parts(0xc8c8c8)  # unlike any colour of the maps
MARK = parts(0xff00ff)      # bins that stand out from every map
# The classes of places to land on; missed hazards have the colour MARK.
SAFE, HAZARD, FALSE_ALARM, UNKNOWN = parts(0xcfe4f2), parts(0xe69f00), parts(0x0072b2), parts(0x8c8c8c)


def table(name):
    """The 256 colours of a map, one in a row, 0 to 255."""
    anchors = np.array([parts(color) for color in ANCHORS[name]], float)
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
