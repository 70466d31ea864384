#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs short cases of the whole chain by two builds of landfall, and compares every dataset outside /provenance.

    scripts/compare_processors.py [--write] FOLDER LANDFALL OTHER_LANDFALL

LANDFALL is the program `landfall` of this machine, OTHER_LANDFALL what starts that of another processor (scripts/test-arm64). This machine's
program also runs as on a processor without AVX2 and FMA. --write puts the table into docs/quality/tests.md. Exit status 1: a file differs.
"""
import glob
import json
import os
import resource
import shutil
import subprocess
import sys
from datetime import datetime, timezone

import h5py
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGE = os.path.join(ROOT, "docs", "quality", "tests.md")
NEXT_SECTION = "\n## Functions of libraries that are left"
OLD_PROCESSOR = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"}


def sets(values):
    return [word for key, value in values.items() for word in ("--set", f"{key}={json.dumps(value)}")]


def cones(radius_m, azimuth_deg):
    return {"grid": {"half_width_m": 12, "resolution_m": 0.05}, "patterns": [
        {"type": "ring", "count": 5, "radius_m": radius_m, "first_azimuth_deg": azimuth_deg, "feature": {"type": "cone", "radius_m": 2, "height_m": 6}}]}


AREA = {"half_width_m": 8, "resolution_m": 0.05}
PULSES = {"laser.scan_time_s": 0.1, "scanner.pattern": {"type": "line_search", "rows": 50, "columns": 40, "half_width_m": 8.5}}
EVAL = {"region_radius_m": 7, "limits.absolute_horizontal_frac": 0.95}
HAZARD = {"region_radius_m": 7, "sites.divert_radius_m": 6, "sites.separation_m": 2}
LINK = {"detector.subpixels": 5, "beam.divergence_rad": 3.2e-3, "surface.albedo": 0.64, "link": {"reference_pe": 500, "reference_range_m": 500},
        "receiver": {"type": "constant_fraction", "threshold_pe": 50, "timer_step_s": 5e-10, "pixel_offset_sigma_m": 0.01, "jitter_sigma_s": 1e-10}}
ROCKS = {"grid": {"half_width_m": 12, "resolution_m": 0.05}, "seed": 5,
         "base": {"type": "fractal", "hurst_exponent": 0.8, "rms_deviation_m": 0.3, "reference_length_m": 10},
         "patterns": [{"type": "golombek_rocks", "k": 0.1, "overlap": False}, {"type": "craters", "model": "trask", "min_diameter_m": 2, "max_diameter_m": 10}]}
NOISE = {"noise": {"range_sigma_m": 0.0167, "dropout_frac": 0.01, "dead_pixel_frac": 0.01}, "pointing_error": {"jitter_sigma_rad": 2e-5},
         "navigation_error.velocity_mps": [0.3, 0.3, 0.7]}
DRAWS = {"draws": 2, "regrid": AREA, "eval": {"region_radius_m": 7},
         "vary": {"scan.noise.range_bias_m": {"type": "normal", "mean": 0, "sigma": 0.01}}}
TRACED = {"draws": 2, "area": {"half_width_m": 6, "resolution_m": 0.1, "region_radius_m": 5}, "hazard": {"region_radius_m": 5},
          "terrain": {key: value for key, value in ROCKS.items() if key in ("base", "patterns")},
          "scan": {"laser": {"scan_time_s": 0.05}, "scanner": {"type": "fsm", "incidence_deg": 0, "pattern": {
              "type": "line_search", "rows": 40, "columns": 25, "half_width_m": 6.5}}, "trajectory": {
                  "type": "constant_velocity", "position_m": [0, 0, 300], "velocity_mps": [0, 0, -20]}}}
MESH = {"mesh": {"path": os.path.join(ROOT, "testdata", "meshes", "boulder.obj"), "scale_m": 0.8, "translate_m": [0.3, -0.2, 0.1],
                 "rotate_rpy_deg": [3, -7, 25]}}
DYNAMICS = {"navigation_error.attitude": "commanded", "trajectory": {
    "type": "dynamics", "position_m": [0, 0, 500], "velocity_mps": [0.4, 0.2, -24], "rpy_deg": [0.1, -0.2, 0.3], "rate_degps": [1, -2, 3],
    "inertia_products_kgm2": [5, -4, 3], "disturbance": {"torque_nm": [1, 0, -1], "torque_sigma_nm": [5, 5, 5], "seed": 3}}}
# A column of pixels in the plane x = 0, in which edges of the ground's triangles lie.
EDGES = {"detector": {"rows": 33, "columns": 1, "ifov_rad": 0.003}, "laser": {"pulse_rate_hz": 50, "scan_time_s": 0.4},
         "scanner": {"type": "fsm", "incidence_deg": 0, "pattern": {"type": "stare"}},
         "trajectory": {"type": "constant_velocity", "position_m": [0, 0.37, 50], "velocity_mps": [0, 1.3, -5]}}


def chain(name, terrain, scan, *scan_options, regrid=(), evaluate=True, hazard=()):
    """terrain-gen to hazard-map; a terrain that is a text is that of an earlier case."""
    terrain_file = terrain if isinstance(terrain, str) else f"{name}.terrain.h5"
    steps = [] if isinstance(terrain, str) else [["terrain-gen", "-o", terrain_file, *sets(terrain)]]
    steps.append(["scan-sim", "-c", scan, "--terrain", terrain_file, "-o", f"{name}.scan.h5", *scan_options])
    steps.append(["regrid", f"{name}.scan.h5", "--terrain", terrain_file, "-o", f"{name}.dem.h5", *sets(AREA), *regrid])
    if evaluate:
        steps.append(["dem-eval", f"{name}.dem.h5", "-o", f"{name}.eval.h5", "--metrics", f"{name}.metrics.json", *sets(EVAL)])
    steps += [["hazard-map", f"{name}.dem.h5", "-o", f"{name}.hazards.h5", "--sites", f"{name}.sites.json", *sets(HAZARD), *more] for more in hazard]
    return name, steps


def lidars():
    """A scan by each lidar of testdata/lidars: all kinds of scanners, detectors, trajectories and errors."""
    return [["scan-sim", "-c", path, "--terrain", "rocks.terrain.h5", "-o", f"lidar-{os.path.basename(path).removesuffix('.json')}.h5"]
            for path in sorted(glob.glob(os.path.join(ROOT, "testdata", "lidars", "*.scan.json")))]


def cases():
    study = os.path.join(ROOT, "studies")
    raster = os.path.join(ROOT, "testdata", "rasters", "relief_europa_10m.tif")
    return [
        chain("example-1", cones(6, 0), f"{study}/raster-200x200.scan.json", *sets(PULSES), hazard=[[]]),
        chain("example-2", cones(5, 11.4), "preset:paper", *sets(PULSES), regrid=["--uncertainty", "--corrected"], hazard=[[]]),
        ("example-3", [["terrain-gen", "-c", f"{study}/relief-12.5m.terrain.json", "-o", "relief.terrain.h5", *sets({"grid.half_width_m": 200})],
                       ["terrain-gen", "-o", "example-3.terrain.h5", *sets({
                           "base": {"type": "dem", "path": 'NETCDF:"relief.terrain.h5":z'}, "grid": {"half_width_m": 12, "resolution_m": 0.05}})],
                       *chain("example-3", "example-3.terrain.h5", f"{study}/raster-200x200.scan.json", *sets({**PULSES, **NOISE}), hazard=[[]])[1]]),
        chain("receiver", "example-2.terrain.h5", "preset:paper", *sets({**PULSES, **LINK}), evaluate=False),
        chain("rocks", ROCKS, "preset:paper", *sets({**PULSES, **NOISE}), regrid=["--uncertainty", "--navigation-sigma", "velocity_mps=0.3"], hazard=[[]]),
        ("methods", [["hazard-map", "rocks.terrain.h5", "-o", f"{method}.hazards.h5", *sets({**HAZARD, "method": method})]
                     for method in ("plane", "range_difference", "lmeds")]),
        ("draws", [["monte-carlo", "example-2.scan.h5", "--terrain", "example-2.terrain.h5", "-o", "draws.h5", *sets(DRAWS)],
                   ["monte-carlo", "-o", "traced.h5", *sets(TRACED)]]),
        chain("mesh", MESH, "preset:paper", *sets(PULSES), hazard=[[]]),
        ("rays along edges", [["scan-sim", "--terrain", "rocks.terrain.h5", "-o", "edges.scan.h5", *sets(EDGES)]]),
        chain("dynamics", "rocks.terrain.h5", "preset:paper", *sets({**PULSES, **DYNAMICS})),
        ("each lidar", lidars()),
        ("a raster", [["terrain-gen", "--from", raster, "-o", "raster.terrain.h5", "--half-width", "100", "--resolution", "2"]]),
    ]


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def make(program, folder, environment=None):
    """Runs all cases; returns their processor times in seconds."""
    os.makedirs(folder, exist_ok=True)
    for path in glob.glob(os.path.join(ROOT, "testdata", "lidars", "*.csv")):
        shutil.copy(path, folder)
    times = {}
    for name, steps in cases():
        begin = processor_time()
        for tool, *arguments in steps:
            result = subprocess.run([program, tool, *arguments, "-O", "-q"], cwd=folder, capture_output=True, text=True, check=False,
                                    env={**os.environ, **(environment or {})})
            if result.returncode != 0:
                sys.exit(f"compare_processors: {program} {tool} {' '.join(arguments)}\n{result.stdout}{result.stderr}")
        times[name] = processor_time() - begin
        print(f"{times[name]:8.1f} s  {program}: {name}", flush=True)
    return times


def datasets(path):
    """Name and values of every dataset outside /provenance."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()]} if isinstance(item, h5py.Dataset) and not name.startswith("provenance") else {}))
    return found


def difference(a, b):
    """Nothing for the same bytes, else how many values differ, and by how much."""
    a, b = np.asarray(a), np.asarray(b)
    if a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes():
        return None
    if a.shape != b.shape or a.dtype.kind not in "fi":
        return "other shape or text"
    unequal = (a != b) & ~(np.isnan(a) & np.isnan(b)) if a.dtype.kind == "f" else a != b
    if not unequal.any():
        return "bits of equal values"
    return f"{np.count_nonzero(unequal):,} of {a.size:,} values, by up to {np.nanmax(abs(a.astype(float) - b.astype(float))[unequal]):.2g}"


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def differences(name, folder, other):
    """How many datasets a file has, and the differences by dataset. A JSON file counts as one."""
    paths = [os.path.join(each, name) for each in (folder, other)]
    if name.endswith(".json"):
        a, b = ({"text": np.bytes_(text_of(path))} for path in paths)
    else:
        a, b = (datasets(path) for path in paths)
    found = {key: difference(a[key], b[key]) if key in a and key in b else "missing" for key in {**a, **b}}
    return len(a), {key: text for key, text in found.items() if text}


def outputs(steps):
    return sorted(value for step in steps for flag, value in zip(step, step[1:]) if flag in ("-o", "--metrics", "--sites"))


def compare(folder, other):
    """Rows (case, number of files, number of datasets, differences as text)."""
    rows = []
    for case, steps in cases():
        names = outputs(steps)
        found = {name: differences(name, folder, other) for name in names}
        text = "; ".join(f"{name} `{key}`: {how}" for name, (_, unequal) in found.items() for key, how in unequal.items())
        rows.append((case, len(names), sum(count for count, _ in found.values()), text))
    return rows


def table(old, other):
    """The rows of both comparisons, as Markdown."""
    lines = ["| case | files | datasets | x86-64 without AVX2 and FMA | arm64 |", "|---|---|---|---|---|"]
    for row, (*_, text) in zip(old, other):
        lines.append("| " + " | ".join(str(cell) for cell in (row[0], row[1], f"{row[2]:,}", row[3] or "equal", text or "equal")) + " |")
    lines.append(f"| all | {sum(row[1] for row in old)} | {sum(row[2] for row in old):,} | | |")
    return "\n".join(lines) + "\n"


def main(arguments):
    is_written = arguments[:1] == ["--write"]
    folder, program, other = (os.path.abspath(path) for path in arguments[is_written:])
    parts = [os.path.join(folder, name) for name in ("amd64", "old", "other")]
    times = [make(program, parts[0]), make(program, parts[1], OLD_PROCESSOR), make(other, parts[2])]
    rows = [compare(parts[0], part) for part in parts[1:]]
    text = table(*rows)
    print(text)
    if is_written:
        today = datetime.now(timezone.utc).date().isoformat()
        total = [sum(part.values()) for part in times]
        note = (f"\nMade on {today} by `scripts/test-arm64 --write`. The cases took {total[0]:.0f} s of processor time on x86-64 "
                f"and {total[2]:.0f} s under emulation.\n")
        with open(PAGE, encoding="utf-8") as file:
            before, after = file.read().split(NEXT_SECTION, 1)
        with open(PAGE, "w", encoding="utf-8") as file:
            file.write(before.split("\n| case |", 1)[0].rstrip() + "\n\n" + text + note + NEXT_SECTION + after)
    return 1 if any(text for part in rows for *_, text in part) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
