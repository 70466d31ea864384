#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How like real scans are their simulations, by landfall-info --compare (docs/quality/validation.md).

    bench/validate_likeness.py [--qi FILE.qi]... [--riegl FOLDER] [--json FILE]

QFIT: the pulses of revolutions 1, 3, 5 ... that validate_atm.py predicts, at the measured heights. RIEGL: the first returns of a full-waveform scan, FOLDER/
riegl_fwf_2535pt_UTM.las and .pls, and its pulses, from their recorded origins and directions, onto a raster of its last returns. Each simulation is
made also with 2 mrad of mount error about an axis across the beam, which the estimates do not know. RIEGL's echoes have widths, which a receiver that sees
pulses of 4.51 ns (docs/quality/real-scan.md) simulates.
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
from oracle.flight import angles_of
from oracle.riegl import NAME, Pulses, Returns

MOUNT_ERROR_RAD = 0.002
PULSE_FWHM_S, DIVERGENCE_RAD = 4.51e-9, 0.0005
RASTER_M = 0.25


def statistics(folder, time, clouds):
    """{name of a simulation: statistics of it and the real scan} of {name: points (n, 3), and the widths of echoes where known}, of which "real" is the
    scan."""
    for name, points in clouds.items():
        path = os.path.join(folder, name.replace(" ", "_"))
        columns = ["t", "x", "y", "z", "echo_width"][:1 + points.shape[1]]
        np.savetxt(path + ".csv", np.column_stack([time, points]), delimiter=",", header=",".join(columns), comments="", fmt="%.9f")
        landfall.run("landfall-import", None, path + ".csv", output=path + ".h5", overwrite=True, quiet=True, center=[0, 0, 0],
                     **({"columns": "echo_width=echo_width"} if points.shape[1] > 3 else {}))
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
        """Places of the hits as the recorded beams say, of beams that are turned about the second axis, and the widths of their echoes."""
        axes = np.stack([side, np.cross(beams, side), beams], -1)
        attitude = Rotation.from_matrix(axes) * Rotation.from_rotvec([0, error, 0])
        ranges = lidar.pulses(np.arange(len(beams)), origins, np.roll(attitude.as_quat(), 1, axis=1))["range_true_m"][:, 0]
        return np.column_stack([origins + beams * ranges[:, None], echo_widths(attitude.as_matrix())])

    def echo_widths(attitudes):
        """Those of a scan along the recorded pulses, one after another; NaN without an echo."""
        flight = os.path.join(folder, "pulses.csv")
        np.savetxt(flight, np.column_stack([np.arange(len(beams)) / 1e5, origins, angles_of(attitudes)]), delimiter=",", comments="", fmt="%.12g",
                   header="t_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg")
        config = {"detector": {"rows": 1, "columns": 1, "subpixels": 9, "ifov_rad": 2 * DIVERGENCE_RAD}, "scanner": {"type": "flash"},
                  "laser": {"pulse_rate_hz": 1e5, "scan_time_s": len(beams) / 1e5}, "mount": {"position_m": [0, 0, 0], "rpy_deg": [0, 0, 0]},
                  "beam": {"profile": "gaussian", "divergence_rad": DIVERGENCE_RAD}, "link": {"reference_pe": 1000, "reference_range_m": 500},
                  "receiver": {"type": "peak", "pulse_fwhm_s": PULSE_FWHM_S}, "trajectory": {"type": "table", "path": flight}}
        return landfall.scan(config, terrain, keep_misses=True, keep_echoes=True)["echo_width"]

    near = np.abs(returns.places[first, 2] - origin[2] - np.median(ground[:, 2])) < 50
    real = landfall.run("landfall-import", None, os.path.join(data, NAME + ".las"), output=os.path.join(folder, "las.h5"), overwrite=True, quiet=True)
    clouds = {"real": np.column_stack([returns.places[first] - origin, real["echo_width"][first]]), "simulated": simulated(0),
              "2 mrad": simulated(MOUNT_ERROR_RAD)}
    near &= np.all([np.isfinite(points[:, :3]).all(1) for points in clouds.values()], 0)
    return statistics(folder, returns.table["t"][first][near] - returns.table["t"].min(), {name: points[near] for name, points in clouds.items()})


def show(title, found):
    returns = next(iter(found.values()))["returns"]["a"]
    print(f"{title}: {returns} returns, bins of {next(iter(found.values()))['posting_m']} m; * beyond chance")
    print(f"  {'':18}" + "".join(f"{name:>12}" for name in found))
    for n, row in enumerate(next(iter(found.values()))["statistics"]):
        values = [one["statistics"][n] for one in found.values()]
        print(f"  {row['name']:18}" + "".join(f"{'-' if v['distance'] is None else format(v['distance'], '.3g'):>11}{'*' if v['differs'] else ' '}"
                                              for v in values))
    print(f"  {'surface.shift_m':18}" + "".join(f"{np.hypot(*one['surface']['shift_m']):>11.3g} " for one in found.values()))


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
