# SPDX-License-Identifier: GPL-3.0-or-later
"""The descent of a rigid body (docs/user/lidar/trajectory-dynamics.md) by the classical Runge-Kutta method in small steps."""
import numpy as np

from oracle import draws
from oracle.frames import matrix_of_quaternion, roll_pitch_yaw, rotation_vector

STEPS_PER_PERIOD = 16


def quaternion_of_matrix(m):
    """The quaternion of a rotation matrix whose angle is less than 180 degrees."""
    w = np.sqrt(1 + np.trace(m)) / 2
    return np.array([w, *(np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / (4 * w))])


class RigidBody:
    """Computes the states at the control times, and the pose at any time."""

    def __init__(self, config, duration):
        self.c = config
        self.h = config["control_period_s"]
        products = config["inertia_products_kgm2"]
        self.inertia = np.diag(np.array(config["inertia_kgm2"], float))
        for (row, column), value in zip(((0, 1), (0, 2), (1, 2)), products):
            self.inertia[row, column] = self.inertia[column, row] = value
        self.inverse = np.linalg.inv(self.inertia)
        q = quaternion_of_matrix(roll_pitch_yaw(np.radians(config["rpy_deg"])))
        state = np.concatenate([config["position_m"], config["velocity_mps"], q, np.radians(config["rate_degps"])])
        self.states, self.loads = [state], []
        for period in range(max(1, int(np.ceil(duration / self.h - 1e-9)))):
            self.loads.append(self.load(period, state))
            state = self.after(state, self.h, self.loads[-1])
            self.states.append(state)

    def command(self):
        control = self.c["attitude_control"]
        angles = control["command_rpy_deg"] if any(control["torque_nm"]) else self.c["rpy_deg"]
        return roll_pitch_yaw(np.radians(angles))

    def load(self, period, state):
        """Engine force along z_B and torque about the axes of B, constant during the period."""
        return self.engine(state), self.thrusters(state) + self.disturbance(period)

    def engine(self, state):
        thrust, cosine = self.c["thrust"], matrix_of_quaternion(state[6:10])[2, 2]
        if cosine <= 0 or thrust["max_n"] == 0:
            return 0.0
        error = -thrust["descent_rate_mps"] - state[5]
        wanted = self.c["mass_kg"] * (self.c["gravity_mps2"] + thrust["gain_per_s"] * error) / cosine
        return min(max(wanted, 0.0), thrust["max_n"])

    def thrusters(self, state):
        control = self.c["attitude_control"]
        torque = np.array(control["torque_nm"], float)
        if not torque.any():
            return torque
        turn = rotation_vector(self.command().T @ matrix_of_quaternion(state[6:10]))
        s = turn + control["rate_gain_s"] * state[10:]
        deadband = np.radians(control["deadband_deg"])
        return np.where(s > deadband, -torque, np.where(s < -deadband, torque, 0))

    def disturbance(self, period):
        d = self.c["disturbance"]
        return np.array(d["torque_nm"]) + np.array(d["torque_sigma_nm"]) * draws.normal(
            d["seed"], draws.DISTURBANCE, period, np.arange(3))

    def derivative(self, state, load):
        """In plain numbers: numpy's calls on three numbers each took most of the test."""
        force, torque = load
        vx, vy, vz, w, x, y, z, p, q, r = state[3:].tolist()
        f = force / self.c["mass_kg"]
        acceleration = [2 * (x * z + w * y) * f, 2 * (y * z - w * x) * f, (1 - 2 * (x * x + y * y)) * f - self.c["gravity_mps2"]]
        turning = [(-x * p - y * q - z * r) / 2, (w * p + y * r - z * q) / 2, (w * q + z * p - x * r) / 2, (w * r + x * q - y * p) / 2]
        a, b, c = (self.inertia @ state[10:]).tolist()
        gyroscopic = np.array([q * c - r * b, r * a - p * c, p * b - q * a])
        return np.array([vx, vy, vz, *acceleration, *turning, *(self.inverse @ (torque - gyroscopic))])

    def after(self, state, duration, load):
        steps = max(1, int(np.ceil(STEPS_PER_PERIOD * duration / self.h)))
        h = duration / steps
        for _ in range(steps):
            a = self.derivative(state, load)
            b = self.derivative(state + h / 2 * a, load)
            c = self.derivative(state + h / 2 * b, load)
            d = self.derivative(state + h * c, load)
            state = state + h / 6 * (a + 2 * b + 2 * c + d)
            state[6:10] /= np.linalg.norm(state[6:10])
        return state

    def pose(self, times):
        result = []
        for t in times:
            period = min(int(t / self.h), len(self.loads) - 1)
            rest = t - period * self.h
            state = self.states[period]
            result.append(self.after(state, rest, self.loads[period]) if rest > 0 else state)
        result = np.array(result)
        return result[:, :3], matrix_of_quaternion(result[:, 6:10])
