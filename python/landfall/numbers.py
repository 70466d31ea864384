# SPDX-License-Identifier: GPL-3.0-or-later
"""The texts of numbers, and the units that names end in."""
import math

FEWEST_DIGITS = 3
UNITS = {"m": "m", "mps": "m/s", "rad": "rad", "radps": "rad/s", "deg": "deg", "degps": "deg/s", "s": "s", "hz": "Hz",
         "frac": "1", "px": "px", "bins": "bins", "count": "1"}


def number(value, digits=FEWEST_DIGITS):
    """A number to so many significant digits; other values as they are."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    if not 1000 <= abs(value) < 1e7:
        return f"{value:.{digits}g}"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    text = f"{value:,.{decimals}f}"
    return text.rstrip("0").rstrip(".") if decimals else text


def with_unit(value, unit, digits=FEWEST_DIGITS):
    unit = "bin" if unit == "bins" and value == 1 else unit
    return f"{number(value, digits)} {unit}" if unit not in ("", "1") else number(value, digits)


def unit_of(name):
    """The unit that a name ends in: range_sigma_m -> m; empty where it ends in none."""
    return UNITS.get(name.rsplit("_", 1)[-1], "") if "_" in name else ""
