# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and lengths as text."""


def metres(value):
    """A length with a unit that suits it: 1.2 mm, 8.3 cm, 1.38 m; a dash where it is not known."""
    if value is None:
        return "–"
    if 0 < abs(value) < 1e-6:
        return "< 1 µm"
    unit, factor = length_unit(value)
    return f"{value * factor:.3g} {unit}"


def length_unit(value_m):
    """(name, factor) of the unit in which a length is neither very small nor very large."""
    return ("m", 1.0) if abs(value_m) >= 0.5 else ("cm", 100.0) if abs(value_m) >= 0.01 else ("mm", 1000.0)


def metre_range(low_m, high_m):
    """Two lengths in one unit: -14.5 to 13.4 cm."""
    unit, factor = length_unit(max(abs(low_m), abs(high_m)))
    low, high = (0.0 if abs(value) < 1e-6 else value * factor for value in (low_m, high_m))
    return f"{low:.3g} to {high:.3g} {unit}"


def number(value):
    """A count or a fractional number; a dash where it is not known."""
    return "–" if value is None else f"{value:,.4g}" if isinstance(value, float) else f"{value:,}"


def counted(value, noun):
    return f"{number(value)} {noun}" + ("" if value == 1 else "s")


def percent(fraction):
    return "–" if fraction is None else f"{100 * fraction:.3g} %"
