# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case through the four tools and compares every column, layer and number with those of this package."""
import contextlib
import json
import os
import subprocess

import h5py
import numpy as np

from harness import columns, config_of, read_bytes, without_warnings, write_file
from oracle import evaluate, regrid, scan, surface, terrain
from oracle.frames import matrix_of_quaternion, roll_pitch_yaw

BIN = os.path.abspath(os.environ["LANDFALL_BIN"])
SINGLE = 6e-8  # relative rounding error of single precision


def run(tool, *arguments):
    result = subprocess.run([os.path.join(BIN, tool), "-t", "1", *map(str, arguments)],
                            capture_output=True, text=True, timeout=120)
    if result.returncode or without_warnings(tool, result.stderr):
        raise AssertionError(f"{tool} {arguments}: exit {result.returncode}: {result.stderr}")


def write_json(name, config):
    return write_file(name, json.dumps(config))


def run_chain(case):
    """Writes terrain.h5, scan.h5, dem.h5, eval.h5 and metrics.json to the working folder."""
    flag = lambda name: ["--" + name.replace("_", "-")] if case["options"][name] else []
    run("terrain-gen", "-O", "-c", write_json("terrain.json", case["terrain"]), "-o", "terrain.h5")
    if case.get("albedo"):
        surface.paint("terrain.h5", **case["albedo"])
    run("scan-sim", "-O", "-c", write_json("scan.json", case["scan"]), "--terrain", "terrain.h5", "-o", "scan.h5",
        *flag("keep_misses"), *flag("float32"))
    truth = ["--terrain", "terrain.h5"] if case["options"]["truth"] else []
    run("regrid", "-O", "scan.h5", "-c", write_json("regrid.json", case["regrid"]), "-o", "dem.h5", *truth,
        *flag("uncertainty"), *flag("corrected"))
    run("dem-eval", "-O", "dem.h5", "-c", write_json("eval.json", case["eval"]), "-o", "eval.h5", "--metrics", "metrics.json")


def holds(resolved, given):
    """True if the resolved configuration has all keys and values that were given."""
    if isinstance(given, dict):
        return all(key in resolved and holds(resolved[key], value) for key, value in given.items())
    if isinstance(given, list):
        return len(resolved) == len(given) and all(map(holds, resolved, given))
    return resolved == given


def check(case, ledger):
    """Compares the files of run_chain(). Each stage starts from the files of the previous one."""
    for name, path in (("terrain", "terrain.h5"), ("scan", "scan.h5"), ("regrid", "dem.h5"), ("eval", "eval.h5")):
        ledger.equal("resolved configuration", [holds(config_of(path), case[name])], [True])
    with np.errstate(divide="ignore", invalid="ignore"):
        check_terrain(case, ledger)
        ground = surface.of_file("terrain.h5")
        check_scan(case, ledger, ground)
        check_dem(case, ledger, ground if case["options"]["truth"] else None)
        check_evaluation(case, ledger)


# terrain.h5

def check_terrain(case, ledger):
    config = case["terrain"]
    if "mesh" in config:
        return check_mesh(config["mesh"], ledger)
    if not terrain.is_known(config):
        return
    resolved = config_of("terrain.h5")
    ledger.close("terrain: x, y", columns("terrain.h5")["x"], terrain.axis(config), 1e-12)
    ledger.close("terrain: z", columns("terrain.h5")["z"], terrain.elevations({**config, "base": resolved["base"]}), 1e-9)


def check_mesh(config, ledger):
    with open(config["path"], encoding="utf-8") as file:
        lines = [line.split() for line in file]
    vertices = np.array([line[1:] for line in lines if line[0] == "v"], float)
    turn = roll_pitch_yaw(np.radians(config["rotate_rpy_deg"]))
    mesh = columns("terrain.h5", "mesh")
    ledger.close("terrain: mesh vertices", mesh["vertices"],
                 (config["scale_m"] * vertices) @ turn.T + config["translate_m"], 1e-9)
    ledger.equal("terrain: mesh triangles", mesh["triangles"],
                 np.array([line[1:] for line in lines if line[0] == "f"], int) - 1)


# scan.h5

POINTS = ["range_true", "range_measured", "x_true", "y_true", "z_true", "x_est", "y_est", "z_est"]


def check_scan(case, ledger, ground):
    config = config_of("scan.h5")
    expected, made, optics = scan.columns(config, ground, surface.albedo("terrain.h5"))
    is_rigid_body = config["trajectory"]["type"] == "dynamics"
    suffix, bound = (" (dynamics)", 1e-8) if is_rigid_body else ("", 1e-9)
    relative = SINGLE if case["options"]["float32"] else 0
    kept = expected["exists"]
    if not case["options"]["keep_misses"]:
        kept = kept & np.isin(expected["status"], (scan.RETURN, scan.FALSE_RETURN))
    points = columns("scan.h5", "points")
    type_of_receiver = config["receiver"]["type"]
    columns_of_receiver = optional_columns(config)
    ledger.equal("points: columns", [sorted(points)], [sorted(["pulse", "pixel", "status", *POINTS, *columns_of_receiver])])
    for name in ("pulse", "pixel", "status", *[name for name in columns_of_receiver if name == "return_number"]):
        ledger.equal(f"points: {name}", points[name], expected[name][kept], expected["doubtful"][kept])
    for name in POINTS if len(points["status"]) == kept.sum() else ():
        ledger.close(f"points: {name}" + suffix + (" (float32)" if relative else ""), points[name], expected[name][kept],
                     bound, relative, expected["doubtful" if name.endswith("true") else "doubtful_estimate"][kept])
    if "intensity" in columns_of_receiver and len(points["status"]) == kept.sum():
        ledger.close("points: intensity", points["intensity"], expected["intensity"][kept], 0, SINGLE,
                     expected["doubtful"][kept])
        single = ", float32" if relative else ""
        ledger.close(f"points: range_measured ({type_of_receiver}{single})", points["range_measured"],
                     expected["range_measured"][kept], bound, relative, expected["doubtful_estimate"][kept])
    check_pulses(ledger, made, np.bincount(expected["pulse"][kept], minlength=len(made.k)), suffix)
    check_counts(ledger, expected["status"][expected["exists"]])
    detector = columns("scan.h5", "detector")
    ledger.equal("detector: dead", detector["dead"], optics["dead"])
    for axis in "xyz":
        ledger.close("detector: direction_*", detector[f"direction_{axis}"], optics[f"direction_{axis}"], 1e-12)


def check_pulses(ledger, made, counts, suffix):
    pulses = columns("scan.h5", "pulses")
    ledger.close("pulses: t", pulses["t"], made.t, 1e-12)
    for n in (0, 1):
        angle = pulses[f"angle_{n + 1}"]
        whole = 2 * np.pi * np.rint((angle - made.true_angles[:, n]) / (2 * np.pi))
        resting = np.isnan(made.true_angles[:, n])  # pulses without an aim
        ledger.close("pulses: angle_1, angle_2" + suffix, angle[~resting],
                     (made.true_angles[:, n] + np.nan_to_num(whole))[~resting], 1e-9)
    for side, (p, turn) in (("true", made.true_pose), ("est", made.estimated_pose)):
        for n, axis in enumerate("xyz"):
            ledger.close(f"pulses: p*_{side}" + suffix, pulses[f"p{axis}_{side}"], p[:, n], 1e-9)
        q = np.stack([pulses[f"q{part}_{side}"] for part in "wxyz"], -1)
        ledger.close(f"pulses: q*_{side}, as matrices" + suffix, matrix_of_quaternion(q), turn, 1e-10 if suffix else 1e-12)
        ledger.equal("pulses: qw >= 0", q[:, 0] >= 0, np.ones(len(q), bool))
    ledger.equal("pulses: point_count", pulses["point_count"], counts)
    ledger.equal("pulses: point_begin", pulses["point_begin"], np.cumsum(counts) - counts)


def optional_columns(config):
    if config["receiver"]["type"] == "none":
        return []
    return ["intensity", "return_number"] if config["receiver"]["returns"] == "all" and config["receiver"]["max_returns"] > 1 else (
        ["intensity"])


def check_counts(ledger, status):
    with h5py.File("scan.h5") as file:
        counted = [(0, "return"), (1, "miss"), (2, "dropout"), (3, "dead"), (6, "false_return")]
        if "intensity" in file["points"]:
            counted.append((7, "undetected"))
        for code, name in counted:
            ledger.equal("points: counts", [file["points"].attrs[f"{name}_count"]], [(status == code).sum()])


# dem.h5

DOUBLE = ["z_est", "weight_sum", "x_true", "y_true", "t_mean"]
FLOATS = ["x_est_mean", "y_est_mean"]
SIGMAS = ["z_sigma_abs", "z_sigma_rel", "z_sigma_noise", "z_corrected_sigma_abs", "z_corrected_sigma_rel", "xy_sigma"]


def returns(path):
    points, pulses = columns(path, "points"), columns(path, "pulses")
    kept = np.isin(points["status"], (scan.RETURN, scan.FALSE_RETURN))
    points = {name: values[kept].astype(float) for name, values in points.items()}
    points["t"] = pulses["t"][points["pulse"].astype(int)]
    return points, pulses


def check_dem(case, ledger, ground, scans=("scan.h5",)):
    config = config_of("dem.h5")
    parts = [returns(path) for path in scans]
    points, pulses = {name: np.concatenate([part[name] for part, _ in parts]) for name in parts[0][0]}, parts[0][1]
    epoch = min(pulses["t"][0] for _, pulses in parts)
    with h5py.File("dem.h5") as file:
        ledger.equal("dem: epoch_s", [file["t_mean"].attrs["epoch_s"]], [epoch])
    points["t"], pulses["t"] = points["t"] - epoch, pulses["t"] - epoch
    bins = regrid.Bins(points, config)
    expected, dem = bins.layers(ground), columns("dem.h5")
    of = f" ({config['method']})"
    ledger.equal("dem: count" + of, dem["count"], expected["count"], bins.doubtful)
    for name in DOUBLE:
        ledger.close(f"dem: {name}" + of, dem[name], expected[name], 1e-9, doubtful=bins.doubtful)
    for name in FLOATS:
        ledger.close(f"dem: {name}", dem[name], expected[name], 1e-9, SINGLE, bins.doubtful)
    ledger.close("dem: z_spread", dem["z_spread"], expected["z_spread"], 1e-6, 1e-6, bins.doubtful)
    if ground is not None:
        ledger.close("dem: z_true" + of, dem["z_true"], expected["z_true"], 1e-9,
                     doubtful=bins.doubtful | at_border(ground, *bins.true_positions(expected)))
    if case["options"]["uncertainty"] or case["options"]["corrected"]:
        check_uncertainty(case, ledger, ground, bins, expected, pulses)
    ledger.equal("dem: layers", sorted(set(dem) - {"x", "y"}), wanted_layers(case))


def wanted_layers(case):
    options = case["options"]
    names = [*DOUBLE, *FLOATS, "z_spread", "count"] + (["z_true"] if options["truth"] else [])
    if options["uncertainty"]:
        names += ["z_sigma_abs", "z_sigma_rel", "z_sigma_noise", "xy_sigma"] + (["z_true_map"] if options["truth"] else [])
    if options["corrected"]:
        names += ["z_corrected"]
    if options["corrected"] and options["uncertainty"]:
        names += ["z_corrected_sigma_abs", "z_corrected_sigma_rel"]
    return sorted(names)


def at_border(ground, x, y):
    """Points within 1e-9 m of the border of the terrain, the border of a hole, or a jump of a mesh's elevation."""
    around = np.array([ground.elevation(x + dx, y + dy) for dx in (-1e-9, 1e-9) for dy in (-1e-9, 1e-9)])
    return (np.isnan(around).any(0) & ~np.isnan(around).all(0)) | (np.ptp(around, axis=0) > 1e-6)


def check_uncertainty(case, ledger, ground, bins, expected, pulses):
    given = case["regrid"]["uncertainty"]
    sigmas = {"range_sigma_m": given["range_sigma_m"], **given["navigation_sigma"]}
    model = regrid.Uncertainty(bins, expected, pulses, sigmas)
    made, dem = model.made(), columns("dem.h5")
    shaky = bins.doubtful | model.doubtful()
    for name in SIGMAS + ["z_corrected"]:
        if name in dem:
            ledger.close(f"dem: {name}", dem[name], made[name], 5e-6, SINGLE if name == "z_corrected" else 2e-5, shaky)
    if "z_true_map" in dem:
        under = np.where(expected["count"] > 0, ground.elevation(bins.x, bins.y), np.nan)
        ledger.close("dem: z_true_map", dem["z_true_map"], under, 1e-9, SINGLE, at_border(ground, bins.x, bins.y))


# eval.h5 and metrics.json

def node_spacing(terrain):
    """None for a mesh and for planes alone."""
    bases = terrain.get("base", [])
    is_plane = all(base["type"] == "plane" for base in (bases if isinstance(bases, list) else [bases]))
    is_exact = "mesh" in terrain or (is_plane and not terrain.get("features") and not terrain.get("patterns"))
    return None if is_exact else terrain["grid"]["resolution_m"]


def check_evaluation(case, ledger):
    config, dem, found = config_of("eval.h5"), columns("dem.h5"), columns("eval.h5")
    mask = columns("mask.h5")["inside"] if config["region"]["shape"] == "mask" else None
    made = evaluate.Evaluation(dem, config, mask, node_spacing(config_of("terrain.h5")))
    doubtful, expected = made.doubtful(), made.layers()
    for name in ("in_region", "invalid", "hole_id"):
        ledger.equal(f"eval: {name}", found[name], expected[name])
    ledger.equal("eval: fail", found["fail"], expected["fail"], doubtful)
    ledger.equal("eval: distance_to_valid", np.nan_to_num(found["distance_to_valid"], nan=-1),
                 np.nan_to_num(finite(expected["distance_to_valid"]), nan=-1).astype(np.float32))
    for axis in "xyz" if made.has_truth else ():
        ledger.close("eval: e_*", found[f"e_{axis}"], expected[f"e_{axis}"], 1e-12)
        for part in ("abs", "rel"):
            ledger.close(f"eval: {part}_*", found[f"{part}_{axis}"], expected[f"{part}_{axis}"], 1e-9, SINGLE)
    ledger.equal("eval: layers", sorted(set(found) - {"x", "y"}), sorted(expected))
    check_holes(ledger, made)
    check_metrics(ledger, made, dem, bool(doubtful.any()))


def check_holes(ledger, made):
    holes = columns("eval.h5", "holes")
    for name, values in made.hole_table().items():
        if values.dtype.kind in "iu":
            ledger.equal(f"holes: {name}", holes[name], values)
        else:
            ledger.close(f"holes: {name}", holes[name], finite(values), 1e-9)


def finite(distances):
    """As files hold them: NaN where the DEM has no valid bin."""
    return np.where(np.isinf(distances), np.nan, distances)


def check_metrics(ledger, made, dem, doubtful):
    metrics = json.loads(read_bytes("metrics.json"))
    with h5py.File("eval.h5") as file:
        ledger.equal("metrics: text in eval.h5", [json.loads(file["metrics_json"].asstr()[()])], [metrics])
    compare_metrics(ledger, metrics, expected_metrics(made, dem), doubtful)


def expected_metrics(made, dem):
    has_sigmas = {"z_true_map", "z_sigma_abs", "z_sigma_rel"} <= set(dem)
    return {"format": "landfall.metrics", "version": 2, **made.metrics(),
            "uncertainty": made.uncertainty() if has_sigmas else None}


def compare_metrics(ledger, metrics, expected, doubtful=False):
    ledger.equal("metrics: keys", sorted(metrics), sorted(expected))
    for key, value in expected.items():
        ledger.nested(f"metrics: {key}", metrics.get(key), value, 1e-9, 1e-12, doubtful)


@contextlib.contextmanager
def inside(folder):
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)
