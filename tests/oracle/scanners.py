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
        return self.tilts(scan.aim(self.c["pattern"], scan.k))

    def settled(self, scan, commanded):
        """The commanded tilts plus e(t) times (tilts to the last aim before the jump, as seen now - tilts commanded now)."""
        time, pattern, k = self.c["settle_time_s"], self.c["pattern"], scan.k
        if time == 0:
            return commanded
        zeta = self.c["settle_damping"]
        wn = 3 / (zeta * time)
        wd = wn * np.sqrt(1 - zeta**2)
        first = patterns.first_after_jump(pattern, k)
        t = (k - first) / scan.rate
        e = np.exp(-zeta * wn * t) * (np.cos(wd * t) + zeta / np.sqrt(1 - zeta**2) * np.sin(wd * t))
        last = np.maximum(first - 1, 0)
        before = self.tilts(scan.look_at(pattern, k, patterns.aims(pattern, last, last / scan.rate))[0])
        return np.where((first > 0)[:, None], commanded + e[:, None] * (before - commanded), commanded)

    def blanked(self, scan):
        k = scan.k
        first = patterns.first_after_jump(self.c["pattern"], k)
        turning = (first > 0) & ((k - first) / scan.rate < self.c["turnaround_time_s"] - 1e-9)
        return turning | np.isnan(scan.aim(self.c["pattern"], k)[:, 0])


class Gimbal(Aimed):
    @staticmethod
    def tilts(c):
        return np.stack([np.arctan2(-c[:, 1], c[:, 2]), np.arctan2(c[:, 0], np.hypot(c[:, 1], c[:, 2]))], -1)

    def angles(self, scan):
        angles = self.settled(scan, self.commanded(scan))
        return angles, angles, self.blanked(scan)

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
        return true, at_pulse + self.c["encoder_sigma_rad"] * noise, self.blanked(scan)

    def aim_at_echo(self, scan):
        """The aim 2 r/c after the pulse. It moves uniformly to the next aim; at the end of a line or pattern, as before it."""
        pattern, k = self.c["pattern"], scan.k
        ground = lambda pulses: patterns.aims(pattern, pulses, pulses / scan.rate)
        first = lambda pulses: patterns.first_after_jump(pattern, pulses)
        here = ground(k)
        after = ground(k + 1)
        ends, begins = (first(k + 1) != first(k)) | np.isnan(after[:, 0]), first(k) == k
        step = np.where(ends[:, None], np.where(begins[:, None], 0, here - ground(np.maximum(k - 1, 0))), after - here)
        delay = 2 * scan.look_at(pattern, k, here)[1] / LIGHT_MPS * scan.rate
        return scan.look_at(pattern, k, here + delay[:, None] * step)[0]

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
        return angles, angles, abs(theta) > c["duty_frac"] * np.pi / c["facets"]

    def beams(self, angles, pixels):
        along = about(Z, np.radians(self.c["line_azimuth_deg"]))
        turn = about(along @ X, angles[:, 1]) @ about(along @ Y, 2 * angles[:, 0])
        directions = np.einsum("nij,mj->nmi", turn, pixels)
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
            commanded = self.steered(scan.aim(self.c["pattern"], scan.k))
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
        p, least = np.zeros(d.shape), np.ones(d.shape[:-1])
        for normal, vertex, (before, behind) in self.faces(angles):
            mu, c = before / behind, dot(d, normal)
            with np.errstate(divide="ignore", invalid="ignore"):
                p = p + d * (dot(vertex - p, normal) / c)[..., None]
            radicand = 1 - mu**2 * (1 - c**2)
            least = np.minimum(least, radicand)
            d = mu * d + (np.sqrt(np.maximum(radicand, 0)) - mu * c)[..., None] * normal
        return d, p, least

    def beams(self, angles, pixels):
        d, p, least = self.traced(angles, pixels)
        return d, p, least < 0

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
