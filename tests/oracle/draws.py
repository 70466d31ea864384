# SPDX-License-Identifier: GPL-3.0-or-later
"""Random draws as functions of (seed, draw, stream, i, j): docs/reference/draws.md, in numpy.

A seed is a number, or a pair (seed, draw)."""
import numpy as np

RANGE_NOISE, DROPOUT, DEAD_PIXEL, ENCODER, FALSE_RETURN = 1, 2, 3, 5, 6
POINTING_JITTER, TIME_STAMP, NAVIGATION_WALK, DISTURBANCE, RISLEY_ENCODER, GAUSS_MARKOV, MIRROR_TIME = 8, 9, 10, 11, 12, 13, 14
FACET_TILT = 15
PENITENTE = 20
PHOTON_COUNT, PHOTON_TIME, BACKGROUND, TIMING_JITTER, PIXEL_OFFSET = 50, 51, 52, 53, 54

MASK = 2**64 - 1
LOW = np.uint64(0xFFFFFFFF)
HALF = np.uint64(32)
FIRST, SECOND = 0xD2E7470EE14C6C93, 0xCA5A826395121157
MULTIPLIERS = (np.uint64(FIRST), np.uint64(SECOND))
WEYL = (0x9E3779B97F4A7C15, 0xBB67AE8584CAA73B)


def product(a, b):
    """The upper and the lower 64 bits of the product a b, computed from 32-bit halves."""
    a_low, a_high, b_low, b_high = a & LOW, a >> HALF, b & LOW, b >> HALF
    low, middle_1, middle_2 = a_low * b_low, a_high * b_low, a_low * b_high
    carry = (low >> HALF) + (middle_1 & LOW) + (middle_2 & LOW)
    return a_high * b_high + (middle_1 >> HALF) + (middle_2 >> HALF) + (carry >> HALF), a * b


FEW = 16  # words of a counter, for which Python's integers are faster than arrays


def philox_of_integers(words, key):
    """philox() of one counter."""
    (a, b, c, d), (k0, k1) = words, map(int, key)
    for _ in range(10):
        first, second = FIRST * a, SECOND * c
        a, b, c, d = second >> 64 ^ b ^ k0, second & MASK, first >> 64 ^ d ^ k1, first & MASK
        k0, k1 = k0 + WEYL[0] & MASK, k1 + WEYL[1] & MASK
    return a, b, c, d


def philox(counter, key):
    """Philox4x64-10 (Salmon et al. 2011): four words from the four words of a counter and the two of a key."""
    shape = np.shape(counter[0])
    if np.size(counter[0]) <= FEW:
        each = zip(*([int(word) & MASK for word in np.ravel(words)] for words in counter))
        found = [philox_of_integers(words, key) for words in each]
        return list(np.array(found, np.uint64).reshape(*shape, 4).transpose(-1, *range(len(shape))))
    with np.errstate(over="ignore"):
        words = [np.asarray(word).astype(np.uint64) for word in counter]
        for round_number in range(10):
            k0, k1 = (np.uint64((key[n] + round_number * WEYL[n]) % 2**64) for n in (0, 1))
            high_0, low_0 = product(MULTIPLIERS[0], words[0])
            high_1, low_1 = product(MULTIPLIERS[1], words[2])
            words = [high_1 ^ words[1] ^ k0, low_1, high_0 ^ words[3] ^ k1, low_0]
    return words


def seed_of(config):
    """The pair of a configuration of scan-sim."""
    return config["seed"], config.get("draw", 0)


def blocks(seed, stream, i, j):
    seed, draw = seed if isinstance(seed, tuple) else (seed, 0)
    i, j = np.broadcast_arrays(np.asarray(i, np.int64), np.asarray(j, np.int64))
    return philox((i, j, np.full(i.shape, draw, np.uint64), np.zeros(i.shape, np.uint64)), (seed, stream))


def unit(word):
    return (word >> np.uint64(11)).astype(float) * 2.0**-53


def uniform(seed, stream, i, j=0):
    """A uniform number in [0, 1)."""
    return unit(blocks(seed, stream, i, j)[0])


def normal(seed, stream, i, j=0):
    """Box and Muller (1958): the cosine branch of the block's first two words."""
    words = blocks(seed, stream, i, j)
    return np.sqrt(-2 * np.log1p(-unit(words[0]))) * np.cos(2 * np.pi * unit(words[1]))


def correlated(seed, stream, k, j, share):
    """A Gauss-Markov process at the pulses k, share = interval / correlation time: docs/reference/draws.md."""
    levels = next(n for n in range(32) if n == 31 or share * 2.0**n > 40)
    drawn = lambda pulse: normal(seed, stream, pulse, j)
    first = k // 2**levels * 2**levels
    x_first, f = drawn(first), np.exp(-share * 2.0**levels)
    x_last = f * x_first + np.sqrt(1 - f**2) * drawn(first + 2**levels)
    for n in reversed(range(levels)):
        half = share * 2.0**n
        e = np.exp(-half)
        middle = first + 2**n
        x = e / (1 + e**2) * (x_first + x_last) + np.sqrt(np.tanh(half)) * drawn(middle)
        later = k >= middle
        x_first, x_last, first = np.where(later, x, x_first), np.where(later, x_last, x), np.where(later, middle, first)
    return x_first
