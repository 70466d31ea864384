#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A real conical scan through landfall's scanner `palmer`: NASA's Airborne Topographic Mapper (docs/quality/validation.md).

    bench/validate_atm.py FILE.qi... [--seconds 0.5] [--json FILE]

QFIT has time, position, scan azimuth, pitch and roll of each pulse, but neither range nor trajectory. Thirteen numbers are fitted to the pulses of
revolutions 0, 2, 4 ...: position and velocity of the aircraft, its heading and turn, roll and pitch of the mount, tilt and incidence of the mirror, zero of the
azimuth. landfall.Lidar then simulates the pulses of revolutions 1, 3, 5 ... from their recorded azimuths. A beam is compared with its point at the
height of the point, since heights are measured and ranges are not in the file. The motor's turn is the clock: time stamps are whole milliseconds. Of a
longer file the first half second is used, during which the aircraft neither accelerates nor changes its turn by much.
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
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

import landfall

NAMES = ("x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "heading_rad", "roll_rad", "pitch_rad", "tilt_rad", "incidence_rad", "zero_rad",
         "heading_rate_radps")
SCALES = np.array([10, 10, 100, 10, 10, 1, 0.1, 0.01, 0.01, 0.01, 0.01, 0.1, 0.1])
DOWN = Rotation.from_matrix(np.diag([1.0, -1, -1]))  # x_L forward, y_L right, z_L down
# Causes of residuals: the effect of a change of each number on the ground points is fitted to those of the second half.
CAUSES = {"mount roll": "roll_rad", "mount pitch": "pitch_rad", "heading": "heading_rad", "turn": "heading_rate_radps", "mirror tilt": "tilt_rad",
          "incidence": "incidence_rad", "azimuth zero": "zero_rad"}


class Shots:
    """The shots of a QFIT file that have a position: words as stored, and landfall-import's points."""

    def __init__(self, path, folder, seconds=0.5):
        with open(path, "rb") as file:
            data = file.read()
        order = next((o for o in "><" if int(np.frombuffer(data, o + "i4", 1)[0]) in (40, 48, 56)), None)
        if order is None:
            raise SystemExit(f"validate_atm.py: {path}: is not QFIT: its first word is not 40, 48 or 56 in either byte order")
        whole = data[:len(data) // 4 * 4]
        count = int(np.frombuffer(data, order + "i4", 1)[0]) // 4
        words = np.frombuffer(whole, order + "i4")
        header, shots = words[count + 1], words[words[count + 1] // 4:]
        shots = shots[:len(shots) // count * count].reshape(-1, count).astype(float)
        shots = shots[(shots[:, 0] >= 0) & shots[:, 1:4].any(1)]
        self.calibration = calibration_of(data[:header], count * 4)
        imported = os.path.join(folder, "points.h5")
        landfall.run("landfall-import", None, path, output=imported, overwrite=True)
        with h5py.File(imported) as file:
            self.points = np.stack([file[f"points/{axis}_est"][()] for axis in "xyz"], -1)
        if len(self.points) != len(shots):
            raise SystemExit(f"validate_atm.py: {path}: landfall-import has {len(self.points)} points of {len(shots)} shots")
        first = shots[:, 0] - shots[0, 0] < 1000 * seconds
        shots, self.points = shots[first], self.points[first]
        self.azimuth, self.pitch, self.roll = (np.unwrap(np.radians(shots[:, n] / 1000)) for n in (6, 7, 8))
        self.step_m = np.radians(1e-6) * 6371000 * np.array([np.cos(np.radians(np.median(shots[:, 1]) / 1e6)), 1])
        slope, start = np.polyfit(self.azimuth, shots[:, 0] / 1000, 1)
        self.time = start + slope * self.azimuth
        self.rate_hz = 1 / (2 * np.pi * abs(slope))
        self.pulse_rate_hz = round(1 / np.median(np.abs(np.diff(self.azimuth)) * abs(slope)))
        self.stamp_error_s = np.std(shots[:, 0] / 1000 - self.time)
        self.time -= self.time.mean()
        self.revolution = np.floor(np.abs(self.azimuth - self.azimuth[0]) / (2 * np.pi)).astype(int)


def calibration_of(header, length):
    """The line of the header in which NASA's program qfit got angles of scanner and mount, by name; {} without one."""
    text = b"".join(header[n + 4:n + length] for n in range(length, len(header), length)).replace(b"\0", b"").decode("latin1")
    line = re.search(r"^([-+.\d ]+)/ *nadang,pitmb,rolmb,rng bias,scan,hdg mb,beta", text, re.M)
    return dict(zip(("nadang", "pitmb", "rolmb", "range_bias", "scan", "hdgmb", "beta"), map(float, line.group(1).split()))) if line else {}


def header_angles(shots):
    """The same angles by NASA's calibration, degrees. The program qfit turns by the heading bias between the recorded angles and the mount's, and counts
    the roll bias from a motor axis at 45 deg."""
    c = shots.calibration
    if not c:
        return {}
    pitch, roll = np.degrees([shots.pitch.mean(), shots.roll.mean()])
    turn = np.radians(c["hdgmb"])
    return {"tilt_rad": c["nadang"], "incidence_rad": c["beta"], "roll_rad": c["rolmb"] + c["beta"] - 45 + turn * pitch, "pitch_rad": turn * roll - c["pitmb"]}


def palmer(phi, tilt, incidence):
    """Directions in L of the boresight: scanner-palmer.md, for the fit; landfall simulates the second half."""
    incoming = np.array([0, -np.sin(2 * incidence), -np.cos(2 * incidence)])
    resting = np.array([0, 0, 1]) - incoming
    resting = resting / np.linalg.norm(resting)
    tilted = Rotation.from_rotvec([tilt, 0, 0]).apply(resting)
    normal = Rotation.from_rotvec(phi[:, None] * resting).apply(tilted)
    return incoming - 2 * normal * (normal @ incoming)[:, None]


def poses(q, shots):
    """Positions and rotations D <- L of the shots."""
    position = q[:3] + q[3:6] * shots.time[:, None]
    angles = np.stack([q[6] + q[12] * shots.time, -shots.pitch, shots.roll], -1)
    body = Rotation.from_euler("ZYX", angles)
    return position, body, Rotation.from_euler("ZYX", [0, q[8], q[7]]) * DOWN


def predicted(q, shots, sign):
    """Points of the beams at the heights of the measured points."""
    position, body, mount = poses(q, shots)
    beam = (body * mount).apply(palmer(sign * shots.azimuth + q[11], q[9], q[10]))
    return position + beam * ((shots.points[:, 2] - position[:, 2]) / beam[:, 2])[:, None]


def starting_points(shots, chosen):
    """Numbers of the fit, and the sense of rotation, for several mirrors and zeros of the azimuth: an ellipse in motion is fitted first."""
    columns = np.stack([np.ones(len(shots.time)), shots.time, np.cos(shots.azimuth), np.sin(shots.azimuth)], -1)
    centre, velocity, along, side = np.linalg.lstsq(columns[chosen], shots.points[chosen, :2], rcond=None)[0]
    sense = 1 if along[0] * side[1] - along[1] * side[0] < 0 else -1  # clockwise from above, as seen by L: positive
    for tilt in np.radians([7.5, 11]):
        height = np.sqrt(np.hypot(*along) * np.hypot(*side)) / np.tan(1.7 * tilt) + np.median(shots.points[:, 2])
        for zero in np.radians([180, 0, 90, 270]):
            heading = np.arctan2(along[1], along[0]) + sense * (zero - np.pi / 2)
            yield np.array([*centre, height, *velocity, 0, heading, 0, 0, tilt, np.radians(45), zero, 0]), sense


def fit(shots):
    """The numbers, their standard errors, and the sense of rotation, from even revolutions."""
    chosen = shots.revolution % 2 == 0
    few = chosen & (np.arange(len(chosen)) % max(1, len(chosen) // 200) == 0)

    def solve(start, sense, part, **limits):
        return least_squares(lambda q: (predicted(q, shots, sense) - shots.points)[part, :2].ravel(), start, x_scale=SCALES,
                             bounds=([-np.inf] * 9 + [0.001, 0] + [-np.inf] * 2, [np.inf] * 9 + [0.5, 1.2] + [np.inf] * 2), **limits)

    tried = [(solve(start, sense, few, max_nfev=40), sense) for start, sense in starting_points(shots, chosen)]
    best, sense = min(tried, key=lambda one: one[0].cost)
    best = solve(best.x, sense, chosen)
    variance = 2 * best.cost / (len(best.fun) - len(best.x))
    return best.x, np.sqrt(variance * np.diag(np.linalg.pinv(best.jac.T @ best.jac))), sense


def simulated(q, shots, sense, chosen):
    """The points of landfall's beams, pulse by pulse, on level ground at the height of each measured point."""
    position, body, mount = poses(q, shots)
    roll, pitch, yaw = Rotation.as_euler(mount, "xyz", degrees=True)
    level = [0.0]
    lidar = landfall.Lidar({"detector": {"rows": 1, "columns": 1}, "laser": {"pulse_rate_hz": shots.pulse_rate_hz, "scan_time_s": 1000},
                            "mount": {"rpy_deg": [roll, pitch, yaw]},
                            "scanner": {"type": "palmer", "tilt_deg": np.degrees(q[9]), "incidence_deg": np.degrees(q[10]), "rate_hz": shots.rate_hz}},
                           lambda origins, directions: (level[0] - origins[:, 2]) / directions[:, 2], threads=1)
    motor = (sense * shots.azimuth + q[11]) / (2 * np.pi) % 1 / shots.rate_hz  # the time at which the motor has this angle
    points = []
    for n in np.flatnonzero(chosen):
        level[0] = shots.points[n, 2]
        points.append(lidar.pulse(int(n), position[n], np.roll(body[n].as_quat(), 1), t_s=motor[n])["true_m"][0])
    return np.array(points)


def residuals(q, shots, points, chosen):
    """Measured less predicted along and across the track, metres, and of the unit vectors of the beams, mrad."""
    track = q[3:5] / np.hypot(*q[3:5])
    axes = np.array([track, [-track[1], track[0]]])
    position = poses(q, shots)[0][chosen]
    unit = lambda p: (p - position) / np.linalg.norm(p - position, axis=1)[:, None]
    measured = shots.points[chosen]
    return (measured - points)[:, :2] @ axes.T, (unit(measured) - unit(points))[:, :2] @ axes.T * 1000


def causes(q, shots, sense, chosen, error):
    """Each alone, the change of a number that explains most of the residuals: value, standard error, share of the variance."""
    track = q[3:5] / np.hypot(*q[3:5])
    axes = np.array([track, [-track[1], track[0]]])

    def effect(change):
        return ((predicted(q + change, shots, sense) - predicted(q - change, shots, sense))[chosen, :2] @ axes.T).ravel() / 2

    def shot_effects():
        for name, key in CAUSES.items():
            yield name, "mrad/s" if name == "turn" else "mrad", effect((np.array(NAMES) == key) * 1e-4) / 0.1
        yield "time stamps", "ms", np.tile([np.hypot(*q[3:5]) / 1000, 0], chosen.sum())
        yield "offset across the track", "cm", np.tile([0, 0.01], chosen.sum())
        yield "height", "cm", effect((np.array(NAMES) == "z_m") * 0.01)

    e = error.ravel()
    for name, unit, slope in shot_effects():
        value = slope @ e / (slope @ slope)
        rest = e - value * slope
        yield {"cause": name, "unit": unit, "value": value, "standard_error": np.sqrt(rest @ rest / (e.size - 1) / (slope @ slope)),
               "variance_frac": 1 - rest @ rest / (e @ e)}


def validate(path, folder, seconds):
    shots = Shots(path, folder, seconds)
    if shots.revolution[-1] < 1:
        raise SystemExit(f"validate_atm.py: {path}: has {shots.revolution[-1] + 1} revolution of the scanner; the fit and its test need 2")
    q, sigma, sense = fit(shots)
    halves = {}
    for name, odd in (("fit", 0), ("second half", 1)):
        chosen = shots.revolution % 2 == odd
        error, angle = residuals(q, shots, simulated(q, shots, sense, chosen), chosen)
        halves[name] = {"pulses": int(chosen.sum()), "two_sigma_cm": list(200 * np.sqrt(np.mean(error**2, 0))),
                        "two_sigma_mrad": list(2 * np.sqrt(np.mean(angle**2, 0))), "mean_cm": list(100 * error.mean(0))}
    track = q[3:5] / np.hypot(*q[3:5])
    rounding = 200 * np.sqrt(np.array([track**2, track[::-1]**2]) @ (shots.step_m**2 / 12))
    return {"file": os.path.basename(path), "revolutions": int(shots.revolution[-1]) + 1, "rate_hz": shots.rate_hz, "pulse_rate_hz": shots.pulse_rate_hz,
            "duration_s": float(np.ptp(shots.time)), "stamp_error_ms": 1000 * shots.stamp_error_s,
            "height_m": q[2] - np.median(shots.points[:, 2]), "speed_mps": np.hypot(*q[3:5]),
            "crab_deg": np.degrees(q[6] - np.arctan2(q[4], q[3]) + np.pi) % 360 - 180,
            "turn_degps": np.degrees(q[12]), "numbers": {name: [value, error] for name, value, error in zip(NAMES, q, sigma)},
            "sense": sense, "header": header_angles(shots),
            "rounding_two_sigma_cm": list(rounding), "halves": halves, "causes": list(causes(q, shots, sense, chosen, error))}


def show(result):
    print(f"{result['file']}: {result['revolutions']} revolutions at {result['rate_hz']:.3f} Hz, {result['pulse_rate_hz']} pulses/s, "
          f"{result['duration_s']:.3f} s, {result['height_m']:.1f} m above ground, {result['speed_mps']:.2f} m/s, "
          f"crab {result['crab_deg']:.2f} deg, turn {result['turn_degps']:.2f} deg/s")
    for name, key, factor in (("twice the mirror tilt", "tilt_rad", 2), ("incidence", "incidence_rad", 1), ("mount roll", "roll_rad", 1),
                              ("mount pitch", "pitch_rad", 1), ("azimuth zero", "zero_rad", 1)):
        value, error = np.degrees(result["numbers"][key]) * factor
        print(f"  {name:22} {value:9.4f} +- {error:.4f} deg" + (f"   header {result['header'][key]:9.4f}" if key in result["header"] else ""))
    print(f"  {'two sigma':12} {'pulses':>6} {'along, cm':>10} {'across, cm':>10} {'along, mrad':>11} {'across, mrad':>12} {'mean along, across, cm':>23}")
    for name, half in result["halves"].items():
        print(f"  {name:12} {half['pulses']:6} {half['two_sigma_cm'][0]:10.1f} {half['two_sigma_cm'][1]:10.1f} {half['two_sigma_mrad'][0]:11.3f} "
              f"{half['two_sigma_mrad'][1]:12.3f} {half['mean_cm'][0]:+12.1f} {half['mean_cm'][1]:+10.1f}")
    print(f"  {'rounding':12} {'':6} {result['rounding_two_sigma_cm'][0]:10.1f} {result['rounding_two_sigma_cm'][1]:10.1f}   of positions to 1e-6 deg")
    print("  one change that the second half asks for, and its share of the variance:")
    for cause in result["causes"]:
        print(f"    {cause['cause']:24} {cause['value']:+8.3f} +- {cause['standard_error']:.3f} {cause['unit']:5} {100 * cause['variance_frac']:5.1f} %")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE.qi", help="QFIT files")
    parser.add_argument("--seconds", type=float, default=0.5, help="length of the part of a file that is used, from its first shot")
    parser.add_argument("--json", metavar="FILE", help="write the results as JSON")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        results = [validate(path, folder, options.seconds) for path in options.files]
    for result in results:
        show(result)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(results, file, indent=1)


if __name__ == "__main__":
    main()
