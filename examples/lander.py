#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A lander with four legs lands on the Moon by the map of its lidar: DART moves it; landfall scans, maps and judges in memory.

    examples/lander.py --seed 1 --picture landing.png     # needs python3-dartpy and python3-matplotlib

It descends by an estimate of its state that is wrong, scans the terrain from the true state, takes the best landing site of its map, flies there,
and stands on its legs. With several seeds, each has its own terrain; the last line counts the landings on truly safe places.
"""
import argparse

import dartpy as dart
import numpy as np

import landfall

GRAVITY, STEP_S, CONTROL_STEPS = 1.62, 0.002, 5
BUS_KG, FOOT_KG, LEG_M, HEIGHT_M, FOOT_M = 600.0, 5.0, 1.3, 1.1, 0.15
START_M, SCAN_M, DESCENT_MPS, TOUCHDOWN_MPS, BRAKING_MPS2 = 160.0, 150.0, 8.0, 0.8, 0.6
POSITION_M, VELOCITY_MPS, ATTITUDE_RAD = 0.5, 0.02, 5e-4  # 1 sigma of the estimate's errors, which a flight keeps

LIDAR = {"detector": {"rows": 32, "columns": 32, "ifov_rad": 6e-4}, "laser": {"pulse_rate_hz": 100}, "noise": {"range_sigma_m": 0.02},
         "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": 16, "columns": 16, "half_width_m": 19, "at_end": "stop"}}}
MAP = {"half_width_m": 20, "resolution_m": 0.1}
JUDGE = {"lander": {"legs": 4, "leg_radius_m": LEG_M, "body_radius_m": LEG_M, "pad_diameter_m": 2 * FOOT_M},
         "limits": {"slope_deg": 10, "roughness_m": 0.4}, "region_radius_m": 17, "touchdown_sigma_m": 0.3, "z_sigma_m": 0.03,
         "sites": {"divert_radius_m": 17, "divert_weight": 0.05, "min_p": 0.9}}


def terrain_config(seed):
    return {"seed": seed, "grid": {"half_width_m": 30, "resolution_m": 0.1},
            "base": [{"type": "plane", "slope_x": 0.03}, {"type": "fractal", "rms_deviation_m": 0.03, "reference_length_m": 1}],
            "features": [{"type": "crater", "x_m": 3, "y_m": -2, "diameter_m": 9}],
            "patterns": [{"type": "golombek_rocks", "k": 0.05, "min_diameter_m": 0.3, "max_diameter_m": 2}]}


class Lander:
    """A bus with four feet on springs, in DART; the terrain pushes the feet."""

    def __init__(self, terrain):
        self.terrain, self.world, self.skeleton = terrain, dart.simulation.World(), dart.dynamics.Skeleton("lander")
        self.world.setGravity([0, 0, -GRAVITY])
        self.world.setTimeStep(STEP_S)
        joint, self.bus = self.skeleton.createFreeJointAndBodyNodePair()
        joint.setName("bus")
        self.bus.setName("bus")
        self.bus.setInertia(inertia(BUS_KG, 0.4 * BUS_KG))
        self.feet = []
        for angle in np.arange(4) * np.pi / 2:
            joint, foot = self.skeleton.createPrismaticJointAndBodyNodePair(self.bus)
            joint.setName(f"leg {angle}")
            foot.setName(f"foot {angle}")
            place = dart.math.Isometry3()
            place.set_translation([LEG_M * np.cos(angle), LEG_M * np.sin(angle), FOOT_M - HEIGHT_M])
            joint.setTransformFromParentBodyNode(place)
            joint.setAxis([0, 0, 1])
            joint.setSpringStiffness(0, 20000)
            joint.setDampingCoefficient(0, 2500)
            foot.setInertia(inertia(FOOT_KG, 0.05))
            self.feet.append(foot)
        self.world.addSkeleton(self.skeleton)

    def place(self, position_m, velocity_mps):
        self.skeleton.setPositions([0, 0, 0, *position_m, 0, 0, 0, 0])
        self.skeleton.setVelocities([0, 0, 0, *velocity_mps, 0, 0, 0, 0])

    def state(self):
        """Position and velocity in D, rotation D <- B, rates in B."""
        pose, velocity = self.bus.getWorldTransform(), self.bus.getLinearVelocity()
        return pose.translation(), velocity, pose.rotation(), pose.rotation().T @ self.bus.getAngularVelocity()

    def step(self, force_n, torque_nm):
        """One step with a force in D and a torque in B; returns how many feet stand on the terrain."""
        self.bus.addExtForce(force_n, np.zeros(3), False)
        self.bus.addExtTorque(torque_nm, True)
        places, standing = np.array([foot.getWorldTransform().translation() for foot in self.feet]), 0
        if places[:, 2].min() < 15:
            depths = self.terrain.elevation(places[:, 0], places[:, 1]) + FOOT_M - places[:, 2]
            for foot, depth in zip(self.feet, depths):
                if depth > 0:
                    velocity = foot.getLinearVelocity()
                    normal = max(60000 * depth - 3000 * velocity[2], 0)
                    grip = min(0.7 * normal / (np.hypot(*velocity[:2]) + 1e-3), 8000) * velocity[:2]
                    foot.addExtForce([*-grip, normal], np.zeros(3), False)
                    standing += 1
        self.world.step()
        return standing


def inertia(mass_kg, moment_kgm2):
    return dart.dynamics.Inertia(mass_kg, np.zeros(3), moment_kgm2 * np.eye(3))


def quaternion(rotation):
    return dart.math.Quaternion(rotation).wxyz()


def command(position, velocity, rotation, rates, target):
    """Force in D and torque in B for an estimated state: down to the target, upright."""
    height = max(position[2] - target[2] - HEIGHT_M, 0)
    rate = min(DESCENT_MPS, np.sqrt(TOUCHDOWN_MPS**2 + 2 * BRAKING_MPS2 * height))
    up = GRAVITY + 2.0 * (-rate - velocity[2]) + (BRAKING_MPS2 if TOUCHDOWN_MPS < rate < DESCENT_MPS else 0)
    sideways = -0.10 * (position[:2] - target[:2]) - 0.55 * velocity[:2]
    up = max(up, 0.2 * GRAVITY)
    sideways *= min(1, 0.27 * up / max(np.linalg.norm(sideways), 1e-9))
    wanted = np.array([*sideways, up])
    tilt = np.cross([0, 0, 1], rotation.T @ wanted / np.linalg.norm(wanted))
    turn = tilt - [0, 0, np.arctan2(rotation[1, 0], rotation[0, 0])]
    return (BUS_KG + 4 * FOOT_KG) * np.linalg.norm(wanted) * rotation[:, 2], 0.4 * BUS_KG * (4.0 * turn - 4.0 * rates)


def fly(seed):
    """One landing: a dict of results."""
    random = np.random.default_rng(seed)
    terrain = landfall.Terrain(terrain_config(seed))
    lander, lidar = Lander(terrain), landfall.Lidar({**LIDAR, "seed": seed}, terrain)
    lander.place([*random.normal(0, 1, 2), START_M], [0.3, -0.2, -DESCENT_MPS])
    position_error, velocity_error = random.normal(0, POSITION_M, 3), random.normal(0, VELOCITY_MPS, 3)
    x, y, z = random.normal(0, ATTITUDE_RAD, 3)
    rotation_error = np.array([[1, -z, y], [z, 1, -x], [-y, x, 1]])
    target, found, pixels, path, standing = np.zeros(3), None, [], [], 0
    period = round(1 / (LIDAR["laser"]["pulse_rate_hz"] * STEP_S))
    for step in range(round(90 / STEP_S)):
        position, velocity, rotation, rates = lander.state()
        seen = position - position_error - velocity_error * step * STEP_S, velocity - velocity_error, rotation @ rotation_error
        if found is None and seen[0][2] < SCAN_M and step % period == 0:
            pixels.append(lidar.pulse(len(pixels), position, quaternion(rotation), (seen[0], quaternion(seen[2]))))
            if len(pixels) == lidar.pulse_limit:
                found = hazards_of(np.concatenate(pixels))
                target = np.array([found.sites[axis][0] for axis in "xyz"])
        if step % CONTROL_STEPS == 0:
            force, torque = command(*seen, rates, target) if standing < 3 else (np.zeros(3), np.zeros(3))
            path.append(position)
        standing = lander.step(force, torque)
        if standing >= 3 and np.linalg.norm(velocity) < 0.02:
            break
    truth = landfall.hazards(terrain, {**JUDGE, "region_radius_m": 25})["safe"]
    x, y, _ = position
    return {"seed": seed, "terrain": terrain, "hazards": found, "path": np.array(path), "target": target, "place": np.array([x, y]),
            "error_m": (position_error + velocity_error * step * STEP_S)[:2], "time_s": step * STEP_S,
            "tilt_deg": np.degrees(np.arccos(rotation[2, 2])), "stands": standing >= 3 and rotation[2, 2] > 0.94, "safe": int(truth.sel(x=x, y=y, method="nearest")) == 1}


def hazards_of(pixels):
    points = pixels["estimated_m"][pixels["status"] == 0]
    return landfall.hazards(landfall.grid(*points.T, config=MAP), JUDGE)


def draw(landing, path):
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 5.6), width_ratios=(1, 1.1))
    safe, x_m, y_m = landing["hazards"].values("safe"), landing["hazards"].values("x"), landing["hazards"].values("y")
    left.pcolormesh(x_m, y_m, safe, cmap=plt.matplotlib.colors.ListedColormap(["#d55e00", "#009e73", "#bbbbbb"]), vmin=0, vmax=2)
    left.plot(*landing["target"][:2], "k*", markersize=14, label="site on the map")
    left.plot(*landing["place"], "wo", markeredgecolor="black", label="touchdown, true")
    left.set(title="the lander's map: green safe, red hazard, grey unknown", xlabel="x (m)", ylabel="y (m)", aspect="equal")
    left.legend(loc="upper right")
    distance = np.hypot(*(landing["path"][:, :2] - landing["place"]).T)
    right.plot(distance, landing["path"][:, 2])
    right.axhline(SCAN_M, color="grey", linestyle=":", label="the scan begins")
    right.set(title=f"descent and divert, seed {landing['seed']}", xlabel="distance to the touchdown (m)", ylabel="height (m)")
    right.legend()
    figure.savefig(path, dpi=100, bbox_inches="tight")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, nargs="+", default=[1], help="seeds of terrains and errors, one landing each")
    parser.add_argument("--picture", metavar="PNG", help="picture of the last landing")
    options = parser.parse_args()
    print("seed   x (m)   y (m)  off site (m)  tilt (deg)  time (s)  on its legs  truly safe")
    landings = []
    for landing in map(fly, options.seed):
        (x, y), off = landing["place"], np.hypot(*(landing["place"] - landing["target"][:2]))
        print(f"{landing['seed']:4d} {x:7.2f} {y:7.2f} {off:13.2f} {landing['tilt_deg']:11.1f} {landing['time_s']:9.1f} {landing['stands']!s:>12} {landing['safe']!s:>11}",
              flush=True)
        landings.append(landing["safe"] and landing["stands"])
    print(f"{sum(landings)} of {len(landings)} landings on truly safe places")
    if options.picture:
        draw(landing, options.picture)


if __name__ == "__main__":
    main()
