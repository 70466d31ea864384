# SPDX-License-Identifier: GPL-3.0-or-later
"""The columns of a scan with --keep-misses, from its configuration and the true surface (Eqs. 1 and 7; docs/user/scan-sim.md)."""
import copy

import numpy as np

from oracle import detector, draws, navigation, patterns, receiver, scanners, trajectory
from oracle.frames import dot, normalised, roll_pitch_yaw, transposed, rotated

RETURN, MISS, DROPOUT, DEAD, BLANKED, TOTAL_REFLECTION, FALSE_RETURN, UNDETECTED = range(8)


class Scan:
    """The quantities that depend on the pulse only: times, poses, angles of the mechanism."""

    def __init__(self, config):
        self.config, self.seed = config, draws.seed_of(config)
        self.rate = config["laser"]["pulse_rate_hz"]
        self.k = np.arange(pulse_count(config))
        self.since = self.k / self.rate
        self.path = trajectory.of_config(config)
        self.t = self.path.start + self.since
        self.mount = roll_pitch_yaw(np.radians(config["mount"]["rpy_deg"]))
        self.arm = np.array(config["mount"]["position_m"], float)
        self.scanner = scanners.of_config(config["scanner"])
        self.true_pose = self.path.pose(self.t)
        pointing = config["pointing_error"]
        stamp = pointing["time_stamp_bias_s"] + pointing["time_stamp_sigma_s"] * draws.normal(
            self.seed, draws.TIME_STAMP, self.k)
        self.estimate = navigation.Estimate(config, self.path)
        self.estimated_pose = self.estimate.pose(self.t + stamp)
        self.there, self.later = self.k, np.zeros(len(self.k))
        self.true_angles, self.estimated_angles, self.blanked = self.scanner.angles(self)
        error = pointing["mirror_time_bias_s"] + pointing["mirror_time_sigma_s"] * draws.normal(
            self.seed, draws.MIRROR_TIME, self.k)
        if error.any():
            self.true_angles = self.scanner.angles(self.with_mirror_at(error))[0]

    def with_mirror_at(self, error):
        """This scan with the mechanism at t + e: at the pulse `there` and `later` seconds after it, less than one interval."""
        late = copy.copy(self)
        late.since = self.since + error
        late.there = self.k + np.trunc(error * self.rate).astype(int)
        if "pattern" in self.config["scanner"]:
            aims = patterns.aims(self.config["scanner"]["pattern"], late.there, late.there / self.rate)
            late.there = np.where((late.there < 0) | np.isnan(aims[:, 0]), self.k, late.there)
        late.later = np.where(late.there == self.k + np.trunc(error * self.rate), error - (late.there - self.k) / self.rate, 0)
        return late

    def ground(self, pattern, later):
        """The aim `later` seconds after the pulse `there`: it moves uniformly between two pulses.

        At the end of a line or pattern it moves as before the last pulse, at the begin as after the first.
        """
        aims = lambda pulses: patterns.aims(pattern, pulses, pulses / self.rate)
        first = lambda pulses: patterns.first_after_jump(pattern, pulses)
        n = self.there
        before, here, after = aims(np.maximum(n - 1, 0)), aims(n), aims(n + 1)
        ends, begins = ((first(n + 1) != first(n)) | np.isnan(after[:, 0]))[:, None], (first(n) == n)[:, None]
        to_next = np.where(ends, np.where(begins, 0, here - before), after - here)
        from_last = np.where(begins, np.where(ends, 0, after - here), here - before)
        return here + (later * self.rate)[:, None] * np.where(later[:, None] < 0, from_last, to_next)

    def look_at(self, pattern, k, ground):
        """Unit vectors in L to points in D, and distances, from the nominal pose of pulses k (uncompensated: of the first), or from the
        estimated pose."""
        aims_from = self.estimate.pose if pattern["aim"] == "estimate" else self.path.nominal
        p, body = aims_from(self.path.start + (k / self.rate if pattern["compensated"] else 0.0 * k))
        lidar = p + rotated(body, self.arm)
        away = ground - lidar
        return normalised(rotated(transposed(body @ self.mount), away)), np.linalg.norm(away, axis=-1)

    def aim(self, pattern):
        return self.look_at(pattern, self.k, self.ground(pattern, self.later))[0]

    def lidar_rotation(self):
        """R_body_lidar_true (n, 3, 3)."""
        pointing = self.config["pointing_error"]
        sigma = detector.pair(pointing["jitter_sigma_rad"])
        time = pointing["jitter_time_s"]
        drawn = [draws.correlated(self.seed, draws.POINTING_JITTER, self.k, n, 1 / self.rate / time) if time else
                 draws.normal(self.seed, draws.POINTING_JITTER, self.k, n) for n in (0, 1)]
        jitter = np.stack([*(sigma[n] * drawn[n] for n in (0, 1)),
                           np.zeros(len(self.k))], -1)
        return self.mount @ roll_pitch_yaw(pointing["misalignment_rpy_rad"]) @ roll_pitch_yaw(jitter)

    def rays(self, pose, lidar, beams):
        """Origins and directions in D of beams (n, m, 3) in L."""
        p, body = pose
        directions, exits, _ = beams
        in_dem = body @ lidar
        origin = p + rotated(body, self.arm)
        return (origin[:, None] + np.einsum("nij,nmj->nmi", in_dem, exits),
                np.einsum("nij,nmj->nmi", in_dem, directions))


def pulse_count(config):
    count = int(np.floor(config["laser"]["pulse_rate_hz"] * config["laser"]["scan_time_s"] + 1e-9))
    return min(count, patterns.limit(config["scanner"].get("pattern", {})))


def columns(config, surface, albedo=None):
    """The columns of /points (flat, all pixels of all pulses), the Scan with the quantities of pulses, and /detector.

    `albedo(x, y)` is the terrain's layer. Rows in which rounding decides are marked `doubtful`; `doubtful_estimate` marks
    measured and estimated values. With several returns, `exists` marks the rows that a file has.
    """
    scan, optics = Scan(config), config["detector"]
    pixels = detector.pixels(optics)
    n, m = len(scan.k), len(pixels)
    lidar = scan.lidar_rotation()
    true_beams = scan.scanner.beams(scan.true_angles, pixels)
    origins, directions = scan.rays(scan.true_pose, lidar, true_beams)
    has_receiver = config["receiver"]["type"] != "none"
    ranges, normals = true_ranges(scan, surface, lidar, true_beams, (origins, directions), has_receiver)
    estimated_beams = scan.scanner.beams(scan.estimated_angles, pixels)
    lost = true_beams[2] | estimated_beams[2]
    ranges = np.where(scan.blanked[:, None] | lost, np.nan, ranges)
    points = origins + ranges[..., None] * directions
    dead = draws.uniform(scan.seed, draws.DEAD_PIXEL, np.arange(m)) < config["noise"]["dead_pixel_frac"]
    seen = reports(scan, surface, albedo, lidar, ranges) if has_receiver else None
    reported = seen.range if seen else ranges[..., None]
    status = statuses(scan, dead, lost, ranges, np.isnan(reported[..., 0]))
    slope, ambiguous = slopes(surface, points, normals, directions, optics)
    measured = measured_ranges(config["noise"], scan.seed, reported, slope)
    measured, uncertain = receiver.clocked(config, measured)
    doubtful = near_total_reflection(scan, pixels)
    if seen:
        doubtful = doubtful | seen.doubtful
    if config["noise"]["incidence_sigma_rad"] == 0:
        ambiguous[:] = False
    doubtful_estimate = (doubtful | ambiguous)[..., None] | uncertain
    table = returns_of(scan, ranges, status, measured, seen)
    no_hit = (table["status"] == FALSE_RETURN) & np.isnan(ranges)[..., None]
    shown = np.where(no_hit, table["range_measured"], ranges[..., None])
    points = origins[:, :, None] + shown[..., None] * directions[:, :, None]
    estimated_origins, estimated_directions = scan.rays(scan.estimated_pose, scan.mount, estimated_beams)
    estimate = estimated_origins[:, :, None] + table["range_measured"][..., None] * estimated_directions[:, :, None]
    everywhere = lambda values: np.broadcast_to(values, measured.shape)
    table.update(doubtful=everywhere(doubtful[..., None]), doubtful_estimate=doubtful_estimate,
                 range_true=everywhere(ranges[..., None]), pulse=everywhere(scan.k[:, None, None]),
                 pixel=everywhere(np.arange(m)[:, None]))
    for axis, name in enumerate("xyz"):
        table[f"{name}_true"], table[f"{name}_est"] = points[..., axis], estimate[..., axis]
    return ({name: column.ravel() for name, column in table.items()}, scan,
            {"dead": dead, **{f"direction_{name}": pixels[:, axis] for axis, name in enumerate("xyz")}})


def returns_of(scan, ranges, status, measured, seen):
    """Status, range, intensity and number of the returns of pixels (pulses, pixels, returns), and which of them exist."""
    n, m, maximum = measured.shape
    false = false_ranges(scan.config["noise"], scan.seed, n, m, ranges, status)
    status = np.repeat(status[..., None], maximum, 2)
    from_background = seen.is_background if seen else np.zeros(measured.shape, bool)
    has_range = (status == RETURN) | (from_background & (status == MISS))
    has_range &= np.isfinite(measured)
    status = np.where(has_range & from_background, FALSE_RETURN, status)
    measured = np.where(has_range, measured, np.nan)
    intensity = np.where(has_range, seen.intensity, np.nan) if seen else np.full(measured.shape, np.nan)
    is_false = np.zeros(measured.shape, bool)
    is_false[..., 0] = np.isfinite(false)
    has_range |= is_false
    return {"status": np.where(is_false, FALSE_RETURN, status),
            "range_measured": np.where(is_false, false[..., None], measured),
            "intensity": np.where(is_false, np.nan, intensity),
            "return_number": np.where(has_range, np.arange(maximum) + 1, 0),
            "exists": has_range | (np.arange(maximum) == 0)}


def sub_rays(scan, surface, lidar):
    """Origins, directions, ranges and normals of all sub-rays (pulses, pixels, sub-rays), and which are lost."""
    looks = detector.subpixels(scan.config["detector"])
    beams = scan.scanner.beams(scan.true_angles, looks.reshape(-1, 3))
    origins, directions = scan.rays(scan.true_pose, lidar, beams)
    ranges, normals = surface.first_hits(origins.reshape(-1, 3), directions.reshape(-1, 3))
    shape = (len(scan.k), *looks.shape[:2])
    return (origins.reshape(*shape, 3), directions.reshape(*shape, 3),
            np.where(beams[2].reshape(shape), np.nan, ranges.reshape(shape)), normals.reshape(*shape, 3))


def reports(scan, surface, albedo, lidar, ranges):
    """The reports of the receiver; a pixel whose own ray hits nothing sees nothing."""
    config = scan.config
    looks = detector.subpixels(config["detector"])
    origins, directions, sub_ranges, normals = sub_rays(scan, surface, lidar)
    hits = origins + sub_ranges[..., None] * directions
    layer = config["surface"]["albedo"]
    share = albedo(hits[..., 0], hits[..., 1]) if layer == "terrain" else layer
    signals = receiver.signals(config, looks, sub_ranges, dot(normals, directions), share)
    sees = np.isfinite(ranges)[..., None]
    return receiver.Receiver(config).reports(np.where(sees, sub_ranges, np.nan), np.where(sees, signals, 0))


def true_ranges(scan, surface, lidar, beams, rays, has_receiver):
    """The true ranges on the centre rays (n, m), and the normals at the hits of single rays."""
    optics = scan.config["detector"]
    shape = rays[0].shape[:2]
    if optics["subpixels"] == 1 or has_receiver:
        ranges, normals = surface.first_hits(rays[0].reshape(-1, 3), rays[1].reshape(-1, 3))
        return np.where(beams[2], np.nan, ranges.reshape(shape)), normals.reshape(*shape, 3)
    return detector.estimated(optics, sub_rays(scan, surface, lidar)[2]), None


def slopes(surface, points, normals, directions, optics):
    """Tangents of incidence angles, limited to 89 deg (0 without a normal), and where the nearest triangle is ambiguous."""
    ambiguous = np.zeros(points.shape[:-1], bool)
    if normals is None:
        found = np.isfinite(points[..., 0])
        normals = np.full(points.shape, np.nan)
        normals[found], ambiguous[found] = surface.normals_at(points[found])
    cosine = np.clip(abs(dot(normals, directions)), np.cos(np.radians(89)), 1)
    return np.nan_to_num(np.tan(np.arccos(cosine))), ambiguous


def near_total_reflection(scan, pixels):
    """The pixels (n, m) with a true, estimated or sub-pixel ray that is sensitive to rounding."""
    doubtful = scan.scanner.doubtful(scan.true_angles, pixels) | scan.scanner.doubtful(scan.estimated_angles, pixels)
    if scan.config["detector"]["subpixels"] > 1:
        looks = detector.subpixels(scan.config["detector"])
        inside = scan.scanner.doubtful(scan.true_angles, looks.reshape(-1, 3))
        doubtful = doubtful | inside.reshape(*doubtful.shape, -1).any(-1)
    return doubtful


def measured_ranges(noise, seed, ranges, slope):
    """Reported ranges (pulses, pixels, returns) with the errors of /noise."""
    n, m, maximum = ranges.shape
    sigma = np.sqrt(noise["range_sigma_m"]**2 + (noise["range_sigma_per_m"] * ranges)**2
                    + (noise["incidence_sigma_rad"] * ranges * slope[..., None])**2)
    return ranges + noise["range_bias_m"] + sigma * draws.normal(
        seed, draws.RANGE_NOISE, np.arange(n)[:, None, None], np.arange(m)[:, None] + np.arange(maximum) * receiver.NUMBER)


def statuses(scan, dead, lost, ranges, unseen):
    """The first status that applies: dead, blanked, total reflection, miss, undetected, dropout."""
    n, m = ranges.shape
    dropped = draws.uniform(scan.seed, draws.DROPOUT, np.arange(n)[:, None], np.arange(m)) < (
        scan.config["noise"]["dropout_frac"])
    blanked = np.broadcast_to(scan.blanked[:, None], (n, m))
    return np.select([np.broadcast_to(dead, (n, m)), blanked, lost, np.isnan(ranges), unseen, dropped],
                     [DEAD, BLANKED, TOTAL_REFLECTION, MISS, UNDETECTED, DROPOUT], RETURN)


def false_ranges(noise, seed, n, m, ranges, status):
    """Ranges of the reported false detections; NaN elsewhere."""
    k, pixel = np.arange(n)[:, None], np.arange(m)
    drawn = draws.uniform(seed, draws.FALSE_RETURN, k, pixel) < noise["false_return_frac"]
    minimum, greatest = noise["false_range_m"]
    false = minimum + draws.uniform(seed, draws.FALSE_RETURN, k, pixel + 2**32) * (greatest - minimum)
    silent = np.isin(status, (MISS, UNDETECTED, DROPOUT))
    with np.errstate(invalid="ignore"):
        first = silent | ((status == RETURN) & (false < ranges))
    return np.where(drawn & first, false, np.nan)
