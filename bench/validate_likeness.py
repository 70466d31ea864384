#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How like real scans are their simulations, by landfall-info --compare (docs/quality/validation.md).

    bench/validate_likeness.py [--qi FILE.qi]... [--riegl FOLDER] [--json FILE]

QFIT: the pulses of revolutions 1, 3, 5 ... that validate_atm.py predicts, at the measured heights. RIEGL: the first returns of a full-waveform scan, FOLDER/
riegl_fwf_2535pt_UTM.las and .pls, and its pulses, from their recorded origins and directions, onto a raster of its last returns. Each simulation is
made also with 2 mrad of mount error about an axis across the beam, which the estimates do not know.
"""
import argparse
import json
import os
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.path[:0] = [os.path.join(ROOT, "python"), os.path.join(ROOT, "tests"), os.path.join(ROOT, "bench")]
# pylint: disable=wrong-import-position
import numpy as np
from scipy.interpolate import griddata
from scipy.spatial.transform import Rotation

import landfall
import validate_atm
from oracle.riegl import Pulses, Returns

MOUNT_ERROR_RAD = 0.002
RASTER_M = 0.25


def statistics(folder, time, clouds):
    """{name of a simulation: statistics of it and the real scan} of {name: points (n, 3)}, of which "real" is the scan."""
    for name, points in clouds.items():
        path = os.path.join(folder, name.replace(" ", "_"))
        np.savetxt(path + ".csv", np.column_stack([time, points]), delimiter=",", header="t,x,y,z", comments="", fmt="%.9f")
        landfall.run("landfall-import", None, path + ".csv", output=path + ".h5", overwrite=True, quiet=True, center=[0, 0, 0])
    real = os.path.join(folder, "real.h5")
    compare = lambda name: json.loads(landfall.run("landfall-info", None, real, os.path.join(folder, name.replace(" ", "_") + ".h5"), compare=True, json=True))
    return {name: compare(name)["likeness"] for name in clouds if name != "real"}


def conical(path, folder):
    shots = validate_atm.Shots(path, folder)
    q, _, sense = validate_atm.fit(shots)
    odd = shots.revolution % 2 == 1
    wrong = q + MOUNT_ERROR_RAD * (np.array(validate_atm.NAMES) == "roll_rad")
    return statistics(folder, shots.time[odd], {"real": shots.points[odd], "simulated": validate_atm.simulated(q, shots, sense, odd),
                                                "2 mrad": validate_atm.simulated(wrong, shots, sense, odd)})


def waveforms(data, folder):
    returns, pulses = Returns(data), Pulses(data)
    number, count = returns.table["returns"] & 15, returns.table["returns"] >> 4
    first = np.flatnonzero(number == 1)
    first = first[np.argsort(returns.table["t"][first], kind="stable")]
    order = np.argsort(pulses.table["t"], kind="stable")
    nearest = order[np.abs(pulses.table["t"][order] * 1e-6 - returns.table["t"][first][:, None]).argmin(1)]
    origin = np.round(returns.places.mean(0))
    ground = returns.places[number == count] - origin
    ground = ground[np.abs(ground[:, 2] - np.median(ground[:, 2])) < 50]  # without a bird
    steps = np.arange(-20, 20 + RASTER_M / 2, RASTER_M)
    x, y = np.meshgrid(steps, steps)
    z = [griddata(ground[:, :2], ground[:, 2], (x, y), method) for method in ("linear", "nearest")]
    terrain = landfall.Terrain.from_array(np.where(np.isnan(z[0]), z[1], z[0]), RASTER_M)
    lidar = landfall.Lidar({"detector": {"rows": 1, "columns": 1}, "laser": {"pulse_rate_hz": 100000, "scan_time_s": 1}, "scanner": {"type": "flash"},
                            "mount": {"position_m": [0, 0, 0], "rpy_deg": [0, 0, 0]}}, terrain)
    beams = pulses.steps[nearest] / np.linalg.norm(pulses.steps[nearest], axis=1)[:, None]
    origins = pulses.anchors[nearest] - origin
    side = np.cross(beams, [0, 1, 0])
    side /= np.linalg.norm(side, axis=1)[:, None]

    def simulated(error):
        """Places of the hits as the recorded beams say, of beams that are turned about the second axis."""
        axes = np.stack([side, np.cross(beams, side), beams], -1)
        attitude = np.roll((Rotation.from_matrix(axes) * Rotation.from_rotvec([0, error, 0])).as_quat(), 1, axis=1)
        ranges = lidar.pulses(np.arange(len(beams)), origins, attitude)["range_true_m"][:, 0]
        return origins + beams * ranges[:, None]

    near = np.abs(returns.places[first, 2] - origin[2] - np.median(ground[:, 2])) < 50
    clouds = {"real": returns.places[first] - origin, "simulated": simulated(0), "2 mrad": simulated(MOUNT_ERROR_RAD)}
    near &= np.all([np.isfinite(points).all(1) for points in clouds.values()], 0)
    return statistics(folder, returns.table["t"][first][near] - returns.table["t"].min(), {name: points[near] for name, points in clouds.items()})


def show(title, found):
    returns = next(iter(found.values()))["returns"]["a"]
    print(f"{title}: {returns} returns, bins of {next(iter(found.values()))['posting_m']} m; * beyond chance")
    print(f"  {'':18}" + "".join(f"{name:>12}" for name in found))
    for n, row in enumerate(next(iter(found.values()))["statistics"]):
        values = [one["statistics"][n] for one in found.values()]
        print(f"  {row['name']:18}" + "".join(f"{'-' if v['distance'] is None else format(v['distance'], '.3g'):>11}{'*' if v['differs'] else ' '}"
                                              for v in values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--qi", action="append", default=[], metavar="FILE.qi", help="a QFIT file; may be given several times")
    parser.add_argument("--riegl", metavar="FOLDER", help="the folder of the RIEGL files")
    parser.add_argument("--json", metavar="FILE", help="write the results as JSON")
    options = parser.parse_args()
    results = {}
    with tempfile.TemporaryDirectory() as folder:
        for path in options.qi:
            results[os.path.basename(path)] = conical(path, folder)
        if options.riegl:
            results["RIEGL"] = waveforms(options.riegl, folder)
    for title, found in results.items():
        show(title, found)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(results, file, indent=1)


if __name__ == "__main__":
    main()
