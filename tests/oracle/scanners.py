# SPDX-License-Identifier: GPL-3.0-or-later
"""Mechanisms (docs/user/lidar/scanner-*.md): their angles at each pulse, and the outgoing rays.

`angles(scan)` of a scanner gives true angles (n, 2), estimated angles (n, 2) and blanked pulses (n,);
`beams(angles, pixels)` gives directions (n, m, 3) and exit points (n, m, 3) in L, and lost rays (n, m).
"""
import numpy as np

from oracle import draws, patterns, tables
from oracle.frames import X, Y, Z, about, dot, normalised, rotated

LIGHT_MPS = 299792458.0
NEAR_REFLECTION = 1e-6


def reflected(d, m):
    return d - 2 * dot(d, m)[..., None] * m


def no_offset(directions):
    return np.zeros(directions.shape), np.zeros(directions.shape[:-1], bool)


class Scanner:
    @staticmethod
    def doubtful(angles, pixels):
        """The rays (n, m) that rounding may change by more than 1e-12."""
        return np.zeros((len(angles), len(pixels)), bool)


class Flash(Scanner):
    def __init__(self, _):
        pass

    def angles(self, scan):
        none = np.zeros((len(scan.k), 2))
        return none, none, np.zeros(len(scan.k), bool)

    def beams(self, angles, pixels):
        directions = np.tile(pixels, (len(angles), 1, 1))
        return (directions, *no_offset(directions))


class Aimed(Scanner):
    """Base class of fsm and gimbal: commanded tilts, jumps, settling."""

    def __init__(self, config):
        self.c = config

    def commanded(self, scan):
        return self.tilts(scan.aim(self.c["pattern"]))

    def settled(self, scan, commanded):
        """The commanded tilts plus e(t) times (tilts to the last aim before the jump, as seen now - tilts commanded now)."""
        time, pattern, k = self.c["settle_time_s"], self.c["pattern"], scan.k
        if time == 0:
            return commanded
        zeta = self.c["settle_damping"]
        wn = 3 / (zeta * time)
        wd = wn * np.sqrt(1 - zeta**2)
        first = patterns.first_after_jump(pattern, scan.there)
        t = np.maximum(0, (scan.there - first) / scan.rate + scan.later)
        e = np.exp(-zeta * wn * t) * (np.cos(wd * t) + zeta / np.sqrt(1 - zeta**2) * np.sin(wd * t))
        last = np.maximum(first - 1, 0)
        before = self.tilts(scan.look_at(pattern, k, patterns.aims(pattern, last, last / scan.rate))[0])
        return np.where((first > 0)[:, None], commanded + e[:, None] * (before - commanded), commanded)

    def blanked(self, scan):
        k = scan.k
        first = patterns.first_after_jump(self.c["pattern"], k)
        turning = (first > 0) & ((k - first) / scan.rate < self.c["turnaround_time_s"] - 1e-9)
        turning |= (first > 0) & ((k - first + 1) / scan.rate < self.catching_up(scan, first) - 1e-9)
        return turning | np.isnan(scan.aim(self.c["pattern"])[:, 0])


    def catching_up(self, scan, first):
        """The time from the last pulse before a jump until both axes, accelerated as they can be, are at the aim."""
        a, pattern = self.c["max_acceleration_radps2"], self.c["pattern"]
        if a == 0:
            return np.zeros(len(first))
        seen = lambda pulses: self.tilts(scan.look_at(pattern, scan.k, patterns.aims(pattern, pulses, pulses / scan.rate))[0])
        begin = lambda pulses: patterns.first_after_jump(pattern, pulses)
        last, following = np.maximum(first - 1, 0), first + 1
        before, at = seen(np.where(begin(last) == last, last, last - 1)), seen(last)
        ends = (begin(following) == following) | np.isnan(patterns.aims(pattern, following, following / scan.rate)[:, 0])
        now, after = seen(first), seen(np.where(ends, first, following))
        # Seen from the moving aim: the distance D to go, and the speed u at which it becomes shorter.
        u, d = (at - before - (after - now)) * scan.rate, now - (after - now) - at
        sign = np.where(d < u * abs(u) / (2 * a), -1, 1)
        return ((2 * np.sqrt(u**2 / 2 + sign * a * d) - sign * u) / a).max(axis=1)


def encoder_errors(config, angles):
    """The errors (n, 2) of the readings of angles (n, 2)."""
    errors = np.zeros(angles.shape)
    for harmonic in config["encoder_harmonics"]:
        n = harmonic["axis"] - 1
        errors[:, n] += harmonic["amplitude_rad"] * np.sin(harmonic["order"] * angles[:, n] + np.radians(harmonic["phase_deg"]))
    return errors


class Gimbal(Aimed):
    @staticmethod
    def tilts(c):
        return np.stack([np.arctan2(-c[:, 1], c[:, 2]), np.arctan2(c[:, 0], np.hypot(c[:, 1], c[:, 2]))], -1)

    def angles(self, scan):
        angles = self.settled(scan, self.commanded(scan))
        return angles, angles + encoder_errors(self.c, angles), self.blanked(scan)

    @staticmethod
    def beams(angles, pixels):
        turn = about(X, angles[:, 0]) @ about(Y, angles[:, 1])
        directions = np.einsum("nij,mj->nmi", turn, pixels)
        return (directions, *no_offset(directions))


class Mirror:
    """A mirror with its rest position and its tilts."""

    def __init__(self, incidence_deg, fold_azimuth_deg):
        i, fold = np.radians([incidence_deg, fold_azimuth_deg])
        self.d0 = about(Z, fold) @ [0, -np.sin(2 * i), -np.cos(2 * i)]
        self.m0 = normalised(Z - self.d0)
        self.e1 = about(Z, fold) @ X
        self.e2 = np.cross(self.m0, self.e1)

    def turn(self, angles):
        return about(self.e1, angles[:, 0]) @ about(self.e2, angles[:, 1])

    def tilts(self, c):
        """The tilts (a1, a2) with m = R(e1, a1) R(e2, a2) m0 = (c - d0)/|c - d0|."""
        m = normalised(c - self.d0)
        return np.stack([np.arctan2(-m @ self.e2, m @ self.m0), np.arcsin(m @ self.e1)], -1)

    def incoming(self, pixels):
        return reflected(pixels, self.m0)

    def beams(self, turn, pixels, pivot=np.zeros(3), focal_distance=0.0):
        m = rotated(turn, self.m0)[:, None]
        incoming = np.broadcast_to(self.incoming(pixels), (len(turn), *pixels.shape))
        point = (pivot - rotated(turn, pivot))[:, None]
        focus = -focal_distance * self.d0
        along = dot(incoming, m)
        exits = focus + incoming * (dot(point - focus, m) / along)[..., None]
        return reflected(incoming, m), exits, along >= 0


class Fsm(Aimed):
    def __init__(self, config):
        super().__init__(config)
        self.mirror = Mirror(config["incidence_deg"], config["fold_azimuth_deg"])
        self.tilts = self.mirror.tilts

    def angles(self, scan):
        at_pulse = self.settled(scan, self.commanded(scan))
        true = self.settled(scan, self.tilts(self.aim_at_echo(scan))) if self.c["tof_lag"] else at_pulse
        noise = np.stack([draws.normal(scan.seed, draws.ENCODER, scan.k, n) for n in (0, 1)], -1)
        read = at_pulse + encoder_errors(self.c, at_pulse) + self.c["encoder_sigma_rad"] * noise
        return true, read, self.blanked(scan)

    def aim_at_echo(self, scan):
        """The aim 2 r/c after the pulse."""
        pattern = self.c["pattern"]
        distance = scan.look_at(pattern, scan.k, scan.ground(pattern, scan.later))[1]
        return scan.look_at(pattern, scan.k, scan.ground(pattern, scan.later + 2 * distance / LIGHT_MPS))[0]

    def beams(self, angles, pixels):
        return self.mirror.beams(self.mirror.turn(angles), pixels, np.array(self.c["pivot_m"]),
                                 self.c["focal_distance_m"])


class Palmer(Scanner):
    def __init__(self, config):
        self.c = config
        self.mirror = Mirror(config["incidence_deg"], config["fold_azimuth_deg"])

    def angles(self, scan):
        phi = (2 * np.pi * self.c["rate_hz"] * scan.since + np.radians(self.c["phase_deg"])) % (2 * np.pi)
        angles = np.stack([phi, np.zeros_like(phi)], -1)
        return angles, angles, np.zeros(len(phi), bool)

    def beams(self, angles, pixels):
        tilt = about(self.mirror.e1, np.radians(self.c["tilt_deg"]))
        return self.mirror.beams(about(self.mirror.m0, angles[:, 0]) @ tilt, pixels)


class Polygon(Scanner):
    def __init__(self, config):
        self.c = config

    def angles(self, scan):
        c = self.c
        q = c["facets"] * (c["rate_hz"] * scan.since + c["phase_deg"] / 360)
        theta = 2 * np.pi / c["facets"] * (q - np.floor(q + 0.5))
        x = c["frame_rate_hz"] * scan.since
        psi = np.radians(c["frame_amplitude_deg"]) * (1 - 4 * abs(x - np.rint(x)))
        angles = np.stack([theta, psi], -1)
        read = angles + encoder_errors(c, np.stack([2 * np.pi / c["facets"] * q, psi], -1))
        tilt = self.tilts(scan.seed)[np.floor(q + 0.5).astype(int) % c["facets"]][:, None]
        blanked = abs(theta) > c["duty_frac"] * np.pi / c["facets"]
        return np.hstack([angles, tilt]), np.hstack([read, tilt if c["facet_tilt_known"] else 0 * tilt]), blanked

    def tilts(self, seed):
        facets = np.arange(self.c["facets"])
        given = np.array(self.c["facet_tilt_rad"] or [0] * len(facets))
        return given + self.c["facet_tilt_sigma_rad"] * draws.normal(seed, draws.FACET_TILT, facets)

    def beams(self, angles, pixels):
        along = about(Z, np.radians(self.c["line_azimuth_deg"]))
        normal = rotated(about(along @ Y, angles[:, 0]) @ about(along @ X, angles[:, 2]), Z)
        mirrored = reflected(reflected(pixels, Z), normal[:, None])
        directions = np.einsum("nij,nmj->nmi", about(along @ X, angles[:, 1]), mirrored)
        return (directions, *no_offset(directions))


class AngleTable(Scanner):
    def __init__(self, config):
        self.table = tables.read(config["path"])
        self.mirror = Mirror(config["incidence_deg"], config["fold_azimuth_deg"])
        self.is_gimbal = config["mechanism"] == "gimbal"

    def angles(self, scan):
        angles = np.stack([np.interp(scan.since, self.table["t_s"], self.table[f"angle_{n}_rad"]) for n in (1, 2)], -1)
        return angles, angles, np.zeros(len(angles), bool)

    def beams(self, angles, pixels):
        if self.is_gimbal:
            return Gimbal.beams(angles, pixels)
        return self.mirror.beams(self.mirror.turn(angles), pixels)


class Risley(Scanner):
    """Snell's law at four faces; steering by bisection of traced rays."""

    def __init__(self, config):
        self.c = config
        both = lambda value: value if isinstance(value, list) else [value, value]
        self.index, self.wedge, self.thickness = (
            both(config[key]) for key in ("index", "wedge_deg", "thickness_m"))
        self.wedge = np.radians(self.wedge)

    def angles(self, scan):
        if "pattern" in self.c:
            commanded = self.steered(scan.aim(self.c["pattern"]))
            blanked = np.isnan(commanded[:, 0])
        else:
            turns = np.outer(scan.since, self.c["rates_hz"]) + np.array(self.c["phases_deg"]) / 360
            commanded = 2 * np.pi * (turns - np.rint(turns))
            blanked = np.zeros(len(commanded), bool)
        noise = np.stack([draws.normal(scan.seed, draws.RISLEY_ENCODER, scan.k, n) for n in (0, 1)], -1)
        return commanded + self.c["encoder_sigma_rad"] * noise, commanded, blanked

    def faces(self, angles):
        """For each face its normal (n, 3), its point on the axis, and the refractive indices in front and behind."""
        z = 0.0
        for prism in (0, 1):
            a, theta = self.wedge[prism], angles[:, prism]
            tilted = np.stack([np.sin(a) * np.cos(theta), np.sin(a) * np.sin(theta), np.full(len(theta), np.cos(a))], -1)
            plane = np.tile(Z, (len(theta), 1))
            for side in (0, 1):
                normal = tilted if self.c["configuration"][2 * prism + side] == "T" else plane
                indices = (1.0, self.index[prism]) if side == 0 else (self.index[prism], 1.0)
                yield normal[:, None], np.array([0, 0, z]), indices
                z += self.thickness[prism] if side == 0 else self.c["gap_m"]

    def traced(self, angles, pixels):
        """Directions, exit points, and the smallest radicand of Snell's law at the four faces."""
        d = np.tile(pixels, (len(angles), 1, 1))
        p, minimum = np.zeros(d.shape), np.ones(d.shape[:-1])
        for normal, vertex, (before, behind) in self.faces(angles):
            mu, c = before / behind, dot(d, normal)
            with np.errstate(divide="ignore", invalid="ignore"):
                p = p + d * (dot(vertex - p, normal) / c)[..., None]
            radicand = 1 - mu**2 * (1 - c**2)
            minimum = np.minimum(minimum, radicand)
            d = mu * d + (np.sqrt(np.maximum(radicand, 0)) - mu * c)[..., None] * normal
        return d, p, minimum

    def beams(self, angles, pixels):
        d, p, minimum = self.traced(angles, pixels)
        return d, p, minimum < 0

    def doubtful(self, angles, pixels):
        """Rays near total reflection, whose rounding error grows as 1/sqrt(radicand)."""
        return abs(self.traced(angles, pixels)[2]) < NEAR_REFLECTION

    def boresight(self, angles):
        return self.beams(angles, np.array([[0.0, 0.0, 1.0]]))[0][:, 0]

    def deflection(self, angles):
        d = self.boresight(angles)
        return np.arctan2(np.hypot(d[:, 0], d[:, 1]), d[:, 2])

    def steered(self, aims):
        """theta_1 and theta_2 whose boresight is the aim; sin(theta_2 - theta_1) has the sign of the branch."""
        sign = 1 if self.c.get("branch", "positive") == "positive" else -1
        rho = np.arctan2(np.hypot(aims[:, 0], aims[:, 1]), aims[:, 2])
        # Bisection of |D|: the deflection is monotonic between aligned (0) and opposed (pi) prisms.
        ends = [np.full(len(aims), 0.0), np.full(len(aims), np.pi)]
        deflection = lambda d: self.deflection(np.stack([np.zeros(len(d)), sign * d], -1))
        falls = deflection(ends[0]) > deflection(ends[1])
        low, high = ends
        for _ in range(60):
            middle = (low + high) / 2
            beyond = (deflection(middle) > rho) == falls
            low, high = np.where(beyond, middle, low), np.where(beyond, high, middle)
        opening = sign * (low + high) / 2
        at_zero = self.boresight(np.stack([np.zeros(len(opening)), opening], -1))
        first = np.arctan2(aims[:, 1], aims[:, 0]) - np.arctan2(at_zero[:, 1], at_zero[:, 0])
        angles = np.stack([first, first + opening], -1)
        angles -= 2 * np.pi * np.rint(angles / (2 * np.pi))
        return np.where(np.isnan(aims[:, :1]), np.nan, angles)


KINDS = {"flash": Flash, "fsm": Fsm, "gimbal": Gimbal, "palmer": Palmer, "polygon": Polygon, "table": AngleTable,
         "risley": Risley}


def of_config(config):
    return KINDS[config["type"]](config)
