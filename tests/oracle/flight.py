# SPDX-License-Identifier: GPL-3.0-or-later
"""A real airborne line scan (docs/quality/real-scan.md): its returns and trajectory in a DEM frame, and the geometry of its lines."""
import os
import struct

import numpy as np

from oracle import geodesy
from oracle.frames import normalised, roll_pitch_yaw, rotated, transposed

FACETS = 4
UTM_ZONE = 11
FORWARD_LEFT_UP = np.diag([1.0, -1.0, -1.0])  # the body's axes in those of the trajectory: forward, right, down
EAST_NORTH_UP = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])  # of north, east, down


def read_points(path):
    """GPS time and UTM coordinates of a LAS 1.2 file with point format 3."""
    with open(path, "rb") as file:
        data = file.read()
    offset, point_format, length, count = struct.unpack_from("<I", data, 96)[0], *struct.unpack_from("<BHI", data, 104)
    assert (data[:4], point_format, length) == (b"LASF", 3, 34)
    scale, shift = (np.array(struct.unpack_from("<3d", data, at)) for at in (131, 155))
    records = np.frombuffer(data, np.uint8, count * length, offset).reshape(count, length)
    xyz = np.ascontiguousarray(records[:, :12]).view("<i4") * scale + shift
    time = np.ascontiguousarray(records[:, 20:28]).view("<f8")[:, 0]
    order = np.argsort(time, kind="stable")
    return time[order], xyz[order]


class Flight:
    """Times from the first row of the trajectory. The DEM frame is east, north, up at the middle of the returns."""

    def __init__(self, folder):
        self.time, utm = read_points(os.path.join(folder, "leeward_points.las"))
        sbet = np.fromfile(os.path.join(folder, "leeward_sbet.out"), "<f8").reshape(-1, 17)
        start = sbet[0, 0]
        self.time, self.rows = self.time - start, sbet[:, 0] - start
        latitude, longitude = geodesy.of_utm(utm[:, 0], utm[:, 1], UTM_ZONE)
        points = geodesy.earth_centred(latitude, longitude, utm[:, 2])
        middle = [np.mean(values) for values in (latitude, longitude, utm[:, 2])]
        self.origin = geodesy.earth_centred(*middle)
        self.axes = EAST_NORTH_UP @ geodesy.north_east_down(*middle[:2])
        self.points = rotated(self.axes, points - self.origin)
        self.latitude, self.longitude, height = sbet[:, 1:4].T
        self.positions = rotated(self.axes, geodesy.earth_centred(self.latitude, self.longitude, height) - self.origin)
        self.roll, self.pitch, self.platform_heading, self.wander = (np.unwrap(sbet[:, n]) for n in (7, 8, 9, 10))
        # A line every 28 ms, each by the next facet.
        self.line = np.concatenate([[0], np.cumsum(np.diff(self.time) > 0.005)])
        self.facet = self.line % FACETS

    def attitudes(self, roll=1, pitch=1, wander=1):
        """R_dem_body (n, 3, 3) of the rows; the arguments multiply the angles."""
        heading = self.platform_heading - wander * self.wander
        to_ned = roll_pitch_yaw(np.stack([roll * self.roll, pitch * self.pitch, heading], -1))
        from_ned = self.axes @ transposed(geodesy.north_east_down(self.latitude, self.longitude))
        return from_ned @ to_ned @ FORWARD_LEFT_UP


def angles_of(matrices):
    """Roll, pitch, yaw (n, 3) in degrees of Rz(yaw) Ry(pitch) Rx(roll)."""
    m = np.asarray(matrices)
    return np.degrees(np.stack([np.arctan2(m[..., 2, 1], m[..., 2, 2]), -np.arcsin(m[..., 2, 0]),
                                np.unwrap(np.arctan2(m[..., 1, 0], m[..., 0, 0]), axis=0)], -1))


class Lines:
    """The small circles of the facets about a common axis, fitted to unit vectors in the body frame."""

    def __init__(self, directions, facet):
        means = np.array([directions[facet == f].mean(0) for f in range(FACETS)])
        rest = directions - means[facet]
        axis = np.linalg.eigh(rest.T @ rest)[1][:, 0]
        self.axis = -axis if axis[0] > 0 else axis  # backwards
        beside = np.arcsin(directions @ self.axis)
        self.offsets = np.array([beside[facet == f].mean() for f in range(FACETS)])
        self.residuals = beside - self.offsets[facet]
        self.rms = np.sqrt(np.mean(self.residuals**2))

    def tilts(self):
        """The offsets of the facets from the smallest one, ascending."""
        return np.sort(self.offsets - self.offsets.min())

    def mount(self):
        """R_body_lidar: y_L along the axis, z_L downwards, the lines along x_L."""
        x = normalised(np.cross(self.axis, [0, 0, -1.0]))
        return np.stack([x, self.axis, np.cross(x, self.axis)], -1)
