# SPDX-License-Identifier: GPL-3.0-or-later
"""Small random configurations of the whole chain. Kinds are dealt from shuffled decks, so that every kind occurs."""
import os

import h5py
import numpy as np

from oracle.lidars import Lidars
from oracle.sites import Sites


class Deck:
    """Deals its kinds in random order, each of them once before any is repeated."""

    def __init__(self, rng, kinds):
        self.rng, self.kinds, self.left = rng, kinds, []

    def deal(self):
        if not self.left:
            self.left = list(self.rng.permutation(len(self.kinds)))
        return self.kinds[self.left.pop()]


TERRAINS = ["plane", "standing", "added", "draped", "ring", "all", "raster nearest", "raster bilinear", "raster bicubic",
            "fractal", "population", "mesh"]
PATTERNS = ["line_search", "line_search", "ramped", "spiral", "rosette", "lissajous", "stare", "step_stare", "table"]
SCANNERS = ["fsm", "fsm", "gimbal", "flash", "polygon", "palmer", "table gimbal", "table fsm", "risley rates",
            "risley pattern", "risley reflecting", "fsm", "gimbal"]
TRAJECTORIES = ["constant_velocity", "constant_velocity", "table quaternion", "table angles", "table mrp", "dynamics"]
NAVIGATION = ["none", "linear", "walk", "gauss_markov", "all", "table", "commanded"]
METHODS = ["bilinear_nearest", "bilinear_nearest", "bilinear4", "mean", "min", "max", "median"]
REGIONS = ["circle", "circle", "square", "mask"]
ESTIMATORS = ["mean", "median", "first", "strongest"]
RECEIVERS = ["none", "leading_edge", "constant_fraction", "none", "peak", "centroid", "geiger", "clock"]
RETURNS = ["first", "last", "strongest", "all"]


class CaseGenerator(Sites, Lidars):
    """Generates cases; writes their tables, rasters and meshes to a folder, where configurations name them without a path."""

    def __init__(self, seed, folder):
        super().__init__(seed, folder)
        self.decks = {name: Deck(self.rng, kinds) for name, kinds in (
            ("terrain", TERRAINS), ("pattern", PATTERNS), ("scanner", SCANNERS), ("trajectory", TRAJECTORIES),
            ("navigation", NAVIGATION), ("method", METHODS), ("region", REGIONS), ("estimator", ESTIMATORS),
            ("receiver", RECEIVERS), ("returns", RETURNS))}

    def case(self, **wanted):
        """The configurations of the four tools and the kinds dealt for them; `wanted` replaces kinds of the decks."""
        dealt = {name: deck.deal() for name, deck in self.decks.items()} | wanted
        scan = self.scan(dealt)
        regrid = self.regrid(dealt)
        albedo = {"minimum": self.between(0, 0.5), "greatest": 1.0, "seed": self.whole(0, 999)} if (
            scan.get("surface", {}).get("albedo") == "terrain") else None
        return {"dealt": dealt, "albedo": albedo, "terrain": self.terrain(dealt["terrain"]), "scan": scan, "regrid": regrid,
                "eval": self.eval(dealt, regrid), "options": self.options(dealt)}

    def options(self, dealt):
        return {"keep_misses": self.chance(0.7), "float32": self.chance(0.1), "truth": self.chance(0.92),
                "uncertainty": dealt["method"] == "bilinear_nearest" and self.chance(0.8),
                "corrected": dealt["method"] == "bilinear_nearest" and self.chance(0.7)}

    def regrid(self, dealt):
        resolution = self.one_of([0.1, 0.08, 0.125])
        return {"resolution_m": resolution, "half_width_m": 25 * resolution, "method": dealt["method"],
                "truth_at": self.one_of(["bin_center", "bin_center", "centroid"]),
                "uncertainty": {"range_sigma_m": self.between(0.005, 0.03), "navigation_sigma": {
                    "position_m": self.between(0, 0.1, 3), "velocity_mps": self.between(0, 0.3, 3),
                    "rpy_rad": self.between(0, 1e-3, 3), "rpy_rate_radps": self.between(0, 1e-2, 3)}}}

    def eval(self, dealt, regrid):
        b, s = self.between, regrid["resolution_m"]
        config = {"region_radius_m": self.one_of([24 * s, b(15, 25) * s]), "footprint_m": self.one_of([5 * s, b(3, 9) * s]),
                  "footprint_shape": self.one_of(["square", "disc"]), "quantile": self.one_of([0.95, b(0, 1)]),
                  "limits": {"invalid_frac": b(0, 1), "hole_bins": self.whole(0, 40), "distance_bins": b(0.5, 6),
                             "relative_elevation_m": b(0.002, 0.1), "relative_horizontal_m": b(0.01, 0.06),
                             "absolute_horizontal_m": b(0.01, 0.2), "absolute_horizontal_frac": b(0.2, 1)}}
        if dealt["region"] == "square":
            config["region"] = {"shape": "square", "half_width_m": self.one_of([20 * s, b(10, 25) * s])}
        if dealt["region"] == "mask":
            config["region"] = {"shape": "mask", "path": self.mask(), "layer": "inside"}
        return config

    def mask(self):
        values = np.zeros((51, 51))
        values[self.whole(2, 10):self.whole(35, 50), self.whole(2, 10):self.whole(35, 50)] = 1
        values[self.rng.random(values.shape) < 0.03] = np.nan
        with h5py.File(os.path.join(self.folder, "mask.h5"), "w") as file:
            file["inside"] = values
        return "mask.h5"
