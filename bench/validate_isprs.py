#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Hazard maps of real airborne lidar against reference ground (docs/quality/validation.md).

    bench/validate_isprs.py FOLDER [--postings 2,5] [--samples 11,22] [--json FILE]

FOLDER has pairs of the ISPRS filter test: isprs_sampNN.pcd, all returns, and isprs_sampNN-ground.pcd, those that a person took for ground. A DEM of all
returns (min, median, mean) is searched for hazards (contact, lmeds); the truth is the mean of the ground returns in bins of the same posting. The lander
has a radius of two bins, the smallest that contact takes: four legs, pads of one bin, 10 deg and 0.5 m. Holes of up to 20 bins are filled. Imported
points have no poses, hence no 1-sigma map: p_safe takes one 1-sigma for all bins, 0.1 m.

A truth is where a person saw ground. Under roofs and dense crowns there is none: a place there is unknown, also if the map calls it safe, and is counted
as "safe on objects", safe places whose bin lies more than 1 m above the ground's triangulation.
Intervals are Wilson's, 95 %, of n/m places, m the bins under the body: neighbouring places share most of their bins and are no independent trials.
"""
import argparse
import json
import os
import re
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
# pylint: disable=wrong-import-position
import h5py
import numpy as np
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import cKDTree

import landfall

METHODS, MEASURES = ("min", "median", "mean"), ("contact", "lmeds")
SIGMA_M, OBJECT_M, HOLE_BINS = 0.1, 1.0, 20
BODY_BINS = 13  # within two bins of a place
LIMITS = {"slope_deg": 10, "roughness_m": 0.5}
SAFE_HAZARD, CLASSES = 2, ("hazard found", "safe found", "missed hazard", "false alarm", "unknown")
P_EDGES = (0, 0.1, 0.5, 0.9, 0.99, 1.0000001)


def wilson(count, total):
    """The 95 % interval of a share; (0, 1) without trials."""
    if total <= 0:
        return 0.0, 1.0
    z2, p = 1.959964**2, count / total
    middle, half = (p + z2 / (2 * total)) / (1 + z2 / total), np.sqrt(z2 * (p * (1 - p) / total + z2 / (4 * total**2))) / (1 + z2 / total)
    return max(0.0, middle - half), min(1.0, middle + half)


def imported(path, center, folder):
    """Points (n, 3) in the frame of `center`."""
    output = os.path.join(folder, "points.h5")
    landfall.run("landfall-import", None, path, output=output, overwrite=True, quiet=True, **({"center": center} if center else {}))
    with h5py.File(output) as file:
        frame = file["points"].attrs
        return np.stack([file[f"points/{axis}_est"][()] for axis in "xyz"], -1), (frame["origin_x"], frame["origin_y"])


class Sample:
    """All returns and the ground ones of a pair, in one frame."""

    def __init__(self, path, folder):
        self.name = re.search(r"samp\d+", path).group()
        # Coordinates that move in steps of half a bin, as float32 makes them, would lie on edges: the origin moves by half a step.
        points, center = imported(path, None, folder)
        self.step_m = [float(np.min(np.diff(np.unique(np.round(points[:, n], 6))))) for n in (0, 1)]
        place = ",".join(f"{value + (step / 2 if step > 0.1 else 0):.3f}" for value, step in zip(center, self.step_m))
        self.points, _ = imported(path, place, folder)
        self.ground, _ = imported(path.replace(".pcd", "-ground.pcd"), place, folder)
        near = cKDTree(self.ground).query(self.points, distance_upper_bound=0.02)[0]
        self.is_ground = np.isfinite(near)
        self.surface = LinearNDInterpolator(self.ground[:, :2] + 1e-4 * np.random.default_rng(1).normal(size=(len(self.ground), 2)), self.ground[:, 2])

    def grid(self, posting):
        half = np.ceil(np.abs(self.points[:, :2]).max() / posting) * posting
        return {"half_width_m": half, "resolution_m": posting}


def per_bin(xy, values, x, posting):
    """Sums of values of points in the bins of a square grid whose bin centres are x."""
    place = np.floor((xy - x[0]) / posting + 0.5).astype(int)
    inside = ((place >= 0) & (place < len(x))).all(1)
    sums = np.zeros((len(x), len(x)))
    np.add.at(sums, (place[inside, 1], place[inside, 0]), values[inside])
    return sums


def error_classes(sample, dem, posting, surface):
    """Errors of bins with ground alone, with ground and objects, and with objects alone, and the share of them within 2 sigma."""
    x = dem.values("x")
    ground, other = (per_bin(sample.points[:, :2], part.astype(float), x, posting) for part in (sample.is_ground, ~sample.is_ground))
    error = dem.values("z_est") - surface
    for name, mask in (("ground", (ground > 0) & (other == 0)), ("both", (ground > 0) & (other > 0)), ("objects", (ground == 0) & (other > 0))):
        mask = mask & np.isfinite(error)
        if mask.any():
            size = np.abs(error[mask])
            yield {"class": name, "bins": int(mask.sum()), "median_error_m": float(np.median(error[mask])), "abs_error_m": float(np.median(size)),
                   "error_95_m": float(np.quantile(size, 0.95)), "within_two_sigma": float(np.mean(size <= 2 * SIGMA_M))}


def judged(sample, dem, measure, surface, posting):
    """Counts of outcomes over the places within the hull of the ground, and the reliability of p_safe."""
    radius_m = 2 * posting
    config = {"lander": {"legs": 4, "leg_radius_m": radius_m, "pad_diameter_m": posting / 2, "body_radius_m": radius_m},
              "hole_fill_bins": HOLE_BINS, "method": measure, "limits": LIMITS, "z_sigma_m": SIGMA_M,
              "region_radius_m": 1.5 * sample.grid(posting)["half_width_m"]}
    hazards = landfall.hazards(dem, config, quiet=True)
    outcome, safe, p, truth = (hazards.values(name) for name in ("outcome", "safe", "p_safe", "safe_true"))
    within = np.isfinite(surface)
    counts = {name: int(np.sum(within & (outcome == code))) for code, name in enumerate(CLASSES)}
    above = dem.values("z_est") - surface > OBJECT_M
    reliability = []
    known = within & np.isfinite(p) & (truth < 2) & (outcome < 4)
    for low, high in zip(P_EDGES, P_EDGES[1:]):
        mine = known & (p >= low) & (p < high)
        if mine.any():
            reliability.append({"p_low": low, "places": int(mine.sum()), "mean_p": float(p[mine].mean()), "safe_frac": float(np.mean(truth[mine] == 1))})
    on_objects = within & (safe == 1) & above
    places = {"judged_safe": int(np.sum(within & (safe == 1))), "safe_on_objects": int(np.sum(on_objects)),
              "p_on_objects": float(np.nanmean(p[on_objects])) if np.isfinite(p[on_objects]).any() else None}
    brier = float(np.mean((p[known] - (truth[known] == 1))**2)) if known.any() else None
    return {"measure": measure, "counts": counts, **places, "reliability": reliability, "brier": brier}


def validate(path, postings, folder):
    sample = Sample(path, folder)
    for posting in postings:
        grid = sample.grid(posting)
        ground = landfall.grid(*sample.ground.T, config={**grid, "method": "mean"}, quiet=True)
        terrain = landfall.Terrain.from_array(ground.values("z_est").astype(float), posting)
        x = ground.values("x")
        surface = sample.surface(*np.meshgrid(x, x))
        for method in METHODS:
            dem = landfall.grid(*sample.points.T, terrain=terrain, config={**grid, "method": method}, quiet=True)
            common = {"sample": sample.name, "points": len(sample.points), "step_m": sample.step_m, "posting_m": posting, "method": method}
            errors = list(error_classes(sample, dem, posting, surface))
            for measure in MEASURES:
                result = {**common, **judged(sample, dem, measure, surface, posting), "errors": errors}
                show(result)
                yield result


def show(result):
    counts, bins = result["counts"], BODY_BINS
    missed, hazards = counts["missed hazard"], counts["missed hazard"] + counts["hazard found"]
    alarms, safe = counts["false alarm"], counts["false alarm"] + counts["safe found"]
    low, high = wilson(missed / bins, hazards / bins)
    top = [one for one in result["reliability"] if one["p_low"] >= 0.9]
    places = sum(one["places"] for one in top)
    mean = lambda key: sum(one["places"] * one[key] for one in top) / places if places else np.nan
    percent = lambda part, all_: f"{100 * part / all_:.1f}" if all_ else "-"
    print(f"| {result['sample']} | {result['posting_m']:g} | {result['method']} | {result['measure']} | {missed} of {hazards} | {percent(missed, hazards)} "
          f"({100 * low:.1f} to {100 * high:.1f}) | {percent(alarms, safe)} | {percent(counts['unknown'], sum(counts.values()))} "
          f"| {percent(result['safe_on_objects'], result['judged_safe'])} | {mean('mean_p'):.3f} | {mean('safe_frac'):.3f} |", flush=True)


def show_errors(results):
    print(f"\n| sample, posting, m | DEM | bins of | number | median error, m | 95 % of errors within, m | within 2 sigma of {SIGMA_M} m |"
          "\n|---|---|---|---|---|---|---|")
    for result in results:
        for one in result["errors"] if result["measure"] == MEASURES[0] else ():
            print(f"| {result['sample']}, {result['posting_m']:g} | {result['method']} | {one['class']} | {one['bins']:,} | {one['median_error_m']:+.2f} "
                  f"| {one['error_95_m']:.2f} | {100 * one['within_two_sigma']:.0f} % |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER", help="folder of the pairs")
    parser.add_argument("--postings", default="2,5", help="bins, metres, comma-separated")
    parser.add_argument("--samples", default="", help="numbers of the samples, comma-separated; default: all")
    parser.add_argument("--json", metavar="FILE", help="write the results as JSON")
    options = parser.parse_args()
    wanted = set(filter(None, options.samples.split(",")))
    paths = [os.path.join(options.folder, name) for name in sorted(os.listdir(options.folder)) if (found := re.fullmatch(r"isprs_samp(\d+)\.pcd", name))
             and (not wanted or found.group(1) in wanted) and os.path.exists(os.path.join(options.folder, name.replace(".pcd", "-ground.pcd")))]
    if not paths:
        raise SystemExit(f"validate_isprs.py: {options.folder}: has no pair isprs_sampNN.pcd, isprs_sampNN-ground.pcd")
    print("| sample | posting, m | DEM | method | missed | missed, % (95 %) | false alarms, % | unknown, % | safe on objects, % "
          "| p >= 0.9: mean p | truly safe |"
          "\n|---|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        results = [result for path in paths for result in validate(path, list(map(float, options.postings.split(","))), folder)]
    show_errors(results)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(results, file, indent=1)


if __name__ == "__main__":
    main()
