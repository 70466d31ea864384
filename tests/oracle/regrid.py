# SPDX-License-Identifier: GPL-3.0-or-later
"""The layers of a DEM from the returns of a scan (Eqs. 8-9; docs/user/regrid.md, docs/reference/sigmas.md)."""
from statistics import NormalDist

import numpy as np

from oracle.frames import matrix_of_quaternion, rotated

EDGE = 1e-9  # in bins: a return so close to the border of a bin, or to the line through its centre, may be counted on either side


class Bins:
    def __init__(self, points, config):
        self.s = config["resolution_m"]
        self.half = int(np.floor(config["half_width_m"] / self.s + 1e-9))
        self.size = 2 * self.half + 1
        self.centres = np.arange(-self.half, self.half + 1) * self.s
        self.points, self.method = points, config["method"]
        self.truth_at = config["truth_at"]
        self.x, self.y = np.meshgrid(self.centres, self.centres)
        self.assign_bins()

    def assign_bins(self):
        """Arrays with one element per return and bin: `of`, the return; `bin`, its row-major index; `weight`."""
        u, v = (self.points[f"{axis}_est"] / self.s for axis in "xy")
        if self.method == "bilinear4":
            parts = [self.share(u, v, dx, dy) for dy in (0, 1) for dx in (0, 1)]
            self.of, self.bin, self.weight = (np.concatenate(part) for part in zip(*parts))
            order = np.argsort(self.of, kind="stable")
            self.of, self.bin, self.weight = self.of[order], self.bin[order], self.weight[order]
            near = [abs(a - np.rint(a)) < EDGE for a in (u, v)]
        else:
            column, row = (np.floor(a + 0.5).astype(int) for a in (u, v))
            inside = (abs(column) <= self.half) & (abs(row) <= self.half)
            self.of = np.flatnonzero(inside)
            self.bin = self.number(column, row)[inside]
            p, q = (abs(self.points[f"{axis}_est"] - k * self.s) / self.s for axis, k in (("x", column), ("y", row)))
            self.weight = ((1 - p) * (1 - q))[inside] if self.method == "bilinear_nearest" else np.ones(len(self.of))
            near = [abs(a + 0.5 - np.rint(a + 0.5)) < EDGE for a in (u, v)]
        self.doubtful = self.around(u[near[0] | near[1]], v[near[0] | near[1]])

    def number(self, column, row):
        return (row + self.half) * self.size + column + self.half

    def share(self, u, v, dx, dy):
        column, row = np.floor(u).astype(int) + dx, np.floor(v).astype(int) + dy
        weight = (1 - abs(u - column)) * (1 - abs(v - row))
        kept = (abs(column) <= self.half) & (abs(row) <= self.half) & (weight > 0)
        return np.flatnonzero(kept), self.number(column, row)[kept], weight[kept]

    def around(self, u, v):
        """The bins around returns whose bin depends on rounding."""
        result = np.zeros((self.size, self.size), bool)
        for column, row in zip(np.rint(u).astype(int) + self.half, np.rint(v).astype(int) + self.half):
            result[max(row - 1, 0):row + 2, max(column - 1, 0):column + 2] = True
        return result

    def sum(self, values):
        return np.bincount(self.bin, values, self.size**2).reshape(self.size, self.size)

    def mean(self, name, values=None):
        values = (self.points[name] if values is None else values)[self.of]
        with np.errstate(invalid="ignore", divide="ignore"):
            return self.sum(self.weight * values) / self.sum(self.weight)

    def chosen(self):
        """{bin: returns} for min, max and median: each layer is the mean of these returns."""
        order = np.lexsort((self.points["z_est"][self.of], self.bin))
        numbers, begins = np.unique(self.bin[order], return_index=True)
        pick = {"min": lambda g: g[:1], "median": lambda g: g[[(len(g) - 1) // 2, len(g) // 2]],
                "max": lambda g: g[[np.flatnonzero(self.points["z_est"][self.of[g]] ==
                                                   self.points["z_est"][self.of[g[-1]]])[0]]]}[self.method]
        return {n: self.of[pick(group)] for n, group in zip(numbers, np.split(order, begins[1:]))}

    def layer(self, name, values=None):
        """The layer that the method computes from a column."""
        if self.method in ("bilinear_nearest", "bilinear4", "mean"):
            return self.mean(name, values)
        values = self.points[name] if values is None else values
        result = np.full(self.size**2, np.nan)
        for number, of in self.choice.items():
            result[number] = values[of].mean()
        return result.reshape(self.size, self.size)

    def layers(self, surface=None):
        if self.method in ("min", "max", "median"):
            self.choice = self.chosen()
        count = self.sum(np.ones(len(self.of)))
        filled = count > 0
        result = {"count": count, "weight_sum": np.where(filled, self.sum(self.weight), np.nan)}
        for layer, name in (("z_est", "z_est"), ("x_true", "x_true"), ("y_true", "y_true"), ("x_est_mean", "x_est"),
                            ("y_est_mean", "y_est"), ("t_mean", "t")):
            result[layer] = self.layer(name)
        z = self.points["z_est"] - self.points["z_est"].mean()
        mean = self.mean(None, z).ravel()
        with np.errstate(invalid="ignore", divide="ignore"):
            result["z_spread"] = np.sqrt(self.sum(self.weight * (z[self.of] - mean[self.bin])**2) / self.sum(self.weight))
        if surface is not None:
            result["z_true"] = surface.elevation(*self.true_positions(result))
        return result

    def true_positions(self, layers):
        if self.truth_at == "centroid":
            return layers["x_true"], layers["y_true"]
        dx, dy = (self.layer(None, self.points[f"{axis}_true"] - self.points[f"{axis}_est"]) for axis in "xy")
        return self.x + dx, self.y + dy


def windows(layer, radius):
    """The values around each bin, (rows, columns, (2 radius + 1)^2); NaN outside the map."""
    padded = np.pad(np.asarray(layer, float), radius, constant_values=np.nan)
    size = 2 * radius + 1
    view = np.lib.stride_tricks.sliding_window_view(padded, (size, size))
    return view.reshape(*np.shape(layer), size * size)


class Uncertainty:
    """Slopes, z_corrected and sigmas by the formulas of docs/reference/sigmas.md."""

    PARTS = ("position_m", "velocity_mps", "rpy_rad", "rpy_rate_radps")

    def __init__(self, bins, layers, pulses, sigmas):
        self.bins, self.layers, self.sigmas = bins, layers, sigmas
        self.centroid = np.stack([bins.mean("x_est"), bins.mean("y_est"), bins.mean("z_est")], -1)
        self.slope = self.slopes()
        self.J = np.concatenate([-self.slope, np.ones((*self.slope.shape[:2], 1))], -1)
        self.lever(pulses)

    def slopes(self):
        w = np.nan_to_num(self.layers["weight_sum"])
        result = np.full((*w.shape, 2), np.nan)
        self.near_limit = np.zeros(w.shape)
        self.misfit, self.bins_of_plane, self.noise_share = np.zeros(w.shape), np.full(w.shape, 3), np.zeros(w.shape)
        w2 = self.squared_weights()
        done = w == 0
        for radius, enough in ((1, 6), (2, 6), (3, 3)):
            weights = np.nan_to_num(windows(np.where(w > 0, w, np.nan), radius))
            at = [windows(self.centroid[..., axis], radius) - self.centroid[..., axis, None] for axis in range(3)]
            x, y, z = (np.nan_to_num(a) for a in at)
            total = weights.sum(-1) + (weights.sum(-1) == 0)
            mean = lambda a: (weights * a).sum(-1) / total
            spread = lambda a, b: mean(a * b) - mean(a) * mean(b)
            xx, xy, yy, xz, yz = spread(x, x), spread(x, y), spread(y, y), spread(x, z), spread(y, z)
            minimum = (xx + yy) / 2 - np.hypot((xx - yy) / 2, xy)
            self.near_limit[~done & (abs(minimum / (0.1 * self.bins.s**2) - 1) < 1e-6)] = 1
            fits = ~done & ((weights > 0).sum(-1) >= enough) & (minimum >= 0.1 * self.bins.s**2)
            determinant = np.where(fits, xx * yy - xy * xy, 1)
            fitted = np.stack([(xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant], -1)
            result = np.where(fits[..., None], fitted, result)
            off = z - mean(z)[..., None]
            off -= fitted[..., :1] * (x - mean(x)[..., None]) + fitted[..., 1:] * (y - mean(y)[..., None])
            self.misfit = np.where(fits, mean(off**2), self.misfit)
            self.bins_of_plane = np.where(fits, (weights > 0).sum(-1), self.bins_of_plane)
            self.noise_share = np.where(fits, mean(np.nan_to_num(windows(w2, radius))), self.noise_share)
            done |= fits
        return result

    def squared_weights(self):
        with np.errstate(invalid="ignore", divide="ignore"):
            return self.bins.sum(self.bins.weight**2) / self.bins.sum(self.bins.weight)**2

    def uneven(self, noise):
        """The variance of the error where the centroids around a bin do not lie in a plane."""
        freedom = np.maximum(self.bins_of_plane - 3, 1)
        by_chance = noise * self.noise_share
        excess = np.where(self.bins_of_plane > 3, self.misfit * self.bins_of_plane / freedom - by_chance, 0)
        unit = 2 / (9 * freedom)
        allowed = by_chance * ((1 - unit + NormalDist().inv_cdf(0.99) * np.sqrt(unit))**3 - 1)
        count = self.layers["count"].astype(float)
        around = windows(np.where(count > 0, count, np.nan), 3)
        filled = np.isfinite(around).sum(-1)
        with np.errstate(invalid="ignore", divide="ignore"):
            self.near_limit[abs(excess / allowed - 1) < 1e-6] = 1
            crowding = np.maximum(0.6, count * filled / np.nan_to_num(around).sum(-1))**1.2
            return np.where(excess > allowed, excess, 0) * (0.41 + 0.175 / count) * crowding

    def doubtful(self):
        """Bins that use a window for which rounding decides whether its scatter suffices for a plane, or near one in which it
        decides whether a misfit counts."""
        return windows(self.near_limit, 3).max(-1) > 0

    def lever(self, pulses):
        """The vector from the body at the bin's mean time to the bin; the pose is interpolated linearly between pulses."""
        t = self.bins.mean("t")
        interpolated = lambda name: np.interp(t, pulses["t"], pulses[name])
        body = np.stack([interpolated(f"p{axis}_est") for axis in "xyz"], -1)
        q = np.stack([interpolated(f"q{axis}_est") for axis in "wxyz"], -1)
        self.turn = matrix_of_quaternion(q / np.linalg.norm(q, axis=-1, keepdims=True))
        self.since = t - pulses["t"][0]
        self.r = np.stack([self.bins.x, self.bins.y, self.layers["z_est"]], -1) - body
        self.n = self.r / np.linalg.norm(self.r, axis=-1, keepdims=True)

    def navigation(self, J):
        p, v, angle, rate = (np.square(self.sigmas[part]) for part in self.PARTS)
        J = np.broadcast_to(J, self.r.shape)
        arm = rotated(np.swapaxes(self.turn, -1, -2), np.cross(self.r, J))
        square = (self.since**2)[..., None]
        return np.sum(J**2 * (p + square * v), -1) + np.sum(arm**2 * (angle + square * rate), -1)

    def made(self):
        bins, s = self.bins, self.bins.s
        total, count = bins.sum(bins.weight), bins.sum(np.ones(len(bins.of)))
        with np.errstate(invalid="ignore", divide="ignore"):
            w2 = self.squared_weights()
            exact = 1792 / 29160
            quantised = s**2 * (exact + (1 / 12 - exact) / count) / count
        off = [(bins.points[f"{a}_est"][bins.of] - self.centroid[..., n].ravel()[bins.bin]) for n, a in enumerate("xyz")]
        J = self.J.reshape(-1, 3)[bins.bin]
        with np.errstate(invalid="ignore", divide="ignore"):
            scatter = bins.sum(bins.weight * sum(J[:, n] * off[n] for n in range(3))**2) / total
        sigma = self.sigmas["range_sigma_m"]**2
        noise = sigma * np.sum(self.J * self.n, -1)**2
        with np.errstate(invalid="ignore", divide="ignore"):
            excess, freedom = (scatter - noise * (1 - w2)) / w2, np.where(np.isnan(self.slope[..., 0]), np.nan, 1 / w2 - 1)
            shares = np.nansum(windows(excess, 3), -1), np.nansum(windows(freedom, 3), -1)
            rough = np.where(shares[1] > 1e-12, np.maximum(0, shares[0] / shares[1]), 0)
        uneven = self.uneven(noise)
        local = (noise + rough) * w2 + uneven
        steep, nav = np.sum(self.slope**2, -1) * quantised, self.navigation(self.J)
        sideways = (self.navigation(np.eye(3)[0]) + self.navigation(np.eye(3)[1])) / 2
        shift = self.centroid[..., :2] - np.stack([bins.x, bins.y], -1)
        return {"z_corrected": self.layers["z_est"] - np.sum(self.slope * shift, -1),
                "z_sigma_abs": np.sqrt(local + steep + nav), "z_sigma_rel": np.sqrt(local + steep),
                "z_sigma_noise": np.sqrt(noise * w2 + np.where(uneven > 0, 0, steep)),
                "z_corrected_sigma_abs": np.sqrt(local + nav), "z_corrected_sigma_rel": np.sqrt(local),
                "xy_sigma": np.sqrt(quantised + np.sum(self.n[..., :2]**2, -1) / 2 * sigma * w2 + sideways)}
