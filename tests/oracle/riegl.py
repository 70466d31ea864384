# SPDX-License-Identifier: GPL-3.0-or-later
"""Full waveforms of an airborne scanner: LAS 1.4 (point format 9, external .wdp) and PulseWaves 0.3 (.pls, .wvs)."""
import os
import struct

import numpy as np

NAME = "riegl_fwf_2535pt_UTM"

POINT = np.dtype([("xyz", "<i4", 3), ("intensity", "<u2"), ("returns", "u1"), ("flags", "u1"), ("classification", "u1"), ("user", "u1"),
                  ("angle", "<i2"), ("source", "<u2"), ("t", "<f8"), ("descriptor", "u1"), ("offset", "<u8"), ("bytes", "<u4"),
                  ("location_ps", "<f4"), ("beam", "<f4", 3), ("amplitude", "<u2"), ("width", "<u2")])
PULSE = np.dtype([("t", "<i8"), ("offset", "<i8"), ("anchor", "<i4", 3), ("target", "<i4", 3), ("first", "<i2"), ("last", "<i2"), ("descriptor", "<u2"),
                  ("intensity", "u1"), ("classification", "u1")])


def read(folder, extension):
    with open(os.path.join(folder, NAME + extension), "rb") as file:
        return file.read()


class Returns:
    """The points of the .las, and their waveforms."""

    def __init__(self, folder):
        data = read(folder, ".las")
        offset, record = struct.unpack_from("<I", data, 96)[0], struct.unpack_from("<H", data, 105)[0]
        if data[104] != 9 or record != POINT.itemsize:
            raise ValueError(f"point format {data[104]} of {record} bytes")
        scale, origin = np.array(struct.unpack_from("<6d", data, 131)).reshape(2, 3)
        self.table = np.frombuffer(data, POINT, struct.unpack_from("<Q", data, 247)[0], offset)
        self.places = self.table["xyz"] * scale + origin
        self.resolution = scale
        self.waves = read(folder, ".wdp")

    def of_one(self):
        """The rows of pulses with one return, whose waveform has 60 samples."""
        return np.flatnonzero((self.table["returns"] >> 4 == 1) & (self.table["bytes"] == 120))

    def samples(self, row):
        """Counts, one a nanosecond."""
        point = self.table[row]
        return np.frombuffer(self.waves, "<u2", point["bytes"] // 2, int(point["offset"])).astype(float)


class Pulses:
    """Origins and directions of the .pls: sample s was scattered at anchor + s (target - anchor)/1000."""

    def __init__(self, folder):
        data = read(folder, ".pls")
        place, count = struct.unpack_from("<qq", data, 176)
        scale, origin = np.array(struct.unpack_from("<6d", data, 256)).reshape(2, 3)
        self.table = np.frombuffer(data, PULSE, count, place)
        self.anchors = self.table["anchor"] * scale + origin
        self.steps = (self.table["target"] - self.table["anchor"]) * scale / 1000
        self.resolution = scale
        self.waves = read(folder, ".wvs")
        # of the composition descriptor 200002: its second sampling record begins after 92 + 104 bytes
        record = data.index(b"1 x RP, 1 x LP, 0 x HP") - 28 + 92 + 104
        self.duration_ns = struct.unpack_from("<f", data, record + 12)[0]

    def starts_ns(self, rows):
        """The times of the first samples after the anchor, of pulses with one outgoing and one returning segment."""
        waves = self.waves
        starts = []
        for row in rows:
            first = int(self.table["offset"][row])
            outgoing = struct.unpack_from("<H", waves, first + 4)[0]
            starts.append(struct.unpack_from("<i", waves, first + 6 + outgoing)[0])
        return self.duration_ns * np.array(starts)
