# SPDX-License-Identifier: GPL-3.0-or-later
"""The reports of a receiver of the sub-rays of its pixels (lib/chain/lidar/receiver/*.h): signals, echoes, photoelectrons, the clock."""
from statistics import NormalDist

import numpy as np

from oracle import detector, draws
from oracle.frames import dot, normalised
from oracle.waveforms import Echoes, split

LIGHT_MPS = 299792458.0
PLANCK_JS = 6.62607015e-34
FWHM_PER_SIGMA = 2 * np.sqrt(2 * np.log(2))
NUMBER = 2**40  # a draw's offset for each further echo or return of a pixel
SUB_RAY = 2**24  # and for each sub-ray of an echo
LARGE_MEAN = 16


def range_of(time_s):
    return LIGHT_MPS / 2 * time_s


# The link budget

def irradiance(beam, looks):
    """Relative to that on the axis, in directions (..., 3) before steering."""
    if "divergence_rad" not in beam:
        return np.ones(looks.shape[:-1])
    x, y = beam["offset_rad"]
    axis = normalised(np.array([np.tan(x), np.tan(y), 1.0]))
    theta = np.arctan2(np.linalg.norm(np.cross(looks, axis), axis=-1), dot(looks, axis))
    if beam["profile"] == "top_hat":
        return np.where(theta <= beam["divergence_rad"] / 2, 1.0, 0.0)
    return np.exp(-8 * (theta / beam["divergence_rad"])**2)


def link_constant(config):
    """Photoelectrons x m^2 of a whole pixel on the beam's axis."""
    link, beam, optics = config["link"], config["beam"], config["detector"]
    if "reference_pe" in link:
        return link["reference_pe"] * link["reference_range_m"]**2
    pixel_sr = optics["fill_factor"] * np.prod(detector.pitch(optics))
    on_axis = (1 if beam["profile"] == "top_hat" else 2) * pixel_sr / (np.pi * (beam["divergence_rad"] / 2)**2)
    photons = link["pulse_energy_J"] / (PLANCK_JS * LIGHT_MPS / link["wavelength_m"])
    return photons * link["efficiency"] * on_axis * link["aperture_m"]**2 / 4


def signals(config, looks, ranges, cosines, albedo):
    """Mean photoelectrons of sub-rays (pulses, pixels, sub-rays); a surface without a normal counts as facing the beam."""
    constant = link_constant(config) / looks.shape[1] * irradiance(config["beam"], looks)
    return constant * albedo * np.where(np.isnan(cosines), 1, abs(cosines)) / ranges**2


# Poisson counts

def poisson(mean, normal, uniform):
    """Counts, and where rounding decides."""
    small = np.minimum(mean, LARGE_MEAN)
    term = np.exp(-small)
    total, count, close = term.copy(), np.zeros(len(mean)), abs(term - uniform) < 1e-12
    for n in range(1, 150):
        count += total <= uniform
        term = term * small / n
        total = total + term
        close |= abs(total - uniform) < 1e-12
    big, w = np.maximum(mean, LARGE_MEAN), normal
    cornish_fisher = (big + np.sqrt(big) * w + (1 / 3 + w**2 / 6) + (-w / 36 - w**3 / 72) / np.sqrt(big)
                      + (-8 / 405 + 7 * w**2 / 810 + w**4 / 270) / big)
    is_big = mean >= LARGE_MEAN
    close = np.where(is_big, abs(cornish_fisher - np.rint(cornish_fisher)) < 1e-9 * big, close)
    return np.where(is_big, np.maximum(0, np.floor(cornish_fisher)), count), close | (abs(mean - LARGE_MEAN) < 1e-9)


class Receiver:
    """Reports of pixels (pulses, pixels, returns): ranges (NaN without), intensities, is_background; and doubtful pixels."""

    def __init__(self, config):
        self.c, self.seed = config["receiver"], draws.seed_of(config)
        self.gate = config["noise"]["false_range_m"]
        self.background = config["link"]["background_pe"]
        self.fwhm = range_of(self.c["pulse_fwhm_s"])
        self.sigma = self.fwhm / FWHM_PER_SIGMA
        self.maximum = self.c["max_returns"] if self.c["returns"] == "all" else 1

    def reports(self, ranges, signals):
        """From the ranges and signals of all sub-rays (pulses, pixels, sub-rays); NaN, or no signal, for those without."""
        shape = (*ranges.shape[:2], self.maximum)
        self.range, self.intensity = np.full(shape, np.nan), np.full(shape, np.nan)
        self.is_background, self.doubtful = np.zeros(shape, bool), np.zeros(shape[:2], bool)
        pixels, echoes = [], []
        for where in np.ndindex(*shape[:2]):
            found, self.doubtful[where] = split(ranges[where], signals[where], self.fwhm)
            pixels.append((where, len(echoes), len(echoes) + len(found)))
            echoes += found
        if self.c["type"] == "geiger":
            for where, begin, end in pixels:
                self.count_photons(where, echoes[begin:end])
        elif echoes:
            self.measure(pixels, Echoes(echoes, self.sigma))
        return self

    # linear receivers

    def measure(self, pixels, echoes):
        c = self.c
        in_sight = echoes.height >= c["threshold_pe"]
        at, edge = echoes.peak, np.zeros(len(in_sight))
        if c["type"] == "centroid":
            at = np.zeros(len(in_sight))
        if c["type"] == "constant_fraction":
            at = echoes.first_crossing(c["fraction"] * echoes.height) + np.sqrt(-2 * np.log(c["fraction"]))
        if c["type"] == "leading_edge":
            edge = self.edges(echoes)
        owner, number, chosen = np.zeros((len(in_sight), 2), int), np.zeros(len(in_sight), int), []
        doubtful = echoes.doubtful | (abs(echoes.height / c["threshold_pe"] - 1) < 2e-6)
        for where, begin, end in pixels:
            owner[begin:end] = where
            if c["returns"] in ("first", "all"):  # the first detected of all is the first
                number[begin:end] = np.arange(end - begin)
                chosen += range(begin, end)
            elif end > begin:
                chosen.append(self.choice(begin, np.arange(begin, end)[in_sight[begin:end]], echoes, end))
            self.doubtful[where] |= doubtful[begin:end].any()
        for row, r, n in zip(chosen, *self.received(echoes, at, edge, owner, number, np.array(chosen, int))):
            where = tuple(owner[row])
            free = int(np.isfinite(self.range[where]).sum())
            if np.isfinite(r) and free < self.maximum:
                self.range[where][free], self.intensity[where][free] = r, n

    def edges(self, echoes):
        """Sigma of the Gaussian through the maximum and the crossing of the threshold (echo.h, Echo.edge_m)."""
        threshold = self.c["threshold_pe"]
        crosses = echoes.height > 1.000001 * threshold
        chord = self.chord(echoes, np.where(crosses, threshold, echoes.height / 2), crosses)
        is_long = echoes.farthest - echoes.nearest > 1
        top = np.exp(-0.5) * echoes.height
        limit = self.chord(echoes, top, is_long & (threshold > top))
        chord = np.where(is_long & (threshold > top), np.where(crosses, np.minimum(chord, 1.5 * limit), limit), chord)
        return np.where(crosses | is_long, chord, echoes.peak_sigma)

    @staticmethod
    def chord(echoes, level, used):
        before = echoes.doubtful.copy()
        chord = (echoes.peak - echoes.first_crossing(level)) / np.sqrt(2 * np.log(echoes.height / level))
        echoes.doubtful &= before | used
        return chord

    def choice(self, begin, seen, echoes, end):
        """The echo that `last` or `strongest` reports, if it is detected."""
        if not len(seen):
            return begin + int(np.argmax(echoes.height[begin:end]))
        if self.c["returns"] == "strongest":
            return int(seen[np.argmax(echoes.signal[seen])])
        return int(seen[-1])

    def received(self, echoes, at, edge, owner, number, rows):
        """Ranges and counts of the chosen echoes; NaN for those that are not detected."""
        c, threshold = self.c, self.c["threshold_pe"]
        mean, share = echoes.signal[rows], (echoes.height / echoes.signal)[rows]
        pulse, pixel = owner[rows].T
        draw = pixel + number[rows] * NUMBER
        n, noise = mean, 0
        if c["photon_noise"]:
            b = self.background * self.fwhm / (self.gate[1] - self.gate[0])
            n, close = poisson(mean + b, draws.normal(self.seed, draws.PHOTON_COUNT, pulse, draw),
                               draws.uniform(self.seed, draws.PHOTON_COUNT, pulse, draw))
            n = n - b
            self.doubtful[pulse[close], pixel[close]] = True
            width = echoes.width[rows]
            dark = b * 4 * np.sqrt(np.pi) / FWHM_PER_SIGMA * width
            noise = width * np.sqrt(n + dark) / n * draws.normal(self.seed, draws.PHOTON_TIME, pulse, draw)
        ratio = n * share / threshold
        close = abs(ratio - 1) < 1e-9
        self.doubtful[pulse[close], pixel[close]] = True
        walk = lambda value: np.sqrt(2 * np.log(np.where(value >= 1, value, 1)))
        x = at[rows] + noise - edge[rows] * walk(ratio)
        if c["type"] == "leading_edge" and c["walk_correction"]:
            x = x + walk(n / threshold)
        seen = ratio >= 1
        return np.where(seen, echoes.mean_m[rows] + self.sigma * x, np.nan), np.where(seen, n, np.nan)

    # Geiger mode

    def count_photons(self, where, echoes):
        pulse, pixel = where
        photons = [self.first_photon(pulse, pixel + number * NUMBER, *echo) for number, echo in enumerate(echoes)]
        photons = sorted(r for r in photons if np.isfinite(r))
        dead, density = range_of(self.c["dead_time_s"]), self.background / (self.gate[1] - self.gate[0])
        armed, number, events = -np.inf, 0, []

        def next_background(after):
            nonlocal number
            if density == 0:
                return np.inf
            u = draws.uniform(self.seed, draws.BACKGROUND, pulse, pixel + number * NUMBER)
            number += 1
            at = after - np.log1p(-u) / density
            return at if at < self.gate[1] else np.inf

        background = next_background(self.gate[0])
        while photons or np.isfinite(background):
            from_background = background < (photons[0] if photons else np.inf)
            at = background if from_background else photons.pop(0)
            if at >= armed:
                events.append((at, from_background))
                armed = at + dead
            if from_background or background < armed:
                background = next_background(armed)
            self.doubtful[where] |= any(abs(r - armed) < 1e-9 for r in photons)
        events = events[-1:] if self.c["returns"] == "last" else events[:self.maximum]
        for n, (at, from_background) in enumerate(events):
            self.range[where][n], self.intensity[where][n], self.is_background[where][n] = at, 1, from_background

    def first_photon(self, pulse, draw, ranges, means):
        """The first of the sub-rays' photoelectrons; infinite without any."""
        u = draws.uniform(self.seed, draws.PHOTON_TIME, pulse, draw + SUB_RAY * np.arange(1, len(means) + 1))
        quantile = -np.log1p(-u) / means
        return min((r + self.sigma * NormalDist().inv_cdf(q) for r, q in zip(ranges, quantile) if 0 < q < 1), default=np.inf)


def clocked(config, ranges):
    """Ranges (pulses, pixels, returns) as the clock measures them, and where rounding decides."""
    c, seed = config["receiver"], draws.seed_of(config)
    n, m, maximum = ranges.shape
    pixel = np.arange(m)[:, None]
    draw = pixel + np.arange(maximum) * NUMBER
    jitter = draws.normal(seed, draws.TIMING_JITTER, np.arange(n)[:, None, None], draw)
    offset = draws.normal(seed, draws.PIXEL_OFFSET, pixel)
    r = (1 + 1e-6 * c["clock_scale_ppm"]) * (
        ranges + range_of(c["jitter_sigma_s"]) * jitter + c["pixel_offset_sigma_m"] * offset)
    step = range_of(c["timer_step_s"])
    if step == 0:
        return r, np.zeros(r.shape, bool)
    count = r / step
    return step * np.floor(count + 0.5), abs(count - np.floor(count) - 0.5) < 1e-9 / step
