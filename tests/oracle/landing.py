# SPDX-License-Identifier: GPL-3.0-or-later
"""Random landers on the DEM of a case, and the comparison of hazards.h5, sites.json and score.json with oracle.hazards."""
import json
import os
import subprocess

import numpy as np

from harness import columns, read_bytes
from oracle import hazards
from oracle.cases import Deck
from oracle.comparison import BIN, SINGLE, write_json
from oracle.drawing import Drawing
from oracle.evaluate import region_of

METHODS = ["contact", "contact", "plane", "contact", "range_difference", "lmeds"]
DECIDED_BY_ROUNDING = 1e-9  # of a slope or a roughness to its limit


class Landers(Drawing):
    """Deals configurations of hazard-map for maps of 51 x 51 bins."""

    def __init__(self, seed):
        super().__init__([seed, 1], None)
        self.methods = Deck(self.rng, METHODS)

    def config(self, s):
        """For bins with an edge of s metres."""
        b = self.between
        return {"lander": {"legs": self.whole(3, 4), "leg_radius_m": b(2, 5) * s, "pad_diameter_m": b(0.5, 4) * s,
                           "pad_height": self.one_of(["max", "mean"]), "body_radius_m": b(2, 5) * s},
                "method": self.methods.deal(), "region_radius_m": b(14, 30) * s,
                "limits": {"slope_deg": b(5, 60), "roughness_m": b(1.01, 6) * s}, "hole_fill_bins": self.one_of([0, self.whole(1, 60), 10000, 10000]),
                "touchdown_sigma_m": self.one_of([0, b(0.3, 4) * s]),
                "sites": {**self.reach(s), "count": self.whole(1, 8), "separation_m": b(0, 6) * s, "divert_radius_m": b(5, 25) * s,
                          "divert_weight": b(0, 1), "min_p": 0.5}}


    def reach(self, s):
        """A circle, a polygon or a divert."""
        b, kind = self.between, self.one_of(["circle", "polygon", "divert"])
        if kind == "circle":
            return {}
        if kind == "polygon":
            return {"reach": [[b(-25, 25) * s, b(-25, 25) * s] for _ in range(self.whole(3, 6))]}
        return {"reach": {"height_m": 40, "descent_mps": b(4, 8), "velocity_mps": [b(-1, 1) * s, b(-1, 1) * s], "position_m": [b(-9, 9) * s, b(-9, 9) * s],
                          "tilt_deg": min(b(5, 15) * s, 60), "thrust_accel_mps2": b(2.2, 4), "gravity_mps2": 1.3}}


def check(config, ledger):
    """Runs hazard-map on dem.h5 of the working folder and compares all that it writes."""
    dem = columns("dem.h5")
    expected = Expected(config, dem)
    command = [os.path.join(BIN, "hazard-map"), "-q", "-O", "-t", "1", "dem.h5", "-c", write_json("hazard.json", config), "-o", "hazards.h5",
               "--sites", "sites.json", *(["--score", "score.json"] if expected.truth else [])]
    result = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    is_unknown = bool((expected.safe[expected.region] == hazards.UNKNOWN).all())
    ledger.equal("hazards: exit code", [result.returncode], [1 if is_unknown else 0])
    if is_unknown or result.returncode != 0:
        return
    found = columns("hazards.h5")
    expected.compare_measures(ledger, found)
    expected.compare_places(ledger, found)
    expected.compare_sites(ledger, found, load("sites.json"))
    if expected.truth:
        expected.compare_score(ledger, found, load("score.json"))


def load(name):
    return json.loads(read_bytes(name))


class Expected:
    """The layers that hazard-map computes from a DEM; p_safe, which is not recomputed, is taken from its file."""

    def __init__(self, config, dem):
        self.config, self.dem = config, dem
        self.s = (dem["x"][-1] - dem["x"][0]) / (len(dem["x"]) - 1)
        self.region = region_of({**config, "region": {"shape": "circle"}}, None, len(dem["x"]) // 2, self.s)
        holes = hazards.small_holes(dem["z_est"], config["hole_fill_bins"])
        self.z = hazards.filled(dem["z_est"], holes)
        self.measured = self.measures(self.z)
        self.safe, self.doubtful = self.judge(self.measured)
        self.truth = None
        if "z_true" in dem:
            rings = {b: [n for n in ring if not np.isnan(dem["z_true"][n])] for b, ring in holes.items() if np.isnan(dem["z_true"][b])}
            self.rings = {b: ring for b, ring in rings.items() if ring}
            self.truth = self.measures(hazards.filled(dem["z_true"], self.rings))
            self.safe_true, self.doubtful_true = self.judge(self.truth)

    def measures(self, z):
        return [np.where(self.region, values, np.nan) for values in hazards.measures(z, self.config, self.s)]

    def judge(self, measured):
        limits = self.config["limits"]
        near = [abs(values - limits[key]) < DECIDED_BY_ROUNDING for values, key in zip(measured, ("slope_deg", "roughness_m"))]
        return hazards.judge(*measured, limits), near[0] | near[1]

    def compare_measures(self, ledger, found):
        pairs = [("", self.measured, self.safe, self.doubtful)]
        if self.truth:
            pairs.append(("_true", self.truth, self.safe_true, self.doubtful_true))
        method = f" ({self.config['method']})"
        for suffix, (slope, rough), safe, doubtful in pairs:
            ledger.close("hazards: slope" + method, found["slope" + suffix], slope, 1e-9, SINGLE)
            ledger.close("hazards: roughness" + method, found["roughness" + suffix], rough, 1e-9, SINGLE)
            ledger.equal("hazards: safe", found["safe" + suffix], safe, doubtful)
        ledger.equal("hazards: layers", sorted(name for name in found if name.endswith("_true") or name in ("outcome", "p_safe")),
                     sorted((["outcome", "roughness_true", "safe_true", "slope_true"] if self.truth else []) +
                            (["p_safe"] if "z_sigma_rel" in self.dem else [])))
        if self.truth:
            outcome = np.full(self.safe.shape, 4)
            for number, pair in enumerate([(0, 0), (1, 1), (1, 0), (0, 1)]):
                outcome[(found["safe"] == pair[0]) & (found["safe_true"] == pair[1])] = number
            ledger.equal("hazards: outcome", found["outcome"], outcome)

    def compare_places(self, ledger, found):
        """From the stored layers that each of them is made of."""
        sites = self.config["sites"]
        known = found["safe"] != hazards.UNKNOWN
        p = np.where(known, found["p_safe"].astype(float), 0) if "p_safe" in found else (found["safe"] == hazards.SAFE).astype(float)
        p = hazards.touchdown(p, self.config["touchdown_sigma_m"], self.s)
        ledger.close("hazards: p_touchdown", found["p_touchdown"], np.where(self.region, p, np.nan), 1e-9, SINGLE)
        distance = np.hypot(self.dem["x"][None, :], self.dem["y"][:, None])
        cost = np.where(self.region, 1 - p + sites["divert_weight"] * distance / sites["divert_radius_m"], np.nan)
        cost[~hazards.within_reach(*np.meshgrid(self.dem["x"], self.dem["y"]), sites)] = np.nan
        ledger.close("hazards: cost", found["cost"], cost, 1e-7, SINGLE)
        ledger.close("hazards: distance_to_hazard", found["distance_to_hazard"],
                     hazards.distances(self.region, found["safe"], self.s), 1e-9, SINGLE)

    def compare_sites(self, ledger, found, listed):
        chosen = hazards.sites(found["cost"], found["safe"], self.dem["x"], self.dem["y"], self.config["sites"])
        rows = listed["sites"]
        ledger.equal("hazards: sites", [[row["rank"], row["x_m"], row["y_m"]] for row in rows],
                     [[i + 1, self.dem["x"][c], self.dem["y"][r]] for i, (r, c) in enumerate(chosen)])
        for row, bin_ in zip(rows, chosen):
            numbers = [row["z_m"], row["slope_deg"], row["roughness_m"]]
            ledger.close("hazards: numbers of sites", numbers, [self.z[bin_], self.measured[0][bin_], self.measured[1][bin_]], 1e-9)
            truth = found["safe_true"][bin_] if self.truth else hazards.UNKNOWN
            ledger.equal("hazards: true_safe", [str(row["true_safe"])], [str([False, True, None][truth])])

    def compare_score(self, ledger, found, score):
        expected = hazards.score(self.measured, self.truth, self.config["limits"], self.region)
        doubtful = bool((self.doubtful | self.doubtful_true)[self.region].any())
        curve = expected.pop("roc")
        ledger.close("hazards: limits of the ROC", score["roc"]["roughness_limit_m"], curve["roughness_limit_m"], 1e-12)
        self.compare_curve(ledger, score["roc"], curve)
        for key, value in expected.items():
            ledger.nested(f"hazards: score.{key}", score[key], value, 1e-12, 1e-12, doubtful)
        ledger.equal("hazards: filled_truth_bins", [score["filled_truth_bins"]], [sum(self.region[b] for b in self.rings)])
        if "p_safe" in found:
            known = (found["safe"] != hazards.UNKNOWN) & (found["safe_true"] != hazards.UNKNOWN)
            if known.any():
                off = found["p_safe"][known].astype(float) - (found["safe_true"][known] == hazards.SAFE)
                ledger.close("hazards: brier", [score["brier"]], [np.mean(off**2)], 1e-12)

    def compare_curve(self, ledger, found, expected):
        rough = np.concatenate([values[self.region] for values in (self.measured[1], self.truth[1])])
        for k, limit in enumerate(expected["roughness_limit_m"]):
            doubtful = np.array([bool((abs(rough - limit) < DECIDED_BY_ROUNDING).any() or self.doubtful_true[self.region].any())])
            for key in ("missed_hazard_frac", "false_alarm_frac"):
                values = [np.nan if curve[key][k] is None else curve[key][k] for curve in (found, expected)]
                ledger.close("hazards: ROC", values[:1], values[1:], 1e-12, doubtful=doubtful)
