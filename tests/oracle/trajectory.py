# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses at given times (docs/user/lidar/trajectory-*.md): p (n, 3) in D, and R_dem_body (n, 3, 3)."""
import numpy as np

from oracle import dynamics, tables
from oracle.frames import matrix_of_quaternion, roll_pitch_yaw


class ConstantVelocity:
    start = 0.0

    def __init__(self, config):
        self.config = config

    def pose(self, t):
        c, t = self.config, np.asarray(t, float)[:, None]
        angles = np.radians(np.array(c["rpy_deg"]) + np.array(c["rpy_rate_degps"]) * t)
        return np.array(c["position_m"]) + np.array(c["velocity_mps"]) * t, roll_pitch_yaw(angles)

    nominal = pose

    def clamped(self, t):
        return t


class Table:
    """Cubic Hermite interpolation of positions, and slerp of attitudes."""

    def __init__(self, path):
        c = tables.read(path)
        self.t = c["t_s"]
        self.start = self.t[0]
        self.p = np.column_stack([c[f"{axis}_m"] for axis in "xyz"])
        self.v = np.column_stack([c[f"v{axis}_mps"] for axis in "xyz"]) if "vx_mps" in c else self.slopes()
        self.q = self.quaternions(c)

    def slopes(self):
        """The velocity of the parabola through each row and its neighbours; at the ends, through the three outermost rows."""
        if len(self.t) == 2:
            return np.tile((self.p[1] - self.p[0]) / (self.t[1] - self.t[0]), (2, 1))
        result = np.empty_like(self.p)
        for row, t in enumerate(self.t):
            first = min(max(row - 1, 0), len(self.t) - 3)
            for axis in range(3):
                a = np.polyfit(self.t[first:first + 3] - t, self.p[first:first + 3, axis], 2)
                result[row, axis] = a[1]
        return result

    @staticmethod
    def quaternions(c):
        if "qw" in c:
            q = np.column_stack([c["qw"], c["qx"], c["qy"], c["qz"]])
            return q / np.linalg.norm(q, axis=1, keepdims=True)
        if "mrp_1" in c:
            s = np.column_stack([c[f"mrp_{n}"] for n in (1, 2, 3)])
            square = np.sum(s * s, axis=1, keepdims=True)
            return np.hstack([1 - square, 2 * s]) / (1 + square)
        half = np.radians(np.column_stack([c["roll_deg"], c["pitch_deg"], c["yaw_deg"]])) / 2
        (cr, cp, cy), (sr, sp, sy) = np.cos(half).T, np.sin(half).T
        return np.column_stack([cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy,
                                cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy])

    def clamped(self, t):
        return np.clip(t, self.t[0], self.t[-1])

    def pose(self, t):
        t = self.clamped(np.asarray(t, float))
        row = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        h = (self.t[row + 1] - self.t[row])[:, None]
        u = (t - self.t[row])[:, None] / h
        w = u * u * (3 - 2 * u)
        p = ((1 - w) * self.p[row] + w * self.p[row + 1]
             + u * (1 - u) * ((1 - u) * h * self.v[row] - u * h * self.v[row + 1]))
        return p, matrix_of_quaternion(self.slerp(row, u))

    nominal = pose

    def slerp(self, row, u):
        a, b = self.q[row], self.q[row + 1]
        cosine = np.sum(a * b, axis=1, keepdims=True)
        b = np.where(cosine < 0, -b, b)
        angle = 2 * np.arcsin(np.minimum(1, np.linalg.norm(b - a, axis=1, keepdims=True) / 2))
        small = angle < 1e-9
        sine = np.where(small, 1, np.sin(angle))
        result = np.where(small, (1 - u) * a + u * b,
                          (np.sin((1 - u) * angle) * a + np.sin(u * angle) * b) / sine)
        return result / np.linalg.norm(result, axis=1, keepdims=True)


class Dynamics:
    """A rigid body, integrated from the last control time before each given time."""
    start = 0.0

    def __init__(self, config, scan_time):
        self.config, self.end = config, scan_time
        self.body = dynamics.RigidBody(config, scan_time)

    def clamped(self, t):
        return np.clip(t, 0, self.end)

    def pose(self, t):
        return self.body.pose(self.clamped(np.asarray(t, float)))

    def nominal(self, t):
        """The initial horizontal velocity and the commanded descent rate, or free fall without an engine."""
        c, t = self.config, np.asarray(t, float)[:, None]
        velocity, falling = np.array(c["velocity_mps"], float), 0.0
        if c["thrust"]["max_n"] > 0:
            velocity[2] = -c["thrust"]["descent_rate_mps"]
        else:
            falling = c["gravity_mps2"] * np.array([0, 0, -0.5]) * t**2
        command = self.body.command()
        return np.array(c["position_m"]) + velocity * t + falling, np.tile(command, (len(t), 1, 1))


def duration(config):
    """The time that dynamics and random navigation errors cover: the scan plus the largest delay of a time stamp."""
    pointing = config["pointing_error"]
    return config["laser"]["scan_time_s"] + max(0, pointing["time_stamp_bias_s"] + 9 * pointing["time_stamp_sigma_s"])


class Dispersed:
    """The true path: the configured one with a departure that is linear in the time since the first pulse."""

    def __init__(self, config, path):
        self.config, self.path, self.start = config, path, path.start
        self.nominal, self.clamped = path.nominal, path.clamped

    def pose(self, t):
        p, body = self.path.pose(t)
        since = self.clamped(np.asarray(t, float)) - self.start
        departure = lambda offset, rate: np.array(self.config[offset]) + np.outer(since, self.config[rate])
        return p + departure("position_m", "velocity_mps"), body @ roll_pitch_yaw(departure("rpy_rad", "rpy_rate_radps"))


def of_config(config):
    return Dispersed(config["trajectory_dispersion"], path_of(config))


def path_of(config):
    trajectory = config["trajectory"]
    if trajectory["type"] == "table":
        return Table(trajectory["path"])
    if trajectory["type"] == "dynamics":
        return Dynamics(trajectory, duration(config))
    return ConstantVelocity(trajectory)
