#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A real airborne scan through scan-sim (Eq. 1): conventions of attitude, interpolation in time, transforms, table and polygon scanners.

`real_scan_test.py --figure FILE` also draws the figure of docs/quality/real-scan.md.
"""
import json
import os
import sys
import unittest

import h5py
import numpy as np
from scipy.interpolate import griddata

from harness import ROOT, ToolTest
from oracle.flight import FACETS, Flight, Lines, angles_of
from oracle.frames import matrix_of_quaternion, normalised, roll_pitch_yaw, rotated, transposed

DATA = os.path.join(os.environ.get("LANDFALL_DATA", os.path.join(ROOT, "..", "shared", "data")), "outside")
FIGURE = sys.argv[sys.argv.index("--figure") + 1] if "--figure" in sys.argv else None
RATE_HZ = 250000  # a pulse within 2 us of every return: 0.2 mm of the flight
MICRO = 1e-6
KNOWN_TILTS = np.array([0, 43, 62, 191]) * MICRO


@unittest.skipUnless(os.path.isdir(DATA), f"no real scan: {DATA} (LANDFALL_DATA)")
class RealScan(ToolTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.flight = Flight(DATA)
        cls.seen = {}

    def setUp(self):
        super().setUp()
        ground = self.config({"grid": {"half_width_m": 4000, "resolution_m": 100}}, "terrain.json")
        self.succeed("terrain-gen", "-c", ground, "-o", self.path("ground.h5"))

    def scan(self, scanner, mount=np.diag([1.0, -1, -1]), **more):
        """Runs scan-sim on the real trajectory. The pulses nearest in time to the returns: poses (n, 3), (n, 3, 3) and beams in L."""
        flight = self.flight
        columns = [flight.rows, *flight.positions.T, *angles_of(flight.attitudes()).T]
        names = "t_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg"
        np.savetxt(self.path("flight.csv"), np.stack(columns, -1), delimiter=",", header=names, comments="", fmt="%.17g")
        config = {"detector": {"rows": 1, "columns": 1}, "laser": {"pulse_rate_hz": RATE_HZ, "scan_time_s": 0.905},
                  "mount": {"rpy_deg": list(angles_of(mount[None])[0])}, "scanner": scanner,
                  "trajectory": {"type": "table", "path": self.path("flight.csv")}, **more}
        self.succeed("scan-sim", "-c", self.config(config, "real.json"), "--terrain", self.path("ground.h5"), "--keep-misses",
                     "-O", "-o", self.path("real.h5"))
        nearest = np.rint(flight.time * RATE_HZ).astype(int)
        with h5py.File(self.path("real.h5")) as file:
            read = lambda names, side: np.stack([file[f"pulses/{name}_{side}"][()][nearest] for name in names.split()], -1)
            poses = {side: (read("px py pz", side), matrix_of_quaternion(read("qw qx qy qz", side))) for side in ("true", "est")}
            hits = np.stack([file[f"points/{axis}_true"][()][nearest] for axis in "xyz"], -1)
            self.assertTrue((file["points/pulse"][()][nearest] == nearest).all())
        position, attitude = poses["true"]
        beams = rotated(transposed(attitude @ mount), normalised(hits - position))
        return poses, beams

    def directions(self, pose, mount=np.eye(3)):
        """Unit vectors to the real returns."""
        position, attitude = pose
        return rotated(transposed(attitude @ mount), normalised(self.flight.points - position))

    def lines(self, pose):
        return Lines(self.directions(pose), self.flight.facet)

    def check_lines(self, lines):
        self.assertAlmostEqual(lines.rms / MICRO, 5, delta=1)
        np.testing.assert_allclose(lines.tilts() / MICRO, KNOWN_TILTS / MICRO, atol=1)

    def check_residuals(self, lines):
        """A wave along the lines, which the facets share, explains most of the scatter; a lever arm along the axis does not."""
        along = self.line_angles(lines) * 2
        fit = lambda mine: np.polyval(np.polyfit(along[mine], lines.residuals[mine], 9), np.linspace(-1, 1, 101))
        wave = fit(slice(None))
        shared = [np.corrcoef(fit(self.flight.facet == f), wave)[0, 1] for f in range(FACETS)]
        rest = lines.residuals - np.polyval(np.polyfit(along, lines.residuals, 9), along)
        print(f"wave {np.ptp(wave) / MICRO:.1f}, correlations", np.round(shared, 2), f"around it {rest.std() / MICRO:.2f}")
        self.assertGreater(min(shared), 0.9)
        self.assertAlmostEqual(rest.std() / MICRO, 3, delta=0.3)
        ranges = np.linalg.norm(self.flight.points - self.poses["true"][0], axis=1)
        columns = np.column_stack([np.eye(FACETS)[self.flight.facet], 1 / ranges, along])
        solution = np.linalg.lstsq(columns, lines.residuals, rcond=None)[0]
        sigma = lines.rms * np.sqrt(np.linalg.inv(columns.T @ columns)[FACETS, FACETS])
        print(f"lever arm {solution[FACETS]:.3f} +- {sigma:.3f} m")
        self.assertLess(abs(solution[FACETS]), 3 * sigma)
        self.assertLess(sigma, 0.03)

    def line_angles(self, lines):
        """Angles along the lines, seen by the mounted lidar."""
        seen = self.directions(self.poses["true"], lines.mount())
        return np.arctan2(seen[:, 0], seen[:, 2])

    def tabulated(self, lines):
        """The scanner `table`: a gimbal whose angle 2 runs along the line, and angle 1 keeps the facet's distance from the plane."""
        along = self.line_angles(lines)
        beside = -np.arcsin(np.sin(lines.offsets[self.flight.facet]) / np.cos(along))
        rows = np.stack([self.flight.time, beside, along], -1)
        rows = rows[np.concatenate([[True], np.diff(self.flight.time) > 0])]
        rows = np.concatenate([[[-1, 0, 0]], rows, [[2, 0, 0]]])
        np.savetxt(self.path("angles.csv"), rows, delimiter=",", header="t_s,angle_1_rad,angle_2_rad", comments="", fmt="%.17g")
        return {"type": "table", "path": self.path("angles.csv"), "mechanism": "gimbal"}

    def polygon(self, lines, tilts):
        """Eight facets, with the tilts of the four in turn, turn the beam as the real mirror does: 2 x 45 degrees a facet."""
        along = -self.line_angles(lines) + self.flight.line * np.pi / 2  # the lines run from right to left, towards -x_L
        speed, start = np.polyfit(self.flight.time, along, 1)
        middle = np.cos(self.line_angles(lines) / 2)  # of the bow of a tilted facet
        share = np.array([middle[self.flight.facet == f].mean() for f in range(FACETS)])
        eight = np.tile(lines.offsets / share / 2, 2)
        return {"type": "polygon", "facets": 8, "rate_hz": speed / (4 * np.pi), "phase_deg": np.degrees(start / 2) % 360,
                "line_azimuth_deg": 180, "duty_frac": 0.7, "facet_tilt_rad": list(eight) if tilts else []}

    def beside_beams(self, beams, lines):
        """The real returns minus the beams, across the lines."""
        seen = self.directions(self.poses["true"], lines.mount())
        return np.arcsin(seen[:, 1]) - np.arcsin(beams[:, 1])

    def test_the_scan_is_reproduced(self):
        self.poses, _ = self.scan({"type": "flash"})
        lines = self.lines(self.poses["true"])
        self.check_lines(lines)
        self.check_residuals(lines)
        report = {"rms": lines.rms, "tilts": lines.tilts()}
        _, beams = self.scan(self.tabulated(lines), lines.mount())
        along = self.line_angles(lines)
        self.assertLess(abs(np.arctan2(beams[:, 0], beams[:, 2]) - along).max(), 3e-4)  # 2 us at 57 rad/s and the interpolation
        report["table"] = self.beside_beams(beams, lines)
        self.assertAlmostEqual(np.std(report["table"]) / MICRO, 5, delta=1)
        self.assertLess(abs(report["table"].mean()), 0.5 * MICRO)
        _, beams = self.scan(self.polygon(lines, True), lines.mount())
        report["polygon"] = self.beside_beams(beams, lines)
        self.assertAlmostEqual(np.std(report["polygon"]) / MICRO, 5, delta=1)
        report["along"] = np.arctan2(beams[:, 0], beams[:, 2]) - along
        self.assertLess(abs(report["along"]).max(), 0.01)  # the motor's speed drifts
        found = np.array([np.arcsin(beams[self.flight.facet == f, 1]).mean() for f in range(FACETS)])
        np.testing.assert_allclose(np.sort(found - found.min()) / MICRO, KNOWN_TILTS / MICRO, atol=1)
        _, beams = self.scan(self.polygon(lines, False), lines.mount())
        report["without tilts"] = self.beside_beams(beams, lines)
        self.assertGreater(np.std(report["without tilts"]), 60 * MICRO)
        for name, value in report.items():
            print(name, np.round(value / MICRO, 2) if np.size(value) <= 4 else f"{value.std() / MICRO:.2f}, at most {abs(value).max() / MICRO:.0f}")
        if FIGURE:
            draw(self.flight, along, self.directions(self.poses["true"], lines.mount()), lines, report)

    def imported(self, name, points):
        """Points at the times of the real returns as a scan."""
        rows = np.column_stack([self.flight.time, points])
        np.savetxt(self.path(name + ".csv"), rows, delimiter=",", header="t,x,y,z", comments="", fmt="%.9g")
        self.succeed("landfall-import", self.path(name + ".csv"), "-o", self.path(name + ".h5"), "--center", "0,0,0", "-O")
        return self.path(name + ".h5")

    def ground_of_returns(self):
        """The terrain of the real returns, linear between them."""
        steps = np.arange(-3000, 3001, 10.0)
        x, y = np.meshgrid(steps, steps[::-1])
        z = griddata(self.flight.points[:, :2], self.flight.points[:, 2], (x, y))
        nearest = griddata(self.flight.points[:, :2], self.flight.points[:, 2], (x, y), "nearest")
        head = f"ncols {len(steps)}\nnrows {len(steps)}\nxllcenter {steps[0]}\nyllcenter {steps[0]}\ncellsize 10"
        np.savetxt(self.path("relief.asc"), np.where(np.isnan(z), nearest, z), fmt="%.3f", header=head, comments="")
        terrain = {"grid": {"half_width_m": 3000, "resolution_m": 10},
                   "base": {"type": "dem", "path": self.path("relief.asc"), "interpolation": "bilinear", "datum": "none", "horizontal_scale_m": 1}}
        self.succeed("terrain-gen", "-c", self.config(terrain, "relief.json"), "-o", self.path("ground.h5"), "-O")

    def test_a_mount_error_makes_a_simulation_less_like_the_scan(self):
        """landfall-info --compare: the real scan, its simulation, and simulations with 2 mrad about the axis of the lines."""
        self.poses, _ = self.scan({"type": "flash"})
        lines = self.lines(self.poses["true"])
        self.ground_of_returns()
        real = self.imported("real_scan", self.flight.points)
        error = [0, 0.002, 0]
        turned = lines.mount() @ roll_pitch_yaw(np.array([error]))[0]
        simulations = {"simulated": (lines.mount(), {}), "misaligned": (lines.mount(), {"pointing_error": {"misalignment_rpy_rad": error}}),
                       "mounted otherwise": (turned, {})}
        nearest = np.rint(self.flight.time * RATE_HZ).astype(int)
        found = {}
        for name, (mount, more) in simulations.items():
            self.scan(self.tabulated(lines), mount, **more)
            with h5py.File(self.path("real.h5")) as file:
                points = np.stack([file[f"points/{axis}_est"][()][nearest] for axis in "xyz"], -1)
            scan = self.imported(name.replace(" ", "_"), points)
            found[name] = json.loads(self.succeed("landfall-info", "--compare", real, scan, "--json").stdout)["likeness"]
        rows = {name: {row["name"]: row for row in one["statistics"]} for name, one in found.items()}
        for row in rows["simulated"]:
            print(f"{row:16}", *(f"{one[row]['distance']:10.3g}{'*' if one[row]['differs'] else ' '}" for one in rows.values()))
        # A misaligned lidar believes its nominal beams: heights are wrong, not places. One that is mounted otherwise sees other places.
        for name, seeing, beyond in (("misaligned", ("elevation", "elevation_spread", "shift", "tilt", "position"), ("elevation", "shift", "position")),
                                     ("mounted otherwise", ("density_map", "coverage", "coverage_time", "position"), ("position",))):
            for row in seeing:
                self.assertGreater(rows[name][row]["distance"], rows["simulated"][row]["distance"], (name, row))
            for row in beyond:
                self.assertEqual((rows["simulated"][row]["differs"], rows[name][row]["differs"]), (False, True), (name, row))
            self.assertAlmostEqual(rows[name]["spacing_along"]["distance"], rows["simulated"]["spacing_along"]["distance"], delta=1e-3)
        self.assertAlmostEqual(np.hypot(*found["misaligned"]["surface"]["shift_m"]), 0.002 * 4600, delta=1.5)  # the simulation has 1.4

    def test_other_conventions_fail(self):
        """The errors that each of them would leave; the estimated poses are those of a wrong time stamp."""
        poses, _ = self.scan({"type": "flash"}, pointing_error={"time_stamp_bias_s": 0.005})
        residuals = {"5 ms late": self.lines(poses["est"]).rms}
        flight = self.flight
        nearest = np.abs(flight.time[:, None] - flight.rows).argmin(1)
        residuals["nearest pose"] = self.lines((flight.positions[nearest], flight.attitudes()[nearest])).rms
        inside = poses["true"][0]
        for name, signs in {"without the wander angle": {"wander": 0}, "roll reversed": {"roll": -1},
                            "pitch reversed": {"pitch": -1}}.items():
            attitude = interpolated(flight.rows, flight.attitudes(**signs), flight.time)
            residuals[name] = self.lines((inside, attitude)).rms
        print({name: f"{rms / MICRO:.1f}" for name, rms in residuals.items()})
        self.assertLess(Lines(self.directions((inside, interpolated(flight.rows, flight.attitudes(), flight.time))),
                              flight.facet).rms, 6 * MICRO)
        for name, rms in residuals.items():
            self.assertGreater(rms, 8 * MICRO, name)


def interpolated(rows, matrices, times):
    """Rotations at any times, from angles that are linear between the rows."""
    angles = np.radians(angles_of(matrices))
    return roll_pitch_yaw(np.stack([np.interp(times, rows, angles[:, n]) for n in range(3)], -1))


def draw(flight, along, seen, lines, report):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(1, 2, figsize=(11, 4.2), layout="constrained", width_ratios=[3, 2])
    order = np.argsort(lines.offsets)
    for rank, facet in enumerate(order):
        mine = flight.facet == facet
        axes[0].plot(np.degrees(along[mine]), (np.arcsin(seen[mine, 1]) - lines.offsets.min()) / MICRO, ".", ms=4,
                     label=f"facet {rank + 1}: {(lines.offsets[facet] - lines.offsets.min()) / MICRO:.0f} µrad")
    axes[0].set(xlabel="angle along the line, degrees", ylabel="angle across the line, µrad",
                title="1,325 real returns, seen from landfall's poses")
    axes[0].legend(loc="center left", bbox_to_anchor=(0, 0.55))
    bins = np.arange(-20, 20.5, 1)
    axes[1].hist(report["table"] / MICRO, bins, histtype="step", lw=1.8, label=f"table: {report['table'].std() / MICRO:.2f} µrad rms")
    axes[1].hist(report["polygon"] / MICRO, bins, histtype="step", lw=1.8, ls="--",
                 label=f"polygon with facet tilt: {report['polygon'].std() / MICRO:.2f} µrad rms")
    axes[1].set(xlabel="real return minus landfall's beam, across the line, µrad", ylabel="returns per µrad")
    axes[1].set_ylim(0, axes[1].get_ylim()[1] * 1.25)
    axes[1].legend(loc="upper center")
    figure.savefig(FIGURE, dpi=110)


if __name__ == "__main__":
    if FIGURE:
        del sys.argv[sys.argv.index("--figure"):][:2]
        sys.argv = sys.argv[:1]
    unittest.main()
