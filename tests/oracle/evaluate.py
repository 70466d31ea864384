# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers, holes and metrics of an evaluation, from the layers of a DEM (Eqs. 10-12; docs/user/dem-eval.md)."""
import numpy as np

from oracle.regrid import windows

NEAR_LIMIT = 1e-12  # values so close to a limit may pass or fail


def region_of(config, mask, half, s):
    i, j = np.meshgrid(np.arange(-half, half + 1), np.arange(-half, half + 1))
    shape = config["region"]["shape"]
    if shape == "mask":
        return np.nan_to_num(mask) != 0
    if shape == "square":
        reach = np.floor(config["region"]["half_width_m"] / s + 1e-9)
        return np.maximum(abs(i), abs(j)) <= reach
    radius = config["region_radius_m"] / s
    if abs(radius - round(radius)) < 1e-9:
        radius = round(radius)
    return i * i + j * j < radius**2


def components(invalid):
    """8-connected components, numbered by their first bin in row-major order."""
    ids, count = np.zeros(invalid.shape, int), 0
    for start in zip(*np.nonzero(invalid)):
        if ids[start]:
            continue
        count += 1
        stack = [start]
        while stack:
            row, column = stack.pop()
            if not (0 <= row < ids.shape[0] and 0 <= column < ids.shape[1]):
                continue
            if not invalid[row, column] or ids[row, column]:
                continue
            ids[row, column] = count
            stack += [(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return ids


def distances(valid):
    """Euclidean distance in bins to the nearest valid bin of the map."""
    result = np.zeros(valid.shape)
    bins_of_holes = np.argwhere(valid)
    for rows in np.array_split(np.argwhere(~valid), max(1, (~valid).sum() // 200)):
        if len(rows):
            square = ((rows[:, None] - bins_of_holes)**2).sum(-1)
            result[tuple(rows.T)] = np.sqrt(square.min(1)) if len(bins_of_holes) else np.inf
    return result


class Footprints:
    def __init__(self, config, s):
        self.radius = int(np.floor(config["footprint_m"] / (2 * s) + 1e-9))
        i, j = np.meshgrid(*[np.arange(-self.radius, self.radius + 1)] * 2)
        reach = config["footprint_m"] / (2 * s) + 1e-9
        self.part = (config["footprint_shape"] == "square") | (i * i + j * j <= reach**2).ravel()
        self.part = np.broadcast_to(self.part, i.size)
        self.quantile = config["quantile"]

    def of(self, error, region):
        """Mean, and quantile of |e - mean|, of each footprint centred in the region; NaN elsewhere."""
        values = windows(error, self.radius)[region][:, self.part]
        count = np.isfinite(values).sum(1)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = np.nansum(values, 1) / count
        off = np.sort(abs(values - mean[:, None]), axis=1)  # NaN last
        rank = np.maximum(count - 1, 0) * self.quantile
        low = np.floor(rank).astype(int)
        rows = np.arange(len(off))
        high = np.minimum(low + 1, np.maximum(count - 1, 0))
        found = off[rows, low] + (rank - low) * (off[rows, high] - off[rows, low])
        absolute, relative = np.full(error.shape, np.nan), np.full(error.shape, np.nan)
        absolute[region], relative[region] = mean, np.where(count > 0, found, np.nan) if self.judges_relative else np.nan
        return absolute, relative

    @property
    def judges_relative(self):
        """Footprints of fewer than 5 x 5 bins have no relative error (D450)."""
        return self.radius >= 2


def known(values):
    return values[np.isfinite(values)]


def quantile(values, q):
    """The quantile with h = (n - 1) q (D23); NaN for no values, like the means and maxima here."""
    return np.quantile(values, q) if values.size else np.nan


def mean(values):
    return np.mean(values) if np.size(values) else np.nan


def rms(values):
    return np.sqrt(mean(np.square(values)))


def median(values):
    return quantile(values, 0.5)


def largest(values):
    return np.max(values, initial=-np.inf) if values.size else np.nan


def spread(values):
    return np.std(values) if values.size else np.nan


class Evaluation:
    def __init__(self, dem, config, mask=None, truth_spacing_m=None):
        self.dem, self.c, self.limits, self.truth_spacing_m = dem, config, config["limits"], truth_spacing_m
        self.s = (dem["x"][-1] - dem["x"][0]) / (len(dem["x"]) - 1)
        self.region = region_of(config, mask, len(dem["x"]) // 2, self.s)
        valid = np.isfinite(dem["z_est"])
        self.invalid = self.region & ~valid
        self.holes = components(self.invalid)
        self.sizes = np.bincount(self.holes.ravel())[1:]
        self.distance = distances(valid)
        self.footprints = Footprints(config, self.s)
        self.has_truth = all(f"{axis}_true" in dem for axis in "xyz")
        self.errors, self.judged = {}, {}
        if self.has_truth:
            self.errors = {"x": dem["x_true"] - dem["x"][None, :], "y": dem["y_true"] - dem["y"][:, None],
                           "z": dem["z_true"] - dem["z_est"]}
            if "z_corrected" in dem:
                self.errors["z_corrected"] = dem["z_true"] - dem["z_corrected"]
            self.judged = {axis: self.footprints.of(error, self.region) for axis, error in self.errors.items()}
            self.horizontal = np.hypot(self.judged["x"][0], self.judged["y"][0])

    def limit_of(self, axis):
        return self.limits["relative_horizontal_m" if axis in "xy" else "relative_elevation_m"]

    def layers(self):
        result = {"in_region": self.region, "invalid": self.invalid, "hole_id": self.holes,
                  "distance_to_valid": self.distance, "fail": self.fails()}
        for axis in "xyz" if self.has_truth else ():
            result[f"e_{axis}"] = self.errors[axis]
            result[f"abs_{axis}"], result[f"rel_{axis}"] = self.judged[axis]
        return result

    def fails(self):
        flags = np.zeros(self.region.shape, int)
        with np.errstate(invalid="ignore"):
            for bit, axis in ((1, "x"), (2, "y"), (4, "z")) if self.has_truth else ():
                flags += bit * (self.judged[axis][1] > self.limit_of(axis))
            if self.has_truth:
                flags += 8 * (self.horizontal > self.limits["absolute_horizontal_m"])
        flags += 16 * ((self.holes > 0) & (np.append(0, self.sizes)[self.holes] > self.limits["hole_bins"]))
        return flags + 32 * (self.invalid & (self.distance > self.limits["distance_bins"]))

    def doubtful(self):
        """Footprints of which a value equals its limit within rounding."""
        if not self.has_truth:
            return np.zeros(self.region.shape, bool)
        values = [(self.judged[axis][1], self.limit_of(axis)) for axis in "xyz"]
        values.append((self.horizontal, self.limits["absolute_horizontal_m"]))
        return np.any([abs(value - limit) < NEAR_LIMIT for value, limit in values], axis=0)

    def hole_table(self):
        bins_of_holes = [np.argwhere(self.holes == number + 1) for number in range(len(self.sizes))]
        first = np.array([bins[0] for bins in bins_of_holes]).reshape(-1, 2)
        centre = np.array([bins.mean(0) for bins in bins_of_holes]).reshape(-1, 2)
        half = len(self.dem["x"]) // 2
        return {"id": np.arange(1, len(bins_of_holes) + 1), "size_bins": self.sizes, "row": first[:, 0], "column": first[:, 1],
                "first_x": (first[:, 1] - half) * self.s, "first_y": (first[:, 0] - half) * self.s,
                "x": (centre[:, 1] - half) * self.s, "y": (centre[:, 0] - half) * self.s,
                "max_distance_bins": np.array([self.distance[tuple(bins.T)].max() for bins in bins_of_holes])}

    def metrics(self):
        """metrics.json without `format`, `version` and `uncertainty`."""
        return {"region": self.region_metrics(), "assumptions": self.assumptions(), "coverage": self.coverage(), "accuracy": self.accuracy(),
                "requirements": self.requirements(), "statistics": self.statistics(), "pass": self.verdict()}

    def region_metrics(self):
        shape = self.c["region"]["shape"]
        return {"bin_count": self.region.sum(), "shape": shape,
                "radius_m": self.c["region_radius_m"] if shape == "circle" else None,
                "half_width_m": self.c["region"]["half_width_m"] if shape == "square" else None,
                **{f"center_{axis}_m": 0 if shape == "circle" else None for axis in "xy"}}

    def assumptions(self):
        counts = self.dem["count"][self.region] if "count" in self.dem else np.zeros(0)
        counts = counts[counts > 0]
        return {"footprint_bins": 2 * self.footprints.radius + 1, "truth_spacing_m": self.truth_spacing_m if self.has_truth else None,
                "median_returns_per_bin": median(counts), "single_return_frac": mean(counts == 1)}

    def coverage(self):
        values, counts = np.unique(self.sizes, return_counts=True)
        apart = self.distance[self.invalid]
        return {"invalid_count": self.invalid.sum(), "invalid_frac": self.invalid.sum() / self.region.sum(),
                "hole_count": len(self.sizes), "largest_hole_bins": max(self.sizes, default=0),
                "holes_over_limit": (self.sizes > self.limits["hole_bins"]).sum(),
                "max_distance_bins": max(apart, default=0),
                "distance_over_limit_count": (apart > self.limits["distance_bins"]).sum(),
                "hole_size_histogram": {"size_bins": values, "count": counts}}

    def accuracy(self):
        if not self.has_truth:
            return {}
        result = {"footprint_bins": 2 * self.footprints.radius + 1, "quantile": self.c["quantile"], "absolute": {},
                  "relative": {}}
        for axis, judged in self.judged.items():
            absolute, relative = map(known, judged)
            result["absolute"][axis] = {"p95_m": quantile(abs(absolute), 0.95), "mean_m": mean(absolute),
                                        "max_m": largest(abs(absolute))}
            result["relative"][axis] = {"p95_m": quantile(relative, 0.95), "max_m": largest(relative),
                                        "violation_count": (relative > self.limit_of(axis)).sum() if self.footprints.judges_relative else None}
        horizontal = known(self.horizontal)
        result["absolute"]["horizontal"] = {
            "p95_m": quantile(horizontal, 0.95),
            "within_limit_frac": mean(horizontal <= self.limits["absolute_horizontal_m"])}
        return result

    def requirements(self):
        coverage, limits = self.coverage(), self.limits
        values = {"coverage": (coverage["invalid_frac"], limits["invalid_frac"]),
                  "hole_size": (coverage["largest_hole_bins"], limits["hole_bins"]),
                  "hole_distance": (coverage["max_distance_bins"], limits["distance_bins"])}
        values.update(self.accuracy_requirements())
        found = {name: {"value": value, "limit": limit, "pass": None if value is None else bool(
            value >= limit if name == "absolute_horizontal" else value <= limit)}
                 for name, (value, limit) in values.items()}
        for name in ("relative_elevation", "relative_horizontal") if self.has_truth and not self.footprints.judges_relative else ():
            found[name] = {"value": None, "limit": 0, "pass": None, "reason": "footprint_bins"}
        return found

    def accuracy_requirements(self):
        limits = {"relative_elevation": 0, "relative_horizontal": 0,
                  "absolute_horizontal": self.limits["absolute_horizontal_frac"]}
        if not self.has_truth:
            return {name: (None, limit) for name, limit in limits.items()}
        accuracy = self.accuracy()
        over = {axis: accuracy["relative"][axis]["violation_count"] or 0 for axis in "xyz"}
        values = np.array([over["z"], over["x"] + over["y"], accuracy["absolute"]["horizontal"]["within_limit_frac"]])
        if not known(self.horizontal).size:
            values[:] = np.nan  # without values the requirements are missed
        return dict(zip(limits, zip(values, limits.values())))

    def verdict(self):
        passes = [entry["pass"] for entry in self.requirements().values()] if self.has_truth else [None]
        return False if False in passes else None if None in passes else True

    def statistics(self):
        result = {"valid_frac": 1 - self.invalid.sum() / self.region.sum()}
        if not self.has_truth:
            return result
        for axis, error in self.errors.items():
            result[axis] = spread_of(known(error[self.region]))
        horizontal = known(np.hypot(self.errors["x"], self.errors["y"])[self.region])
        result["horizontal"] = {"count": horizontal.size, "ce90_m": quantile(horizontal, 0.9), "rmse_m": rms(horizontal)}
        return result

    def uncertainty(self):
        """z-scores of a DEM with sigmas."""
        error = self.dem["z_true_map"].astype(float) - self.dem["z_est"]
        mean, _ = self.footprints.of(error, self.region)
        return {"absolute": self.scores(error, self.dem["z_sigma_abs"].astype(float), self.region),
                "relative": self.scores(error - mean, self.dem["z_sigma_rel"].astype(float), self.with_neighbours(error))}

    def with_neighbours(self, error):
        """The bins of the region whose footprint contains another valid bin."""
        inside = windows(error, self.footprints.radius)[..., self.footprints.part]
        return self.region & (np.isfinite(inside).sum(-1) > 1)

    def scores(self, error, sigma, region):
        judged = region & np.isfinite(error)
        with np.errstate(invalid="ignore"):
            used = judged & (sigma > 0) & np.isfinite(sigma)
        z, counts, sigmas, errors = (error / sigma)[used], self.dem["count"][used], sigma[used], error[used]
        numbers = np.unique(counts)
        step = np.floor(4 * np.log2(sigmas))
        steps = [step == k for k in np.unique(step)]
        ks = np.arange(0.25, 4.1, 0.25) if z.size else np.array([])
        return {"count": used.sum(), "left_out_count": judged.sum() - used.sum(), "mean": mean(z), "std": spread(z),
                "within_1_sigma_frac": mean(abs(z) <= 1), "within_2_sigma_frac": mean(abs(z) <= 2),
                "by_count": {"count": numbers, "bins": [(counts == n).sum() for n in numbers],
                             "std": [z[counts == n].std() for n in numbers],
                             "within_1_sigma_frac": [(abs(z[counts == n]) <= 1).mean() for n in numbers],
                             "within_2_sigma_frac": [(abs(z[counts == n]) <= 2).mean() for n in numbers]},
                "reliability": {"bins": [part.sum() for part in steps],
                                "sigma_m": [rms(sigmas[part]) for part in steps],
                                "rmse_m": [rms(errors[part]) for part in steps]},
                "within_k_sigma": {"k": ks, "frac": [mean(abs(z) <= k) for k in ks]}}


def spread_of(error):
    middle = median(error)
    return {"count": error.size, "mean_m": mean(error), "std_m": spread(error), "rmse_m": rms(error), "median_m": middle,
            "nmad_m": 1.4826 * median(abs(error - middle)), "le90_m": quantile(abs(error), 0.9),
            "p95_m": quantile(abs(error), 0.95)}
