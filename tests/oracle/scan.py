# SPDX-License-Identifier: GPL-3.0-or-later
"""The columns of a scan with --keep-misses, from its configuration and the true surface (docs/user/scan-sim.md)."""
import numpy as np

from oracle import detector, draws, navigation, patterns, scanners, trajectory
from oracle.frames import dot, normalised, roll_pitch_yaw, transposed, rotated

RETURN, MISS, DROPOUT, DEAD, BLANKED, TOTAL_REFLECTION, FALSE_RETURN = range(7)


class Scan:
    """The quantities that depend on the pulse only: times, poses, angles of the mechanism."""

    def __init__(self, config):
        self.config, self.seed = config, config["seed"]
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
        self.estimated_pose = navigation.Estimate(config, self.path).pose(self.t + stamp)
        self.true_angles, self.estimated_angles, self.blanked = self.scanner.angles(self)

    def look_at(self, pattern, k, ground):
        """Unit vectors in L to points in D, and distances, from the nominal pose of pulses k (uncompensated: of the first)."""
        p, body = self.path.nominal(self.path.start + (k / self.rate if pattern["compensated"] else 0.0 * k))
        lidar = p + rotated(body, self.arm)
        away = ground - lidar
        return normalised(rotated(transposed(body @ self.mount), away)), np.linalg.norm(away, axis=-1)

    def aim(self, pattern, k):
        return self.look_at(pattern, k, patterns.aims(pattern, k, k / self.rate))[0]

    def lidar_rotation(self):
        """R_body_lidar_true (n, 3, 3)."""
        pointing = self.config["pointing_error"]
        sigma = detector.pair(pointing["jitter_sigma_rad"])
        jitter = np.stack([*(sigma[n] * draws.normal(self.seed, draws.POINTING_JITTER, self.k, n) for n in (0, 1)),
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


def columns(config, surface):
    """The columns of /points (flat, all pixels of all pulses), the Scan with the quantities of pulses, and /detector.

    Rows in which rounding decides are marked `doubtful`; `doubtful_estimate` marks measured and estimated values.
    """
    scan, optics = Scan(config), config["detector"]
    pixels = detector.pixels(optics)
    n, m = len(scan.k), len(pixels)
    lidar = scan.lidar_rotation()
    true_beams = scan.scanner.beams(scan.true_angles, pixels)
    origins, directions = scan.rays(scan.true_pose, lidar, true_beams)
    ranges, normals = true_ranges(scan, surface, lidar, true_beams, (origins, directions))
    estimated_beams = scan.scanner.beams(scan.estimated_angles, pixels)
    lost = true_beams[2] | estimated_beams[2]
    ranges = np.where(scan.blanked[:, None] | lost, np.nan, ranges)
    points = origins + ranges[..., None] * directions
    dead = draws.uniform(scan.seed, draws.DEAD_PIXEL, np.arange(m)) < config["noise"]["dead_pixel_frac"]
    status = statuses(scan, dead, lost, ranges)
    slope, ambiguous = slopes(surface, points, normals, directions, optics)
    measured = measured_ranges(config["noise"], scan.seed, ranges, slope)
    false = false_ranges(config["noise"], scan.seed, n, m, ranges, status)
    is_false = np.isfinite(false)
    status = np.where(is_false, FALSE_RETURN, status)
    measured = np.where(is_false, false, np.where(status == RETURN, measured, np.nan))
    points = np.where((is_false & np.isnan(ranges))[..., None], origins + false[..., None] * directions,
                      np.where(np.isnan(ranges)[..., None], np.nan, points))
    estimated_rays = scan.rays(scan.estimated_pose, scan.mount, estimated_beams)
    estimate = estimated_rays[0] + measured[..., None] * estimated_rays[1]
    doubtful = near_total_reflection(scan, pixels)
    if config["noise"]["incidence_sigma_rad"] == 0:
        ambiguous[:] = False
    table = {"doubtful": doubtful, "doubtful_estimate": doubtful | ambiguous,
             "range_true": ranges, "range_measured": measured, "status": status,
             "pulse": np.broadcast_to(scan.k[:, None], (n, m)), "pixel": np.broadcast_to(np.arange(m), (n, m))}
    for axis, name in enumerate("xyz"):
        table[f"{name}_true"], table[f"{name}_est"] = points[..., axis], estimate[..., axis]
    return ({name: column.ravel() for name, column in table.items()}, scan,
            {"dead": dead, **{f"direction_{name}": pixels[:, axis] for axis, name in enumerate("xyz")}})


def true_ranges(scan, surface, lidar, beams, rays):
    """The true ranges on the centre rays (n, m), and the normals at the hits of single rays."""
    optics = scan.config["detector"]
    shape = rays[0].shape[:2]
    if optics["subpixels"] == 1:
        ranges, normals = surface.first_hits(rays[0].reshape(-1, 3), rays[1].reshape(-1, 3))
        return np.where(beams[2], np.nan, ranges.reshape(shape)), normals.reshape(*shape, 3)
    looks = detector.subpixels(optics)
    beams = scan.scanner.beams(scan.true_angles, looks.reshape(-1, 3))
    origins, directions = scan.rays(scan.true_pose, lidar, beams)
    ranges, _ = surface.first_hits(origins.reshape(-1, 3), directions.reshape(-1, 3))
    ranges = np.where(beams[2], np.nan, ranges.reshape(beams[2].shape))
    return detector.estimated(optics, ranges.reshape(*shape, -1)), None


def slopes(surface, points, normals, directions, optics):
    """Tangents of incidence angles, limited to 89 deg (0 without a normal), and where the nearest triangle is ambiguous."""
    ambiguous = np.zeros(points.shape[:-1], bool)
    if optics["subpixels"] > 1:
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
    n, m = ranges.shape
    sigma = np.sqrt(noise["range_sigma_m"]**2 + (noise["range_sigma_per_m"] * ranges)**2
                    + (noise["incidence_sigma_rad"] * ranges * slope)**2)
    return ranges + noise["range_bias_m"] + sigma * draws.normal(
        seed, draws.RANGE_NOISE, np.arange(n)[:, None], np.arange(m))


def statuses(scan, dead, lost, ranges):
    """The first status that applies: dead, blanked, total reflection, miss, dropout."""
    n, m = ranges.shape
    dropped = draws.uniform(scan.seed, draws.DROPOUT, np.arange(n)[:, None], np.arange(m)) < (
        scan.config["noise"]["dropout_frac"])
    blanked = np.broadcast_to(scan.blanked[:, None], (n, m))
    return np.select([np.broadcast_to(dead, (n, m)), blanked, lost, np.isnan(ranges), dropped],
                     [DEAD, BLANKED, TOTAL_REFLECTION, MISS, DROPOUT], RETURN)


def false_ranges(noise, seed, n, m, ranges, status):
    """Ranges of the reported false detections; NaN elsewhere."""
    k, pixel = np.arange(n)[:, None], np.arange(m)
    drawn = draws.uniform(seed, draws.FALSE_RETURN, k, pixel) < noise["false_return_frac"]
    least, greatest = noise["false_range_m"]
    false = least + draws.uniform(seed, draws.FALSE_RETURN, k, pixel + 2**32) * (greatest - least)
    silent = np.isin(status, (MISS, DROPOUT))
    with np.errstate(invalid="ignore"):
        first = silent | ((status == RETURN) & (false < ranges))
    return np.where(drawn & first, false, np.nan)
