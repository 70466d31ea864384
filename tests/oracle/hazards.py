# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers, sites and score of a hazard map, from an elevation map (docs/user/hazard-map.md)."""
import itertools

import numpy as np

from oracle.draws import uniform
from oracle.evaluate import components

LMEDS = 31  # the stream of random numbers
HAZARD, SAFE, UNKNOWN = 0, 1, 2


def ring(shape, bin_, distance):
    """The bins at this Chebyshev distance that lie in the map."""
    row, column = bin_
    return [(r, c) for r, c in itertools.product(range(row - distance, row + distance + 1), range(column - distance, column + distance + 1))
            if max(abs(r - row), abs(c - column)) == distance and 0 <= r < shape[0] and 0 <= c < shape[1]]


def small_holes(z, maximum):
    """{bin: the bins of its ring that have a value} for the holes that are filled."""
    ids = components(np.isnan(z))
    result = {}
    for number in range(1, ids.max() + 1):
        rows, columns = np.nonzero(ids == number)
        inside = rows.min() > 0 and columns.min() > 0 and rows.max() < z.shape[0] - 1 and columns.max() < z.shape[1] - 1
        if len(rows) > maximum or not inside:
            continue
        for bin_ in zip(rows, columns):
            result[bin_] = next(values for distance in itertools.count(1)
                                if (values := [b for b in ring(z.shape, bin_, distance) if not np.isnan(z[b])]))
    return result


def filled(z, holes):
    result = z.copy()
    for bin_, values in holes.items():
        result[bin_] = np.nanmean([z[b] for b in values])
    return result


def disc(radius_m, s):
    reach = int(radius_m / s) + 1
    return [(i, j) for i, j in itertools.product(range(-reach, reach + 1), repeat=2) if np.hypot(i * s, j * s) <= radius_m + 1e-9]


def shifted(z, columns, rows):
    """z at (x + columns, y + rows) of every bin; NaN beyond the map."""
    result = np.full(z.shape, np.nan)
    height, width = z.shape
    if abs(rows) < height and abs(columns) < width:
        result[max(0, -rows):height - max(0, rows), max(0, -columns):width - max(0, columns)] = \
            z[max(0, rows):height - max(0, -rows), max(0, columns):width - max(0, -columns)]
    return result


def pads_at(lander, s, yaw):
    """The bins of the pads, relative to the lander's, in a yaw."""
    n, radius = lander["legs"], lander["leg_radius_m"] / s
    nearest = lambda v: int(np.sign(v) * np.floor(abs(v) + 0.5 + 1e-9))
    angles = [yaw + 2 * np.pi * k / n for k in range(n)]
    pads = [(nearest(radius * np.cos(a)), nearest(radius * np.sin(a))) for a in angles]
    if n == 3:
        return pads
    x, y = pads[0]
    return [(x, y), (-y, x), (-x, -y), (y, -x)]


def yaws(lander, s):
    sector = 2 * np.pi / lander["legs"]
    count = int(np.ceil(sector * lander["leg_radius_m"] / s - 1e-9))
    return [pads_at(lander, s, m * sector / count) for m in range(count)]


def plane_of(pads, heights, s):
    """East, north and height at the centre of the plane through three pads, for every place."""
    matrix = np.linalg.inv([[x * s, y * s, 1] for x, y in pads])
    return np.einsum("ij,jrc->irc", matrix, np.stack(heights))


def range_differences(z, config, s):
    """Slope and roughness by windows of the median-filtered map; NaN where a bin in a window is missing."""
    square = lambda half: list(itertools.product(range(-half, half + 1), repeat=2))
    body, rock = (int(np.floor((radius + 1e-9) / s)) for radius in (config["lander"]["body_radius_m"], config["limits"]["roughness_m"]))
    smooth = np.median([shifted(z, *offset) for offset in square(1)], axis=0)
    spread = lambda values, half: np.ptp([shifted(values, *offset) for offset in square(half)], axis=0)
    rough = np.max([shifted(spread(smooth, rock), *offset) for offset in square(body)], axis=0)
    slope = np.degrees(np.arctan(spread(smooth, body) / (2 * body * s)))
    return np.where(np.isnan(rough), np.nan, slope), rough


def median_plane(body):
    """The plane of least median through one of 35 triples of samples, as (east, north, height) per bin."""
    half = max(i for i, _ in body)
    stride = max(1, half // 4)
    samples = sorted(((i, j) for i, j in body if i % stride == 0 and j % stride == 0), key=lambda bin_: bin_[::-1])
    heights = np.stack([body[bin_] for bin_ in samples])
    draws = ([int(np.floor(uniform(1, LMEDS, draw, k) * len(samples))) for k in range(3)] for draw in itertools.count())
    matrices = ((chosen, np.array([[*samples[k], 1] for k in chosen])) for chosen in draws)
    triples = itertools.islice(((chosen, matrix) for chosen, matrix in matrices if round(np.linalg.det(matrix)) != 0), 35)
    planes = np.stack([np.einsum("ij,jrc->irc", np.linalg.inv(matrix), heights[chosen]) for chosen, matrix in triples])
    medians = np.stack([np.median(np.abs(heights - sum(np.multiply.outer(axis, p) for axis, p in zip([*zip(*samples), [1] * len(samples)], plane))),
                                  axis=0) for plane in planes])
    minimum, chosen = np.full(body[0, 0].shape, np.inf), np.full((3, *body[0, 0].shape), np.nan)
    for plane, median in zip(planes, medians):
        gain = minimum - median
        assert not (abs(gain - 1e-9) < 1e-12).any(), "a median that rounding decides"
        chosen = np.where(gain > 1e-9, plane, chosen)
        minimum = np.where(gain > 1e-9, median, minimum)
    return chosen


def measures(z, config, s, turns=None):
    """Slope in degrees and roughness of every place; NaN where it is unknown. `turns`: pads of the yaws to stand in, if not in all."""
    if config["method"] == "range_difference":
        return range_differences(z, config, s)
    lander = config["lander"]
    body = {offset: shifted(z, *offset) for offset in disc(lander["body_radius_m"], s)}
    slope, rough = np.full(z.shape, -np.inf), np.full(z.shape, -np.inf)

    def stand(plane, magnitude):
        gradient = np.hypot(plane[0], plane[1])
        above = [magnitude(values - (plane[0] * i * s + plane[1] * j * s + plane[2])) for (i, j), values in body.items()]
        np.maximum(slope, np.degrees(np.arctan(gradient)), out=slope)
        np.maximum(rough, np.max(above, axis=0) / np.hypot(1, gradient), out=rough)

    if config["method"] == "plane":
        matrix = np.linalg.pinv([[i * s, j * s, 1] for i, j in body])
        stand(np.einsum("ij,jrc->irc", matrix, np.stack(list(body.values()))), abs)
    elif config["method"] == "lmeds":
        east, north, height = median_plane(body)
        stand((east / s, north / s, height), abs)
    else:
        under = np.stack([shifted(z, *offset) for offset in disc(lander["pad_diameter_m"] / 2, s)])
        pad = under.max(axis=0) if lander["pad_height"] == "max" else under.mean(axis=0)
        for pads in turns or yaws(lander, s):
            heights = [shifted(pad, *offset) for offset in pads]
            if lander["legs"] == 3:
                stand(plane_of(pads, heights, s), lambda v: v)
                continue
            first = heights[0] + heights[2] >= heights[1] + heights[3]
            for a, b in (((0, 2, 1), (1, 3, 0)), ((0, 2, 3), (1, 3, 2))):
                planes = [plane_of([pads[k] for k in legs], [heights[k] for k in legs], s) for legs in (a, b)]
                stand(np.where(first, *planes), lambda v: v)
    unknown = np.isnan(slope) | np.isnan(rough)
    return np.where(unknown, np.nan, slope), np.where(unknown, np.nan, rough)


def judge(slope, rough, limits):
    safe = (slope <= limits["slope_deg"]) & (rough <= limits["roughness_m"])
    return np.where(np.isnan(slope), UNKNOWN, np.where(safe, SAFE, HAZARD))


def touchdown(p, sigma, s):
    """p smoothed along x, then along y; p is 0 at unknown places and beyond the map."""
    if sigma == 0:
        return p
    reach = int(np.floor((3 * sigma + 1e-9) / s))
    weights = {k: np.exp(-(k * s)**2 / (2 * sigma**2)) for k in range(-reach, reach + 1)}
    total = sum(weights.values())
    for axis in (0, 1):
        p = sum(w / total * np.nan_to_num(shifted(p, *((k, 0) if axis == 0 else (0, k)))) for k, w in weights.items())
    return p


def distances(region, safe, s):
    hazards = np.argwhere(region & (safe != SAFE))
    result = np.full(region.shape, np.nan)
    if len(hazards):
        for bin_ in np.argwhere(region):
            result[tuple(bin_)] = np.sqrt(((hazards - bin_)**2).sum(1).min()) * s
    return result


def within_reach(x, y, config):
    """The places among which sites are looked for: a circle, a polygon whose edges the ray to +x crosses an odd number of times, or those with
    two constant accelerations that bring the lander to rest there."""
    reach = config.get("reach")
    if reach is None:
        return np.hypot(x, y) <= config["divert_radius_m"] + 1e-9
    if isinstance(reach, list):
        crossings = np.zeros(x.shape, int)
        for (ax, ay), (bx, by) in zip(reach, [*reach[1:], reach[0]]):
            if ay != by:
                crossings += ((np.minimum(ay, by) <= y) & (y < np.maximum(ay, by))) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
        return crossings % 2 == 1
    time = 2 * reach["height_m"] / reach["descent_mps"]
    upward = reach["gravity_mps2"] + reach["descent_mps"] / time
    maximum = min(upward * np.tan(np.radians(reach["tilt_deg"])), np.sqrt(reach["thrust_accel_mps2"] ** 2 - upward ** 2))
    phases = []
    for place, start, speed in zip((x, y), reach.get("position_m", (0, 0)), reach.get("velocity_mps", (0, 0))):
        # speed + (first + second) T/2 = 0 and start + speed T + first 3 T^2/8 + second T^2/8 = place
        phases.append(np.linalg.solve([[time / 2, time / 2], [3 * time ** 2 / 8, time ** 2 / 8]],
                                      np.array([np.full(place.size, -speed), (place - start - speed * time).ravel()])))
    return (np.hypot(*phases) <= maximum).all(axis=0).reshape(x.shape)


def sites(cost, safe, x, y, config):
    """The chosen bins, from the stored cost."""
    bins = [(cost[row, column], round((x[column]**2 + y[row]**2) * 1e9), row, column)
            for row, column in np.argwhere((safe == SAFE) & ~np.isnan(cost))]
    chosen = []
    for *_, row, column in sorted(bins):
        if len(chosen) == config["count"]:
            break
        if all(np.hypot(x[column] - x[c], y[row] - y[r]) >= config["separation_m"] - 1e-9 for r, c in chosen):
            chosen.append((row, column))
    return chosen


def fraction(part, whole):
    return part / whole if whole else None


def score(judged, truth, limits, region):
    """Counts, fractions and ROC, from slope and roughness of the map and of the true terrain."""
    def counts(roughness_limit):
        a, b = judge(*judged, {**limits, "roughness_m": roughness_limit})[region], judge(*truth, limits)[region]
        known = (a != UNKNOWN) & (b != UNKNOWN)
        number = lambda x, y: int(np.count_nonzero(known & (a == x) & (b == y)))
        return {"safe_safe": number(SAFE, SAFE), "safe_hazard": number(SAFE, HAZARD), "hazard_safe": number(HAZARD, SAFE),
                "hazard_hazard": number(HAZARD, HAZARD), "unknown": int(np.count_nonzero(~known))}

    def rates(n):
        return {"missed_hazard_frac": fraction(n["safe_hazard"], n["safe_hazard"] + n["hazard_hazard"]),
                "false_alarm_frac": fraction(n["hazard_safe"], n["hazard_safe"] + n["safe_safe"])}

    here = counts(limits["roughness_m"])
    tried = [2 * limits["roughness_m"] * i / 20 for i in range(21)]
    curve = [rates(counts(limit)) for limit in tried]
    return {"counts": here, **rates(here), "roc": {"roughness_limit_m": tried, **{key: [point[key] for point in curve] for key in rates(here)}}}
