# SPDX-License-Identifier: GPL-3.0-or-later
"""WGS84: UTM (Krueger's series to the fourth order in n, as in C. Karney, J. Geodesy 85 (2011), 475-485), geodetic and
Earth-centred coordinates, north-east-down axes."""
import numpy as np

A, F = 6378137.0, 1 / 298.257223563
E2 = F * (2 - F)


def of_utm(easting, northing, zone):
    """Latitude and longitude, radians, on the northern hemisphere."""
    n = F / (2 - F)
    radius = 0.9996 * A / (1 + n) * (1 + n**2 / 4 + n**4 / 64)
    xi, eta = northing / radius, (easting - 500000) / radius
    beta = (n / 2 - 2 * n**2 / 3 + 37 * n**3 / 96 - n**4 / 360, n**2 / 48 + n**3 / 15 - 437 * n**4 / 1440,
            17 * n**3 / 480 - 37 * n**4 / 840, 4397 * n**4 / 161280)
    twice = [(b, 2 * (j + 1)) for j, b in enumerate(beta)]
    x = xi - sum(b * np.sin(j * xi) * np.cosh(j * eta) for b, j in twice)
    y = eta - sum(b * np.cos(j * xi) * np.sinh(j * eta) for b, j in twice)
    tan_conformal = np.sin(x) / np.hypot(np.sinh(y), np.cos(x))
    tan, e = tan_conformal, np.sqrt(E2)
    for _ in range(5):  # Newton; two steps suffice
        sigma = np.sinh(e * np.arctanh(e * tan / np.hypot(1, tan)))
        guess = tan * np.hypot(1, sigma) - sigma * np.hypot(1, tan)
        tan = tan + (tan_conformal - guess) / np.hypot(1, guess) * (1 + (1 - E2) * tan**2) / ((1 - E2) * np.hypot(1, tan))
    return np.arctan(tan), np.arctan2(np.sinh(y), np.cos(x)) + np.radians(6 * zone - 183)


def earth_centred(latitude, longitude, height):
    radius = A / np.sqrt(1 - E2 * np.sin(latitude)**2)
    across = (radius + height) * np.cos(latitude)
    return np.stack([across * np.cos(longitude), across * np.sin(longitude),
                     (radius * (1 - E2) + height) * np.sin(latitude)], -1)


def north_east_down(latitude, longitude):
    """Matrices (..., 3, 3) whose rows are the axes in Earth-centred coordinates."""
    s, c, sl, cl = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    return np.stack([np.stack([-s * cl, -s * sl, c], -1), np.stack([-sl, cl, 0 * s], -1),
                     np.stack([-c * cl, -c * sl, -s], -1)], -2)
