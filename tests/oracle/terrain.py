# SPDX-License-Identifier: GPL-3.0-or-later
"""Elevations of the nodes of a grid from its configuration (docs/user/terrain-gen.md, docs/user/terrain/)."""
import numpy as np

from oracle import draws
from oracle.surface import Grid


def taper(inside, width):
    """T(s, w) of docs/user/terrain: 0 on the border, 1 at the distance `width` inside it."""
    t = np.minimum(1, inside / width) if width > 0 else np.ones_like(inside)
    return t * t * (3 - 2 * t)


def cone(c, u, v):
    r = np.hypot(u, v)
    return np.where(r <= c["radius_m"], c["height_m"] * (1 - r / c["radius_m"]), np.nan)


def hemisphere(c, u, v):
    square = c["radius_m"]**2 - u * u - v * v
    return np.where(square >= 0, np.sqrt(np.maximum(square, 0)), np.nan)


def pyramid(c, u, v):
    outermost = 2 * np.maximum(abs(u), abs(v)) / c["base_width_m"]
    return np.where(outermost <= 1, c["height_m"] * (1 - outermost), np.nan)


def rock(c, u, v):
    a = c["diameter_m"] / 2
    square = 1 - (u / a)**2 - (v / (c.get("axis_ratio", 0.8) * a))**2
    return np.where(square >= 0, c.get("height_m", a) * np.sqrt(np.maximum(square, 0)), np.nan)


def ice_block(c, u, v):
    tilt = np.radians(c.get("tilt_deg", 0))
    t, v = abs(tilt), v * (1 if tilt >= 0 else -1)
    w, s = c["width_m"] * np.cos(t) / 2, c["height_m"] * np.sin(t)
    top = (c["height_m"] + v * np.sin(t)) / np.cos(t)
    side = (c["width_m"] / 2 - v * np.cos(t)) / np.sin(t) if t > 0 else top
    z = np.where((v >= -w - s) & (v <= w - s), top, np.where((v > w - s) & (v <= w), side, np.nan))
    return np.where(abs(u) <= c["length_m"] / 2, z, np.nan)


CRATER_DEPTHS = [(10, 0.10), (40, 0.11), (100, 0.13), (200, 0.15), (400, 0.17), (np.inf, 0.21)]


def crater(c, u, v):
    d = c["diameter_m"]
    x = 2 * np.hypot(u, v) / d
    bowl = -0.228809953 + 0.227533882 * x + 0.083116795 * x**2 - 0.039499407 * x**3
    outside = 0.188253307 - 0.187050452 * x + 0.01844746 * x**2 + 0.01505647 * x**3
    rim = 0.036822095
    depth = c.get("depth_m", d * next(fraction for below, fraction in CRATER_DEPTHS if d < below))
    full = rim * 0.196 / 0.036
    height = min(depth / d / full, 1)
    floored = np.maximum(bowl, rim - depth / d / height)
    profile = height * np.where(x <= 0.98, floored, np.where(x <= 1.02, rim, outside))
    return np.where(x <= 1.5, c.get("freshness", 1) * d * profile, 0)


def pit(c, u, v):
    inside = c["diameter_m"] / 2 - np.hypot(u, v)
    slope = np.tan(np.radians(c.get("wall_slope_deg", 90)))
    return np.where(inside >= 0, -np.minimum(c["depth_m"], inside * slope), 0)


def fracture(c, u, v):
    g = np.tan(np.radians(c.get("wall_slope_deg", 90)))
    half, fade = c.get("width_m", 0) / 2, c.get("fade_m", c["length_m"] / 2)
    throw = c.get("throw_m", 0)
    trough = np.where(abs(v) <= half, -np.minimum(c.get("depth_m", 0), (half - abs(v)) * g), 0)
    cliff = np.where((v >= 0) & (v <= fade), np.sign(throw) * np.minimum(abs(throw), v * g) * taper(fade - v, fade), 0)
    inside = c["length_m"] / 2 - abs(u)
    ends = taper(np.maximum(inside, 0), c.get("taper_m", c["length_m"] / 10))
    return np.where(inside >= 0, (trough + cliff) * ends, 0)


def ridge(c, u, v):
    d = abs(abs(v) - c.get("spacing_m", 0) / 2)
    inside = c["length_m"] / 2 - abs(u)
    z = (c["height_m"] * 2.0**-((2 * d / c["width_m"])**2)
         * taper(np.maximum(inside, 0), c.get("taper_m", c["length_m"] / 10)))
    return np.where((inside >= 0) & (d <= 3 * c["width_m"]), z, np.nan)


def penitente_field(c, u, v):
    length = c.get("wavelength_m", 7.5)
    extents = [c["diameter_m"]] if "diameter_m" in c else [c["length_m"], c["width_m"]]
    edge = c.get("edge_m", min(length, min(extents) / 2))
    if "diameter_m" in c:
        inside = c["diameter_m"] / 2 - np.hypot(u, v)
        within, rise = inside >= 0, taper(np.maximum(inside, 0), edge)
    else:
        along, across = c["length_m"] / 2 - abs(u), c["width_m"] / 2 - abs(v)
        within = (along >= 0) & (across >= 0)
        rise = taper(np.maximum(along, 0), edge) * taper(np.maximum(across, 0), edge)
    wander = c.get("wobble_m", 0) * noise(c.get("seed", 1), *(x / c.get("wobble_length_m", 2 * length) for x in (u, v)))
    waves = (v + wander) / length
    blade = 1 - abs(2 * (waves - np.floor(waves)) - 1)
    return np.where(within, c["amplitude_m"] * blade**c.get("exponent", 1) * rise, np.nan)


def noise(seed, u, v):
    """Uniform random values on a unit lattice, interpolated with t^2 (3 - 2 t)."""
    i, j = np.floor(u), np.floor(v)
    p, q = taper(u - i, 1), taper(v - j, 1)
    corner = [[2 * draws.uniform(seed, draws.PENITENTE, i + di, j + dj) - 1 for di in (0, 1)] for dj in (0, 1)]
    south, north = (row[0] + p * (row[1] - row[0]) for row in corner)
    return south + q * (north - south)


STANDING = {"cone": cone, "hemisphere": hemisphere, "pyramid": pyramid, "rock": rock, "ice_block": ice_block}
ADDED = {"crater": crater, "pit": pit, "fracture": fracture}
DRAPED = {"ridge": ridge, "penitente_field": penitente_field}


def own_axes(c, x, y):
    yaw = np.radians(c.get("yaw_deg", 0))
    dx, dy = x - c.get("x_m", 0), y - c.get("y_m", 0)
    return np.cos(yaw) * dx + np.sin(yaw) * dy, np.cos(yaw) * dy - np.sin(yaw) * dx


def placed(config):
    """All features, including those of rings."""
    result = list(config.get("features", []))
    for pattern in config.get("patterns", []):
        for n in range(pattern["count"]):
            azimuth = np.radians(pattern.get("first_azimuth_deg", 0)) + 2 * np.pi * n / pattern["count"]
            result.append({**pattern["feature"], "x_m": pattern["radius_m"] * np.cos(azimuth),
                           "y_m": pattern["radius_m"] * np.sin(azimuth)})
    return result


def raster(base, x, y):
    """A `dem` base from an Esri ASCII file without a CRS; row 0 of the file is the northernmost."""
    with open(base["path"], encoding="utf-8") as file:
        lines = file.read().splitlines()
    header = {line.split()[0]: float(line.split()[1]) for line in lines[:6]}
    samples = np.array([line.split() for line in lines[6:]], float)[::-1]
    samples[samples == header["NODATA_value"]] = np.nan
    step = header["cellsize"] * base["horizontal_scale_m"]
    rows, columns = samples.shape
    # The centre in pixel coordinates, in which sample (r, c) lies at (c, r), with rows counted from the south.
    middle = (base["center_pixel"][0], rows - 1 - base["center_pixel"][1])
    at = {"nearest": nearest, "bilinear": bilinear, "bicubic": bicubic}[base["interpolation"]]
    z = at(samples, middle[0] + x / step, middle[1] + y / step)
    if base["datum"] == "center":
        z = z - at(samples, np.array(middle[0]), np.array(middle[1]))
    return base.get("vertical_scale", 1) * z


def nearest(samples, u, v):
    return samples[np.floor(v + 0.5).astype(int), np.floor(u + 0.5).astype(int)]


def weighted(samples, u, v, weights_of, first, count):
    """The sum of samples times weights along u and v; samples of weight 0 are ignored, even if they are holes."""
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    wu, wv = weights_of(u - i), weights_of(v - j)
    total = np.zeros(np.shape(u))
    for b in range(count):
        for a in range(count):
            weight = wu[a] * wv[b]
            row, column = (np.clip(k, 0, n - 1) for k, n in zip((j + first + b, i + first + a), samples.shape))
            total = total + np.where(weight != 0, weight * samples[row, column], 0)
    return total


def bilinear(samples, u, v):
    return weighted(samples, u, v, lambda t: (1 - t, t), 0, 2)


def keys(t):
    """Weights of the samples at -1, 0, 1 and 2 by Keys (1981), a = -1/2."""
    near = lambda d: 1 - 2.5 * d**2 + 1.5 * d**3
    far = lambda d: 2 - 4 * d + 2.5 * d**2 - 0.5 * d**3
    return far(1 + t), near(t), near(1 - t), far(2 - t)


def bicubic(samples, u, v):
    cubic = weighted(samples, u, v, keys, -1, 4)
    return np.where(np.isnan(cubic), bilinear(samples, u, v), cubic)


def base_elevation(base, x, y):
    if base["type"] == "plane":
        return base.get("elevation_m", 0) + base.get("slope_x", 0) * x + base.get("slope_y", 0) * y
    return raster(base, x, y)


def is_known(config):
    """True if elevations() can compute the terrain, which has neither fractals nor populations."""
    bases = config["base"] if isinstance(config["base"], list) else [config["base"]]
    return all(base["type"] != "fractal" for base in bases) and all(
        pattern["type"] == "ring" for pattern in config.get("patterns", []))


def axis(config):
    half = round(config["grid"]["half_width_m"] / config["grid"]["resolution_m"])
    return np.arange(-half, half + 1) * config["grid"]["resolution_m"]


def elevations(config):
    """The elevations z (y, x) of the nodes."""
    x, y = np.meshgrid(axis(config), axis(config))
    bases = config["base"] if isinstance(config["base"], list) else [config["base"]]
    ground = sum(base_elevation(base, x, y) for base in bases) + np.zeros(x.shape)
    features = placed(config)
    draped = np.zeros(x.shape)
    for c in features:
        u, v = own_axes(c, x, y)
        if c["type"] in ADDED:
            ground = ground + ADDED[c["type"]](c, u, v)
        elif c["type"] in DRAPED:
            draped = np.fmax(draped, DRAPED[c["type"]](c, u, v))
    ground = ground + draped
    under = Grid(axis(config), axis(config), ground)
    z = ground
    for c in features:
        if c["type"] in STANDING:
            foot = under.elevation(np.array([c.get("x_m", 0.0)]), np.array([c.get("y_m", 0.0)]))[0]
            z = np.fmax(z, np.where(np.isnan(ground), np.nan, foot + STANDING[c["type"]](c, *own_axes(c, x, y))))
    return z
