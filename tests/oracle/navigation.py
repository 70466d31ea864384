# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimated pose of the lander (Eqs. 4-6; docs/user/lidar/error-navigation.md)."""
import numpy as np

from oracle import draws, trajectory
from oracle.frames import roll_pitch_yaw


class Path:
    """Three components given at the times 0, h, 2 h ...; linear in between, constant outside."""

    def __init__(self, h, values):
        self.h, self.values = h, values

    def at(self, t):
        times = np.arange(len(self.values)) * self.h
        return np.stack([np.interp(t, times, self.values[:, axis]) for axis in range(3)], -1)

    def integral(self):
        steps = (self.values[1:] + self.values[:-1]) * self.h / 2
        return Path(self.h, np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]))


def normals(seed, stream, steps, first_axis):
    return draws.normal(seed, stream, np.arange(steps + 1)[:, None], first_axis + np.arange(3))


def walk(h, steps, seed, density, first_axis):
    increments = np.array(density) * np.sqrt(h) * normals(seed, draws.NAVIGATION_WALK, steps, first_axis)
    increments[0] = 0
    return Path(h, np.cumsum(increments, axis=0))


def gauss_markov(h, steps, seed, sigma, time, first_axis):
    x = np.array(sigma) * normals(seed, draws.GAUSS_MARKOV, steps, first_axis)
    f = np.exp(-h / time)
    for n in range(1, len(x)):
        x[n] = f * x[n - 1] + np.sqrt(1 - f * f) * x[n]
    return Path(h, x)


class Estimate:
    """The estimated pose at times of the trajectory."""

    def __init__(self, config, path):
        self.c, self.path = config["navigation_error"], path
        self.table = trajectory.Table(self.c["table"]) if "table" in self.c else None
        h = self.c["interval_s"]
        steps = max(1, int(np.ceil(trajectory.duration(config) / h)))
        self.models = [self.walks(h, steps, draws.seed_of(config)), self.markov(h, steps, draws.seed_of(config))]

    def walks(self, h, steps, seed):
        c = self.c["random_walk"]
        return (walk(h, steps, seed, c["position_m_per_sqrt_s"], 0),
                walk(h, steps, seed, c["velocity_mps_per_sqrt_s"], 3).integral(),
                walk(h, steps, seed, c["rpy_rad_per_sqrt_s"], 6))

    def markov(self, h, steps, seed):
        c = self.c["gauss_markov"]
        return (gauss_markov(h, steps, seed, c["position_sigma_m"], c["position_time_s"], 0),
                gauss_markov(h, steps, seed, c["velocity_sigma_mps"], c["velocity_time_s"], 3).integral(),
                gauss_markov(h, steps, seed, c["rpy_sigma_rad"], c["rpy_time_s"], 6))

    def pose(self, t):
        if self.table:
            return self.table.pose(t)
        t = self.path.clamped(t)
        since = t - self.path.start
        p, turn = self.path.pose(t)
        if self.c["attitude"] == "commanded":
            turn = self.path.nominal(t)[1]
        linear = lambda offset, rate: np.array(self.c[offset]) + np.outer(since, self.c[rate])
        p = p - linear("position_m", "velocity_mps")
        turn = turn @ roll_pitch_yaw(linear("rpy_rad", "rpy_rate_radps"))
        for position, moved, angles in self.models:
            p = p - position.at(since) - moved.at(since)
            turn = turn @ roll_pitch_yaw(angles.at(since))
        return p, turn
