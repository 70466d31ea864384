# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotations of arrays of vectors. Quaternions are Hamilton, scalar first; matrices have shape (..., 3, 3)."""
import numpy as np


def normalised(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def dot(a, b):
    return np.sum(a * b, axis=-1)


def rotated(matrices, vectors):
    return np.einsum("...ij,...j->...i", matrices, vectors)


def transposed(matrices):
    return np.swapaxes(matrices, -1, -2)


def about(axis, angle):
    """Rodrigues' formula for a unit axis (3,) and angles of any shape."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], float)
    angle = np.asarray(angle, float)[..., None, None]
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)


X, Y, Z = np.eye(3)


def roll_pitch_yaw(angles):
    """Rz(yaw) Ry(pitch) Rx(roll) of angles (..., 3) in radians."""
    angles = np.asarray(angles, float)
    return about(Z, angles[..., 2]) @ about(Y, angles[..., 1]) @ about(X, angles[..., 0])


def matrix_of_quaternion(q):
    w, x, y, z = np.moveaxis(np.asarray(q, float), -1, 0)
    return np.stack([np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], -1),
                     np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], -1),
                     np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1)], -2)


def rotation_vector(matrix):
    """The rotation vector of a rotation matrix whose angle is less than 180 degrees."""
    sine = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]) / 2
    length = np.linalg.norm(sine)
    angle = np.arctan2(length, (np.trace(matrix) - 1) / 2)
    return sine if length < 1e-12 else sine * (angle / length)
