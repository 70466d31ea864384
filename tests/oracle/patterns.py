# SPDX-License-Identifier: GPL-3.0-or-later
"""Ground aims of the patterns (docs/user/lidar/pattern-*.md): x, y (n,), NaN for pulses without an aim."""
import numpy as np

from oracle import tables


def line_search(c, k, _):
    points = c["rows"] * c["columns"]
    past = k >= points
    n = k % points
    line, column = np.divmod(n, c["columns"])
    if c["direction"] == "boustrophedon":
        column = np.where(line % 2 == 1, c["columns"] - 1 - column, column)
    e = c["half_width_m"]
    x = -e + 2 * e * column / (c["columns"] - 1) if c["columns"] > 1 else np.zeros(len(k))
    if c["rows"] == 1:
        y = np.zeros(len(k))
    elif c["ramped"]:
        y = e - 2 * e * n / (points - 1)
    else:
        y = e - 2 * e * line / (c["rows"] - 1)
    lost = past & (c["at_end"] == "stop")
    return np.where(lost, np.nan, x), np.where(lost, np.nan, y)


def step_stare(c, k, _):
    step = k // c["pulses_per_step"]
    tiles = c["rows"] * c["columns"]
    row, column = np.divmod(step % tiles, c["columns"])
    if c["direction"] == "boustrophedon":
        column = np.where(row % 2 == 1, c["columns"] - 1 - column, column)
    e = c["half_width_m"]
    lost = (step >= tiles) & (c["at_end"] == "stop")
    return (np.where(lost, np.nan, -e + 2 * e * (column + 0.5) / c["columns"]),
            np.where(lost, np.nan, e - 2 * e * (row + 0.5) / c["rows"]))


def spiral(c, _, t):
    phase = t / c["period_s"] % 2
    share = np.where(phase > 1, 2 - phase, phase)
    if c["direction"] == "inward":
        share = 1 - share
    inner, outer = c["inner_radius_m"]**2, c["radius_m"]**2
    r = np.sqrt(inner + (outer - inner) * share)
    azimuth = 2 * np.pi * r / c["pitch_m"]
    return r * np.cos(azimuth), r * np.sin(azimuth)


def rosette(c, _, t):
    z = sum(np.exp(1j * (2 * np.pi * rate * t + np.radians(phase)))
            for rate, phase in zip(c["rates_hz"], c["phases_deg"])) * c["radius_m"] / 2
    return z.real, z.imag


def lissajous(c, _, t):
    half = c["half_width_m"] if isinstance(c["half_width_m"], list) else [c["half_width_m"]] * 2
    return (half[0] * np.sin(2 * np.pi * c["rates_hz"][0] * t + np.radians(c["phase_deg"])),
            half[1] * np.sin(2 * np.pi * c["rates_hz"][1] * t))


def stare(c, k, _):
    return np.full(len(k), float(c["aim_m"][0])), np.full(len(k), float(c["aim_m"][1]))


def table(c, _, t):
    columns = tables.read(c["path"])
    end = columns["t_s"][-1]
    past = t > end + 1e-9
    if c["at_end"] == "wrap":
        t = np.where(past, t % end, t)
    x, y = (np.interp(t, columns["t_s"], columns[name]) for name in ("x_m", "y_m"))
    lost = past & (c["at_end"] == "stop")
    return np.where(lost, np.nan, x), np.where(lost, np.nan, y)


AIMS = {f.__name__: f for f in (line_search, step_stare, spiral, rosette, lissajous, stare, table)}


def aims(config, k, t):
    """Ground aims (n, 3) of the pulses k, at times t after the first pulse."""
    k = np.asarray(k)
    x, y = AIMS[config["type"]](config, k, np.asarray(t, float))
    return np.stack([x, y, np.where(np.isnan(x), np.nan, 0)], -1)


def first_after_jump(config, k):
    """The first pulse after the latest jump of the aim; 0 before the first jump."""
    if config["type"] == "line_search":
        return k - k % config["columns"]
    if config["type"] == "step_stare":
        return k - k % config["pulses_per_step"]
    return np.zeros_like(k)


def limit(config):
    """The number of pulses after which the scan ends."""
    if config.get("at_end") != "stop" or config["type"] == "table":
        return np.inf
    return config["rows"] * config["columns"] * config.get("pulses_per_step", 1)
