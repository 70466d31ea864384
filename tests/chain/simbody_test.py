#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A lander in Simbody with landfall's lidar: examples/simbody_lander, its own checks, and its scans through the chain."""
import glob
import json
import os
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

from harness import columns, run, write_file

BUILD = os.environ["LANDFALL_BUILD"]
EXAMPLE = os.path.join(os.environ["LANDFALL_ROOT"], "examples", "simbody_lander")
CONFIG = os.path.join(EXAMPLE, "scan.json")
INSTALLED = glob.glob("/usr/lib/*/cmake/simbody/SimbodyConfig.cmake")


def check(*command):
    result = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=600, check=False)
    if result.returncode:
        raise AssertionError(f"{command}: exit {result.returncode}\n{result.stdout}{result.stderr}")
    return result.stdout


def rotation(q):
    """Matrices (n, 3, 3) of quaternions (n, 4), Hamilton, w first."""
    w, x, y, z = q.T
    return np.stack([np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], -1),
                     np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], -1),
                     np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1)], -2)


def poses(scan, kind):
    """Positions and attitudes of the pulses."""
    pulses = columns(scan, "pulses")
    return (np.stack([pulses[f"p{axis}_{kind}"] for axis in "xyz"], -1),
            rotation(np.stack([pulses[f"q{axis}_{kind}"] for axis in "wxyz"], -1)))


def points(scan, kind):
    columns_ = columns(scan, "points")
    return np.stack([columns_[f"{axis}_{kind}"] for axis in "xyz"], -1)


def height(terrain, x, y):
    """The stored surface: cells split along the diagonal from (i + 1, j) to (i, j + 1)."""
    grid = columns(terrain)
    step = grid["x"][1] - grid["x"][0]
    u, v = (x - grid["x"][0]) / step, (y - grid["y"][0]) / step
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b, z = u - i, v - j, grid["z"]
    lower = z[j, i] + a * (z[j, i + 1] - z[j, i]) + b * (z[j + 1, i] - z[j, i])
    far = z[j + 1, i + 1]
    upper = far + (1 - a) * (z[j + 1, i] - far) + (1 - b) * (z[j, i + 1] - far)
    return np.where(a + b > 1, upper, lower)


@unittest.skipUnless(INSTALLED, "Simbody is not installed (Debian's libsimbody-dev)")
class SimbodyLander(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="landfall-simbody-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        check("cmake", "--install", BUILD, "--component", "lidar", "--prefix", cls.path("prefix"))
        check("cmake", "-S", EXAMPLE, "-B", cls.path("build"), "-DCMAKE_PREFIX_PATH=" + cls.path("prefix"),
              "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_COMPILER=" + os.environ["LANDFALL_CXX"], "-DLANDER_TESTS=ON",
              "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")
        check("cmake", "--build", cls.path("build"), "--parallel", "2")
        cls.tool("terrain-gen", "-c", os.path.join(EXAMPLE, "terrain.json"), "-o", cls.path("terrain.h5"))
        cls.fly("filter")
        cls.fly("perfect", "--perfect")

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def tool(cls, *arguments):
        result = run(*arguments)
        if result.returncode or result.stderr:
            raise AssertionError(f"{arguments}: exit {result.returncode}\n{result.stderr}")

    @classmethod
    def fly(cls, name, *options, config=CONFIG, terrain="terrain.h5"):
        check(cls.path("build/simbody_lander"), cls.path(terrain), config, cls.path(f"{name}.h5"),
              cls.path(f"{name}.csv"), *options)

    def motion(self, name):
        return np.genfromtxt(self.path(f"{name}.csv"), delimiter=",", names=True)

    def metrics(self, name):
        self.tool("regrid", self.path(f"{name}.h5"), "--terrain", self.path("terrain.h5"), "--set", "resolution_m=0.1",
                  "-o", self.path(f"{name}-dem.h5"), "-O")
        self.tool("dem-eval", self.path(f"{name}-dem.h5"), "--metrics-only", "-O", "--metrics", self.path(f"{name}.json"))
        with open(self.path(f"{name}.json"), encoding="utf-8") as file:
            return json.load(file)

    def test_the_checks_of_its_units_pass(self):
        """Momentum, energy, slosh and legs in closed form; controls, filter, scene, poses."""
        printed = check(self.path("build/lander_test"))
        self.assertIn("[  PASSED  ] 18 tests.", printed)

    def test_with_perfect_knowledge_and_no_noise_the_points_lie_on_the_terrain(self):
        with open(CONFIG, encoding="utf-8") as file:
            config = json.load(file)
        config["noise"]["range_sigma_m"] = 0
        config["scanner"]["pattern"].update(rows=30, columns=30)
        write_file(self.path("exact.json"), json.dumps(config))
        self.fly("exact", "--perfect", config=self.path("exact.json"))
        estimated = points(self.path("exact.h5"), "est")
        self.assertEqual(len(estimated), 900 * 324)
        self.assertLess(np.abs(estimated - points(self.path("exact.h5"), "true")).max(), 1e-9)
        above = estimated[:, 2] - height(self.path("terrain.h5"), *estimated[:, :2].T)
        self.assertLess(np.abs(above).max(), 1e-6)

    def test_true_points_lie_on_the_terrain(self):
        for name in ["filter", "perfect"]:
            truth = points(self.path(f"{name}.h5"), "true")
            self.assertEqual(len(truth), 10000 * 324)
            self.assertLess(np.abs(truth[:, 2] - height(self.path("terrain.h5"), *truth[:, :2].T)).max(), 1e-6)

    def test_the_poses_of_the_scan_are_those_of_the_motion(self):
        motion = self.motion("filter")
        position, attitude = poses(self.path("filter.h5"), "true")
        t = columns(self.path("filter.h5"), "pulses")["t"]
        rows = np.isin(np.round(t * 1e6), np.round(motion["t"] * 1e6))
        at = np.isin(np.round(motion["t"] * 1e6), np.round(t * 1e6))
        self.assertEqual(rows.sum(), 100)
        np.testing.assert_allclose(position[rows], np.stack([motion[at][axis] for axis in "xyz"], -1), atol=1e-8)
        # The tilt is a small rotation vector: the body's z axis is (tilt_y, -tilt_x, 1) to second order.
        np.testing.assert_allclose(attitude[rows][:, 0, 2], motion[at]["tilt_y"], atol=2e-5)
        np.testing.assert_allclose(attitude[rows][:, 1, 2], -motion[at]["tilt_x"], atol=2e-5)

    def test_knowledge_does_not_change_the_motion(self):
        np.testing.assert_array_equal(self.motion("filter"), self.motion("perfect"))

    def test_it_arrives_above_the_site_as_commanded(self):
        end = self.motion("filter")[-1]
        self.assertLess(abs(end["vz"] + 23), 0.05)
        self.assertLess(np.hypot(end["x"], end["y"]), 2)
        self.assertLess(np.hypot(end["tilt_x"], end["tilt_y"]), 0.03)

    def test_the_swing_of_the_propellant_turns_the_bus(self):
        """Euler's equation in the recorded motion: J phi'' = torque - m a h (delta_1 + delta_2), h the height of the hinges above the centre of
        mass of bus and legs, a the acceleration that the engine gives. The ratio of the two fitted factors does not depend on J."""
        motion = self.motion("filter")
        total_kg, slosh_kg, legs_kg, bus_kg = 554.93, 53.464, 48, 400
        legs_z = -0.3 - 0.6 * np.sin(0.7)
        height_m = 0.5 - legs_kg * legs_z / (legs_kg + bus_kg)
        steady = (motion["t"] > 9)[1:-1]
        felt = (motion["thrust"][1:-1] / total_kg)[steady].mean()
        for axis in "xy":
            tilt = motion[f"tilt_{axis}"]
            turn = (tilt[2:] - 2 * tilt[1:-1] + tilt[:-2]) / 0.01 ** 2
            torque = (motion[f"torque_{axis}"][1:-1] + motion[f"torque_{axis}"][:-2]) / 2
            swing = motion[f"slosh_1{axis}"][1:-1] + motion[f"slosh_2{axis}"][1:-1]
            self.assertGreater(np.abs(swing[steady]).max(), 0.05)
            (per_torque, per_swing), *_ = np.linalg.lstsq(np.stack([torque, swing], -1)[steady], turn[steady], rcond=None)
            self.assertAlmostEqual(per_swing / per_torque / (-slosh_kg * felt * height_m), 1, delta=0.03)

    def test_frozen_propellant_gives_another_attitude(self):
        self.fly("frozen", "--frozen")
        moving, frozen = self.motion("filter"), self.motion("frozen")
        rows = min(len(moving), len(frozen))
        for axis in "xy":
            self.assertEqual(np.abs(frozen[f"slosh_1{axis}"]).max(), 0)
            turn = np.abs(moving[f"tilt_{axis}"][:rows] - frozen[f"tilt_{axis}"][:rows]).max()
            self.assertGreater(turn, 1e-3)
            self.assertLess(turn, 1e-2)

    def test_the_dem_of_perfect_knowledge_passes(self):
        metrics = self.metrics("perfect")
        self.assertIs(metrics["pass"], True)
        self.assertEqual(metrics["coverage"]["invalid_count"], 0)
        for axis in "xyz":
            self.assertLess(abs(metrics["accuracy"]["absolute"][axis]["mean_m"]), 1e-3)

    def test_the_dem_of_the_filter_is_off_by_the_error_of_the_filter(self):
        metrics = self.metrics("filter")
        self.assertIs(metrics["pass"], True)
        self.assertEqual(metrics["coverage"]["invalid_count"], 0)
        # The pose errors move a point p of the estimate to T_true T_est^-1 p; range noise averages out.
        scan = self.path("filter.h5")
        (p_true, R_true), (p_est, R_est) = poses(scan, "true"), poses(scan, "est")
        centre = points(scan, "est").reshape(10000, 324, 3).mean(axis=1)
        moved = p_true + np.einsum("nij,nkj,nk->ni", R_true, R_est, centre - p_est)
        inside = np.hypot(centre[:, 0], centre[:, 1]) < 50
        expected = (moved - centre)[inside].mean(axis=0)
        found = [metrics["accuracy"]["absolute"][axis]["mean_m"] for axis in "xyz"]
        self.assertGreater(np.hypot(*expected[:2]), 0.1)
        np.testing.assert_allclose(found, expected, atol=2e-3)

    def test_the_figure_and_the_uncertainty_map(self):
        self.metrics("perfect")
        self.tool("dem-eval", self.path("perfect-dem.h5"), "-o", self.path("eval.h5"), "-O")
        check("/usr/bin/python3", os.path.join(EXAMPLE, "plot_flight.py"), self.path("filter.csv"), self.path("perfect.csv"),
              self.path("eval.h5"), self.path("figure.png"))
        self.assertGreater(os.path.getsize(self.path("figure.png")), 100_000)
        self.tool("regrid", self.path("filter.h5"), "--uncertainty", "--range-sigma", "0.0167", "--navigation-sigma", "position_m=0.2",
                  "--set", "resolution_m=0.1", "--layers", "z_est,z_sigma_abs", "-o", self.path("sigma.h5"))
        sigma = columns(self.path("sigma.h5"))["z_sigma_abs"]
        self.assertAlmostEqual(float(np.nanmedian(sigma)), 0.2, delta=0.01)

    def test_it_lands_by_the_site_that_hazard_map_picked(self):
        """A crater lies where it would land. The divert changes nothing before the scan ends; the touchdown is off the place by the error of the
        filter at the last pulse, as monte-carlo's landings are without u, by what that has drifted since, and by the controller."""
        self.tool("terrain-gen", "-c", os.path.join(EXAMPLE, "terrain.json"), "--set", "features.0.x_m=4", "--set", "features.0.y_m=3",
                  "-o", self.path("crater.h5"))
        self.fly("map", terrain="crater.h5")
        self.tool("regrid", self.path("map.h5"), "--terrain", self.path("crater.h5"), "--set", "resolution_m=0.1", "-o", self.path("map-dem.h5"))
        self.tool("hazard-map", self.path("map-dem.h5"), "--set", "region_radius_m=20", "--set", 'sites={"divert_radius_m":20}',
                  "-o", self.path("hazards.h5"), "--sites", self.path("sites.json"))
        with open(self.path("sites.json"), encoding="utf-8") as file:
            site = json.load(file)["sites"][0]
        self.assertIs(site["true_safe"], True)
        self.assertGreater(np.hypot(site["x_m"], site["y_m"]), 3)
        self.fly("landed", "--site", f"{site['x_m']},{site['y_m']},{site['z_m']}", terrain="crater.h5")

        flown, landed = self.motion("map"), self.motion("landed")
        for name in flown.dtype.names:
            np.testing.assert_array_equal(landed[name][:len(flown)], flown[name])
        end = landed[-1]
        place, at, error, drift = ([row(axis) for axis in "xy"] for row in (
            lambda axis: site[axis + "_m"], lambda axis: end[axis], lambda axis: end[f"error_{axis}"],
            lambda axis: np.sqrt(end[f"sigma_{axis}"] ** 2 - flown[-1][f"sigma_{axis}"] ** 2)))
        (p_true, _), (p_est, _) = poses(self.path("landed.h5"), "true"), poses(self.path("landed.h5"), "est")
        expected = place + (p_true - p_est)[-1, :2]
        control = np.hypot(*(np.subtract(at, error) - place))
        self.assertLess(control, 0.03)
        self.assertLess(np.hypot(*(at - expected)), control + 3 * np.hypot(*drift))
        self.assertGreater(np.hypot(*np.subtract(at, place)), 2 * np.hypot(*(at - expected)))
        feet = end["z"] - height(self.path("crater.h5"), end["x"][None], end["y"][None])[0] - (0.3 + 1.2 * np.sin(0.7))
        self.assertLess(abs(feet), 0.02)  # a period of 10 ms at the speed of the touchdown
        self.assertLess(abs(end["vz"] + 1), 0.3)

    def test_errors(self):
        for arguments, code, message in [
                ([], 2, "usage: simbody_lander terrain.h5"),
                (["t.h5", CONFIG, "a.h5", "a.csv", "--site", "1,2"], 2, "--site: 1,2 is not X,Y,Z in metres"),
                ([self.path("none.h5"), CONFIG, self.path("a.h5"), self.path("a.csv")], 1, "none.h5: cannot be opened"),
                ([self.path("terrain.h5"), self.path("terrain.h5"), self.path("a.h5"), self.path("a.csv")], 1, "terrain.h5")]:
            result = subprocess.run([self.path("build/simbody_lander"), *arguments], capture_output=True, text=True, check=False)
            self.assertEqual(result.returncode, code)
            self.assertIn(message, result.stderr)


if __name__ == "__main__":
    unittest.main()
